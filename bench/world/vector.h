/* vector.h - a vector of floats, and FP3's estimates without their table.
 *
 * An entry of the table is 1/sqrt or 1/x of the end of an interval, cut to 9 or 10 bits. So the
 * estimate is that of the end, computed to more bits and cut. What is computed is larger than the
 * exact number, by less than 22 * 2^-23 of it: no entry is so near the next cut (the nearest is),
 * and where a root is exact, a smaller number would be wrong.
 */
#ifndef BENCH_WORLD_VECTOR_H
#define BENCH_WORLD_VECTOR_H

#include "machine/estimate.h"

#include <immintrin.h>
#include <stdint.h>
#include <string.h>

#ifdef __AVX512F__
#define WIDTH 16
#define HAND_KIND "x86-64-v4"
#define HAND(name) name##_v4
#else
#define WIDTH 8
#define HAND_KIND "x86-64-v3"
#define HAND(name) name##_v3
#endif

typedef float vec __attribute__((vector_size(4 * WIDTH)));
typedef int32_t veci __attribute__((vector_size(4 * WIDTH)));
typedef float vec_any __attribute__((vector_size(4 * WIDTH), aligned(4), may_alias));
#define INLINE static inline __attribute__((always_inline))

INLINE vec load(const float *from) { return *(const vec_any *)from; }
INLINE void store(float *to, vec value) { *(vec_any *)to = value; }
INLINE vec all(float value) { return value - (vec){0}; }
INLINE veci all_i(int32_t value) { return value - (veci){0}; }

/* 1/sqrt(a) to some 22 bits, and larger by 2^-20 of it; half: a/2. A step of Newton from what the
 * processor has. */
INLINE vec rsqrt_above(vec a, vec half) {
    const vec c = all(0.5f + 0x1p-20f);
#if WIDTH == 16
    const __m512 y = _mm512_rsqrt14_ps((__m512)a);
    const __m512 e = _mm512_fnmadd_ps(_mm512_mul_ps((__m512)half, y), y, (__m512)c);
    return (vec)_mm512_fmadd_ps(y, e, y);
#else
    const __m256 y = _mm256_rsqrt_ps((__m256)a);
    const __m256 e = _mm256_fnmadd_ps(_mm256_mul_ps((__m256)half, y), y, (__m256)c);
    return (vec)_mm256_fmadd_ps(y, e, y);
#endif
}

/* Of a number from 2^-125 to the last interval, whose end is infinite. */
INLINE vec rsqrt(vec a) {
    const veci bits = (veci)a, last = bits | 0x3fff;
    const veci cut =
        0x1fff | ((bits >> 10) & 0x2000); /* 9 bits where the exponent is odd, else 10 */
    return (vec)((veci)rsqrt_above((vec)(last + 1), (vec)(last + (1 - 0x800000))) & ~cut);
}

/* c + a b and c - a b, rounded twice. */
INLINE vec madd(vec a, vec b, vec c) { return c + a * b; }
INLINE vec msub(vec a, vec b, vec c) { return c - a * b; }

/* 1/sqrt(a) as the compiler makes it: the estimate y and a step, y + y d (0.5 + 0.375 d), d = 1 - a
 * y^2. */
INLINE vec step_of(vec a, vec y) {
    const vec d = msub(a, y * y, all(1));
    return d * madd(all(0.375f), d, all(0.5f));
}

/* Where a bit of the mask is set, the sum; elsewhere the first one. */
#if WIDTH == 16
typedef __mmask16 lanes;
INLINE vec add_where(lanes mask, vec a, vec b) {
    return (vec)_mm512_mask_add_ps((__m512)a, mask, (__m512)a, (__m512)b);
}
INLINE vec gather(const float *from, const int32_t *index) {
    return (vec)_mm512_i32gather_ps(_mm512_loadu_si512(index), from, 4);
}
#else
typedef uint8_t lanes;
INLINE vec add_where(lanes mask, vec a, vec b) {
    const veci bit = {1, 2, 4, 8, 16, 32, 64, 128};
    const veci is = (all_i(mask) & bit) != 0;
    return (vec)((is & (veci)(a + b)) | (~is & (veci)a));
}
INLINE vec gather(const float *from, const int32_t *index) {
    return (vec)_mm256_i32gather_ps(from, _mm256_loadu_si256((const __m256i *)index), 4);
}
#endif

/* Each entry, at both ends of its interval, for each exponent that rsqrt takes. */
static int is_exact(void) {
    for (uint32_t entry = 0; entry < (253 << 9) - 1; entry++)
        for (uint32_t end = 0; end < 2; end++) {
            const uint32_t bits = (2u << 23) + (entry << 14) + end * 0x3fff;
            float a;
            memcpy(&a, &bits, sizeof a);
            const vec found = rsqrt(all(a));
            if (((veci)found)[0] != (int32_t)fp3_estimate_rsqrt(bits))
                return 0;
        }
    return 1;
}

#endif
