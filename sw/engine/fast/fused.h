/* SPDX-License-Identifier: Apache-2.0 */
/* fused.h - multiply-add, rounded once. Its text stands behind that of lanes.h, where a
 * configuration has the instruction. */
#ifndef FP3_FAST_FUSED_H
#define FP3_FAST_FUSED_H

#ifdef __FMA__
FP3_OPERATION fp3_v fp3_fused(fp3_v a, fp3_v b, fp3_v c) {
#if FP3_LANES == 16
    return (fp3_v)__builtin_ia32_vfmaddps512_mask(a, b, c, (unsigned short)-1, 4 /* MXCSR */);
#else
    return (fp3_v)__builtin_ia32_vfmaddps256(a, b, c);
#endif
}
#endif

/* The sum, rounded to odd: of the two doubles beside it that whose last bit is 1. As a double has
 * every product of two floats, a float that is made of it is rounded once (Boldo and Melquiond
 * 2008). A difference with the larger number is exact in every rounding (Dekker 1971); rounded to
 * nearest, the error is, too (Knuth). They raise inexact where the sum does. */
FP3_OPERATION fp3_d fp3_odd_sum(fp3_d a, fp3_d b) {
    const fp3_d s = a + b;
    const fp3_l is_finite = ((fp3_l)s & 0x7ff0000000000000ll) != 0x7ff0000000000000ll;
    const fp3_d sum = (fp3_d)((fp3_l)s & is_finite);
    const fp3_d x = (fp3_d)((fp3_l)a & is_finite), y = (fp3_d)((fp3_l)b & is_finite);
    if (FP3_NEAREST) {
        const fp3_d of_y = sum - x, off = (x - (sum - of_y)) + (y - of_y);
        const fp3_l is_off = (fp3_l)(off != 0), is_away = is_off & (((fp3_l)off ^ (fp3_l)sum) < 0);
        return (fp3_d)(((fp3_l)s + is_away) | (is_off & 1));
    }
    return (fp3_d)((fp3_l)s | ((fp3_l)((sum - x != y) | (sum - y != x)) & 1));
}

FP3_OPERATION fp3_v fp3_fused_of_wide(fp3_v a, fp3_v b, fp3_v c) {
    const fp3_v x = fp3_flushed(a), y = fp3_flushed(b), z = fp3_flushed(c);
    const fp3_d low = fp3_odd_sum(fp3_wide(x, 0) * fp3_wide(y, 0), fp3_wide(z, 0));
    const fp3_d high = fp3_odd_sum(fp3_wide(x, 1) * fp3_wide(y, 1), fp3_wide(z, 1));
    const fp3_v d =
        fp3_whole(__builtin_convertvector(low, fp3_half), __builtin_convertvector(high, fp3_half));
    if (FP3_SUBNORMAL)
        return d;
    const fp3_l size[2] = {(fp3_l)low & 0x7fffffffffffffffll, (fp3_l)high & 0x7fffffffffffffffll};
    return fp3_underflown(fp3_joined((size[0] < FP3_WIDE_LEAST) & (size[0] != 0),
                                     (size[1] < FP3_WIDE_LEAST) & (size[1] != 0)),
                          (fp3_i)d, d);
}

/* Some processors do not tell that infinity times 0 is invalid where a NaN is added. */
FP3_OPERATION fp3_v fp3_fmadd(fp3_v a, fp3_v b, fp3_v c) {
#ifdef __FMA__
    if (FP3_SUBNORMAL && FP3_FLAGS) {
        const fp3_i mask = (fp3_magnitude(a) == FP3_INFINITE) | (fp3_magnitude(b) == FP3_INFINITE);
        const fp3_v one = (fp3_v)fp3_all(FP3_ONE);
        fp3_v product = fp3_choose(mask, a, one);
        product *= fp3_choose(mask, b, one);
        __asm__ volatile("" : : FP3_ANYWHERE(product));
    }
    if (FP3_SUBNORMAL)
        return fp3_fused(a, b, c);
#endif
    return fp3_fused_of_wide(a, b, c);
}
FP3_OPERATION fp3_v fp3_fmsub(fp3_v a, fp3_v b, fp3_v c) { return fp3_fmadd(fp3_minus(a), b, c); }

#endif
