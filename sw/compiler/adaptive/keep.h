/* SPDX-License-Identifier: Apache-2.0 */
/* keep.h - values that a step leaves to the next one. */
#ifndef FP3_KEEP_H
#define FP3_KEEP_H

#include "compiler/step/advance.h"

/* A variable that holds node `first` in each step: computed when a visit begins, and then `next`.
 * FP3_E_SYSTEM: out of memory. */
fp3_status fp3_keep(fp3_step *step, uint32_t first, uint32_t next, fp3_error *error);

/* Keeps the slopes and the functions of t at the end of the step, if computed, for the next step.
 * Errors as above. */
fp3_status fp3_keep_stages(const fp3_advance *a, fp3_error *error);

#endif
