/* SPDX-License-Identifier: Apache-2.0 */
/* gsl.c - the solvers of GSL, each with a sweep of tolerances; its rk4 with fixed steps.
 *
 * A driver is made once and reset for each object. GSL's rk4 makes two steps of h/2 for each step
 * of h, to estimate the error.
 */
#include "gsl.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STEPS_MOST 1000000 /* of one object */
#define SECONDS_MOST 1.0   /* of all objects, per run */
#define FIRST_STEP 1e-3    /* of the span */

static const struct {
    const char *name;
    const gsl_odeiv2_step_type *const *type;
    int is_fixed;
} methods[] = {
    {"rkf45", &gsl_odeiv2_step_rkf45, 0},     {"rk8pd", &gsl_odeiv2_step_rk8pd, 0},
    {"msadams", &gsl_odeiv2_step_msadams, 0}, {"msbdf", &gsl_odeiv2_step_msbdf, 0},
    {"rk4", &gsl_odeiv2_step_rk4, 1},
};
enum { METHODS = sizeof methods / sizeof *methods };

typedef struct {
    gsl_odeiv2_system system;
    gsl_odeiv2_driver *driver; /* of adaptive steps */
    gsl_odeiv2_step *step;     /* of fixed ones */
    fp3_measure_slopes_fn *slopes;
    double *params;        /* of the present object; not owned */
    double *y, *error, *f; /* states each */
} solver;

static int slopes(double t, const double y[], double f[], void *self) {
    const solver *s = self;
    return s->slopes(t, y, f, s->params);
}

/* By differences, as CVODE does it: the solvers only need it to converge. */
static int jacobian(double t, const double y[], double *dfdy, double dfdt[], void *self) {
    solver *s = self;
    const size_t n = s->system.dimension;
    memcpy(s->y, y, n * sizeof *y);
    s->slopes(t, y, s->error, s->params);
    for (size_t j = 0; j < n; j++) {
        const double apart = 1.5e-8 * fmax(fabs(y[j]), 1e-5);
        s->y[j] = y[j] + apart;
        s->slopes(t, s->y, s->f, s->params);
        for (size_t i = 0; i < n; i++)
            dfdy[i * n + j] = (s->f[i] - s->error[i]) / (s->y[j] - y[j]);
        s->y[j] = y[j];
    }
    memset(dfdt, 0, n * sizeof *dfdt);
    return GSL_SUCCESS;
}

static int one(solver *s, const fp3_measure_point *point, double *y) {
    double t = 0;
    if (s->driver) {
        int result = gsl_odeiv2_driver_reset_hstart(s->driver, point->problem->end * FIRST_STEP);
        return result ? result : gsl_odeiv2_driver_apply(s->driver, &t, point->problem->end, y);
    }
    gsl_odeiv2_step_reset(s->step);
    for (uint64_t n = 0; n < point->steps; n++) {
        const int result = gsl_odeiv2_step_apply(s->step, (double)n * point->h, point->h, y,
                                                 s->error, NULL, NULL, &s->system);
        if (result)
            return result;
    }
    return GSL_SUCCESS;
}

static fp3_status run(fp3_measure_point *point, double *seconds, fp3_error *error) {
    const fp3_measure_problem *p = point->problem;
    solver *s = point->self;
    const size_t states = p->model->state_count;
    const double begin = fp3_measure_now(), spent = fp3_measure_spent();
    memcpy(point->ends, p->initial, p->variants * states * sizeof *point->ends);
    for (unsigned v = 0; v < p->variants; v++) {
        s->params = p->params + v * p->model->param_count;
        const int result = one(s, point, point->ends + v * states);
        if (result)
            return fp3_fail(error, FP3_E_LIMIT, "%s", gsl_strerror(result));
        if (fp3_measure_spent() - spent > SECONDS_MOST)
            return fp3_fail(error, FP3_E_LIMIT, "%u of %u objects took more than %g s", v + 1,
                            p->variants, SECONDS_MOST);
    }
    *seconds = fp3_measure_now() - begin;
    return FP3_OK;
}

static void close_solver(fp3_measure_point *point) {
    solver *s = point->self;
    if (s->driver)
        gsl_odeiv2_driver_free(s->driver);
    if (s->step)
        gsl_odeiv2_step_free(s->step);
    free(s->y);
    free(s);
}

/* errors are relative to the scale of a state, as they are told. */
static fp3_status add(fp3_measure_points *points, fp3_measure_point point, int method,
                      fp3_measure_slopes_fn *fn, fp3_error *error) {
    const fp3_measure_problem *p = point.problem;
    const size_t n = p->model->state_count;
    solver *s = calloc(1, sizeof *s);
    if (!s || !(s->y = calloc(3 * n, sizeof *s->y))) {
        free(s);
        return fp3_no_memory(error);
    }
    s->error = s->y + n;
    s->f = s->y + 2 * n;
    s->slopes = fn;
    s->system = (gsl_odeiv2_system){slopes, jacobian, n, s};
    point.self = s;
    if (methods[method].is_fixed)
        s->step = gsl_odeiv2_step_alloc(*methods[method].type, n);
    else
        s->driver = gsl_odeiv2_driver_alloc_scaled_new(&s->system, *methods[method].type,
                                                       p->end * FIRST_STEP, point.tolerance, 0, 1,
                                                       0, p->scale);
    if (s->driver)
        gsl_odeiv2_driver_set_nmax(s->driver, STEPS_MOST);
    if ((!s->driver && !s->step) || !fp3_measure_points_add(points, &point)) {
        close_solver(&point);
        return fp3_no_memory(error);
    }
    return FP3_OK;
}

fp3_status fp3_measure_add_gsl(fp3_measure_points *points, const fp3_measure_problem *problem,
                               const fp3_measure_options *options, fp3_measure_slopes_fn *slopes_of,
                               fp3_error *error) {
    fp3_status status = FP3_OK;
    gsl_set_error_handler_off(); /* GSL's own ends the program */
    for (int m = 0; !status && m < METHODS; m++) {
        fp3_measure_point point = {.engine = "gsl",
                                   .method = methods[m].name,
                                   .threads = 1,
                                   .objects = problem->variants,
                                   .run = run,
                                   .close = close_solver,
                                   .problem = problem};
        for (unsigned d = options->fewest_digits;
             !status && !methods[m].is_fixed && d <= options->most_digits;
             d += options->digits_apart) {
            point.tolerance = pow(10, -(double)d);
            status = add(points, point, m, slopes_of, error);
        }
        for (unsigned k = 0; !status && methods[m].is_fixed && k < options->most_rungs; k++) {
            point.steps = fp3_measure_steps(k);
            point.h = problem->end / (double)point.steps;
            status = add(points, point, m, slopes_of, error);
        }
    }
    return status;
}
