/* SPDX-License-Identifier: Apache-2.0 */
/* side.h - the two sides of an equation: whose it is, and what that is. */
#ifndef FP3_ODE_SIDE_H
#define FP3_ODE_SIDE_H

#include "parser.h"

/* The state, or component of one, that an equation is for: the name, which is read already, and
 * what stands behind it. NULL after an error, and where it is skipped. */
const ode_symbol *fp3_ode_target(ode_parser *p, fp3_token name, unsigned *start, unsigned *size);
/* An equation at this token, for the indices around it. */
ode_equation fp3_ode_equation(const ode_parser *p, fp3_token at, uint32_t expr);
/* "= expression" of this size (0: of any); a value of size 0 after an error. */
ode_value fp3_ode_right_side(ode_parser *p, ode_context context, unsigned size);

#endif
