/* SPDX-License-Identifier: Apache-2.0 */
/* run_reach.h - whether objects are faster than near objects can be seen: one that moves farther in
 * a step than a relation reaches may pass others without any of them noticing.
 */
#ifndef FP3_CHECK_RUN_REACH_H
#define FP3_CHECK_RUN_REACH_H

#include "run_loss.h"

/* Says a warning of the fastest object of a part at the end of its run, and adds it to *warnings.
 * It looks at relations whose position has a velocity among the states (x' = v), and at fixed
 * steps. */
fp3_status fp3_run_reach_warn(const fp3_run_part *part, fp3_run_say_fn *say, const char *path,
                              size_t *warnings, fp3_error *error);

#endif
