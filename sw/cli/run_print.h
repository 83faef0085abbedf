/* SPDX-License-Identifier: Apache-2.0 */
/* run_print.h - what fp3 run prints: final states, who sleeps, who failed, what the run cost. */
#ifndef FP3_RUN_PRINT_H
#define FP3_RUN_PRINT_H

#include "lab/check/run_check.h"

#include <fp3/recording.h>

/* What is run: a program, or a scene; the other is NULL. */
typedef struct {
    const fp3_program *program;
    const fp3_scene *scene;
} fp3_run_task;

/* cost: of a recording all; of a plain run stats alone, and the engine knows the rest.
 * A run that ended before its time has a state, too. clock: in Hz, to print how long its cycles
 * take; 0: not asked for. checks: estimates of the errors of the states, one for the program or for
 * each group of the scene; or NULL. */
void fp3_run_print(fp3_engine *engine, const fp3_run_task *of, const fp3_engine_def *def,
                   const fp3_cost *cost, const fp3_run_check *const *checks, int all, double clock);

/* Whether a group, or the program, has adaptive steps. */
int fp3_run_is_adaptive(const fp3_run_task *of);

/* FP3_E_FAILED: objects failed in the run; error names the first. */
fp3_status fp3_run_failed(fp3_engine *engine, const fp3_run_task *of, const fp3_cost *cost,
                          fp3_error *error);

#endif
