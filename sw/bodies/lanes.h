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
/* Of each half in turn: the first two of a and of b, the last two. */
#define FP3_LOW(a, b) FP3_SHUFFLE(a, b, 0, 8, 1, 9, 4, 12, 5, 13)
#define FP3_HIGH(a, b) FP3_SHUFFLE(a, b, 2, 10, 3, 11, 6, 14, 7, 15)

/* Fours of eight bodies become four vectors of eight. */
FP3_WIDELY void fp3_lanes_bring(const fp3_four *from, uint32_t stride, const uint32_t of[FP3_WIDE],
                                fp3_wide words[4]) {
    fp3_wide m[4], s[4];
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++)
        m[i] = FP3_SHUFFLE(from[stride * of[i]], from[stride * of[i + 4]], 0, 1, 2, 3, 4, 5, 6, 7);
#pragma GCC unroll 2
    for (int i = 0; i < 2; i++) {
        s[i] = FP3_LOW(m[i], m[i + 2]);
        s[i + 2] = FP3_HIGH(m[i], m[i + 2]);
    }
#pragma GCC unroll 2
    for (int i = 0; i < 2; i++) {
        words[2 * i] = FP3_LOW(s[2 * i], s[2 * i + 1]);
        words[2 * i + 1] = FP3_HIGH(s[2 * i], s[2 * i + 1]);
    }
}

/* Four vectors, of which the fourth is `last`, become fours of eight bodies. */
FP3_WIDELY void fp3_lanes_make(const fp3_wide words[3], fp3_wide last, fp3_four to[FP3_WIDE]) {
    const fp3_wide xy[2] = {FP3_LOW(words[0], words[1]), FP3_HIGH(words[0], words[1])};
    const fp3_wide w[2] = {FP3_LOW(words[2], last), FP3_HIGH(words[2], last)};
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

/* Eight vectors of eight: number k of vector i becomes number i of vector k. */
FP3_WIDELY void fp3_lanes_flip(fp3_wide x[8], fp3_wide words[8]) {
    fp3_wide y[8];
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) { /* numbers of 0, 2 and of 4, 6; of 1, 3 and of 5, 7 */
        const int k = i < 2 ? i : i + 2;
        y[k] = FP3_LOW(x[k], x[k + 2]);
        y[k + 2] = FP3_HIGH(x[k], x[k + 2]);
    }
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) { /* words 0, 1 and 4, 5 of four contacts, or 2, 3 and 6, 7 */
        x[2 * i] = FP3_LOW(y[2 * i], y[2 * i + 1]);
        x[2 * i + 1] = FP3_HIGH(y[2 * i], y[2 * i + 1]);
    }
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        words[i] = FP3_SHUFFLE(x[i], x[i + 4], 0, 1, 2, 3, 8, 9, 10, 11);
        words[i + 4] = FP3_SHUFFLE(x[i], x[i + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
}

#endif
