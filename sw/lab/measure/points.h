/* SPDX-License-Identifier: Apache-2.0 */
/* points.h - ways to solve a problem: an integrator with a time step on an engine, or a solver with
 * a tolerance.
 *
 * All points of a problem are timed in turn, again and again, so that all see the same machine; the
 * figure is the median.
 */
#ifndef FP3_MEASURE_POINTS_H
#define FP3_MEASURE_POINTS_H

#include "problem.h"

#include <jansson.h>
#include <stdint.h>

#define FP3_MEASURE_REPEATS 9  /* at most */
#define FP3_MEASURE_HOPELESS 8 /* times the work of another that is as accurate */

typedef struct fp3_measure_point fp3_measure_point;
struct fp3_measure_point {
    /* What it is; NULL or 0: has none. The strings outlive the point. */
    const char *engine, *method, *integrator, *arithmetic, *config;
    double h, tolerance, cycles;
    unsigned threads;
    uint64_t objects, steps;
    double work; /* instructions for an object, where the error is known: what is hopeless is not
                    run; 0: unknown */
    /* Solves the problem once: *seconds for all objects, and ends. */
    fp3_status (*run)(fp3_measure_point *point, double *seconds, fp3_error *error);
    void (*close)(fp3_measure_point *point); /* frees self; or NULL */
    void *self;
    const fp3_measure_problem *problem;
    double *ends;
    /* What came of it. */
    double error_median, error_worst;
    double seconds[FP3_MEASURE_REPEATS];
    unsigned repeats;
};

typedef struct {
    fp3_measure_point *point;
    size_t count, room;
    json_t *left_out; /* what could not be solved, and why */
    double patience;  /* seconds that all repeats of a point may take together */
    unsigned repeats;
    void (*say)(void *user, const char *what); /* what is done now; or NULL */
    void *user;
} fp3_measure_points;

double fp3_measure_now(void); /* seconds */
double fp3_measure_spent(
    void); /* ... that this thread had a processor: limits do not depend on what else runs */

/* A copy, with room for its ends. NULL: no memory. */
fp3_measure_point *fp3_measure_points_add(fp3_measure_points *points,
                                          const fp3_measure_point *point);
void fp3_measure_points_leave_out(fp3_measure_points *points, const fp3_measure_point *point,
                                  const char *why);
/* So many times the work of the best on its engine, or in its arithmetic there, that is as
 * accurate; 0: none is. */
double fp3_measure_points_behind(const fp3_measure_points *points, const fp3_measure_point *point,
                                 int is_same_arithmetic);
/* Runs every point once for its error, leaves out those that have none, then all in turn. */
fp3_status fp3_measure_points_time(fp3_measure_points *points, fp3_error *error);
json_t *fp3_measure_points_json(const fp3_measure_points *points);
void fp3_measure_points_close(fp3_measure_points *points);

__attribute__((format(printf, 2, 3))) void fp3_measure_points_say(const fp3_measure_points *points,
                                                                  const char *format, ...);

#endif
