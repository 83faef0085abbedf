/* SPDX-License-Identifier: Apache-2.0 */
/* estimate.c - see estimate.h; rtl/fp/fp3_fp_value.v does the same. */
#include "estimate.h"

#include "gen/estimates.h"

#include <fp3/isa.h>

#define SIGN FP3_BITS_MINUS_ZERO
#define INFINITE 0x7f800000u
#define SIGNALLING 0x7fa00000u /* a NaN that raises invalid */
#define FRACTION 0x007fffffu

static int is_nan(uint32_t a) { return (a & ~SIGN) > INFINITE; }

static uint32_t exponent(uint32_t a) { return a >> 23 & 255; }

uint32_t fp3_estimate_rcp(uint32_t a) {
    const uint32_t sign = a & SIGN, e = exponent(a);
    if (is_nan(a))
        return a;
    if (e == 0)
        return sign | INFINITE;
    if (e == 255)
        return sign;
    const uint32_t entry = fp3_estimates[(a & FRACTION) >> 13];
    return sign | (e < 253 ? (253 - e) << 23 | entry << 14 : (512 | entry) >> (e - 253) << 13);
}

uint32_t fp3_estimate_rsqrt(uint32_t a) {
    const uint32_t e = exponent(a), odd = e & 1;
    if (is_nan(a))
        return a;
    if (e == 0)
        return INFINITE;
    if (a & SIGN)
        return SIGNALLING;
    if (e == 255)
        return 0;
    const uint32_t entry = fp3_estimates[1024 + 512 * odd + ((a & FRACTION) >> 14)];
    return (190 - (e + 1) / 2) << 23 | entry << (13 + odd);
}

void fp3_estimate_table(int table[FP3_ESTIMATES]) {
    for (int i = 0; i < FP3_ESTIMATES; i++)
        table[i] = fp3_estimates[i];
}
