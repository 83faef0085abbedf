/* SPDX-License-Identifier: Apache-2.0 */
/* estimate.h - the first approximations that rcp and rsqrt give, bit for bit.
 *
 * Binary32 bits in and out. A NaN comes out as it went in: the instruction then adds -0, which
 * makes it 7FC00000 and raises invalid if it was a signalling one.
 */
#ifndef FP3_ESTIMATE_H
#define FP3_ESTIMATE_H

#include <stdint.h>

/* y ~ 1/a: 0 <= 1 - a*y < 2^-9 + 2^-11 while a is below 2^127 in size, 2^-8 above it, where y is
 * subnormal as above 2^126. That of 0 or a subnormal a is an infinity with the sign of a, that of
 * an infinity a 0. */
uint32_t fp3_estimate_rcp(uint32_t a);

/* y ~ 1/sqrt(a): 0 <= 1 - a*y*y < 2^-8 for normal a > 0. For 0 and subnormal a, of either sign,
 * infinity; for every other a < 0 the signalling NaN 7FA00000; for infinity 0. */
uint32_t fp3_estimate_rsqrt(uint32_t a);

/* Both tables, as a vector of objects looks things up: that of rcp by the 10 upper bits of the
 * fraction, behind it that of rsqrt by the lowest bit of the exponent and 9 of the fraction. */
#define FP3_ESTIMATES 2048
void fp3_estimate_table(int table[FP3_ESTIMATES]);

#endif
