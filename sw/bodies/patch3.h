/* SPDX-License-Identifier: Apache-2.0 */
/* patch3.h - a manifold of two shapes in space, from step to step. Ground of triangles has several
 * with one shape. */
#ifndef FP3_BODIES_PATCH3_H
#define FP3_BODIES_PATCH3_H

#include "shapes/collide3.h"

/* What a step goes over stands together, in this order: rows of contacts are made of the words from
 * `m` to `radius_b`, eight at a time (solve3.c). */
typedef struct {
    fp3_manifold3 m;          /* from a to b */
    float p[4], twist;        /* impulses */
    float f[3], roll[3], top; /* ... f and roll in the world's axes */
    fp3_point3 from; /* b's centre of mass as seen from a's, when the shapes were last looked at, */
    float friction, rolling, radius_a, radius_b; /* of both shapes together */
    float turn_a[4], turn_b[4];                  /* ... their turns, */
    float gap[4];                                /* ... and the gaps of m then: all else stays */
    uint32_t touch;                              /* of bodies->touch, in this step */
    uint32_t a, b, part;                         /* shapes; the triangle */
} fp3_patch3;

#endif
