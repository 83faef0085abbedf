/* SPDX-License-Identifier: Apache-2.0 */
/* stiff.h - whether the steps of an explicit method are as long as its stability allows. */
#ifndef FP3_TRUTH_STIFF_H
#define FP3_TRUTH_STIFF_H

#include <gsl/gsl_odeiv2.h>

/* The largest |h lambda| of all eigenvalues lambda of the Jacobian that damp (the real part of h
 * lambda is below 0), but 0 if it is surely below `least`. A Jacobian that has no value makes it 0,
 * too. GSL_SUCCESS or GSL_ENOMEM. */
int fp3_stiff_reach(const gsl_odeiv2_system *system, double t, double h, const double *y,
                    double least, double *reach);

#endif
