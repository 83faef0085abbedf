/* SPDX-License-Identifier: Apache-2.0 */
/* collide2.h - where two shapes in the plane touch, or will soon.
 *
 * A manifold has a normal and up to two points. All is computed from where b is as seen from a, so
 * what a world far from its origin loses is lost in the poses alone. Extents below are those of
 * both shapes together (fp3_shape2).
 *
 * - The normal is of length 1 within 2^-21, from a to b, in the axes of the world. Which: where
 *   the shapes without their radii (the cores) overlap, that of the least way out, of an edge of a
 *   or b; where they do not, that between their nearest points.
 * - Two edges that are equally good within 2^-16 of the extents: a's is taken, so that boxes on
 *   each other keep their normal. The least gap is right within 2^-15 of the extents therefore,
 *   and otherwise within 4 roundings (2^-22) of the extents and of the distance.
 * - A point's gap is along the normal, negative where the shapes overlap. Of a rounded edge that is
 *   tilted by f, the second point's gap is of the core's point: larger than the surface's by
 *   radius * (1 / cos f - 1).
 * - Shapes that overlap or are nearer than reach have a point at least, others have none. A
 *   point with a gap above reach is left out.
 *
 * Where the choice is free (discs with one centre), the normal is a's axis y. Poses that are not
 * finite, are no turns, or are more than 1e15 apart touch nothing. Swapping a and b turns the
 * normal around and swaps the points, within the errors above; not bit for bit. */
#ifndef FP3_BODIES_COLLIDE2_H
#define FP3_BODIES_COLLIDE2_H

#include "bodies/shapes/shape2.h"

typedef struct {
    fp3_point2 normal;
    struct {
        fp3_point2
            arm; /* from a's position to the middle between both surfaces, in the world's axes */
        float gap;
    } point[2]; /* in the order of the tangent (-normal.y, normal.x); from count on
                 numbers without a meaning */
    uint32_t count;
} fp3_manifold2;

/* reach: 0 or more. */
void fp3_collide2(const fp3_shape2 *a, const fp3_pose2 *pose_a, const fp3_shape2 *b,
                  const fp3_pose2 *pose_b, float reach, fp3_manifold2 *made);

/* An edge of ground, as a part of a chain: it has one side, and what slides over its ends does not
 * catch there. The ground is to the left of the way from corner 0 to 3, as in a polygon: a chain
 * around an island runs anticlockwise, a floor under bodies from right to left. */
enum {
    FP3_LINK2_FIRST = 1, /* there is no edge before this one */
    FP3_LINK2_LAST = 2   /* there is none after it */
};

typedef struct {
    /* The edge is from 1 to 2; 0 and 3 are the other ends of its neighbours, or, at an end of the
     * chain, the user's idea of how the ground goes on. */
    fp3_point2 corner[4];
    float radius;
    uint32_t ends; /* the sum of what there is of the above */
} fp3_link2;

/* The normal is the edge's, or at an end where the ground is convex one between those of the two
 * edges there. Of the latter each edge has those that are nearer to its own normal, so that no
 * contact is made twice. What has the middle of its corners behind, along that normal, does not
 * touch. */
void fp3_collide_link2(const fp3_link2 *a, const fp3_pose2 *pose_a, const fp3_shape2 *b,
                       const fp3_pose2 *pose_b, float reach, fp3_manifold2 *made);

#endif
