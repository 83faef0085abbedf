/* SPDX-License-Identifier: Apache-2.0 */
/* lns.c - see lns.h; rtl/lns/lns_*.v does the same. */
#include "lns.h"

#include "gen/logarithms.h"

#include <fp3/isa.h>

#define SIGN 0x80000000u
#define FIELD 0x7fffffffu
#define INFINITE 0x7f800000u
#define ONE ((int64_t)FP3_BITS_ONE)
/* A distance of 4: nearer operands that cancel take another way. */
#define FOUR (UINT32_C(1) << 25)
#define WHOLE (INT64_C(1) << 28) /* a logarithm of 1: tables have 28 bits behind the point */
#define FAR (UINT32_C(1) << 28)  /* a distance of 32: the smaller operand does not count */

static int is_nan(uint32_t a) { return (a & FIELD) > INFINITE; }

static int is_infinite(uint32_t a) { return (a & FIELD) == INFINITE; }

static int is_zero(uint32_t a) { return !(a & FIELD); }

static uint32_t invalid(uint32_t *flags) {
    *flags = FP3_FLAG_INVALID;
    return FP3_BITS_NAN;
}

/* What leaves the range becomes zero or infinity. */
static uint32_t limited(uint32_t sign, int64_t n, uint32_t *flags) {
    if (n <= 0) {
        *flags |= FP3_FLAG_UNDERFLOW | FP3_FLAG_INEXACT;
        return sign;
    }
    if (n >= INFINITE) {
        *flags |= FP3_FLAG_OVERFLOW | FP3_FLAG_INEXACT;
        return sign | INFINITE;
    }
    return sign | (uint32_t)n;
}

uint32_t fp3_lns_mul(uint32_t a, uint32_t b, uint32_t *flags) {
    const uint32_t sign = (a ^ b) & SIGN;
    *flags = 0;
    if (is_nan(a) || is_nan(b))
        return FP3_BITS_NAN;
    if ((is_infinite(a) && is_zero(b)) || (is_zero(a) && is_infinite(b)))
        return invalid(flags);
    if (is_infinite(a) || is_infinite(b))
        return sign | INFINITE;
    if (is_zero(a) || is_zero(b))
        return sign;
    return limited(sign, (int64_t)(a & FIELD) + (b & FIELD) - ONE, flags);
}

uint32_t fp3_lns_div(uint32_t a, uint32_t b, uint32_t *flags) {
    const uint32_t sign = (a ^ b) & SIGN;
    *flags = 0;
    if (is_nan(a) || is_nan(b))
        return FP3_BITS_NAN;
    if ((is_infinite(a) && is_infinite(b)) || (is_zero(a) && is_zero(b)))
        return invalid(flags);
    if (is_zero(b) && !is_infinite(a))
        *flags = FP3_FLAG_DIVIDE_BY_ZERO;
    if (is_infinite(a) || is_zero(b))
        return sign | INFINITE;
    if (is_zero(a) || is_infinite(b))
        return sign;
    return limited(sign, (int64_t)(a & FIELD) - (b & FIELD) + ONE, flags);
}

uint32_t fp3_lns_rcp(uint32_t a, uint32_t *flags) { return fp3_lns_div(FP3_BITS_ONE, a, flags); }

/* Half of an even or odd number, to nearest, ties to even. */
static uint32_t half(uint32_t twice, uint32_t *flags) {
    *flags = twice & 1 ? FP3_FLAG_INEXACT : 0;
    return (twice + (twice >> 1 & 1)) >> 1;
}

uint32_t fp3_lns_rsqrt(uint32_t a, uint32_t *flags) {
    *flags = 0;
    if (is_nan(a))
        return FP3_BITS_NAN;
    if (is_zero(a)) {
        *flags = FP3_FLAG_DIVIDE_BY_ZERO;
        return INFINITE;
    }
    if (a & SIGN)
        return invalid(flags);
    return a == INFINITE ? 0 : half(3 * FP3_BITS_ONE - a, flags);
}

/* A function of x / 2^24 in 0 .. 1, in units of 2^-28: log2(1 + x) - x, or with power 1 + x - 2^x.
 */
static int64_t curve(uint32_t x, int power) {
    const fp3_lns_curve *word = &fp3_lns_curves[512 * power + (x >> 15)];
    const int64_t v = x & 0x7fff;
    return word->c0 + (word->c1 * v >> 14) - (word->c2 * (v * v >> 13) >> 17);
}

int32_t fp3_lns_of_distance(uint32_t r, int subtract) {
    const int band = r >> 27 ? 2 : r >> 26 ? 1 : 0; /* r below 32, 16, 8 */
    const uint32_t first[] = {0, 256, 384};
    const uint32_t u = r >> band & 0x3ffff;
    const uint32_t word = first[band] + (r >> (18 + band) & (band ? 127 : 255));
    const fp3_lns_sum *c = &fp3_lns_sums[512 * !!subtract + word];
    const int64_t t = ((int64_t)c->c2 * u >> 12) + c->c3;
    int64_t sum = c->c0 - ((int64_t)c->c1 * u >> 14) + (t * u >> 21);
    if (subtract && r < FOUR) { /* r = 2^(1 - n) (1 + f) */
        uint32_t n = 0;
        while (n < 24 && !(r << n & FOUR >> 1))
            n++;
        const uint32_t f = (r << n) & 0xffffff;
        sum += (((int64_t)f - ((int64_t)(n + 1) << 24)) * 16) + curve(f, 0);
    } else if (subtract) {
        sum = ~sum;
    }
    return (int32_t)(sum >> 5);
}

