/* run.h - the variants of a problem through a program on an engine, once. */
#ifndef FP3_MEASURE_RUN_H
#define FP3_MEASURE_RUN_H

#include "machines.h"
#include "options.h"
#include "points.h"

typedef struct {
    fp3_engine *engine;
    const fp3_compiled *compiled;
    const fp3_measure_machines *machines;
    const fp3_model *adapted; /* of adaptive steps: its params are those of the run; else NULL */
    int is_flipped;           /* a bit of what the first object ends with */
} fp3_measure_run;

/* `steps` steps of h. Fills the states of the variants, row by row. FP3_E_MISMATCH: objects that are
 * the same variant end with different bits. *seconds and *cycles are of the run alone. */
fp3_status fp3_measure_run_solve(const fp3_measure_run *run, const fp3_measure_problem *problem,
                                 double h, uint64_t steps, double *ends, double *seconds,
                                 uint64_t *cycles, fp3_error *error);

/* The same of run->adapted, with its values, until all objects have ended. FP3_E_LIMIT: an object did not. */
fp3_status fp3_measure_run_adaptive(const fp3_measure_run *run, const fp3_measure_problem *problem,
                                    uint64_t attempts, double *ends, double *seconds,
                                    fp3_stats *stats, fp3_error *error);

/* How many objects a timed run has in which each makes so many steps and takes `each` seconds with one
 * thread: always whole rounds of the variants. */
uint64_t fp3_measure_run_objects(const fp3_measure_options *options, double steps, double each,
                                 unsigned threads);

/* FP3_E_MISMATCH: the first `variants` rows differ; the names are for the message. */
fp3_status fp3_measure_run_compare(const fp3_measure_problem *problem, size_t variants,
                                   const double *ends, const char *who, const double *others,
                                   const char *whom, fp3_error *error);

#endif
