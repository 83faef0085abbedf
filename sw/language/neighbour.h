/* SPDX-License-Identifier: Apache-2.0 */
/* neighbour.h - what an expression says of the neighbours of an object. expression.h reads the
 * expressions within. */
#ifndef FP3_ODE_NEIGHBOUR_H
#define FP3_ODE_NEIGHBOUR_H

#include "parser.h"

/* The field of this name that the entries of a relation have, or NULL; of a vector the first
 * component. The name may have a component behind it: s.x. */
const ode_quantity *fp3_ode_field(const ode_parser *p, const fp3_relation *relation,
                                  fp3_token name);

/* What is made of a term over all neighbours: a sum, its least, its most, how many terms are not 0,
 * whether any is. */
typedef enum { ODE_SUM, ODE_LEAST, ODE_MOST, ODE_COUNT, ODE_ANY, ODE_NO_FOLD } ode_fold;

/* Of a function's name; ODE_NO_FOLD: that function goes over no neighbours. */
ode_fold fp3_ode_fold_named(fp3_token name);

typedef struct {
    fp3_token at; /* the function's name */
    ode_fold fold;
    uint32_t relation, symbol; /* symbol: FP3_NONE: its name cannot be one */
    int has_term;              /* 0: `count(o in touch)`, of all neighbours */
} ode_neighbours;

/* Whether "o in springs" is next, with the name of a relation. */
int fp3_ode_at_neighbours(ode_parser *p);
/* Reads it, up to where the term begins; 0 after an error. at: the function's name. */
int fp3_ode_neighbours_open(ode_parser *p, fp3_token at, ode_neighbours *n);
/* Behind the term: the neighbour's name ends. */
void fp3_ode_neighbours_behind(ode_parser *p, const ode_neighbours *n);
/* What is so for near neighbours, and otherwise for those beyond the reach; of other relations the
 * first. */
ode_value fp3_ode_where_near(ode_parser *p, fp3_token at, uint32_t relation, ode_value near,
                             ode_value otherwise);
/* The fold of this term; a least and a most begin with start, a value of the object's own. */
ode_value fp3_ode_neighbours_close(ode_parser *p, const ode_neighbours *n, ode_value term,
                                   ode_value start);

/* What all objects of an invariant's group give: a sum over them, or over the pairs of a relation.
 */
typedef struct {
    fp3_token at; /* the function's name */
    fp3_expr_op op;
    uint32_t relation, symbol; /* of pairs, as of neighbours */
} ode_group;

/* Whether "objects:" or "pairs o in springs" is next. */
int fp3_ode_at_group(const ode_parser *p);
/* As the functions for neighbours. */
int fp3_ode_group_open(ode_parser *p, fp3_token at, ode_group *g);
ode_value fp3_ode_group_close(ode_parser *p, const ode_group *g, ode_value term);

/* Of "o.x", where o is a neighbour, the part x; 0 after an error. */
int fp3_ode_neighbours_part(ode_parser *p, fp3_token name, fp3_token *part);
/* What it stands for: a field of the link, or what another symbol is of the neighbour. */
ode_value fp3_ode_neighbours_field(ode_parser *p, fp3_token name, fp3_token part,
                                   const ode_quantity *field);
/* Words of a neighbour of another kind. */
ode_value fp3_ode_foreign(ode_parser *p, fp3_token at, uint32_t first, unsigned size);
ode_value fp3_ode_neighbours_value(ode_parser *p, fp3_token name, const fp3_relation *relation,
                                   const ode_symbol *symbol, unsigned start, unsigned size);

#endif
