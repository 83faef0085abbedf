/* SPDX-License-Identifier: Apache-2.0 */
/* division.h - quotients and roots from the machine's estimates. */
#ifndef FP3_DIVISION_H
#define FP3_DIVISION_H

#include "compiler/value/term.h"

/* An estimate y and a small t, so that x/b or x/sqrt(b) is x y (1 + t). Two of the same b share
 * both. t is FP3_NONE where y is no estimate, but as near to 1/b or 1/sqrt(b) as a word can be, or
 * almost: keys logarithmic and mixed. */
typedef struct {
    uint32_t estimate, correction;
} fp3_series;

fp3_series fp3_reciprocal(dag *g, uint32_t b);
fp3_series fp3_inverse_root(dag *g, uint32_t b);

/* x y (1 + t) */
term fp3_corrected(dag *g, term x, fp3_series s);

/* The same of an inverse root that may be that of 0, as x/b and x/b^n are below. */
term fp3_over_root(dag *g, term x, fp3_series s);
term fp3_quotient(dag *g, term x, uint32_t b);
term fp3_over_power(dag *g, term x, uint32_t b, unsigned n);

/* x r^n of a reciprocal r. */
term fp3_times_power(dag *g, term x, term r, unsigned n);

/* Of b below 2^-126 with the estimate of 2^-126, so that b times it is small. */
fp3_series fp3_finite_inverse_root(dag *g, uint32_t b);

/* sqrt(b) is b/sqrt(b), 0 for 0. Below 2^-126 the root is off by 2^-65 at most. The second function
 * shares values with x/sqrt(b), and like x/sqrt(b) raises invalid for 0. */
uint32_t fp3_root(dag *g, uint32_t b);
uint32_t fp3_root_beside_inverse(dag *g, uint32_t b);

#endif
