/* SPDX-License-Identifier: Apache-2.0 */
/* ends.h - the parts that run once: before the steps, and after them. */
#ifndef FP3_ENDS_H
#define FP3_ENDS_H

#include "search.h"

/* Each function fills its lines in made, and raises made->registers. FP3_E_LIMIT: too few
 * registers. step, best: the scheduled step part. The first part executes its operations ahead for
 * the first step. */
fp3_status fp3_ends_first(const fp3_block *step, const fp3_choice *best, fp3_schedule *made,
                          fp3_error *error);
fp3_status fp3_ends_last(const fp3_step_code *code, const fp3_config *config, fp3_schedule *made,
                         fp3_error *error);

#endif
