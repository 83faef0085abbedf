/* SPDX-License-Identifier: Apache-2.0 */
/* run_check.h - fp3 run --check: runs groups that see each other again with half the time step, or
 * a tenth of the tolerance, and estimates the error of each final state from the difference.
 */
#ifndef FP3_CHECK_RUN_CHECK_H
#define FP3_CHECK_RUN_CHECK_H

#include "run_set.h"

typedef struct fp3_run_check fp3_run_check;

/* Makes the second run of a set that has ended. def: of the engine that ran it. Both must outlive
 * the check. The caller frees *check, which is NULL on failure. FP3_E_ARGUMENT: a part is no model,
 * or a value of it does not allow another step. */
fp3_status fp3_run_check_make(const fp3_run_set *set, const fp3_engine_def *def,
                              fp3_run_check **check, fp3_error *error);
/* Sets *check to NULL, which it may be already. */
void fp3_run_check_free(fp3_run_check **check);

/* The end of a printed state's line; nothing if there is no estimate. check may be NULL. object: of
 * the engine. */
void fp3_run_check_print_state(const fp3_run_check *check, const char *name, size_t object);
/* Of the part whose first object this is: how the check was made, the states of all objects and the
 * worst of them, and what became of the model's invariants. check may be NULL. */
void fp3_run_check_print(const fp3_run_check *check, size_t first);
/* FP3_E_FAILED: the worst estimate or the change of an invariant, relative to its size, is not
 * finite, or above the bound. check may be NULL. */
fp3_status fp3_run_check_judge(const fp3_run_check *check, double bound, fp3_error *error);

#endif
