/* SPDX-License-Identifier: Apache-2.0 */
/* options.h - how much is measured. */
#ifndef FP3_MEASURE_OPTIONS_H
#define FP3_MEASURE_OPTIONS_H

#include "points.h"

/* The right-hand side as C, compiled. */
typedef int fp3_measure_slopes_fn(double t, const double *y, double *slopes, void *params);

/* ---- what solves: each adds its points ---- */

typedef struct fp3_measure_options fp3_measure_options;
typedef fp3_status fp3_measure_solver_fn(fp3_measure_points *points,
                                         const fp3_measure_problem *problem,
                                         const fp3_measure_options *options,
                                         fp3_measure_slopes_fn *slopes, fp3_error *error);

struct fp3_measure_options {
    unsigned variants, repeats;
    double patience;    /* of fp3_measure_points */
    const char *engine; /* of fp3: "fast" or "isa" */
    const char *config; /* of engine and hardware, and nothing is measured beside; NULL: those that
                           were placed, and peers */
    const char *const *integrators; /* ended by NULL; NULL: all that are built in */
    double most_work; /* instructions of the longest run that finds an error, times its objects */
    int has_times;    /* of engine; else errors and cycles alone */
    uint64_t objects; /* of a timed run */
    uint64_t object_steps; /* at most so many in a timed run: then of fewer objects */
    unsigned most_rungs;   /* of fp3_measure_steps */
    unsigned fewest_digits, most_digits, digits_apart; /* tolerances 10^-fewest ... 10^-most */
    int has_threads;                                   /* also with a thread for each processor */
    int is_flipped; /* turns a bit of what the engine gives, to see that it is noticed */
    fp3_measure_solver_fn *more; /* beside GSL; or NULL */
    const char *more_name;       /* the engine of its points */
    void (*say)(void *user, const char *what);
    void *user;
};

#endif
