/* SPDX-License-Identifier: Apache-2.0 */
/* lns.h - logarithmic arithmetic, bit for bit as rtl/lns/lns_*.v computes it: see
 * docs/logarithmic.md.
 *
 *     uint32_t flags;
 *     const uint32_t two = fp3_lns_add(FP3_BITS_ONE, FP3_BITS_ONE, &flags);     0x40000000, flags 0
 *
 * A word is the sign and 31 bits n, the number 2^(n / 2^23 - 127); n = 0 is zero, the words of
 * infinity and NaN are those of binary32. flags are FP3_FLAG_*. Integers alone compute: every
 * machine gives the same bits.
 */
#ifndef FP3_LNS_H
#define FP3_LNS_H

#include <stdint.h>

/* Exact unless they leave the range. */
uint32_t fp3_lns_mul(uint32_t a, uint32_t b, uint32_t *flags);
uint32_t fp3_lns_div(uint32_t a, uint32_t b, uint32_t *flags);
uint32_t fp3_lns_rcp(uint32_t a, uint32_t *flags);

/* To the nearest word, ties to even. */
uint32_t fp3_lns_rsqrt(uint32_t a, uint32_t *flags);

/* Within 0.65 of the last place of the logarithm, where operands cancel, too. */
uint32_t fp3_lns_add(uint32_t a, uint32_t b, uint32_t *flags);
uint32_t fp3_lns_sub(uint32_t a, uint32_t b, uint32_t *flags);

/* From and to binary32, within 0.65 of the last place of the result. */
uint32_t fp3_lns_from_float(uint32_t a, uint32_t *flags);
uint32_t fp3_lns_to_float(uint32_t a, uint32_t *flags);

/* 1/a and 1/sqrt(a) of binary32 numbers, through their logarithms: within 0.95 of the last place.
 * Flags and special operands are those of IEEE 754, but 1/sqrt(-0) is +infinity. */
uint32_t fp3_lns_float_rcp(uint32_t a, uint32_t *flags);
uint32_t fp3_lns_float_rsqrt(uint32_t a, uint32_t *flags);

/* log2(1 + 2^-r) or, with subtract, log2(1 - 2^-r), in units of 2^-23 both, 0 <= r < 2^28 (r > 0
 * with subtract): all that is not exact in a sum. */
int32_t fp3_lns_of_distance(uint32_t r, int subtract);

#endif
