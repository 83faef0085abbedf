/* SPDX-License-Identifier: Apache-2.0 */
/* pair_functions.h - functions of double-single (double_single.h). docs/compiler.md has their
 * errors, and their values at the ends of the range. */
#ifndef FP3_PAIR_FUNCTIONS_H
#define FP3_PAIR_FUNCTIONS_H

#include "double_single.h"
#include "language/function_rows.h"

/* fp3_pair_sin, ...: a declaration for each row that has constants. */
#define FP3_PAIR_INSTRUCTIONS(name)
#define FP3_PAIR_POLYNOMIAL(name) fp3_pair fp3_pair_##name(dag *g, fp3_pair x);
#define FP3_PAIR_POLYNOMIAL_2(name) fp3_pair fp3_pair_##name(dag *g, fp3_pair y, fp3_pair x);
#define X(OP, name, MADE, ...) FP3_PAIR_##MADE(name)
FP3_FUNCTION_ROWS(X)
#undef X

/* r/tan(r) for |r| <= pi/4. */
fp3_pair fp3_pair_cotangent_times(dag *g, fp3_pair r);

/* x^n, where n is a known value and x is not. */
fp3_pair fp3_pair_power(dag *g, fp3_pair x, uint32_t n);

#endif
