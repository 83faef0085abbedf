/* SPDX-License-Identifier: Apache-2.0 */
/* wide.h - eight numbers at a time, each with the bits of the instruction of its name
 * (docs/isa.md).
 *
 * Eight on every processor, so that rows of contacts lie in memory alike everywhere; a compiler
 * makes of a vector what there is. Sums, differences and products are those of C. Compiled without
 * contraction.
 */
#ifndef FP3_BODIES_WIDE_H
#define FP3_BODIES_WIDE_H

#include "base/bits.h"

#include "gen/estimates.h"

#include <machine/estimate.h>
#include <math.h>

#define FP3_WIDE 8
typedef float fp3_wide __attribute__((vector_size(4 * FP3_WIDE), may_alias));
/* Where one of its words stands. Clang takes no address of an element of a vector. */
#define FP3_WORD_OF(words, lane) ((float *)&(words) + (lane))
typedef int fp3_mask __attribute__((vector_size(4 * FP3_WIDE), may_alias));

#define FP3_WIDELY static inline __attribute__((always_inline, unused))

FP3_WIDELY fp3_wide fp3_wide_all(float x) { return (fp3_wide){x, x, x, x, x, x, x, x}; }

/* A statement for k = 0 and k = 1. */
#define FP3_BOTH(...)                                                                              \
    do {                                                                                           \
        {                                                                                          \
            enum { k = 0 };                                                                        \
            __VA_ARGS__;                                                                           \
        }                                                                                          \
        {                                                                                          \
            enum { k = 1 };                                                                        \
            __VA_ARGS__;                                                                           \
        }                                                                                          \
    } while (0)

/* Where the mask is -1 a, where it is 0 b. */
FP3_WIDELY fp3_wide fp3_wide_choose(fp3_mask mask, fp3_wide a, fp3_wide b) {
#ifdef __AVX__
    return __builtin_ia32_blendvps256(b, a, (fp3_wide)mask);
#else
    return (fp3_wide)((mask & (fp3_mask)a) | (~mask & (fp3_mask)b));
#endif
}
FP3_WIDELY fp3_wide fp3_wide_min(fp3_wide a, fp3_wide b) {
#ifdef __AVX__
    return __builtin_ia32_minps256(a, b);
#else
    return fp3_wide_choose((fp3_mask)(a < b), a, b);
#endif
}
FP3_WIDELY fp3_wide fp3_wide_max(fp3_wide a, fp3_wide b) {
#ifdef __AVX__
    return __builtin_ia32_maxps256(a, b);
#else
    return fp3_wide_choose((fp3_mask)(b < a), a, b);
#endif
}
FP3_WIDELY fp3_wide fp3_wide_lt(fp3_wide a, fp3_wide b) {
    return (fp3_wide)((fp3_mask)(a < b) & (fp3_mask)fp3_wide_all(1));
}
FP3_WIDELY fp3_wide fp3_wide_le(fp3_wide a, fp3_wide b) {
    return (fp3_wide)((fp3_mask)(a <= b) & (fp3_mask)fp3_wide_all(1));
}
FP3_WIDELY fp3_wide fp3_wide_sel(fp3_wide a, fp3_wide b, fp3_wide c) {
    return fp3_wide_choose((fp3_mask)(c != fp3_wide_all(0)), a, b);
}
FP3_WIDELY fp3_wide fp3_wide_sqrt(fp3_wide a) {
#ifdef __AVX__
    return __builtin_ia32_sqrtps256(a);
#else
    for (int i = 0; i < FP3_WIDE; i++)
        a[i] = sqrtf(a[i]);
    return a;
#endif
}
FP3_WIDELY fp3_wide fp3_wide_abs(fp3_wide a) { return (fp3_wide)((fp3_mask)a & 0x7fffffff); }

#ifdef __AVX2__
/* Whether all lanes are. */
FP3_WIDELY int fp3_wide_are(fp3_mask mask) {
    return __builtin_ia32_movmskps256((fp3_wide)mask) == 0xff;
}
/* Entries of the tables of estimates: two side by side are read at once. */
FP3_WIDELY fp3_mask fp3_wide_entries(fp3_mask at) {
    const fp3_mask two = (fp3_mask)__builtin_ia32_gathersiv8si(
        (fp3_mask){0}, (const int *)(const void *)fp3_estimates, at >> 1, (fp3_mask){0} - 1, 4);
    return two >> 16 * (at & 1) & 0xffff;
}
#endif

/* As machine/estimate.h: lane by lane where one is no ordinary number. */
FP3_WIDELY fp3_wide fp3_wide_rcp(fp3_wide a) {
#ifdef __AVX2__
    const fp3_mask bits = (fp3_mask)a, e = bits >> 23 & 255;
    if (fp3_wide_are((fp3_mask)(e > 0) & (fp3_mask)(e < 253)))
        return (fp3_wide)((bits & (int)0x80000000) | (253 - e) << 23 |
                          fp3_wide_entries(bits >> 13 & 1023) << 14);
#endif
    for (int i = 0; i < FP3_WIDE; i++)
        a[i] = fp3_value_of(fp3_estimate_rcp(fp3_bits_of(a[i])));
    return a;
}
FP3_WIDELY fp3_wide fp3_wide_rsqrt(fp3_wide a) {
#ifdef __AVX2__
    const fp3_mask bits = (fp3_mask)a, e = bits >> 23; /* with the sign */
    if (fp3_wide_are((fp3_mask)(e > 0) & (fp3_mask)(e < 255))) {
        const fp3_mask odd = e & 1, entry = fp3_wide_entries(1024 + 512 * odd + (bits >> 14 & 511));
        return (fp3_wide)((190 - (e + 1) / 2) << 23 | entry << (13 + odd));
    }
#endif
    for (int i = 0; i < FP3_WIDE; i++)
        a[i] = fp3_value_of(fp3_estimate_rsqrt(fp3_bits_of(a[i])));
    return a;
}

#endif
