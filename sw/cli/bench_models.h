/* SPDX-License-Identifier: Apache-2.0 */
/* bench_models.h - fp3 bench MODEL...: error against run time of models. */
#ifndef FP3_CLI_BENCH_MODELS_H
#define FP3_CLI_BENCH_MODELS_H

#include <fp3/status.h>

#define FP3_BENCH_NAMES_MOST 60

typedef struct {
    const char *models[FP3_BENCH_NAMES_MOST]; /* paths, or names in programs/ */
    unsigned model_count;
    const char *integrators[FP3_BENCH_NAMES_MOST + 1]; /* none: all that are built in */
    unsigned integrator_count;
    const char *json, *csv; /* or NULL */
    const char *config; /* of engine and hardware, alone; NULL: those that were placed, and peers */
    int is_quick, has_no_times;
} fp3_bench_models;

/* Prints a table for each model, and then writes the files. *report: errors of a model's text; the
 * caller frees it. */
fp3_status fp3_bench_models_run(const fp3_bench_models *what, char **report, fp3_error *error);

#endif
