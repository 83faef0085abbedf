/* SPDX-License-Identifier: Apache-2.0 */
/* before.h - what the variables of a step are when a run begins. */
#ifndef FP3_BEFORE_H
#define FP3_BEFORE_H

#include "compiler/step/step.h"

/* Columns of count objects, of params, of states, and of the start of each variable, except carried
 * variables. A state one step before the start is computed from the equations in double at -h. */
fp3_status fp3_before_start(const fp3_step *step, const double *params, const double *initial,
                            double h, size_t count, double *start, fp3_error *error);

#endif
