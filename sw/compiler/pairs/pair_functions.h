/* pair_functions.h - functions of double-single (double_single.h). docs/compiler.md has their errors, and
 * says what they are at the ends of the range. */
#ifndef FP3_PAIR_FUNCTIONS_H
#define FP3_PAIR_FUNCTIONS_H

#include "double_single.h"

/* |x| < 2^16, of the tangent 2^15: beyond that they are NaNs and raise invalid. With the pass `small-angles`
 * sine and cosine likewise beyond pi/2. */
fp3_pair fp3_pair_sine(dag *g, fp3_pair x);
fp3_pair fp3_pair_cosine(dag *g, fp3_pair x);
fp3_pair fp3_pair_tangent(dag *g, fp3_pair x);

/* r/tan(r) for |r| <= pi/4. */
fp3_pair fp3_pair_cotangent_times(dag *g, fp3_pair r);

fp3_pair fp3_pair_atan(dag *g, fp3_pair x);
fp3_pair fp3_pair_atan2(dag *g, fp3_pair y, fp3_pair x);
fp3_pair fp3_pair_asin(dag *g, fp3_pair x);
fp3_pair fp3_pair_acos(dag *g, fp3_pair x);

fp3_pair fp3_pair_exp(dag *g, fp3_pair x);
fp3_pair fp3_pair_sinh(dag *g, fp3_pair x);
fp3_pair fp3_pair_cosh(dag *g, fp3_pair x);
fp3_pair fp3_pair_tanh(dag *g, fp3_pair x);
fp3_pair fp3_pair_log(dag *g, fp3_pair x);

/* x^n, where n is a known value and x is not. */
fp3_pair fp3_pair_power(dag *g, fp3_pair x, uint32_t n);

#endif
