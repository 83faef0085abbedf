/* SPDX-License-Identifier: Apache-2.0 */
/* lanes.h - words of eight bodies to vectors, and back.
 *
 * A body has its words in fours, one behind the other.
 */
#ifndef FP3_BODIES_LANES_H
#define FP3_BODIES_LANES_H

#include "wide.h"

/* Four words of a body. */
typedef float fp3_four __attribute__((vector_size(16), may_alias));

#define FP3_SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)

/* Fours of eight bodies become four vectors of eight. */
FP3_WIDELY void fp3_lanes_bring(const fp3_four *from, uint32_t stride, const uint32_t of[FP3_WIDE],
                                fp3_wide words[4]) {
    fp3_wide m[4], s[4];
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++)
        m[i] = FP3_SHUFFLE(from[stride * of[i]], from[stride * of[i + 4]], 0, 1, 2, 3, 4, 5, 6, 7);
#pragma GCC unroll 2
    for (int i = 0; i < 2; i++) {
        s[i] = FP3_SHUFFLE(m[i], m[i + 2], 0, 8, 1, 9, 4, 12, 5, 13);
        s[i + 2] = FP3_SHUFFLE(m[i], m[i + 2], 2, 10, 3, 11, 6, 14, 7, 15);
    }
#pragma GCC unroll 2
    for (int i = 0; i < 2; i++) {
        words[2 * i] = FP3_SHUFFLE(s[2 * i], s[2 * i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
        words[2 * i + 1] = FP3_SHUFFLE(s[2 * i], s[2 * i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
    }
}

/* Four vectors, of which the fourth is `last`, become fours of eight bodies. */
FP3_WIDELY void fp3_lanes_make(const fp3_wide words[3], fp3_wide last, fp3_four to[FP3_WIDE]) {
    const fp3_wide xy[2] = {FP3_SHUFFLE(words[0], words[1], 0, 8, 1, 9, 4, 12, 5, 13),
                            FP3_SHUFFLE(words[0], words[1], 2, 10, 3, 11, 6, 14, 7, 15)};
    const fp3_wide w[2] = {FP3_SHUFFLE(words[2], last, 0, 8, 1, 9, 4, 12, 5, 13),
                           FP3_SHUFFLE(words[2], last, 2, 10, 3, 11, 6, 14, 7, 15)};
#pragma GCC unroll 2
    for (int i = 0; i < 2; i++) {
        const fp3_wide even = FP3_SHUFFLE(xy[i], w[i], 0, 1, 8, 9, 4, 5, 12, 13),
                       odd = FP3_SHUFFLE(xy[i], w[i], 2, 3, 10, 11, 6, 7, 14, 15);
        to[2 * i] = FP3_SHUFFLE(even, even, 0, 1, 2, 3);
        to[2 * i + 1] = FP3_SHUFFLE(odd, odd, 0, 1, 2, 3);
        to[2 * i + 4] = FP3_SHUFFLE(even, even, 4, 5, 6, 7);
        to[2 * i + 5] = FP3_SHUFFLE(odd, odd, 4, 5, 6, 7);
    }
}

#endif
