/* SPDX-License-Identifier: Apache-2.0 */
/* page.h - a recording as one HTML file that loads nothing. */
#ifndef FP3_VIEW_PAGE_H
#define FP3_VIEW_PAGE_H

#include "fields.h"
#include "pack.h"

#include <stdio.h>

/* A wall: all points whose coordinate along the axis has this value. */
typedef struct {
    unsigned axis;
    double at;
} fp3_view_plane;

#define FP3_VIEW_PLANES_MOST 16

typedef struct {
    const fp3_view_recording *recording; /* loaded */
    const fp3_view_axes *axes;
    const fp3_view_fields *fields;
    fp3_view_plane planes[FP3_VIEW_PLANES_MOST];
    unsigned plane_count;
    double box[2][FP3_VIEW_AXES];  /* its corners */
    unsigned box_axes;             /* 0: there is no box */
    double seen[FP3_VIEW_AXES][2]; /* from where to where is seen at first */
    unsigned seen_axes;            /* 0: all that moves is seen */
    int has_contacts;              /* contacts are drawn, if they are recorded */
    const char *title;             /* NULL: the model's name, or the file's */
    int up;                        /* the axis that points up */
    int is_exact;                  /* all bits of FP32, instead of 16 */
} fp3_view_page;

/* FP3_E_ARGUMENT: a wall is along an axis that the position does not have. */
fp3_status fp3_view_page_check(const fp3_view_page *page, fp3_error *error);

/* Sets scales[i], one for each column of the recording that is loaded. FP3_E_SYSTEM: out of memory.
 */
fp3_status fp3_view_page_write(const fp3_view_page *page, FILE *out, fp3_view_scale *scales,
                               fp3_error *error);

#endif
