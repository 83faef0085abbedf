/* SPDX-License-Identifier: Apache-2.0 */
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
    fp3_model
        *adapted; /* where objects have times of their own: a run gives it its params; else NULL */
    int is_flipped; /* a bit of what the first object ends with */
} fp3_measure_run;

/* How objects come from the start to the end. */
typedef struct {
    double h;         /* of a step; of adaptive ones where they begin */
    double tolerance; /* of an adaptive step; its `absolute` is that times the smallest scale of a
                         state. 0: not adaptive */
    uint64_t steps;   /* ... then so many of them fill the span */
    uint64_t count;   /* of steps; the most attempts of those that are adaptive or cut at events */
    double made;      /* by one object, steps or attempts, on average: for who asks, not read */
} fp3_measure_pace;

/* Fills the states of the variants, row by row. FP3_E_MISMATCH: objects that are the same variant
 * end with different bits. FP3_E_LIMIT: an object does not end with so many attempts. *seconds and
 * *stats are of the run alone. */
fp3_status fp3_measure_run_solve(const fp3_measure_run *run, const fp3_measure_problem *problem,
                                 const fp3_measure_pace *pace, double *ends, double *seconds,
                                 fp3_stats *stats, fp3_error *error);

/* How many objects a timed run has in which each makes so many steps and takes `each` seconds with
 * one thread: always whole rounds of the variants. */
uint64_t fp3_measure_run_objects(const fp3_measure_options *options, double steps, double each,
                                 unsigned threads);

/* FP3_E_MISMATCH: the first `variants` rows differ; the names are for the message. */
fp3_status fp3_measure_run_compare(const fp3_measure_problem *problem, size_t variants,
                                   const double *ends, const char *who, const double *others,
                                   const char *whom, fp3_error *error);

#endif
