/* SPDX-License-Identifier: Apache-2.0 */
/* camera.h - where in a picture a place of a recording is: as in the page (page/camera.js), seen
 * from its first view or turned.
 *
 * Of the mathematical library only sqrt and floor are used, which are exact everywhere: so a place
 * is in the same part of a pixel on every machine.
 */
#ifndef FP3_VIEW_CAMERA_H
#define FP3_VIEW_CAMERA_H

#include "page.h"
#include "raster.h"

/* A picture, and from where it is seen. */
typedef struct {
    uint32_t width, height;
    double azimuth, elevation; /* degrees; of three axes alone */
} fp3_view_look;

typedef struct {
    double middle[FP3_VIEW_AXES], scale[FP3_VIEW_AXES], half[FP3_VIEW_AXES]; /* of what is seen */
    double right[3], up[3], back[3];
    double distance, nearest,
        depth; /* of the eye; of what is nearest to it; from there to what is farthest */
    double zoom, width, height; /* of the drawing */
    int is_flat;
} fp3_view_camera;

#define FP3_VIEW_NEAR 0.02 /* of the distance: what is nearer to the eye is not seen */

fp3_view_camera fp3_view_camera_of(const fp3_view_page *page, const fp3_view_look *look);

/* A value along an axis, in the world: 0 in the middle, 2 from end to end of the longest side. */
double fp3_view_camera_world(const fp3_view_camera *camera, unsigned axis, double value);
/* A point of the world. *size: parts of a pixel that a length of 1 there takes. */
fp3_view_place fp3_view_camera_see(const fp3_view_camera *camera, const double point[3],
                                   double *size);
/* A point of the world from the eye: to the right, up, and away. */
void fp3_view_camera_eye(const fp3_view_camera *camera, const double point[3], double eye[3]);
/* Cuts off what of a line between two points of the world is too near to the eye, or behind it;
 * ends are the same line in any coordinates. 0: nothing is left. */
int fp3_view_camera_cut(const fp3_view_camera *camera, const double world[2][3], double ends[2][3]);
/* Where that is in the picture. */
fp3_view_place fp3_view_camera_place(const fp3_view_camera *camera, const double eye[3]);
/* What a length of 1 is as a depth. */
double fp3_view_camera_deep(const fp3_view_camera *camera);

#endif
