/* relation.h - how objects see others: `links`, `near`, `all`, and sums over neighbours. */
#ifndef FP3_ODE_RELATION_H
#define FP3_ODE_RELATION_H

#include "parser.h"

/* Whether the word begins the declaration of a relation. */
int fp3_ode_is_relation(fp3_token word);
/* The rest of the statement: "springs(k = 10 [N/m])". */
void fp3_ode_relation(ode_parser *p, fp3_token word);

/* Whether "o in springs" is next, with the name of a relation. */
int fp3_ode_at_neighbours(ode_parser *p);
/* Reads "o in springs: term", inside of `sum`, which is this token. */
ode_value fp3_ode_over_neighbours(ode_parser *p, fp3_token sum);
/* What "o.x" stands for, where o is a neighbour; the token has been read. */
ode_value fp3_ode_of_neighbour(ode_parser *p, fp3_token name, const ode_symbol *neighbour);

/* Where sums over neighbours may not be: what happens at the end of a step, and what is observed. */
void fp3_ode_check_sums(ode_parser *p);

#endif
