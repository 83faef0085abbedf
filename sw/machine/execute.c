/* SPDX-License-Identifier: Apache-2.0 */
/* execute.c - see execute.h.
 *
 * base/fpu.h computes values and flags: it is IEEE 754 binary32, in its two roundings. What is left
 * to do is the one quiet NaN, results and operands that are flushed, and underflow where the host
 * detects tininess before rounding.
 */
#include "execute.h"
#include "base/bits.h"

#include "estimate.h"
#include "finite.h"
#include "lns.h"
#include "narrow.h"

#include <assert.h>
#include <float.h>
#include <fp3/isa.h>
#include <math.h>

static uint32_t bits_of(float value) { return isnan(value) ? FP3_BITS_NAN : fp3_bits_of(value); }

static float flushed(const fp3_config *config, float x) {
    return config->subnormal || fpclassify(x) != FP_SUBNORMAL ? x : copysignf(0.0f, x);
}

/* Whether a product is tiny after rounding as if exponents had no bound: 754, 7.5. */
static int is_tiny(const fp3_config *config, double exact) {
    return isless(fabs(exact), config->nearest ? 0x1p-126 - 0x1p-151 : 0x1p-126);
}

/* x op y, for add, sub and mul; its flags are added to those of the host's FPU. volatile: the
 * compiler may move no operation across the reading of flags. */
static float one(const fp3_config *config, uint32_t op, float x, float y) {
    volatile float a = flushed(config, x), b = flushed(config, y), d;
    if (!config->subnormal) {
        /* A product is exact in double, and so is a sum that is as small as this. */
        const double exact = op == FP3_OP_ADD   ? (double)a + (double)b
                             : op == FP3_OP_SUB ? (double)a - (double)b
                                                : (double)a * (double)b;
        /* A comparison by isless raises nothing for a quiet NaN. */
        if (isless(fabs(exact), (double)FLT_MIN) && exact != 0) {
            fp3_fpu_set(fp3_fpu_get() | FP3_FPU_UNDERFLOW | FP3_FPU_INEXACT);
            return copysignf(0.0f, (float)exact);
        }
    }
    const uint64_t before = FP3_FPU_IS_EARLY ? fp3_fpu_get() : 0;
    d = op == FP3_OP_MUL ? fp3_fpu_mul(a, b) : fp3_fpu_add(a, op == FP3_OP_SUB ? -b : b);
    if (FP3_FPU_IS_EARLY && op == FP3_OP_MUL && !is_tiny(config, (double)a * (double)b))
        fp3_fpu_set(fp3_fpu_get() & (before | ~(uint64_t)FP3_FPU_UNDERFLOW));
    return d;
}

/* How much the exact z + x y is more than d, to which it is rounded, times the sign of d. Only the
 * sign counts, and whether it is less than -2^-151: of d = 2^-126 that is right, as a product is
 * exact in double, and so is z - d. */
static double beyond(float x, float y, float z, float d) {
    return ((double)x * (double)y + ((double)z - (double)d)) * (double)copysignf(1.0f, d);
}

/* x y + z, rounded once. */
static float fused(const fp3_config *config, float x, float y, float z) {
    volatile float a = flushed(config, x), b = flushed(config, y), c = flushed(config, z), d;
    const uint64_t before = fp3_fpu_get();
    d = fp3_fpu_fma(a, b, c);
    const float size = fabsf(d);
    if (isless(size, FLT_MIN) == 0 && size != FLT_MIN)
        return d; /* NaN, too */
    const uint64_t after = fp3_fpu_get();
    const double off = beyond(a, b, c, d);
    const int is_zero = d == 0 && off == 0;
    fp3_fpu_set(after); /* without what that raised */
    const int is_below = size != FLT_MIN || off < 0;
    if (!config->subnormal && is_below && !is_zero) {
        fp3_fpu_set(after | FP3_FPU_UNDERFLOW | FP3_FPU_INEXACT);
        return copysignf(0.0f, d);
    }
    if (FP3_FPU_IS_EARLY && size == FLT_MIN && (config->nearest ? off >= -0x1p-151 : off >= 0))
        fp3_fpu_set(after & (before | ~(uint64_t)FP3_FPU_UNDERFLOW));
    return d;
}

