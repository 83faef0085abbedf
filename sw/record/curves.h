/* SPDX-License-Identifier: Apache-2.0 */
/* curves.h - what a picture is drawn of: values of some objects over time. */
#ifndef FP3_OUTPUT_CURVES_H
#define FP3_OUTPUT_CURVES_H

#include "sink.h"

#define FP3_CURVES_MOST 8  /* objects */
#define FP3_PANELS_MOST 12 /* over time */

typedef struct {
    const fp3_subject *subject;
    size_t objects[FP3_CURVES_MOST], object_count;
    size_t points;       /* of a curve */
    const double *times; /* or steps, where there is no time */
    /* [name][object][point] */
    const double *values;
} fp3_figure;

#endif
