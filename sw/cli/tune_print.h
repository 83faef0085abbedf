/* SPDX-License-Identifier: Apache-2.0 */
/* tune_print.h - what fp3 tune says, and the files that it writes. */
#ifndef FP3_CLI_TUNE_PRINT_H
#define FP3_CLI_TUNE_PRINT_H

#include "tune_machines.h"

#include <fp3/tune.h>

typedef struct {
    const char *program;      /* the model's file */
    const char *scene, *json; /* NULL: not asked for */
    const fp3_tune_machines *machines;
} fp3_tune_print;

int fp3_tune_print_has_ranges(const fp3_params *params);

void fp3_tune_print_all(const fp3_tune_print *out, const fp3_tune_def *def,
                        const fp3_tuning *tuning);
/* There is no scene if nothing meets the tolerance: then the one that was there stays. */
fp3_status fp3_tune_print_files(const fp3_tune_print *out, const fp3_tune_def *def,
                                const fp3_tuning *tuning, uint32_t objects, fp3_error *error);
/* FP3_E_FAILED: nothing meets the tolerance. */
fp3_status fp3_tune_print_judge(const fp3_tune_def *def, const fp3_tuning *tuning,
                                fp3_error *error);

#endif