static uint32_t raised(const fp3_config *config) {
    const uint64_t raised = config->flags ? fp3_fpu_get() : 0;
    return (raised & FP3_FPU_INVALID ? FP3_FLAG_INVALID : 0) |
           (raised & FP3_FPU_DIVIDE_BY_ZERO ? FP3_FLAG_DIVIDE_BY_ZERO : 0) |
           (raised & FP3_FPU_OVERFLOW ? FP3_FLAG_OVERFLOW : 0) |
           (raised & FP3_FPU_UNDERFLOW ? FP3_FLAG_UNDERFLOW : 0) |
           (raised & FP3_FPU_INEXACT ? FP3_FLAG_INEXACT : 0);
}

/* a < b of the raw bits, as integers: numbers that are not NaN are ordered as their magnitudes. */
static int is_less(uint32_t a, uint32_t b) {
    const uint32_t x = a & 0x7fffffffu, y = b & 0x7fffffffu, infinite = 0x7f800000u;
    if (x > infinite || y > infinite || !(x | y))
        return 0;
    return a >> 31 ? !(b >> 31) || y < x : !(b >> 31) && x < y;
}

static int is_equal(uint32_t a, uint32_t b) {
    const uint32_t infinite = 0x7f800000u;
    return (a & 0x7fffffffu) <= infinite && (a == b || !((a | b) & 0x7fffffffu));
}

/* A NaN stays for the sum, which raises what it has to. */
static uint32_t integral(uint32_t a) {
    const float x = fp3_value_of(a);
    return isnan(x) ? a : bits_of(fp3_fpu_rint(x));
}

/* 2^n of the integral part n. In integers, as a conversion to int raises inexact. */
static uint32_t power_of_two(uint32_t a) {
    const uint32_t exponent = a >> 23 & 255, significand = (a & 0x7fffffu) | 0x800000u;
    if (isnan(fp3_value_of(a)))
        return a;
    if (exponent > 127 + 7) /* 256 and more */
        return a >> 31 ? 0 : bits_of(INFINITY);
    const int n = exponent < 127 ? 0 : (int)(significand >> (150 - exponent));
    if (a >> 31)
        return n > 149 ? 0 : bits_of(ldexpf(1, -n));
    return bits_of(n > 127 ? INFINITY : ldexpf(1, n));
}

/* A zero or subnormal number has -infinity, as if it were flushed. */
static uint32_t exponent(uint32_t a) {
    const float x = fp3_value_of(a);
    if (isnan(x))
        return a;
    return bits_of(isless(fabsf(x), FLT_MIN) ? -INFINITY : logbf(x));
}

/* What fp_value makes of its operands, all as bits. Returns 1 if fp_value handles the operation. */
static int choose(uint32_t op, uint32_t a, uint32_t b, uint32_t c, uint32_t *d) {
    switch (op) {
    case FP3_OP_MIN:
        *d = is_less(a, b) ? a : b;
        return 1;
    case FP3_OP_MAX:
        *d = is_less(b, a) ? a : b;
        return 1;
    case FP3_OP_ABS:
        *d = a & 0x7fffffffu;
        return 1;
    case FP3_OP_LT:
        *d = is_less(a, b) ? FP3_BITS_ONE : 0;
        return 1;
    case FP3_OP_LE:
        *d = is_less(a, b) || is_equal(a, b) ? FP3_BITS_ONE : 0;
        return 1;
    case FP3_OP_SEL:
        *d = c & 0x7fffffffu ? a : b;
        return 1;
    case FP3_OP_RCP:
        *d = fp3_estimate_rcp(a);
        return 1;
    case FP3_OP_RSQRT:
        *d = fp3_estimate_rsqrt(a);
        return 1;
    case FP3_OP_RINT:
        *d = integral(a);
        return 1;
    case FP3_OP_EXP2:
        *d = power_of_two(a);
        return 1;
    case FP3_OP_LOGB:
        *d = exponent(a);
        return 1;
    default:
        return 0;
    }
}

