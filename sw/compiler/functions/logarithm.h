/* SPDX-License-Identifier: Apache-2.0 */
/* logarithm.h - log, and powers with an exponent that is known. docs/compiler.md has the errors. */
#ifndef FP3_LOGARITHM_H
#define FP3_LOGARITHM_H

#include "compiler/value/dag.h"

/* x^n, where n is a known value and x is not. A negative x is a NaN, and raises invalid, unless n
 * is an integer. */
uint32_t fp3_power(dag *g, uint32_t x, uint32_t n);

/* Double-single uses these functions, too. A scale for x, so that the product has a normal power of
 * two; 0 for a negative x, which makes e a NaN. Of x scale and scale: x = m 2^-e with m from
 * sqrt(1/2) to sqrt(2), m = (x scale) power. 0 is 0 2^-inf, infinity is inf 2^inf. */
typedef struct {
    uint32_t m, power, e;
} fp3_log_parts;
uint32_t fp3_log_scale(dag *g, uint32_t x);
fp3_log_parts fp3_log_parts_of(dag *g, uint32_t scaled, uint32_t scale);
uint32_t fp3_log_near_1(dag *g, uint32_t m); /* of such an m */

#endif
