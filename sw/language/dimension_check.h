/* SPDX-License-Identifier: Apache-2.0 */
/* dimension_check.h - the dimension of each expression, from those of its operands. */
#ifndef FP3_ODE_DIMENSION_CHECK_H
#define FP3_ODE_DIMENSION_CHECK_H

#include "parser.h"

/* Of the expressions from .. expr_count-1. Reports operands that do not fit. */
void fp3_ode_check_dimensions(ode_parser *p, uint32_t from);
/* Whether the equations' right sides fit the states, once the step's dimension is known. */
void fp3_ode_check_equations(ode_parser *p);

#endif