/* x plus or minus a product, each rounded. */
static float chained(const fp3_config *config, uint32_t op, float x, float y, float z) {
    return one(config, op, x, one(config, FP3_OP_MUL, y, z));
}

static float calculate(const fp3_config *config, uint32_t op, const uint32_t operands[3]) {
    const float a = fp3_value_of(operands[0]), b = fp3_value_of(operands[1]),
                c = fp3_value_of(operands[2]);
    uint32_t chosen;
    switch (op) {
    case FP3_OP_ADD:
    case FP3_OP_SUB:
    case FP3_OP_MUL:
        return one(config, op, a, b);
    case FP3_OP_MADD:
        return chained(config, FP3_OP_ADD, c, a, b);
    case FP3_OP_MSUB:
        return chained(config, FP3_OP_SUB, c, a, b);
    case FP3_OP_FMADD:
        return fused(config, a, b, c);
    case FP3_OP_FMSUB:
        return fused(config, -a, b, c);
    case FP3_OP_ADDH:
        return chained(config, FP3_OP_ADD, a, b, 0.5f);
    case FP3_OP_SUBH:
        return chained(config, FP3_OP_SUB, a, b, 0.5f);
    case FP3_OP_ADDT:
        return chained(config, FP3_OP_ADD, a, b, 2.0f);
    case FP3_OP_SUBT:
        return chained(config, FP3_OP_SUB, a, b, 2.0f);
    default:
        break;
    }
    const int is_chosen = choose(op, operands[0], operands[1], operands[2], &chosen);
    assert(is_chosen);
    return is_chosen ? one(config, FP3_OP_ADD, fp3_value_of(chosen), -0.0f) : NAN;
}

/* ---- in integers: logarithmic words, and numbers with fewer fraction bits ---- */

static uint32_t sum(const fp3_config *config, int is_minus, uint32_t x, uint32_t y,
                    uint32_t *flags) {
    uint32_t raised = 0;
    const uint32_t d =
        !config->logarithmic
            ? fp3_narrow_add(config, x, is_minus ? y ^ FP3_BITS_MINUS_ZERO : y, &raised)
            : (is_minus ? fp3_lns_sub : fp3_lns_add)(x, y, &raised);
    *flags |= raised;
    return d;
}

static uint32_t product(const fp3_config *config, uint32_t x, uint32_t y, uint32_t *flags) {
    return config->logarithmic ? fp3_lns_mul(x, y, flags) : fp3_narrow_mul(config, x, y, flags);
}

/* What reads its operands and has no product and no sum of its own: then -0 is added. */
static uint32_t chosen(const fp3_config *config, uint32_t op, const uint32_t operands[3],
                       uint32_t *flags) {
    uint32_t read[3], value;
    if (config->logarithmic && op == FP3_OP_RCP)
        return fp3_lns_rcp(operands[0], flags);
    if (config->logarithmic && op == FP3_OP_RSQRT)
        return fp3_lns_rsqrt(operands[0], flags);
    for (int i = 0; i < 3; i++)
        read[i] = fp3_narrow_read(config, operands[i]);
    const int is_chosen = choose(op, read[0], read[1], read[2], &value);
    assert(is_chosen);
    return sum(config, 0, is_chosen ? value : FP3_BITS_NAN, FP3_BITS_MINUS_ZERO, flags);
}

