/* SPDX-License-Identifier: Apache-2.0 */
/* picture.h - a snapshot of a recording as pixels, without a display: what the page shows at first,
 * in its light colours and without words.
 */
#ifndef FP3_VIEW_PICTURE_H
#define FP3_VIEW_PICTURE_H

#include "camera.h"

typedef struct {
    const fp3_view_page *page;
    fp3_view_camera camera;
    size_t life; /* column, or FP3_VIEW_NO_COLUMN */
    fp3_view_raster raster;
    uint8_t *pixels; /* 3 bytes of each */
} fp3_view_picture;

/* The caller frees *picture, after a failure too. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_view_picture_make(const fp3_view_page *page, const fp3_view_look *look,
                                 fp3_view_picture *picture, fp3_error *error);
/* Leaves {0}, which may be freed as well. */
void fp3_view_picture_free(fp3_view_picture *picture);

/* Fills picture->pixels. */
void fp3_view_picture_draw(fp3_view_picture *picture, size_t snapshot);

#endif
