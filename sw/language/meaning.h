/* SPDX-License-Identifier: Apache-2.0 */
/* meaning.h - what names stand for in an expression. */
#ifndef FP3_ODE_MEANING_H
#define FP3_ODE_MEANING_H

#include "parser.h"

/* The value of a symbol, or of `size` components of it from `start` on, where this expression may
 * have it; of size 0 after an error, and where it is skipped. */
ode_value fp3_ode_stands_for(ode_parser *p, fp3_token name, const ode_symbol *symbol,
                             unsigned start, unsigned size);
/* As many leaves, with these indices. */
ode_value fp3_ode_leaves(ode_parser *p, fp3_token at, fp3_expr_op op, uint32_t first,
                         unsigned size);

#endif
