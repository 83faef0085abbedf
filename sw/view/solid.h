/* SPDX-License-Identifier: Apache-2.0 */
/* solid.h - faces and round bodies in space as pixels, with what hides what.
 *
 * Points and lengths are of the camera's world. Light comes from the left above, as on balls.
 */
#ifndef FP3_VIEW_SOLID_H
#define FP3_VIEW_SOLID_H

#include "camera.h"

/* A flat convex face, whose corners run anticlockwise as seen from outside, from where alone it is
 * seen. */
void fp3_view_solid_face(fp3_view_raster *raster, const fp3_view_camera *camera,
                         const double (*corners)[3], unsigned count, const fp3_view_paint *paint);

/* All points that are as near as the radius to the way from one end to the other: a ball, if they
 * are the same. sectors: two directions across; where the surface looks along both or against both,
 * it is darker. NULL: it has one colour. */
void fp3_view_solid_round(fp3_view_raster *raster, const fp3_view_camera *camera,
                          const double ends[2][3], double radius, const double (*sectors)[3],
                          const fp3_view_paint *paint);

#endif
