/* SPDX-License-Identifier: Apache-2.0 */
/* run_values.h - the options of fp3 run and fp3 tune that give values. */
#ifndef FP3_RUN_VALUES_H
#define FP3_RUN_VALUES_H

#include <argp.h>
#include <fp3/program.h>

typedef struct {
    fp3_params *params;
    char *sets, *spreads; /* names, each between commas: of --set, of --spread */
} fp3_run_values;

/* What the options say; they end with 2 and a message where it cannot be. */
void fp3_run_values_load(fp3_run_values *values, struct argp_state *state, const char *path);
void fp3_run_values_set(fp3_run_values *values, struct argp_state *state, const char *text);
void fp3_run_values_spread(fp3_run_values *values, struct argp_state *state, const char *text);
void fp3_run_values_free(fp3_run_values *values);

#endif
