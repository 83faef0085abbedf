/* SPDX-License-Identifier: Apache-2.0 */
/* run_check.h - fp3 run --check: runs the objects again with half the time step, or a tenth of the
 * tolerance, and estimates the error of each final state from the difference. Groups of a scene do
 * not see each other, so each has a check of its own.
 */
#ifndef FP3_CHECK_RUN_CHECK_H
#define FP3_CHECK_RUN_CHECK_H

#include "run_loss.h"

#include <fp3/scene.h>

typedef struct fp3_run_check fp3_run_check;

/* Makes the second run of a part that has ended. group: that of a scene, or NULL. def: of the
 * part's engine. All must outlive the check. The caller frees *check, which is NULL on failure.
 * FP3_E_ARGUMENT: the part is no model, or a value of it does not allow another step. */
fp3_status fp3_run_check_make(const fp3_run_part *part, const fp3_scene_group *group,
                              const fp3_engine_def *def, fp3_run_check **check, fp3_error *error);
/* Sets *check to NULL, which it may be already. */
void fp3_run_check_free(fp3_run_check **check);

/* The end of a printed state's line; nothing if there is no estimate. check may be NULL. object: of
 * the engine. */
void fp3_run_check_print_state(const fp3_run_check *check, const char *name, size_t object);
/* How the check was made, the worst state, and what became of the model's invariants. check may be
 * NULL. */
void fp3_run_check_print(const fp3_run_check *check);
/* FP3_E_FAILED: the worst estimate is not finite, or above the bound. check may be NULL. */
fp3_status fp3_run_check_judge(const fp3_run_check *check, double bound, fp3_error *error);

#endif
