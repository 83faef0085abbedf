/* SPDX-License-Identifier: Apache-2.0 */
/* figure.h - curves as a script for gnuplot: panels over time, orbits, phase planes. */
#ifndef FP3_OUTPUT_FIGURE_H
#define FP3_OUTPUT_FIGURE_H

#include "curves.h"

#include <stdio.h>

/* Over time: a name has one. Of one object, the components of a vector share one. */
size_t fp3_figure_panels(const fp3_figure *figure);

void fp3_figure_write(const fp3_figure *figure, FILE *script);

#endif
