/* SPDX-License-Identifier: Apache-2.0 */
/* outline.h - where the edge of a body's shape is, and how far bodies reach. */
#ifndef FP3_VIEW_OUTLINE_H
#define FP3_VIEW_OUTLINE_H

#include "axes.h"

#define FP3_VIEW_WAYS 48 /* directions in which the edge is looked for */

/* The convex edge of a shape in a plane, anticlockwise, in the axes of its body: of each direction
 * the corner that is farthest, and the radius beyond it. least: a radius that circles and capsules
 * have at least, so that a segment can be seen. Returns how many points there are: those that are
 * equal stand once. */
unsigned fp3_view_outline(const fp3_view_recording *r, const fp3_view_shape *shape, double least,
                          double points[FP3_VIEW_WAYS][3]);

/* Where the body of an object is at value `at`, which is snapshot * objects + object, and how it is
 * turned. 0: it is nowhere. */
typedef struct {
    double x[3], turn[3][3];
} fp3_view_pose;
int fp3_view_pose_of(const fp3_view_recording *r, const fp3_view_axes *axes, size_t at,
                     fp3_view_pose *pose);
static inline void fp3_view_pose_place(const fp3_view_pose *pose, const double from[3],
                                       double to[3]) {
    for (int k = 0; k < 3; k++)
        to[k] = pose->x[k] + ((pose->turn[k][0] * from[0] + pose->turn[k][1] * from[1]) +
                              pose->turn[k][2] * from[2]);
}

/* From where to where bodies that are not static reach along an axis in all snapshots; where there
 * are none, all bodies. */
void fp3_view_outline_ends(const fp3_view_recording *r, const fp3_view_axes *axes, unsigned axis,
                           double ends[2]);

#endif
