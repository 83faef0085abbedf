/* SPDX-License-Identifier: Apache-2.0 */
/* collide3.h - where two shapes touch: a normal and up to four points.
 *
 *     fp3_manifold3 touch;
 *     fp3_collide3(&a, &pose_a, &b, &pose_b, 0.02f, &touch);
 *
 * All is computed in a's frame, from the difference of both positions, so the world's origin does
 * not matter. Errors below are in units of the sizes S = outer_a + outer_b of both shapes, each
 * from its own origin.
 *
 * The normal: if the cores overlap, that of the least overlap, or of one that overlaps more by at
 * most fp3_axes3_slack (1/128 of the smaller inner radius), which keeps the choice stable; if they
 * are apart, from closest point to closest point. The gap of a point is that of both surfaces along
 * the normal, within 2e-6 S of the exact one for that normal; negative in overlap. The least gap
 * of a manifold is that of the shapes, within the slack just named and 1e-5 S.
 *
 * Order: points go anticlockwise about the normal, from the one farthest along a fixed direction
 * (clip3.h); two points too begin with that one. The order and the choice of four may change while
 * bodies turn against each other; so old and new points are matched by place:
 * fp3_match_manifold3.
 *
 * No contact for poses that are not finite, quaternions whose length is not from 1e-3 to 1e3, or
 * positions more than 1e8 apart. Where no direction follows from the shapes (two balls with one
 * centre) the normal is (0, 1, 0).
 */
#ifndef FP3_BODIES_COLLIDE3_H
#define FP3_BODIES_COLLIDE3_H

#include "bodies/shapes/shape3.h"

typedef struct {
    fp3_point3 normal; /* from a to b, in the world's axes */
    uint32_t count;    /* 0: nothing within reach */
    struct {
        fp3_point3 arm; /* in the world's axes, from a's position to midway between the surfaces */
        float gap;
    } point[4];
} fp3_manifold3;

/* Points with a gap of at most `reach` are kept. */
void fp3_collide3(const fp3_shape3 *a, const fp3_pose3 *pose_a, const fp3_shape3 *b,
                  const fp3_pose3 *pose_b, float reach, fp3_manifold3 *to);

/* The same with the normal of one face of a, whatever else is nearer; and only what is before that
 * face. */
void fp3_collide_face3(const fp3_shape3 *a, const fp3_pose3 *pose_a, uint32_t face,
                       const fp3_shape3 *b, const fp3_pose3 *pose_b, float reach,
                       fp3_manifold3 *to);

/* For each new point in from[] the nearest old one, by arms, or 4 if none is within `near`. No old
 * point is taken twice: pairs are matched from the closest one on, and equally close ones by
 * number. */
void fp3_match_manifold3(const fp3_manifold3 *old, const fp3_manifold3 *new_one, float near,
                         uint8_t from[4]);

/* All points with normal . p <= offset, in a body's frame; normal has length 1. */
typedef struct {
    fp3_point3 normal;
    float offset;
} fp3_plane3;

void fp3_collide_plane3(const fp3_plane3 *a, const fp3_pose3 *pose_a, const fp3_shape3 *b,
                        const fp3_pose3 *pose_b, float reach, fp3_manifold3 *to);

#endif
