/* SPDX-License-Identifier: Apache-2.0 */
/* exponential.h - powers of e, for whatever is made of them. */
#ifndef FP3_EXPONENTIAL_H
#define FP3_EXPONENTIAL_H

#include "compiler/value/dag.h"

/* In two parts, so that the product of the first with an integer below 2^9 is exact. */
#define FP3_LN2_HIGH 0x1.62e4p-1
#define FP3_LN2_LOW 0x1.7f7d1cf79abcap-20

/* e^r 2^k for |r| <= ln 2 and integers -150 <= k <= 127, with one rounding of the product. A larger
 * r with k = 127 overflows, as a product does. */
uint32_t fp3_exp_scaled(dag *g, uint32_t r, uint32_t k);

/* limit, if n is beyond it; n, if it is a NaN. */
uint32_t fp3_at_most(dag *g, double limit, uint32_t n);
uint32_t fp3_at_least(dag *g, double limit, uint32_t n);

#endif
