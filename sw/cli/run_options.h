/* SPDX-License-Identifier: Apache-2.0 */
/* run_options.h - the command line of fp3 run. */
#ifndef FP3_CLI_RUN_OPTIONS_H
#define FP3_CLI_RUN_OPTIONS_H

#include "files.h"
#include "progress.h"
#include "run_engine.h"
#include "run_ranks.h"
#include "run_record.h"
#include "run_values.h"

#include <fp3/program.h>
#include <fp3/recording.h>

/* Of errors relative to the size of a state, where no other is given. */
#define FP3_RUN_BOUND 1e-3

/* Of --check and --strict. */
typedef struct {
    int is_asked, is_strict, has_bound;
    double bound;
} fp3_run_check_def;

typedef struct {
    const char *program, *scene, *group, *config, *integrator, *contacts;
    uint64_t steps, objects;
    fp3_run_engine on;
    int all, has_steps, is_model, allows_failures;
    fp3_run_values values;
    const char *links[FP3_RELATIONS_MAX]; /* relation=file */
    size_t link_count;
    fp3_run_record record;
    fp3_run_check_def check;
    fp3_recording *recording; /* while it runs; else NULL */
    fp3_files files;
    fp3_program_def how;
    fp3_progress *progress;
    const fp3_ranks *ranks; /* NULL: one process */
    int is_quiet;           /* prints nothing of the run, and judges nothing in it */
} fp3_run_options;

/* The `forms` of an option: it decides the bits of a run, or it says what is written, printed,
 * judged or measured, or how fast the run goes. */
enum { FP3_RUN_DECIDES = 1, FP3_RUN_BESIDE };
const fp3_option *fp3_run_options_table(void);
/* Whether the value of -o is a number: -o was --objects before it was --output. */
int fp3_run_options_is_number(const char *output);
/* Makes the defaults, and what the command line says of them. Ends the command where it is wrong.
 * FP3_E_SYSTEM: out of memory. The caller frees *options, after a failure too. */
fp3_status fp3_run_options_parse(int argc, char **argv, fp3_run_options *options, fp3_error *error);
void fp3_run_options_free(fp3_run_options *options);
/* The run itself; *report as of fp3_program_open. */
fp3_status fp3_run_make(fp3_run_options *options, char **report, fp3_error *error);

#endif
