/* SPDX-License-Identifier: Apache-2.0 */
/* circular.h - what sine, cosine and tangent of floats share with those of pairs. */
#ifndef FP3_CIRCULAR_H
#define FP3_CIRCULAR_H

#include "compiler/value/term.h"

/* rint(x/unit), and infinite where limit times x overflows: x less an infinite n times parts of
 * different signs is a NaN, and raises invalid. */
uint32_t fp3_nearest_multiple(dag *g, uint32_t x, double unit, double limit);
/* Not 0 if n is odd. */
uint32_t fp3_is_odd(dag *g, uint32_t n);
/* x, or a NaN if |x| > pi/2. */
uint32_t fp3_small_angle(dag *g, uint32_t x);

#endif
