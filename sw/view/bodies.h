/* SPDX-License-Identifier: Apache-2.0 */
/* bodies.h - shapes, joints and contacts of rigid bodies as pixels, in a plane and in space. */
#ifndef FP3_VIEW_BODIES_H
#define FP3_VIEW_BODIES_H

#include "camera.h"

/* Of a page whose axes have shapes. */
void fp3_view_bodies_draw(const fp3_view_page *page, const fp3_view_camera *camera,
                          fp3_view_raster *raster, size_t snapshot);

#endif
