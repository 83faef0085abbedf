/* SPDX-License-Identifier: Apache-2.0 */
/* clip3.h - the part of a face that is before another face, and the four points that stand for it.
 */
#ifndef FP3_BODIES_CLIP3_H
#define FP3_BODIES_CLIP3_H

#include "bodies/shapes/shape3.h"

enum { FP3_CLIPPED3 = 2 * FP3_CORNERS3 + 2 };

/* A face, anticlockwise about its normal; with two corners a segment, with one a point. */
typedef struct {
    uint32_t count;
    fp3_point3 corner[FP3_CLIPPED3];
} fp3_side3;

/* Cuts `side` by the planes through the edges of `face`, square to it. What is outside by less than
 * `slack` stays, so that two equal faces one above the other have four points, not eight. */
void fp3_clip3(const fp3_side3 *face, fp3_point3 normal, float slack, fp3_side3 *side);

typedef struct {
    fp3_point3 at;
    float gap;
} fp3_touch3;

/* At most four of the points, moved to the front; *count is at least 1. First that of the least
 * gap, where a slope of 1:1024 along a direction u decides between gaps that are nearly equal; then
 * the farthest from it; then those that add the largest areas on either side. There a point counts
 * as nearer by what its gap is larger, beyond that slope: of a plate that spins fast all corners
 * are within reach, and the upper ones do not hold it. If more than two are left they are in order
 * anticlockwise about the normal, and the first is the farthest along u. u is 0.8 t + 0.6 n x t,
 * where t is the axis on which the normal is smallest (x before y before z), made square to the
 * normal. So the last bits of the gaps change neither choice nor order. */
void fp3_reduce3(fp3_point3 normal, uint32_t *count, fp3_touch3 *touch);

#endif
