/* SPDX-License-Identifier: Apache-2.0 */
/* run_check.h - fp3 run --check: runs the objects again with half the time step, or a tenth of the tolerance, and
 * estimates the error of each final state from the difference.
 */
#ifndef FP3_CLI_RUN_CHECK_H
#define FP3_CLI_RUN_CHECK_H

#include <argp.h>
#include <fp3/program.h>

#define FP3_RUN_BOUND 1e-3 /* of errors relative to the size of a state, where no other is given */

/* What the options say. */
typedef struct {
    int is_asked, is_strict, has_bound;
    double bound;
} fp3_run_check_def;

/* Of --strict: text is NULL if it has no value. */
void fp3_run_check_strict(fp3_run_check_def *def, struct argp_state *state, const char *text);
/* After the last option; ends with 2 and a message where a check has no meaning. */
void fp3_run_check_check(const fp3_run_check_def *def, int is_model, const fp3_params *params,
                         struct argp_state *state);

/* The run that has ended. */
typedef struct {
    const fp3_program *program; /* a model */
    const fp3_params *params;
    fp3_engine *engine;
    const fp3_engine_def *def;
    uint64_t steps;
} fp3_run_checked;

typedef struct fp3_run_check fp3_run_check;

/* Makes the second run. The caller frees *check, which is NULL on failure. */
fp3_status fp3_run_check_make(const fp3_run_checked *run, fp3_run_check **check, fp3_error *error);
/* Sets *check to NULL, which it may be already. */
void fp3_run_check_free(fp3_run_check **check);

/* The end of a printed state's line; nothing if there is no estimate. check may be NULL. */
void fp3_run_check_print_state(const fp3_run_check *check, const char *name, size_t object);
/* How the check was made, and the worst state. */
void fp3_run_check_print(const fp3_run_check *check);
/* FP3_E_FAILED: the worst estimate is not finite, or above the bound. */
fp3_status fp3_run_check_judge(const fp3_run_check *check, double bound, fp3_error *error);

#endif
