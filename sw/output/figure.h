/* figure.h - curves as a script for gnuplot: panels over time, orbits, phase planes. */
#ifndef FP3_OUTPUT_FIGURE_H
#define FP3_OUTPUT_FIGURE_H

#include "sink.h"

#include <stdio.h>

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

/* Over time: a name has one. Of one object, the components of a vector share one. */
size_t fp3_figure_panels(const fp3_figure *figure);

void fp3_figure_write(const fp3_figure *figure, FILE *script);

#endif
