/* SPDX-License-Identifier: Apache-2.0 */
/* shape3.h - shapes in space: convex hulls of up to 32 corners, rounded by a radius.
 *
 *     fp3_shape3 box;
 *     fp3_box3((fp3_point3){0.5f, 0.5f, 0.5f}, NULL, 0, &box, &error);
 *
 * One corner is a ball, two are a capsule (or a segment, with radius 0), three a triangle, more a
 * polyhedron. A shape is all points that are no farther than the radius from the hull of its
 * corners, its core. What only the core has (faces, edges, normals) is in the shape's own frame.
 *
 * Makers refuse numbers that are not finite, coordinates and sizes beyond 1e6, and cores with a
 * side below 1e-6. A maker leaves *shape unchanged if it fails.
 */
#ifndef FP3_BODIES_SHAPE3_H
#define FP3_BODIES_SHAPE3_H

#include <fp3/status.h>

#include "point3.h"

enum { FP3_CORNERS3 = 32, FP3_FACES3 = 60, FP3_HALVES3 = 180 };

typedef enum { FP3_NO_BOX3, FP3_BOX3, FP3_STRAIGHT_BOX3 } fp3_box_kind3;

/* An edge is two halves, 2 k and 2 k + 1, that run in opposite directions. Seen from outside a
 * face's halves run anticlockwise. */
typedef struct {
    uint32_t count;  /* of corners */
    uint32_t faces;  /* 0: point or segment; 2: triangle, from both sides */
    uint32_t halves; /* 0: point; 2: segment, its halves have no face */
    float radius;
    float extent;      /* from the frame's origin to the farthest point, its rounding included */
    float inner;       /* from the centre to the nearest face of the core; 0 without faces */
    fp3_box_kind3 box; /* whether face 2 k is opposite to face 2 k + 1 and square to the others */
    fp3_point3 middle; /* of the corners */
    fp3_point3 half;   /* of a box: half of its sides, along the normals of faces 0, 2 and 4 */
    fp3_point3 corner[FP3_CORNERS3];
    fp3_point3 normal[FP3_FACES3]; /* of length 1, outwards */
    float offset[FP3_FACES3];      /* normal . p of the face's points */
    uint8_t first[FP3_FACES3];     /* a half of each face */
    uint8_t from[FP3_HALVES3]; /* the corner at which a half begins; its twin begins at the end */
    uint8_t next[FP3_HALVES3]; /* the next half around the face */
    uint8_t face[FP3_HALVES3];
} fp3_shape3;

typedef struct {
    fp3_point3 low, high;
} fp3_bounds3;

/* A radius of 0 makes a point. */
fp3_status fp3_ball3(fp3_point3 centre, float radius, fp3_shape3 *shape, fp3_error *error);

/* With a and b closer than 1e-6, or than the rounding of their coordinates, a ball at a. */
fp3_status fp3_capsule3(fp3_point3 a, fp3_point3 b, float radius, fp3_shape3 *shape,
                        fp3_error *error);

/* Half sides along the axes of a pose (NULL: none), then rounded by the radius. */
fp3_status fp3_box3(fp3_point3 half, const fp3_pose3 *pose, float radius, fp3_shape3 *shape,
                    fp3_error *error);

/* Anticlockwise as seen from where its first normal points. */
fp3_status fp3_triangle3(const fp3_point3 corner[3], float radius, fp3_shape3 *shape,
                         fp3_error *error);

/* The hull of up to 32 points in any order (hull3.c). Corners keep the order of their points.
 * Points within 2^-16 of the hull's size of a face belong to it; those that are no corners of the
 * faces found so are left out. Refused if flat. */
fp3_status fp3_hull3(uint32_t count, const fp3_point3 *point, float radius, fp3_shape3 *shape,
                     fp3_error *error);

/* Where the shape reaches, margin more on each side, and a little more for what rounding hides. */
fp3_bounds3 fp3_bound3(const fp3_shape3 *shape, const fp3_pose3 *pose, float margin);

/* A polyhedron's faces as loops of corners, anticlockwise; corners and their count are there
 * already. Writes halves, normals and what else a shape has. 0: the loops are no polyhedron. */
int fp3_shape3_close(fp3_shape3 *shape, uint32_t faces, uint8_t (*loop)[FP3_CORNERS3],
                     const uint8_t *length);

#define FP3_LARGEST3 1e6f
/* Whether numbers are finite and at most that. */
int fp3_shape3_takes(uint32_t count, const fp3_point3 *point, float radius);

#endif
