/* SPDX-License-Identifier: Apache-2.0 */
/* exceptions.h - what sums and products raise, for a vector, known from their operands alone. */
#ifndef FP3_FAST_EXCEPTIONS_H
#define FP3_FAST_EXCEPTIONS_H

#include <fp3/isa.h>

#include "tiny.h"

static inline fp3_i fp3_is_finite(fp3_v a) { return fp3_magnitude(a) < FP3_INFINITE; }

/* Whether one of a row is infinite or NaN. */
static inline int fp3_is_any_astray(const float *row, unsigned count) {
    unsigned is_any = 0;
    for (unsigned i = 0; i < count; i++) {
        unsigned bits;
        __builtin_memcpy(&bits, &row[i], sizeof bits);
        is_any |= (~bits & FP3_INFINITE) == 0;
    }
    return is_any != 0;
}

static inline fp3_i fp3_is_signalling(fp3_v a) {
    return fp3_is_nan(a) & (((fp3_i)a & 0x00400000) == 0);
}
static inline fp3_i fp3_marked(fp3_i mask, int flag) { return mask & flag; }

/* Halves of a mask: |x| >= 2^128. */
static inline fp3_l fp3_is_beyond(fp3_d x) { return ((fp3_l)x & FP3_WIDE_SIZE) >= FP3_WIDE_END; }

static inline fp3_i fp3_flags_of_finite(fp3_finite of) {
    return fp3_marked(of.over, FP3_FLAG_OVERFLOW) | fp3_marked(of.under, FP3_FLAG_UNDERFLOW) |
           fp3_marked(of.inexact, FP3_FLAG_INEXACT);
}

/* Of the sum of a and b, which was rounded to d (before it was flushed). That a sum is inexact
 * shows in the difference with the larger one, which is exact in every rounding (Dekker 1971). */
static inline fp3_i fp3_flags_of_sum(fp3_v x, fp3_v y) {
    if (FP3_FINITE)
        return fp3_flags_of_finite(fp3_finite_sum(x, y, 1));
    const fp3_v a = fp3_flushed(x), b = fp3_flushed(y), d = a + b;
    const fp3_i nan = fp3_is_nan(a) | fp3_is_nan(b), finite = fp3_is_finite(a) & fp3_is_finite(b);
    const fp3_i over =
        finite & (~fp3_is_finite(d) | fp3_joined(fp3_is_beyond(fp3_wide(a, 0) + fp3_wide(b, 0)),
                                                 fp3_is_beyond(fp3_wide(a, 1) + fp3_wide(b, 1))));
    const fp3_i size = fp3_magnitude(d);
    const fp3_i under = (size != 0) & (size < (FP3_SUBNORMAL ? 0 : FP3_LEAST));
    const fp3_i inexact = finite & ((d - a != b) | (d - b != a));
    const fp3_i invalid = fp3_is_signalling(a) | fp3_is_signalling(b) | (fp3_is_nan(d) & ~nan);
    return fp3_marked(invalid, FP3_FLAG_INVALID) |
           fp3_marked(over, FP3_FLAG_OVERFLOW | FP3_FLAG_INEXACT) |
           fp3_marked(under, FP3_FLAG_UNDERFLOW | FP3_FLAG_INEXACT) |
           fp3_marked(inexact, FP3_FLAG_INEXACT);
}

static inline fp3_i fp3_flags_of_product(fp3_v a, fp3_v b) {
    if (FP3_FINITE)
        return fp3_flags_of_finite(fp3_finite_product(a, b));
    const fp3_product_of p = fp3_tiny_product(a, b);
    const fp3_i nan = fp3_is_nan(a) | fp3_is_nan(b), finite = fp3_is_finite(a) & fp3_is_finite(b);
    const fp3_i invalid =
        fp3_is_signalling(a) | fp3_is_signalling(b) | (fp3_is_nan(p.value) & ~nan);
    return fp3_marked(invalid, FP3_FLAG_INVALID) |
           fp3_marked(finite & p.over, FP3_FLAG_OVERFLOW | FP3_FLAG_INEXACT) |
           fp3_marked(p.under, FP3_FLAG_UNDERFLOW | FP3_FLAG_INEXACT) |
           fp3_marked(finite & p.inexact, FP3_FLAG_INEXACT);
}

static inline fp3_v fp3_product_value(fp3_v a, fp3_v b) {
    return FP3_FINITE ? fp3_mul(a, b) : fp3_tiny_product(a, b).value;
}

/* Of a b + c, rounded once. */
static inline fp3_i fp3_flags_of_fused(fp3_v a, fp3_v b, fp3_v c) {
    const fp3_product_of d = fp3_tiny_fused(a, b, c);
    const fp3_i nan = fp3_is_nan(a) | fp3_is_nan(b);
    const fp3_i finite = fp3_is_finite(a) & fp3_is_finite(b) & fp3_is_finite(c);
    const fp3_i invalid = fp3_is_signalling(a) | fp3_is_signalling(b) | fp3_is_signalling(c) |
                          (fp3_is_nan(fp3_flushed(a) * fp3_flushed(b)) & ~nan) |
                          (fp3_is_nan(d.value) & ~nan & ~fp3_is_nan(c));
    return fp3_marked(invalid, FP3_FLAG_INVALID) |
           fp3_marked(finite & d.over, FP3_FLAG_OVERFLOW | FP3_FLAG_INEXACT) |
           fp3_marked(finite & d.under, FP3_FLAG_UNDERFLOW | FP3_FLAG_INEXACT) |
           fp3_marked(finite & d.inexact, FP3_FLAG_INEXACT);
}

#endif
