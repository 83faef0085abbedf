/* SPDX-License-Identifier: Apache-2.0 */
/* kepler.h - a planet for the suite: objects that are the same orbit, turned, so that their
 * roundings differ. */
#ifndef FP3_STRESS_KEPLER_H
#define FP3_STRESS_KEPLER_H

#include "lab.h"

#define FP3_KEPLER_STATES 4 /* v_x, v_y, r_x, r_y: the rows of fp3_lab_read_all */

extern const char fp3_kepler_text[];

/* Object i starts in the pericentre of an orbit of semi-major axis 1, turned by i angles; the first
 * is not. */
fp3_status fp3_kepler_fill(fp3_lab *lab, size_t objects, double eccentricity, fp3_error *error);
double fp3_kepler_energy(const double *row);
double fp3_kepler_momentum(const double *row);
/* Where it is at time t, by Kepler's equation (Goldstein, Classical Mechanics, chapter 3). */
void fp3_kepler_truth(const double *start, double t, double *row);

#endif
