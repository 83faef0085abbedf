/* SPDX-License-Identifier: Apache-2.0 */
/* remember.h - `remember`: fields of neighbours that each step gives a value. */
#ifndef FP3_ODE_REMEMBER_H
#define FP3_ODE_REMEMBER_H

#include "parser.h"

/* Whether the word, which has been read, begins one. */
int fp3_ode_is_remember(const ode_parser *p, fp3_token first);
/* The rest of it: "o in touch: o.s = o.s + h*o.v". */
void fp3_ode_remember(ode_parser *p);
/* At the end of the source: near objects have no other fields than those. */
void fp3_ode_check_memories(ode_parser *p);

#endif
