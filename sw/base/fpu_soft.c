/* SPDX-License-Identifier: Apache-2.0 */
/* fpu_soft.c - see fpu_soft.h. */
#include "fpu_soft.h"
#include "base/bits.h"

#include <math.h>
#include <string.h>

_Thread_local uint64_t fp3_fpu_register;

static int is_signalling(float value) {
    const uint32_t bits = fp3_bits_of(value);
    return (bits & 0x7fffffffu) > 0x7f800000u && !(bits & 0x00400000u);
}

/* The next float below in magnitude; FLT_MAX below infinity. */
static float toward_zero(float value) { return fp3_value_of(fp3_bits_of(value) - 1); }

/* What x, which stands for the exact result, is rounded to, with the flags of finite results.
 * Tininess is found after rounding, as if exponents had no bound (754, 7.5). */
static float rounded(double x) {
    const int is_nearest = !(fp3_fpu_register & FP3_FPU_TO_ZERO);
    const double size = fabs(x);
    float d = (float)x;
    if (!isfinite(x))
        return d;
    const int is_over = is_nearest ? isinf(d) : size >= 0x1p128;
    if (!is_nearest && fabs((double)d) > size)
        d = toward_zero(d);
    if ((double)d == x)
        return d;
    fp3_fpu_register |= FP3_FPU_INEXACT;
    if (is_over)
        fp3_fpu_register |= FP3_FPU_OVERFLOW;
    if (size < (is_nearest ? 0x1p-126 - 0x1p-151 : 0x1p-126))
        fp3_fpu_register |= FP3_FPU_UNDERFLOW;
    return d;
}

/* The sum of two doubles, rounded to odd: of the two doubles beside the exact sum that whose last
 * bit is 1. */
static double odd_sum(double a, double b) {
    double sum = a + b;
    const double of_b = sum - a;
    const double error = (a - (sum - of_b)) + (b - of_b); /* exact (Knuth) */
    uint64_t bits;
    memcpy(&bits, &sum, sizeof bits);
    if (isfinite(sum) && error != 0 && !(bits & 1)) {
        bits += (error > 0) == (sum > 0) ? UINT64_C(1) : UINT64_MAX;
        memcpy(&sum, &bits, sizeof sum);
    }
    return sum;
}

static float result(float a, float b, double exact) {
    if (is_signalling(a) || is_signalling(b) || (isnan(exact) && !isnan(a) && !isnan(b)))
        fp3_fpu_register |= FP3_FPU_INVALID;
    return rounded(exact);
}

float fp3_fpu_add(float a, float b) { return result(a, b, odd_sum(a, b)); }

float fp3_fpu_mul(float a, float b) { return result(a, b, (double)a * (double)b); }

/* Infinity times 0 is invalid whatever is added. */
float fp3_fpu_fma(float a, float b, float c) {
    const double product = (double)a * (double)b, exact = odd_sum(product, (double)c);
    if (is_signalling(a) || is_signalling(b) || is_signalling(c) ||
        (isnan(product) && !isnan(a) && !isnan(b)) ||
        (isnan(exact) && !isnan(product) && !isnan(c)))
        fp3_fpu_register |= FP3_FPU_INVALID;
    return rounded(exact);
}

float fp3_fpu_rint(float a) {
    return fp3_fpu_register & FP3_FPU_TO_ZERO ? truncf(a) : nearbyintf(a);
}
