/* SPDX-License-Identifier: Apache-2.0 */
/* spectrum.h - how fast the objects of a scene may swing and be damped together, and what a step of
 * their integrators makes of a small disturbance.
 *
 *     fp3_spectrum *of = NULL;
 *     fp3_growth found;
 *     fp3_status status = fp3_spectrum_open(scene, INFINITY, &of, error);
 *     if (!status)
 *         status = fp3_spectrum_growth(of, 0, &found, error);
 *     fp3_spectrum_close(&of);
 *
 * The equations are linearised at the states of the crowd, by differences. Power iteration leaves
 * the fastest part of a random disturbance of all objects: of the equations, or of a step. Pairs
 * remember nothing. Where that takes more work than allowed, the objects that answer a disturbance
 * most are looked at, and the others stay where they are, which can only make forces that are equal
 * and opposite less stiff.
 */
#ifndef FP3_LAB_SPECTRUM_H
#define FP3_LAB_SPECTRUM_H

#include "crowd.h"

typedef struct fp3_spectrum fp3_spectrum;

/* What a step makes of a disturbance. */
typedef struct {
    double factor; /* it grows so many times in each step; 1: the step is short enough, or the
                      motion itself grows as fast */
    double stable; /* a step with which it does not grow; 0: even with h/16 it does */
    size_t group, object; /* where it is largest */
} fp3_growth;

/* The largest eigenvalues of the equations: of -dv'/dx, and of -dv'/dv with all that has no
 * velocity. What pushes away has no frequency and is no damper: it is of the other sign, and does
 * not count. */
typedef struct {
    double stiffness; /* of springs: the square of an angular frequency */
    double damping;   /* of dampers, and of equations of first order */
    size_t of_springs, springs_object, of_dampers, dampers_object; /* groups and objects */
} fp3_rates;

/* The scene must outlive it. work: how many numbers may be computed in a look. FP3_E_PROGRAM: as of
 * fp3_crowd_open. The caller closes *of, which is NULL on failure. */
fp3_status fp3_spectrum_open(const fp3_scene *scene, double work, fp3_spectrum **of,
                             fp3_error *error);
/* Sets *of to NULL, which it may be already. */
void fp3_spectrum_close(fp3_spectrum **of);

/* Of its groups the states, which the caller may change. At first they are the scene's start. */
fp3_crowd *fp3_spectrum_crowd(fp3_spectrum *of);
/* Leaves a few equal objects of this group alone, at rest, side by side, just within the reach of
 * its first relation of near objects of its own. Returns 0 if it has none. */
int fp3_spectrum_pack(fp3_spectrum *of, size_t group);

/* After so many steps of the scene: who lives then is looked at. Groups with a linearly implicit
 * integrator are not, and stay where they are. */
fp3_status fp3_spectrum_growth(fp3_spectrum *of, uint64_t step, fp3_growth *found,
                               fp3_error *error);
/* Whether no group before this one is tied to it by what they see. */
int fp3_spectrum_is_first(const fp3_spectrum *of, size_t group);
/* Of one group, with those that it is tied to by what they see. */
fp3_status fp3_spectrum_rates(fp3_spectrum *of, uint64_t step, size_t group, fp3_rates *found,
                              fp3_error *error);
/* How many objects, in the mean, one of those looked at had within reach of a relation of near
 * objects of its own group; infinite where there is no such relation. */
double fp3_spectrum_neighbours(const fp3_spectrum *of);

#endif
