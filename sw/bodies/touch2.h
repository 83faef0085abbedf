/* SPDX-License-Identifier: Apache-2.0 */
/* touch2.h - two shapes in a plane that are or may soon be near, from step to step. */
#ifndef FP3_BODIES_TOUCH2_H
#define FP3_BODIES_TOUCH2_H

#include "shapes/collide2.h"

/* a is below b. Points of the manifold are in the order of the tangent, and so are impulses. What a
 * step goes over stands together, in this order: rows of contacts are made of the words from `m` to
 * `radius_b`, eight at a time (solve2.c). */
typedef struct {
    fp3_manifold2 m; /* from a to b; no points: they do not touch */
    float p[2], f[2], r;
    fp3_point2 from;                                   /* the way from a to b */
    float friction, belt, rolling, radius_a, radius_b; /* of both shapes together */
    fp3_point2 before;                                 /* the normal that the impulses are of */
    float top;
    /* When the shapes were last looked at, and what was found: while both have hardly moved since,
     * gaps follow from it. is_found 0: it says nothing, also if neither is awake. */
    fp3_manifold2 found;
    fp3_point2 found_from, turn_a, turn_b;
    uint32_t is_found;
    uint32_t a, b, body_a, body_b;
    float approach;                         /* how fast they come together when a step begins */
    uint32_t points;                        /* ... that the impulses are of */
    uint8_t is_bouncy, is_sensor, has_belt; /* has_belt: in space, a surface moves */
    uint8_t is_touching, is_left;           /* is_left: it does nothing in this step */
    double at[3];                           /* where its deepest point was when it was looked at */
    float normal[3];                        /* there */
    uint32_t first_patch, patches, patch_room; /* in space: its manifolds (patch3.h) */
} fp3_touch2;

#endif
