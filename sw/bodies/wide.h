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

#include <machine/estimate.h>

#define FP3_WIDE 8
typedef float fp3_wide __attribute__((vector_size(4 * FP3_WIDE), may_alias));
typedef int fp3_mask __attribute__((vector_size(4 * FP3_WIDE), may_alias));

#define FP3_WIDELY static inline __attribute__((always_inline, unused))

FP3_WIDELY fp3_wide fp3_wide_all(float x) { return (fp3_wide){x, x, x, x, x, x, x, x}; }

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
FP3_WIDELY fp3_wide fp3_wide_abs(fp3_wide a) { return (fp3_wide)((fp3_mask)a & 0x7fffffff); }

/* Lane by lane: only joints ask for them. */
FP3_WIDELY fp3_wide fp3_wide_rcp(fp3_wide a) {
    for (int i = 0; i < FP3_WIDE; i++)
        a[i] = fp3_value_of(fp3_estimate_rcp(fp3_bits_of(a[i])));
    return a;
}
FP3_WIDELY fp3_wide fp3_wide_rsqrt(fp3_wide a) {
    for (int i = 0; i < FP3_WIDE; i++)
        a[i] = fp3_value_of(fp3_estimate_rsqrt(fp3_bits_of(a[i])));
    return a;
}

#endif
