/* SPDX-License-Identifier: Apache-2.0 */
/* bench_table.h - what fp3 bench tells of a run: a row of the table, and the same as JSON. */
#ifndef FP3_CLI_BENCH_TABLE_H
#define FP3_CLI_BENCH_TABLE_H

#include "lab/golden/bench.h"
#include "machine/config.h"

#include <jansson.h>

/* What was run, and what came of it. */
typedef struct {
    const char *program; /* its name */
    fp3_bench_case what;
    fp3_bench_result got;
    const fp3_config *config;
} fp3_bench_outcome;

/* The columns, for runs of a program like this one and so many steps after the first. */
void fp3_bench_head(uint64_t steps, const fp3_program *program, const char *name);
void fp3_bench_row(const fp3_bench_outcome *o);

/* The caller owns what is returned; a figure that is no number is null. */
json_t *fp3_bench_json(const fp3_bench_outcome *o);
/* Only what runs and scenes both tell: names, sizes, what was compared. */
json_t *fp3_bench_common_json(const fp3_bench_outcome *o);

#endif
