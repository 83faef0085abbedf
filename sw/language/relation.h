/* SPDX-License-Identifier: Apache-2.0 */
/* relation.h - how objects see others: `links`, `near`, `all`. */
#ifndef FP3_ODE_RELATION_H
#define FP3_ODE_RELATION_H

#include "parser.h"

/* Whether the word begins the declaration of a relation. */
int fp3_ode_is_relation(fp3_token word);
/* The rest of the statement: "springs(k = 10 [N/m])". */
void fp3_ode_relation(ode_parser *p, fp3_token word);

/* Where sums over neighbours may not be: what happens at the end of a step, and what is observed.
 */
void fp3_ode_check_sums(ode_parser *p);

#endif
