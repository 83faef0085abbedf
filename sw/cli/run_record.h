/* run_record.h - the options of fp3 run that say what is recorded of it. */
#ifndef FP3_RUN_RECORD_H
#define FP3_RUN_RECORD_H

#include <argp.h>
#include <fp3/program.h>

typedef struct {
    fp3_recording_def def; /* path and plot NULL: nothing is recorded */
    const char **names;
    double *times;
} fp3_run_record;

/* What the options say; they end with 2 and a message where it cannot be. */
void fp3_run_record_every(fp3_run_record *record, struct argp_state *state, const char *text);
void fp3_run_record_times(fp3_run_record *record, struct argp_state *state, const char *text);
/* Takes text apart, which must outlive the record. */
void fp3_run_record_observe(fp3_run_record *record, struct argp_state *state, char *text);
/* Whether anything is recorded. */
int fp3_run_record_is_asked(const fp3_run_record *record);
/* After the last option. */
void fp3_run_record_check(const fp3_run_record *record, struct argp_state *state);
void fp3_run_record_free(fp3_run_record *record);

#endif
