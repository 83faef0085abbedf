/* SPDX-License-Identifier: Apache-2.0 */
/* relation.h - how objects see others: `links`, `near`, `all`. */
#ifndef FP3_ODE_RELATION_H
#define FP3_ODE_RELATION_H

#include "parser.h"

/* Whether the word begins the declaration of a relation. */
int fp3_ode_is_relation(fp3_token word);
/* The rest of the statement: "springs(k = 10 [N/m])". */
void fp3_ode_relation(ode_parser *p, fp3_token word);

/* Tells invariants of an object from those of all objects, and checks what they are made of. */
void fp3_ode_finish_invariants(ode_parser *p);

#endif
