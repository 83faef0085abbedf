/* SPDX-License-Identifier: Apache-2.0 */
/* query3.h - questions about shapes in space: how far apart, what a ray or a moving shape meets.
 *
 * Everything is computed from where the second is as seen from the first. Poses that collide3.h
 * does not take, and what is more than 1e8 apart, meet nothing. S is the sum of both extents. */
#ifndef FP3_BODIES_QUERY3_H
#define FP3_BODIES_QUERY3_H

#include "bodies/shapes/shape3.h"

/* Where two shapes are nearest, or, if they overlap, the least way out of each other. */
typedef struct {
    float gap;         /* negative: they overlap */
    fp3_point3 normal; /* from a to b, in the world's axes, as are */
    fp3_point3 arm_a;  /* from a's position to a point of each surface, a gap from each other */
    fp3_point3 arm_b;
} fp3_apart3;

/* The gap is right within 1e-5 of the cores' distance and 1e-6 S, where the cores are more than
 * 1e-5 S apart; else as collide3.h says. 0: they meet nothing, see above; *made is then as it was.
 */
int fp3_separation3(const fp3_shape3 *a, const fp3_pose3 *pose_a, const fp3_shape3 *b,
                    const fp3_pose3 *pose_b, fp3_apart3 *made);

/* Whether they touch or overlap. */
int fp3_overlap3(const fp3_shape3 *a, const fp3_pose3 *pose_a, const fp3_shape3 *b,
                 const fp3_pose3 *pose_b);

typedef struct {
    float fraction;    /* of the way until then, 0 to 1 */
    fp3_point3 normal; /* of what is hit, towards what moves */
    fp3_point3 arm;    /* from the position of what is hit to the place where it is */
} fp3_hit3;

/* The first point of a ray from a point along a way. From within the shape: fraction 0, the normal
 * against the way (0 without one). The point is on the surface within 2^-17 of the shape's extent
 * and of the way from its position to the ray's ends; what only grazes the shape within that may
 * be found or not. 0: nothing is hit. */
int fp3_ray3(const fp3_shape3 *shape, const fp3_pose3 *pose, fp3_point3 from, fp3_point3 way,
             fp3_hit3 *hit);

/* A motion: the position goes straight ahead, the turn along the chord between both quaternions, so
 * that no angle is needed, the shorter way round. */
typedef struct {
    fp3_pose3 from, to;
} fp3_sweep3;

/* When b, moving, first meets a, moving (Mirtich's conservative advancement: no more of the way at
 * a time than it takes to close the gap along the normal). Until the fraction found they are at
 * least half of slop apart, and there at most slop: a lower bound of the time of the impact. slop
 * counts as at least 2^-17 of S, of the distance at the start and of the ways. Nearer than slop at
 * the start: fraction 0. 0: nothing is hit, they stay half of slop apart. There are 64 rounds at
 * most, which what nearly slides along another while it turns may need: then the gap at the
 * fraction is above slop. */
int fp3_impact3(const fp3_shape3 *a, const fp3_sweep3 *sweep_a, const fp3_shape3 *b,
                const fp3_sweep3 *sweep_b, float slop, fp3_hit3 *hit);

/* The same of b that does not turn, along a way, with a at rest. */
int fp3_cast3(const fp3_shape3 *a, const fp3_pose3 *pose_a, const fp3_shape3 *b,
              const fp3_pose3 *pose_b, fp3_point3 way, float slop, fp3_hit3 *hit);

#endif
