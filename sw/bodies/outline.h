/* SPDX-License-Identifier: Apache-2.0 */
/* outline.h - shapes and joints of bodies as they are drawn. z is 0 in the plane. */
#ifndef FP3_BODIES_OUTLINE_H
#define FP3_BODIES_OUTLINE_H

#include <fp3/bodies.h>

/* One corner is a circle, in space a sphere, two are a capsule. More go around anticlockwise; in
 * space they are those of triangles, anticlockwise as seen from outside: of a hull, a mesh or
 * heights. An infinite radius is a plane: its corners are a point of it and one above that. */
typedef struct {
    uint64_t body; /* its handle */
    fp3_body_type type;
    int is_sensor;
    double radius; /* around all of it */
    size_t corners, triangles;
    const double (*corner)[3]; /* in the body's axes, from its origin */
    const uint32_t (*triangle)[3];
} fp3_outline;

typedef struct {
    fp3_joint_type type;
    uint64_t joint, a, b; /* handles */
    double anchor_a[3], anchor_b[3];
} fp3_outline_joint;

/* Call `one` for each shape, where an edge of a chain is one, or for each joint, in the order of
 * numbers. They end with what `one` returns, unless it is FP3_OK. FP3_E_SYSTEM: out of memory. */
typedef fp3_status fp3_outline_fn(void *user, const fp3_outline *outline);
fp3_status fp3_bodies_outlines(const fp3_bodies *bodies, fp3_outline_fn *one, void *user,
                               fp3_error *error);
typedef fp3_status fp3_outline_joint_fn(void *user, const fp3_outline_joint *joint);
fp3_status fp3_bodies_outline_joints(const fp3_bodies *bodies, fp3_outline_joint_fn *one,
                                     void *user);

#endif
