/* SPDX-License-Identifier: Apache-2.0 */
/* narrow.c - see narrow.h. */
#include "narrow.h"

#include <fp3/isa.h>

#define SIGN FP3_BITS_MINUS_ZERO
#define INFINITE 0x7f800000u
#define FRACTION 0x007fffffu
#define HIDDEN 0x00800000u
#define QUIET 0x00400000u
#define TOP 62 /* the bit of a significand's leading 1: a sum has room for a carry */

/* m 2^e with its sign: the leading bit of m is TOP, or m is 0. Bit 0 says also whether the rest
 * below it is not 0. */
typedef struct {
    uint32_t sign;
    uint64_t m;
    int e;
} number;

static int below(const fp3_config *config) { return (int)(23 - config->fraction); }

uint32_t fp3_narrow_read(const fp3_config *config, uint32_t word) {
    return word & UINT32_MAX << below(config);
}

static int is_nan(uint32_t a) { return (a & ~SIGN) > INFINITE; }

static int is_signalling(uint32_t a) { return is_nan(a) && !(a & QUIET); }

static int is_infinite(uint32_t a) { return (a & ~SIGN) == INFINITE; }

static uint32_t invalid(uint32_t *flags) {
    *flags |= FP3_FLAG_INVALID;
    return FP3_BITS_NAN;
}

static number normal(uint32_t sign, uint64_t m, int e) {
    const int zeros = m ? __builtin_clzll(m) - (63 - TOP) : 0;
    if (zeros < 0) /* a carry */
        return (number){sign, m >> 1 | (m & 1), e + 1};
    return (number){sign, m << zeros, e - zeros};
}

/* Where subnormal numbers are flushed they are zeros of their sign. */
static number read(const fp3_config *config, uint32_t a) {
    const int e = (int)(a >> 23 & 255);
    const uint64_t m = e ? (a & FRACTION) | HIDDEN : config->subnormal ? a & FRACTION : 0;
    return normal(a & SIGN, m, (e ? e : 1) - 150);
}

/* m without its lowest bits, rounded; whether they were not 0. */
static uint64_t shortened(const fp3_config *config, uint64_t m, int bits, int *has_rest) {
    const uint64_t rest = m & ((UINT64_C(1) << bits) - 1), half = UINT64_C(1) << (bits - 1);
    const uint64_t kept = m >> bits;
    *has_rest = rest != 0;
    return kept + (config->nearest && (rest > half || (rest == half && kept & 1)));
}

static uint32_t rounded(const fp3_config *config, number x, uint32_t *flags) {
    const int places = TOP - (int)config->fraction, e = x.e + TOP + 127; /* e: of a normal number */
    int has_rest;
    if (!x.m)
        return x.sign;
    if (e < 1 && !config->subnormal) {
        *flags |= FP3_FLAG_UNDERFLOW | FP3_FLAG_INEXACT;
        return x.sign;
    }
    if (e >= 1) {
        const uint64_t kept = shortened(config, x.m, places, &has_rest);
        const uint64_t bits = ((uint64_t)(e - 1) << 23) + (kept << below(config));
        *flags |= has_rest ? FP3_FLAG_INEXACT : 0;
        if (bits < INFINITE)
            return x.sign | (uint32_t)bits;
        *flags |= FP3_FLAG_OVERFLOW | FP3_FLAG_INEXACT;
        return x.sign | (config->nearest ? INFINITE : fp3_narrow_read(config, INFINITE - 1));
    }
    /* Tiny, unless it were 2^-126 once rounded as if exponents had no bound: 754, 7.5. */
    const int is_tiny = e < 0 || shortened(config, x.m, places, &has_rest) >> config->fraction == 1;
    const int more = places + 1 - e;
    const uint64_t kept = shortened(config, more > 63 ? 1 : x.m, more > 63 ? 63 : more, &has_rest);
    *flags |= has_rest ? FP3_FLAG_INEXACT | (is_tiny ? FP3_FLAG_UNDERFLOW : 0) : 0;
    return x.sign | (uint32_t)kept << below(config);
}

/* Neither is 0. */
static number sum(number x, number y) {
    const int is_greater = x.e > y.e || (x.e == y.e && x.m >= y.m);
    const number big = is_greater ? x : y, little = is_greater ? y : x;
    const int distance = big.e - little.e;
    const uint64_t moved =
        distance > TOP ? 1
                       : little.m >> distance | ((little.m & ((UINT64_C(1) << distance) - 1)) != 0);
    if (x.sign == y.sign)
        return normal(big.sign, big.m + moved, big.e);
    return normal(big.m == moved ? 0 : big.sign, big.m - moved, big.e);
}

static uint32_t add(const fp3_config *config, number x, number y, uint32_t *flags) {
    if (!x.m && !y.m)
        return x.sign & y.sign;
    return rounded(config, !x.m ? y : !y.m ? x : sum(x, y), flags);
}

/* Exact. */
static number product(const fp3_config *config, uint32_t a, uint32_t b) {
    const number x = read(config, a), y = read(config, b);
    return normal(x.sign ^ y.sign, (x.m >> 32) * (y.m >> 32), x.e + y.e + 64);
}

static int is_zero(const fp3_config *config, uint32_t a) { return !read(config, a).m; }

uint32_t fp3_narrow_add(const fp3_config *config, uint32_t a, uint32_t b, uint32_t *flags) {
    a = fp3_narrow_read(config, a);
    b = fp3_narrow_read(config, b);
    if (is_signalling(a) || is_signalling(b) || (is_infinite(a) && b == (a ^ SIGN)))
        return invalid(flags);
    if (is_nan(a) || is_nan(b))
        return FP3_BITS_NAN;
    if (is_infinite(a) || is_infinite(b))
        return is_infinite(a) ? a : b;
    return add(config, read(config, a), read(config, b), flags);
}

/* Of a product that is no number: its infinity, NaN, or 0 if it is one. */
static uint32_t special(const fp3_config *config, uint32_t a, uint32_t b, uint32_t *flags) {
    if (is_signalling(a) || is_signalling(b) || (is_infinite(a) && is_zero(config, b)) ||
        (is_infinite(b) && is_zero(config, a)))
        return invalid(flags);
    if (is_nan(a) || is_nan(b))
        return FP3_BITS_NAN;
    return is_infinite(a) || is_infinite(b) ? ((a ^ b) & SIGN) | INFINITE : 0;
}

uint32_t fp3_narrow_mul(const fp3_config *config, uint32_t a, uint32_t b, uint32_t *flags) {
    a = fp3_narrow_read(config, a);
    b = fp3_narrow_read(config, b);
    const uint32_t other = special(config, a, b, flags);
    return other ? other : rounded(config, product(config, a, b), flags);
}

uint32_t fp3_narrow_fma(const fp3_config *config, uint32_t a, uint32_t b, uint32_t c,
                        uint32_t *flags) {
    a = fp3_narrow_read(config, a);
    b = fp3_narrow_read(config, b);
    c = fp3_narrow_read(config, c);
    const uint32_t other = special(config, a, b, flags);
    if (other || is_nan(c) || is_infinite(c))
        return fp3_narrow_add(config, other, c, flags);
    return add(config, product(config, a, b), read(config, c), flags);
}