static uint32_t calculate_words(const fp3_config *config, uint32_t op, const uint32_t operands[3],
                                uint32_t *flags) {
    const uint32_t a = operands[0], b = operands[1], c = operands[2];
    const uint32_t half = 0x3f000000, two = 0x40000000;
    *flags = 0;
    switch (op) {
    case FP3_OP_ADD:
    case FP3_OP_SUB:
        return sum(config, op == FP3_OP_SUB, a, b, flags);
    case FP3_OP_MUL:
        return product(config, a, b, flags);
    case FP3_OP_MADD:
    case FP3_OP_MSUB:
        return sum(config, op == FP3_OP_MSUB, c, product(config, a, b, flags), flags);
    case FP3_OP_FMADD:
        return fp3_narrow_fma(config, a, b, c, flags);
    case FP3_OP_FMSUB:
        return fp3_narrow_fma(config, a ^ FP3_BITS_MINUS_ZERO, b, c, flags);
    case FP3_OP_ADDH:
    case FP3_OP_SUBH:
        return sum(config, op == FP3_OP_SUBH, a, product(config, b, half, flags), flags);
    case FP3_OP_ADDT:
    case FP3_OP_SUBT:
        return sum(config, op == FP3_OP_SUBT, a, product(config, b, two, flags), flags);
    default:
        return chosen(config, op, operands, flags);
    }
}

int fp3_execute_is_of_words(const fp3_config *config) {
    return config->logarithmic || config->fraction < 23;
}

int fp3_execute_is_by_logarithms(const fp3_config *config, uint32_t op) {
    return config->mixed && (op == FP3_OP_RCP || op == FP3_OP_RSQRT);
}

static uint32_t inverse(uint32_t op, uint32_t a, uint32_t *flags) {
    return op == FP3_OP_RCP ? fp3_lns_float_rcp(a, flags) : fp3_lns_float_rsqrt(a, flags);
}

uint32_t fp3_execute(const fp3_config *config, uint32_t op, const uint32_t operands[3],
                     uint32_t *flags) {
    if (config->finite || fp3_execute_is_of_words(config)) {
        uint32_t there;
        const uint32_t d = config->finite ? fp3_finite_execute(op, operands, &there)
                                          : calculate_words(config, op, operands, &there);
        if (flags)
            *flags = config->flags ? there : 0;
        return d;
    }
    if (fp3_execute_is_by_logarithms(config, op)) {
        uint32_t there;
        const uint32_t d = inverse(op, operands[0], &there);
        if (flags)
            *flags = config->flags ? there : 0;
        return d;
    }
    if (flags)
        fp3_fpu_forget();
    const float d = calculate(config, op, operands);
    if (flags)
        *flags = raised(config);
    return bits_of(d);
}

int fp3_execute_sleeps(const fp3_config *config, const uint32_t operands[3]) {
    const uint32_t size = fp3_narrow_read(config, operands[0] & 0x7fffffffu);
    const uint32_t limit = fp3_narrow_read(config, operands[1]);
    return config->finite ? fp3_finite_is_less(size, limit) : is_less(size, limit);
}

double fp3_execute_exact(uint32_t op, double a, double b, double c) {
    switch (op) {
    case FP3_OP_ADD:
        return a + b;
    case FP3_OP_SUB:
        return a - b;
    case FP3_OP_MUL:
        return a * b;
    case FP3_OP_MADD:
    case FP3_OP_FMADD:
        return c + a * b;
    case FP3_OP_MSUB:
    case FP3_OP_FMSUB:
        return c - a * b;
    case FP3_OP_ADDH:
        return a + b / 2;
    case FP3_OP_SUBH:
        return a - b / 2;
    case FP3_OP_ADDT:
        return a + 2 * b;
    case FP3_OP_SUBT:
        return a - 2 * b;
    case FP3_OP_MIN:
        return isless(a, b) ? a : b;
    case FP3_OP_MAX:
        return isless(b, a) ? a : b;
    case FP3_OP_ABS:
        return fabs(a);
    case FP3_OP_LT:
        return isless(a, b) ? 1 : 0;
    case FP3_OP_LE:
        return islessequal(a, b) ? 1 : 0;
    case FP3_OP_SEL:
        return c != 0 ? a : b; /* a NaN is not 0 */
    case FP3_OP_RCP:
        return 1 / a;
    case FP3_OP_RSQRT:
        return a == 0 ? INFINITY : 1 / sqrt(a); /* of -0, too */
    case FP3_OP_RINT:
        return nearbyint(a);
    case FP3_OP_EXP2:
        return exp2(trunc(a));
    case FP3_OP_LOGB:
        return logb(a);
    default:
        assert(!"an arithmetic operation");
        return NAN;
    }
}
