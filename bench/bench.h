/* bench.h - error against run time: one problem, many ways to solve it.
 *
 * A problem is a model from 0 to its span, for objects that differ a little (variants). A point is one
 * way to solve it: an integrator with a time step on an engine, or a solver with a tolerance. All points
 * of a problem are timed in turn, again and again, so that all see the same machine; the figure is the
 * median.
 */
#ifndef BENCH_H
#define BENCH_H

#include <fp3/compile.h>
#include <fp3/engine.h>
#include <fp3/model.h>
#include <jansson.h>
#include <stdint.h>

#define BENCH_REPEATS 9 /* at most */

typedef struct {
    const fp3_model *model;
    double end;        /* time, exact in FP32: where errors are taken */
    unsigned variants; /* objects that differ */
    double *params;    /* a row for each variant */
    double *initial;   /* likewise */
    double *truth;     /* likewise, states at the end */
    double *scale;     /* of each state: the largest magnitude along the truth */
} bench_problem;

/* The truth of every variant, by two methods. model stays the caller's. */
fp3_status bench_problem_open(const fp3_model *model, unsigned variants, bench_problem *problem,
                              fp3_error *error);
void bench_problem_close(bench_problem *problem);

/* Of ends, a row of states for each variant: relative to the scale, root of the mean square over the
 * states; its median and its largest over the variants. Infinite where a state is not finite. */
void bench_problem_errors(const bench_problem *problem, const double *ends, double *median,
                          double *worst);

typedef struct bench_point bench_point;
struct bench_point {
    /* What it is; NULL or 0: has none. The strings outlive the point. */
    const char *engine, *method, *integrator, *arithmetic, *config;
    double h, tolerance, cycles;
    unsigned threads;
    uint64_t objects, steps;
    /* Solves the problem once: *seconds for all objects, and ends. */
    fp3_status (*run)(bench_point *point, double *seconds, fp3_error *error);
    void (*close)(bench_point *point); /* frees self; or NULL */
    void *self;
    const bench_problem *problem;
    double *ends;
    /* What came of it. */
    double error_median, error_worst;
    double seconds[BENCH_REPEATS];
    unsigned repeats;
};

typedef struct {
    bench_point *point;
    size_t count, room;
    json_t *left_out; /* what could not be solved, and why */
    double patience;  /* seconds that all repeats of a point may take together */
    unsigned repeats;
} bench_points;

double bench_now(void); /* seconds */
double bench_spent(
    void); /* ... that this thread had a processor: limits do not depend on what else runs */

/* A copy, with room for its ends. NULL: no memory. */
bench_point *bench_points_add(bench_points *points, const bench_point *point);
void bench_points_leave_out(bench_points *points, const bench_point *point, const char *why);
/* Runs every point once for its error, leaves out those that have none, then all in turn. */
fp3_status bench_points_time(bench_points *points, fp3_error *error);
json_t *bench_points_json(const bench_points *points);
void bench_points_close(bench_points *points);
double bench_median(const double *values, unsigned count);

/* What solves: each adds its points. */
typedef struct {
    const char *engine;             /* of fp3: "fast" or "isa" */
    const char *const *integrators; /* ended by NULL; NULL: all that are built in */
    uint64_t objects;               /* of a timed run */
    uint64_t object_steps;          /* at most so many in a timed run: then of fewer objects */
    unsigned most_rungs;            /* time steps span/1, span/2, ... */
    unsigned fewest_digits, most_digits, digits_apart; /* tolerances 10^-fewest ... 10^-most */
    int has_threads;                                   /* also with a thread for each processor */
    int is_flipped; /* turns a bit of what the engine gives, to see that it is noticed */
} bench_options;

struct bench_machines;
fp3_status bench_add_engine(bench_points *points, const bench_problem *problem,
                            const bench_options *options, struct bench_machines *machines,
                            fp3_error *error);

/* The right-hand side as C, compiled. */
typedef int bench_slopes_fn(double t, const double *y, double *slopes, void *params);
fp3_status bench_add_gsl(bench_points *points, const bench_problem *problem,
                         const bench_options *options, bench_slopes_fn *slopes, fp3_error *error);
/* The plain C loop, scalar and as vectors. */
fp3_status bench_add_loop(bench_points *points, const bench_problem *problem,
                          const bench_options *options, fp3_error *error);
fp3_status bench_add_sundials(bench_points *points, const bench_problem *problem,
                              const bench_options *options, bench_slopes_fn *slopes,
                              fp3_error *error);

#endif
