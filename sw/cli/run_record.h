/* SPDX-License-Identifier: Apache-2.0 */
/* run_record.h - the options of fp3 run that say what is recorded of it. */
#ifndef FP3_RUN_RECORD_H
#define FP3_RUN_RECORD_H

#include "files.h"

#include <argp.h>
#include <fp3/recording.h>

typedef struct {
    fp3_recording_def def; /* path and plot NULL: nothing is recorded */
    char **names;          /* def.observed */
    double *times;
    char *command; /* def.command */
    char *before;  /* where checkpoints go that are replaced; NULL: there are none */
} fp3_run_record;

/* What the options say; they end with 2 and a message where it cannot be. */
void fp3_run_record_every(fp3_run_record *record, struct argp_state *state, const char *text);
void fp3_run_record_times(fp3_run_record *record, struct argp_state *state, const char *text);
void fp3_run_record_observe(fp3_run_record *record, struct argp_state *state, const char *text);
/* --checkpoint-every. */
void fp3_run_record_checkpoint_every(fp3_run_record *record, struct argp_state *state,
                                     const char *text);
/* Whether snapshots are recorded. */
int fp3_run_record_has_snapshots(const fp3_run_record *record);
/* Whether the run is one in parts: it has snapshots or checkpoints, or begins at one. */
int fp3_run_record_is_asked(const fp3_run_record *record);
/* Keeps the arguments for def, one a line. FP3_E_ARGUMENT: one has a line break, and checkpoints
 * are to keep it. */
fp3_status fp3_run_record_command(fp3_run_record *record, int argc, char **argv, fp3_error *error);
/* Those of checkpoints. A restart may be from the file that the run's checkpoints replace. */
void fp3_run_record_files(fp3_run_record *record, fp3_files *files);
/* After the last option. */
void fp3_run_record_check(const fp3_run_record *record, struct argp_state *state);
void fp3_run_record_free(fp3_run_record *record);

#endif
