/* SPDX-License-Identifier: Apache-2.0 */
/* gsl.h - the solvers of GSL, each with a sweep of tolerances. */
#ifndef FP3_MEASURE_GSL_H
#define FP3_MEASURE_GSL_H

#include "options.h"

fp3_measure_solver_fn fp3_measure_add_gsl;

#endif
