/* SPDX-License-Identifier: Apache-2.0 */
/* measure.c - see measure.h: a model by everything that solves it. */
#include "measure.h"

#include "gsl.h"
#include "loop.h"
#include "programs.h"

#include "lab/bench/equations.h"
#include "lab/bench/native.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const flags[] = {"-O3", "-march=native", NULL};
static const char export[] =
    "int right_side(double t, const double *y, double *d, void *p) { slopes(t, y, p, d); return 0; "
    "}\n";

fp3_measure_options fp3_measure_default(const char *engine, int is_quick) {
    fp3_measure_options o = {.variants = 64,
                             .repeats = 3,
                             .patience = 0.15,
                             .engine = engine,
                             .most_work = 2e9,
                             .has_times = 1,
                             .objects = 16384,
                             .object_steps = 1 << 20,
                             .most_rungs = 19,
                             .fewest_digits = 2,
                             .most_digits = 10,
                             .digits_apart = 1,
                             .has_threads = 1};
    if (is_quick) {
        o.patience = 0.2;
        o.most_work = 1e8;
        o.objects = 1024;
        o.object_steps = 1 << 20;
        o.most_rungs = 10;
        o.digits_apart = 2;
    }
    if (!strcmp(engine, "isa")) {
        o.objects = o.variants;
        o.has_threads = 0;
    }
    return o;
}

static fp3_status compile_slopes(const fp3_model *model, fp3_bench_native **native,
                                 fp3_measure_slopes_fn **slopes, fp3_error *error) {
    char *equations = NULL, *text = NULL;
    fp3_status status = fp3_bench_equations(model, FP3_BENCH_DOUBLE, &equations, error);
    if (!status && asprintf(&text, "%s%s", equations, export) < 0) {
        text = NULL;
        status = fp3_no_memory(error);
    }
    if (!status)
        status = fp3_bench_native_open(text, flags, native, error);
    if (!status)
        status = fp3_bench_native_find(*native, "right_side", slopes, error);
    free(equations);
    free(text);
    return status;
}

static void leave_out(fp3_measure *m, const char *engine, const char *why) {
    fp3_measure_points_leave_out(
        &m->points, &(fp3_measure_point){.engine = engine, .problem = &m->problem}, why);
}

static int has_stop(const fp3_model *model) {
    int has = 0;
    for (uint32_t i = 0; i < model->event_count; i++)
        has |= model->events[i].stops;
    return has;
}

/* Which makes its steps to the end. */
static fp3_status add_loop(fp3_measure *m, const fp3_measure_options *o, fp3_error *error) {
    if (!has_stop(m->problem.model))
        return fp3_measure_add_loop(&m->points, &m->problem, o, error);
    leave_out(m, "plain_c", "the model has `stop`, and all its objects make the same steps");
    return FP3_OK;
}

/* Solvers in double. */
static fp3_status add_peers(fp3_measure *m, const fp3_measure_options *o, fp3_error *error) {
    fp3_measure_slopes_fn *slopes = NULL;
    if (m->problem.model->event_count) {
        static const char why[] = "the model has events, which it does not look for";
        leave_out(m, "gsl", why);
        if (o->more)
            leave_out(m, o->more_name, why);
        return FP3_OK;
    }
    fp3_measure_points_say(&m->points, "%s: solvers in double", m->problem.model->name);
    fp3_status status = compile_slopes(m->problem.model, &m->native, &slopes, error);
    if (!status)
        status = fp3_measure_add_gsl(&m->points, &m->problem, o, slopes, error);
    return status || !o->more ? status : o->more(&m->points, &m->problem, o, slopes, error);
}

/* Nothing can be measured on the configuration that was asked for: why the first was left out. */
static fp3_status fail_as_left_out(const fp3_measure *m, const fp3_measure_options *options,
                                   fp3_error *error) {
    const char *why =
        json_string_value(json_object_get(json_array_get(m->points.left_out, 0), "why"));
    return fp3_fail(error, FP3_E_PROGRAM, "nothing to measure on configuration '%s': %s",
                    options->config, why ? why : "no integrator applies");
}

fp3_status fp3_measure_model(const fp3_model *model, const fp3_measure_options *options,
                             fp3_measure *m, fp3_error *error) {
    *m = (fp3_measure){.points = {.left_out = json_array(),
                                  .patience = options->patience,
                                  .repeats = options->repeats,
                                  .say = options->say,
                                  .user = options->user}};
    fp3_measure_points_say(&m->points, "%s: the truth of %u objects", model->name,
                           options->variants);
    fp3_status status = fp3_measure_problem_open(model, options->variants, &m->problem, error);
    if (!status)
        status = fp3_measure_machines_open(!options->has_times, &m->machines, error);
    if (!status)
        status = fp3_measure_add_programs(&m->points, &m->problem, options, m->machines, error);
    if (!status && options->config && !m->points.count)
        status = fail_as_left_out(m, options, error);
    if (!status && !options->config)
        status = add_loop(m, options, error);
    if (!status && !options->config)
        status = add_peers(m, options, error);
    return status ? status : fp3_measure_points_time(&m->points, error);
}

void fp3_measure_close(fp3_measure *m) {
    fp3_measure_points_close(&m->points);
    fp3_bench_native_close(&m->native);
    fp3_measure_machines_close(&m->machines);
    fp3_measure_problem_close(&m->problem);
}

json_t *fp3_measure_json(const fp3_measure *m) {
    const fp3_measure_problem *p = &m->problem;
    return json_pack("{s:[{s:s, s:s, s:f, s:I, s:I, s:b}], s:o, s:O}", "problems", "model",
                     p->model->name, "doc", p->model->doc, "span", p->end, "states",
                     (json_int_t)p->model->state_count, "variants", (json_int_t)p->variants,
                     "has_events", p->model->event_count > 0, "points",
                     fp3_measure_points_json(&m->points), "left_out", m->points.left_out);
}