static uint32_t sum(uint32_t a, uint32_t b, uint32_t *flags) {
    *flags = 0;
    if (is_nan(a) || is_nan(b))
        return FP3_BITS_NAN;
    if (is_infinite(a) && is_infinite(b) && a != b)
        return invalid(flags);
    const uint32_t x = a & FIELD, y = b & FIELD;
    const uint32_t big = x < y ? b : a, r = x < y ? y - x : x - y;
    const int subtract = (a ^ b) >> 31;
    if (subtract && r == 0)
        return 0;
    if (is_infinite(big) || is_zero(a) || is_zero(b))
        return big; /* of two zeros they have one sign */
    /* 2^x + 2^y is a power of two of this fineness in two cases alone: docs/logarithmic.md */
    *flags = (subtract ? r == UINT32_C(1) << 23 : r == 0) ? 0 : FP3_FLAG_INEXACT;
    if (r >= FAR)
        return big;
    return limited(big & SIGN, (int64_t)(big & FIELD) + fp3_lns_of_distance(r, subtract), flags);
}

uint32_t fp3_lns_add(uint32_t a, uint32_t b, uint32_t *flags) { return sum(a, b, flags); }

uint32_t fp3_lns_sub(uint32_t a, uint32_t b, uint32_t *flags) { return sum(a, b ^ SIGN, flags); }

uint32_t fp3_lns_from_float(uint32_t a, uint32_t *flags) {
    const uint32_t sign = a & SIGN, size = a & FIELD;
    *flags = 0;
    if (is_nan(a))
        return FP3_BITS_NAN;
    if (size == 0 || size == INFINITE)
        return a;
    if (size <= 0x400000) { /* up to 2^-127 */
        *flags = FP3_FLAG_UNDERFLOW | FP3_FLAG_INEXACT;
        return sign;
    }
    const uint32_t e = size >> 23, f = e ? (size & 0x7fffff) << 1 : (size & 0x3fffff) << 2;
    if (f)
        *flags = FP3_FLAG_INEXACT;
    return sign | ((e << 23) + (uint32_t)(((int64_t)f * 16 + curve(f, 0) + 16) >> 5));
}

uint32_t fp3_lns_to_float(uint32_t a, uint32_t *flags) {
    const uint32_t sign = a & SIGN, size = a & FIELD;
    *flags = 0;
    if (is_nan(a))
        return FP3_BITS_NAN;
    if (size == 0 || size == INFINITE)
        return a;
    const uint32_t e = size >> 23, x = (size & 0x7fffff) << 1;
    const int64_t one = 1 << 28, fraction = (int64_t)x * 16 - curve(x, 1);
    *flags = (x ? FP3_FLAG_INEXACT : 0) | (e ? 0 : FP3_FLAG_UNDERFLOW);
    return sign | (uint32_t)(e ? (e * one + fraction + 16) >> 5 : (one + fraction + 32) >> 6);
}

/* A number above 0 is 2^(log / 2^28). Returns whether the logarithm is a whole number. */
static int logarithm(uint32_t a, int64_t *log) {
    const uint32_t field = a >> 23;
    const uint32_t m = field ? (a & 0x7fffff) | 0x800000 : a;
    const int zeros = __builtin_clz(m) - 8;
    const uint32_t x = (m << zeros & 0x7fffff) << 1;
    const int64_t whole = (int64_t)(field ? field : 1) - 127 - zeros;
    *log = whole * WHOLE + (int64_t)x * 16 + curve(x, 0);
    return x == 0;
}

/* The number 2^(n / 2^24). */
static uint32_t power(int64_t n, int is_exact, uint32_t *flags) {
    const int64_t e = (n >> 24) + 127;
    const uint32_t x = (uint32_t)n & 0xffffff;
    const int64_t significand = WHOLE + (int64_t)x * 16 - curve(x, 1);
    *flags = is_exact ? 0 : FP3_FLAG_INEXACT;
    if (e >= 255) {
        *flags = FP3_FLAG_OVERFLOW | FP3_FLAG_INEXACT;
        return INFINITE;
    }
    if (e >= 1)
        return (uint32_t)(((e - 1) * WHOLE + significand + 16) >> 5);
    *flags |= is_exact ? 0 : FP3_FLAG_UNDERFLOW;
    return (uint32_t)((significand + (32 << -e)) >> (6 - e));
}

/* Of zero an infinity. */
static uint32_t by_zero(uint32_t sign, uint32_t *flags) {
    *flags = FP3_FLAG_DIVIDE_BY_ZERO;
    return sign | INFINITE;
}

/* Of a NaN the one NaN; a signalling one is invalid. */
static uint32_t quiet(uint32_t a, uint32_t *flags) {
    *flags = a & 0x400000 ? 0 : FP3_FLAG_INVALID;
    return FP3_BITS_NAN;
}

uint32_t fp3_lns_float_rcp(uint32_t a, uint32_t *flags) {
    const uint32_t sign = a & SIGN;
    int64_t log;
    *flags = 0;
    if (is_nan(a))
        return quiet(a, flags);
    if (is_infinite(a))
        return sign;
    if (is_zero(a))
        return by_zero(sign, flags);
    const int is_exact = logarithm(a & FIELD, &log);
    return sign | power((8 - log) >> 4, is_exact, flags);
}

uint32_t fp3_lns_float_rsqrt(uint32_t a, uint32_t *flags) {
    int64_t log;
    *flags = 0;
    if (is_nan(a))
        return quiet(a, flags);
    if (is_zero(a))
        return by_zero(0, flags);
    if (a & SIGN)
        return invalid(flags);
    if (is_infinite(a))
        return 0;
    const int is_exact = logarithm(a, &log) && !(log & WHOLE);
    return power((16 - log) >> 5, is_exact, flags);
}
