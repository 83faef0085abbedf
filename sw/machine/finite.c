/* SPDX-License-Identifier: Apache-2.0 */
/* finite.c - see finite.h; rtl/fp/ does the same with FINITE = 1. */
#include "finite.h"

#include "estimate.h"

#include <assert.h>
#include <fp3/isa.h>

#define SIGN FP3_BITS_MINUS_ZERO
#define FRACTION 0x007fffffu
#define HIDDEN 0x00800000u
#define MOST 0x7fffffffu          /* the largest number */
#define MOST_ESTIMATE 0x7fffe000u /* ... of those that an estimate can be */
#define HALF 0x3f000000u
#define TWO 0x40000000u
#define SPARE 32 /* bits below a significand's last */

static int exponent(uint32_t a) { return (int)(a >> 23 & 255); }

static uint64_t significand(uint32_t a) { return exponent(a) ? (a & FRACTION) | HIDDEN : 0; }

/* The number m 2^(e - 150), and a rest below its last bit if there is one, truncated. 1.0 is m =
 * 2^23 with e = 127. */
static uint32_t truncated(uint32_t sign, uint64_t m, int e, int has_rest, uint32_t *flags) {
    if (!m)
        return 0;                               /* a rest is never left alone */
    const int places = 40 - __builtin_clzll(m); /* above 24 bits */
    if (places > 0) {
        has_rest |= (m & ((UINT64_C(1) << places) - 1)) != 0;
        m >>= places;
    } else {
        m <<= -places;
    }
    e += places;
    if (e > 255) {
        *flags |= FP3_FLAG_OVERFLOW | FP3_FLAG_INEXACT;
        return sign | MOST;
    }
    if (e < 1) {
        *flags |= FP3_FLAG_UNDERFLOW | FP3_FLAG_INEXACT;
        return 0;
    }
    *flags |= has_rest ? FP3_FLAG_INEXACT : 0;
    return sign | (uint32_t)e << 23 | ((uint32_t)m & FRACTION);
}

static uint32_t add(uint32_t a, uint32_t b, uint32_t *flags) {
    const uint32_t big = (a & ~SIGN) < (b & ~SIGN) ? b : a, little = big == a ? b : a;
    const int distance = exponent(big) - exponent(little), e = exponent(big) - SPARE;
    const uint64_t x = significand(big) << SPARE, y = significand(little) << SPARE;
    const uint64_t moved = distance < 64 ? y >> distance : 0;
    const int has_rest = y && (distance >= 64 || moved << distance != y);
    if (!((big ^ little) & SIGN))
        return truncated(big & SIGN, x + moved, e, has_rest, flags);
    /* What was cut off of the smaller one makes the difference less. */
    return truncated(big & SIGN, x - moved - (uint64_t)has_rest, e, has_rest, flags);
}

static uint32_t mul(uint32_t a, uint32_t b, uint32_t *flags) {
    return truncated((a ^ b) & SIGN, significand(a) * significand(b),
                     exponent(a) + exponent(b) - 150, 0, flags);
}

int fp3_finite_is_less(uint32_t a, uint32_t b) {
    if (!exponent(a) && !exponent(b))
        return 0;
    const uint32_t x = a & ~SIGN, y = b & ~SIGN;
    return a & SIGN ? !(b & SIGN) || y < x : !(b & SIGN) && x < y;
}

/* Of zero, the largest estimate with its sign. Above 2^126 the result is below 2^-126: the adder
 * makes it 0. */
static uint32_t rcp(uint32_t a) {
    const int e = exponent(a);
    return e == 0 ? (a & SIGN) | MOST_ESTIMATE : e > 252 ? 0 : fp3_estimate_rcp(a);
}

/* There is no NaN: of a negative number the largest estimate, so that what follows overflows. */
static uint32_t rsqrt(uint32_t a) {
    const int e = exponent(a);
    if (e == 0 || a & SIGN)
        return MOST_ESTIMATE;
    return e == 255 ? fp3_estimate_rsqrt(a - (2u << 23)) - (1u << 23) : fp3_estimate_rsqrt(a);
}

static uint32_t integral(uint32_t a) {
    const int e = exponent(a);
    if (e < 127)
        return a & SIGN;
    return e >= 150 ? a : a & ~(FRACTION >> (e - 127));
}

/* 2^n of the integral part n: 2^128 is a number, and what is more is the largest one. */
static uint32_t power_of_two(uint32_t a) {
    const int e = exponent(a), is_huge = e > 127 + 7;
    const int n = e < 127 || is_huge ? 0 : (int)(significand(a) >> (150 - e));
    if (a & SIGN)
        return is_huge || n > 126 ? 0 : (uint32_t)(127 - n) << 23;
    return is_huge || n > 128 ? MOST : (uint32_t)(127 + n) << 23;
}

/* The exponent as a number; of zero, the least number. */
static uint32_t logarithm(uint32_t a) {
    uint32_t no_flags = 0;
    const int n = exponent(a) - 127;
    if (!exponent(a))
        return SIGN | MOST;
    return truncated(n < 0 ? SIGN : 0, (uint64_t)(n < 0 ? -n : n), 150, 0, &no_flags);
}

/* What fp_value makes of its operands: the adder has it then, and makes it +0 if its exponent is 0.
 */
static uint32_t choose(uint32_t op, uint32_t a, uint32_t b, uint32_t c) {
    switch (op) {
    case FP3_OP_MIN:
        return fp3_finite_is_less(a, b) ? a : b;
    case FP3_OP_MAX:
        return fp3_finite_is_less(b, a) ? a : b;
    case FP3_OP_ABS:
        return a & ~SIGN;
    case FP3_OP_LT:
        return fp3_finite_is_less(a, b) ? FP3_BITS_ONE : 0;
    case FP3_OP_LE:
        return fp3_finite_is_less(b, a) ? 0 : FP3_BITS_ONE;
    case FP3_OP_SEL:
        return exponent(c) ? a : b;
    case FP3_OP_RCP:
        return rcp(a);
    case FP3_OP_RSQRT:
        return rsqrt(a);
    case FP3_OP_RINT:
        return integral(a);
    case FP3_OP_EXP2:
        return power_of_two(a);
    case FP3_OP_LOGB:
        return logarithm(a);
    default:
        assert(!"an arithmetic operation");
        return 0;
    }
}

uint32_t fp3_finite_execute(uint32_t op, const uint32_t operands[3], uint32_t *flags) {
    const uint32_t a = operands[0], b = operands[1], c = operands[2];
    *flags = 0;
    switch (op) {
    case FP3_OP_ADD:
        return add(a, b, flags);
    case FP3_OP_SUB:
        return add(a, b ^ SIGN, flags);
    case FP3_OP_MUL:
        return mul(a, b, flags);
    case FP3_OP_MADD:
        return add(c, mul(a, b, flags), flags);
    case FP3_OP_MSUB:
        return add(c, mul(a, b, flags) ^ SIGN, flags);
    case FP3_OP_ADDH:
        return add(a, mul(b, HALF, flags), flags);
    case FP3_OP_SUBH:
        return add(a, mul(b, HALF, flags) ^ SIGN, flags);
    case FP3_OP_ADDT:
        return add(a, mul(b, TWO, flags), flags);
    case FP3_OP_SUBT:
        return add(a, mul(b, TWO, flags) ^ SIGN, flags);
    default:
        return add(choose(op, a, b, c), SIGN, flags);
    }
}
