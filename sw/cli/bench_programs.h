/* SPDX-License-Identifier: Apache-2.0 */
/* bench_programs.h - fp3 bench without MODEL: programs on the hardware, the ship unless another is
 * named. */
#ifndef FP3_CLI_BENCH_PROGRAMS_H
#define FP3_CLI_BENCH_PROGRAMS_H

#include <fp3/status.h>
#include <stdint.h>

#define FP3_BENCH_SHIPS "programs/ship*.s"
#define FP3_BENCH_SHIP_PARAMS "programs/ship.cfg"

typedef struct {
    const char *config;     /* NULL: all */
    const char *program;    /* NULL: the ships */
    const char *params;     /* NULL: the ship's, or those of the model */
    const char *json;       /* or NULL */
    uint64_t steps;         /* after the first, of one object; many share them */
    uint64_t scene_objects; /* 0: no scenes */
    int is_model;
} fp3_bench_programs;

/* Prints the tables, and then writes the file. FP3_E_MISMATCH, FP3_E_FAILED: bits differ; objects
 * failed, or there is no truth; all figures are printed. *report: errors of a source's text; the
 * caller frees it. */
fp3_status fp3_bench_programs_run(const fp3_bench_programs *what, char **report, fp3_error *error);

#endif
