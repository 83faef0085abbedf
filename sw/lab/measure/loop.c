/* SPDX-License-Identifier: Apache-2.0 */
/* loop.c - the plain C loop of lab/bench/loop.h of the library: one object after the other, and in
 * columns. */
#include "loop.h"

#include "lab/bench/loop.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const scalar_flags[] = {"-O2", "-march=native", NULL};
static const char *const vector_flags[] = {"-O3", "-march=native", "-fopenmp-simd", NULL};

/* Points share the loops. */
typedef struct {
    fp3_bench_loop loop;
    int users;
} shared;

typedef struct {
    shared *of;
    int is_vector;
    float *p, *y; /* rows of an object each; of vectors: columns */
} self;

static void fill(const fp3_measure_point *point) {
    const fp3_measure_problem *problem = point->problem;
    const self *s = point->self;
    const size_t params = problem->model->param_count, states = problem->model->state_count;
    const size_t objects = point->objects;
    for (size_t i = 0; i < objects; i++) {
        const size_t v = i % problem->variants;
        for (size_t k = 0; k < params; k++)
            s->p[s->is_vector ? k * objects + i : i * params + k] =
                (float)problem->params[v * params + k];
        for (size_t k = 0; k < states; k++)
            s->y[s->is_vector ? k * objects + i : i * states + k] =
                (float)problem->initial[v * states + k];
    }
}

static fp3_status run(fp3_measure_point *point, double *seconds, fp3_error *error) {
    (void)error;
    const fp3_measure_problem *problem = point->problem;
    const self *s = point->self;
    const size_t params = problem->model->param_count, states = problem->model->state_count;
    const size_t objects = point->objects;
    fill(point);
    const double begin = fp3_measure_now();
    if (s->is_vector)
        s->of->loop.many(s->p, s->y, objects, point->steps, (float)point->h);
    for (size_t i = 0; !s->is_vector && i < objects; i++)
        s->of->loop.one(s->p + i * params, s->y + i * states, 0, point->steps, (float)point->h);
    *seconds = fp3_measure_now() - begin;
    for (size_t v = 0; v < problem->variants; v++)
        for (size_t k = 0; k < states; k++)
            point->ends[v * states + k] =
                (double)s->y[s->is_vector ? k * objects + v : v * states + k];
    return FP3_OK;
}

static void leave(shared *of) {
    if (--of->users == 0) {
        fp3_bench_loop_close(&of->loop);
        free(of);
    }
}

static void close_self(fp3_measure_point *point) {
    self *s = point->self;
    leave(s->of);
    free(s->p);
    free(s->y);
    free(s);
}

static fp3_status add(fp3_measure_points *points, fp3_measure_point point, shared *of,
                      int is_vector, fp3_error *error) {
    const fp3_model *model = point.problem->model;
    self *s = point.self = calloc(1, sizeof *s);
    if (!s)
        return fp3_no_memory(error);
    of->users++;
    *s = (self){.of = of,
                .is_vector = is_vector,
                .p = calloc(point.objects * model->param_count + 1, sizeof(float)),
                .y = calloc(point.objects * model->state_count + 1, sizeof(float))};
    if (!s->p || !s->y || !fp3_measure_points_add(points, &point)) {
        close_self(&point);
        return fp3_no_memory(error);
    }
    return FP3_OK;
}

static fp3_status add_form(fp3_measure_points *points, const fp3_measure_problem *problem,
                           const fp3_measure_options *options, int is_vector, fp3_error *error) {
    shared *of = calloc(1, sizeof *of);
    if (!of)
        return fp3_no_memory(error);
    of->users = 1;
    fp3_status status = fp3_bench_loop_open(problem->model, is_vector ? vector_flags : scalar_flags,
                                            &of->loop, error);
    for (unsigned k = 0; !status && k < options->most_rungs; k++) {
        fp3_measure_point point = {.engine = "plain_c",
                                   .method = is_vector ? "vectors" : "scalar",
                                   .integrator = "rk4",
                                   .arithmetic = "plain",
                                   .threads = 1,
                                   .objects = is_vector ? 16 * (uint64_t)problem->variants
                                                        : problem->variants,
                                   .steps = fp3_measure_steps(k),
                                   .h = problem->end / (double)fp3_measure_steps(k),
                                   .run = run,
                                   .close = close_self,
                                   .problem = problem};
        status = add(points, point, of, is_vector, error);
    }
    leave(of);
    return status;
}

fp3_status fp3_measure_add_loop(fp3_measure_points *points, const fp3_measure_problem *problem,
                                const fp3_measure_options *options, fp3_error *error) {
    const fp3_status status = add_form(points, problem, options, 0, error);
    return status ? status : add_form(points, problem, options, 1, error);
}
