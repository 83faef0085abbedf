/* SPDX-License-Identifier: Apache-2.0 */
/* shape2.h - shapes of rigid bodies in the plane: where they reach, and what they weigh.
 *
 * There is one kind: a convex polygon of 1 to 8 corners, rounded by a radius. One corner is a disc,
 * two are a capsule (with radius 0 a segment).
 *
 * Arithmetic: binary32 with + - * / and roots alone, in the order of the text, so that a shape has
 * the same bits everywhere; mass in binary64 likewise. What the makers accept are numbers between
 * FP3_SIZE2_LEAST and FP3_SIZE2_MOST. A made shape is one that the rest of this room takes. */
#ifndef FP3_BODIES_SHAPE2_H
#define FP3_BODIES_SHAPE2_H

#include <fp3/status.h>

#include <stddef.h>

enum { FP3_CORNERS2 = 8 };

/* Lengths, in whatever unit. A shape is at least as wide as the first and as far from its origin
 * as the second. */
#define FP3_SIZE2_LEAST 1e-6f
#define FP3_SIZE2_MOST 1e6f

typedef struct {
    float x, y;
} fp3_point2;

/* A point p of a shape is in the world at + (c * p.x - s * p.y, s * p.x + c * p.y). */
typedef struct {
    fp3_point2 at;
    float c, s;
} fp3_pose2;

typedef struct {
    float x[FP3_CORNERS2], y[FP3_CORNERS2];
} fp3_points2;

/* Behind the last corner it stands again, with its normal, up to the end. */
typedef struct {
    uint32_t count;     /* of corners, from 1 */
    fp3_points2 corner; /* anticlockwise */
    fp3_points2 normal; /* outwards, of the edge from corner i to the next; of a single one 0 */
} fp3_core2;

typedef struct {
    fp3_core2 core;
    float radius;      /* around each corner and what is between them */
    float extent;      /* no point of the shape is farther from its origin */
    fp3_point2 middle; /* the mean of the corners */
} fp3_shape2;

typedef struct {
    fp3_point2 low, high;
} fp3_bounds2;

/* Of a surface with a density: binary64, as are the sums behind it. */
typedef struct {
    double mass, x, y; /* and where its centre is */
    double inertia;    /* about the centre */
} fp3_mass2;

/* ---- points ---- */

static inline fp3_point2 fp3_at2(const fp3_points2 *points, uint32_t i) {
    return (fp3_point2){points->x[i], points->y[i]};
}
static inline fp3_point2 fp3_add2(fp3_point2 a, fp3_point2 b) {
    return (fp3_point2){a.x + b.x, a.y + b.y};
}
static inline fp3_point2 fp3_subtract2(fp3_point2 a, fp3_point2 b) {
    return (fp3_point2){a.x - b.x, a.y - b.y};
}
/* a + t b */
static inline fp3_point2 fp3_along2(fp3_point2 a, float t, fp3_point2 b) {
    return (fp3_point2){a.x + t * b.x, a.y + t * b.y};
}
static inline float fp3_dot2(fp3_point2 a, fp3_point2 b) { return a.x * b.x + a.y * b.y; }
static inline float fp3_cross2(fp3_point2 a, fp3_point2 b) { return a.x * b.y - a.y * b.x; }
/* Sums alone: of a difference beside a sum gcc 12 makes a fused multiply-add where there is one, in
 * spite of -ffp-contract=off. */
static inline fp3_point2 fp3_turn2(const fp3_pose2 *pose, fp3_point2 p) {
    const float back = -pose->s;
    return (fp3_point2){pose->c * p.x + back * p.y, pose->s * p.x + pose->c * p.y};
}
static inline fp3_point2 fp3_turn_back2(const fp3_pose2 *pose, fp3_point2 p) {
    const float back = -pose->s;
    return (fp3_point2){pose->c * p.x + pose->s * p.y, back * p.x + pose->c * p.y};
}
static inline fp3_point2 fp3_place2(const fp3_pose2 *pose, fp3_point2 p) {
    return fp3_add2(pose->at, fp3_turn2(pose, p));
}

/* ---- makers: *made is unchanged after a failure ---- */

fp3_status fp3_disc2(fp3_point2 centre, float radius, fp3_shape2 *made, fp3_error *error);
/* radius 0: a segment. */
fp3_status fp3_capsule2(fp3_point2 a, fp3_point2 b, float radius, fp3_shape2 *made,
                        fp3_error *error);
/* Half its width and height without the radius, and where its middle is. */
fp3_status fp3_box2(fp3_point2 half, const fp3_pose2 *pose, float radius, fp3_shape2 *made,
                    fp3_error *error);
/* The convex hull of 3 to 8 points in any order. Its first corner is the lowest of the leftmost. A
 * corner is left out that is nearer than 2^-14 of the points' extent to the line through the two
 * beside it; fewer than three corners are refused. */
fp3_status fp3_polygon2(const fp3_point2 *points, uint32_t count, float radius, fp3_shape2 *made,
                        fp3_error *error);

/* The same shape as seen from another point: what was at by is at the origin. */
void fp3_shift2(const fp3_shape2 *shape, fp3_point2 by, fp3_shape2 *made);

/* ---- what the others ask ---- */

/* Where the shape reaches, margin more on each side; right within the rounding of the numbers in
 * *pose and of the shape's extent, so a margin of 2^-22 of these two is enough. */
fp3_bounds2 fp3_bound2(const fp3_shape2 *shape, const fp3_pose2 *pose, float margin);

/* Mass, centre and inertia of the rounded shape; a segment weighs nothing. */
fp3_mass2 fp3_weigh2(const fp3_shape2 *shape, double density);
/* Of several together, in their order. Without mass the centre is the origin. */
fp3_mass2 fp3_weigh_together2(const fp3_mass2 *parts, size_t count);

#endif
