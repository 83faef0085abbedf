/* SPDX-License-Identifier: Apache-2.0 */
/* part.h - from the beginning of a step to a time within it. */
#ifndef FP3_TRUTH_PART_H
#define FP3_TRUTH_PART_H

#include <gsl/gsl_odeiv2.h>

/* y goes from time t to t + h. step is of a method that needs no step before it; lost is room for
 * states. Returns GSL's codes. */
int fp3_part_go(gsl_odeiv2_step *step, const gsl_odeiv2_system *system, double t, double h,
                double *y, double *lost);

#endif
