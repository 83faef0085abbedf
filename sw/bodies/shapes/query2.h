/* SPDX-License-Identifier: Apache-2.0 */
/* query2.h - questions about shapes in the plane: how far apart, what a ray or a moving shape
 * meets.
 *
 * Everything is computed from where the second is as seen from the first, in binary32 with
 * + - * / and roots. Poses that are not finite, are no turns or are more than 1e15 apart meet
 * nothing. Extents are those of both shapes together. */
#ifndef FP3_BODIES_QUERY2_H
#define FP3_BODIES_QUERY2_H

#include "bodies/shapes/shape2.h"

/* Where two shapes are nearest, or, if they overlap, the least way out of each other. */
typedef struct {
    float gap;         /* negative: they overlap */
    fp3_point2 normal; /* from a to b, in the world's axes, as is */
    fp3_point2 arm_a,
        arm_b; /* from a's position to a point of each surface, a gap from each other */
} fp3_apart2;

/* The gap is right within 4 roundings (2^-22) of the extents and of the distance. 0: they meet
 * nothing, see above; *made is then as it was. */
int fp3_separation2(const fp3_shape2 *a, const fp3_pose2 *pose_a, const fp3_shape2 *b,
                    const fp3_pose2 *pose_b, fp3_apart2 *made);

/* Whether they touch or overlap. */
int fp3_overlap2(const fp3_shape2 *a, const fp3_pose2 *pose_a, const fp3_shape2 *b,
                 const fp3_pose2 *pose_b);

typedef struct {
    float fraction;    /* of the way until then, 0 to 1 */
    fp3_point2 normal; /* of what is hit, towards what moves: against the way */
    fp3_point2 arm;    /* from the position of what is hit to the place where it is */
} fp3_hit2;

/* The first point of a ray from a point along a way. From within the shape: fraction 0, the normal
 * against the way (0 without one). The point is on the surface within 2^-20 of the shape's extent
 * and of the way from its position to the ray's ends. 0: nothing is hit. */
int fp3_ray2(const fp3_shape2 *shape, const fp3_pose2 *pose, fp3_point2 from, fp3_point2 way,
             fp3_hit2 *hit);

/* A motion: the position goes straight ahead, the turn along the chord between both turns (so that
 * no angle is needed), the shorter way round. With half a turn nothing is found. */
typedef struct {
    fp3_pose2 from, to;
} fp3_sweep2;

/* When b, moving, first meets a, moving. Until the fraction found they are at least half of slop
 * apart, and there at most slop: a lower bound of the time of the impact. slop counts as at least
 * 2^-18 of the extents, of the distance at the start and of the way. Nearer than slop at the start:
 * fraction 0. 0: nothing is hit, they stay half of slop apart. There are 64 rounds at most, which
 * what nearly slides along another while it turns may need: then the gap at the fraction is above
 * slop. */
int fp3_impact2(const fp3_shape2 *a, const fp3_sweep2 *sweep_a, const fp3_shape2 *b,
                const fp3_sweep2 *sweep_b, float slop, fp3_hit2 *hit);

/* The same of b that does not turn, along a way, with a at rest. */
int fp3_cast2(const fp3_shape2 *a, const fp3_pose2 *pose_a, const fp3_shape2 *b,
              const fp3_pose2 *pose_b, fp3_point2 way, float slop, fp3_hit2 *hit);

#endif
