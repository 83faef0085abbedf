/* SPDX-License-Identifier: Apache-2.0 */
/* planes.h - which of the observed names are drawn one against another, and which share a panel.
 *
 * Consecutive names that end in x, y and, maybe, z after the same letters (r_x, r_y) are the
 * components of a vector.
 */
#ifndef FP3_OUTPUT_PLANES_H
#define FP3_OUTPUT_PLANES_H

#include "curves.h"

/* Components of the vector that begins here, which may be drawn along one axis; 1: there is none.
 */
size_t fp3_planes_vector(const fp3_subject *subject, size_t name);

/* What stands before the x of a component: "r" of "r_x"; "" of "x". */
size_t fp3_planes_prefix(const char *name);

typedef struct {
    double from, to;
} fp3_range;

/* Of what is finite, with a margin; never empty, which gnuplot would refuse. */
fp3_range fp3_range_of(const double *values, size_t count);
fp3_range fp3_range_joined(fp3_range a, fp3_range b);

/* The names along the axes of each curve: of orbits there may be several, of bodies that move in
 * one plane. */
typedef struct {
    size_t x[FP3_CURVES_MOST], y[FP3_CURVES_MOST], count;
    int is_orbit;
    int has_one_scale; /* both axes are measured in the same */
} fp3_plane;

#define FP3_PLANES_MOST 6

/* Orbits, then each state with its velocity; else the two states, if there are just two. Returns
 * how many. The values matter to vectors of three components alone. */
size_t fp3_planes_find(const fp3_figure *figure, fp3_plane planes[FP3_PLANES_MOST]);

#endif
