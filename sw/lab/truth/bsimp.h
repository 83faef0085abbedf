/* SPDX-License-Identifier: Apache-2.0 */
/* bsimp.h - GSL's bsimp, also where a state is near 0. */
#ifndef FP3_TRUTH_BSIMP_H
#define FP3_TRUTH_BSIMP_H

#include <gsl/gsl_odeiv2.h>

/* A method for gsl_odeiv2_step_alloc. An error of infinity says that the step is too long. */
extern const gsl_odeiv2_step_type fp3_step_bsimp;

#endif
