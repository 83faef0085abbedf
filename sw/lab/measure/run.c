/* SPDX-License-Identifier: Apache-2.0 */
/* run.c - see run.h. */
#include "run.h"

#include "lab/bench/variants.h"

#include <fp3/engine.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LOCATE_PART 16384 /* of the step: 14 attempts more for an event */
#define OBJECTS_LEAST 512 /* of a timed run with many steps: one block for each thread */

static fp3_status said(const fp3_measure_run *e, fp3_status status, fp3_error *error) {
    return fp3_fail(error, status, "%s", fp3_measure_machines_error(e->machines)->text);
}

/* Twice: what a program needs once is not timed. */
static fp3_status prepare(const fp3_measure_run *e, const fp3_measure_problem *p, double h,
                          fp3_error *error) {
    fp3_status status = FP3_OK;
    for (int i = 0; !status && i < 2; i++) {
        error->text[0] = 0;
        status = fp3_bench_start(e->engine, e->compiled, e->adapted ? e->adapted : p->model, h,
                                 p->variants, error);
        if (!status && fp3_image_slept(e->compiled->image) >= 0)
            status = fp3_engine_wake(e->engine, 0, fp3_engine_objects(e->engine));
        if (!status && i == 0)
            status = fp3_engine_run(e->engine, 1, NULL);
    }
    return status && !error->text[0] ? said(e, status, error) : status;
}

/* The second words of a state in double-single. */
static fp3_status add_low_words(const fp3_measure_run *e, size_t state, float *column,
                                size_t states, size_t variants, double *ends, fp3_error *error) {
    const int low = fp3_compiled_low(e->compiled, (uint32_t)state);
    if (low < 0)
        return FP3_OK;
    const fp3_status status = fp3_engine_read(e->engine, 0, variants, (uint32_t)low, column);
    for (size_t i = 0; !status && i < variants; i++)
        ends[i * states + state] += (double)column[i];
    return status ? said(e, status, error) : FP3_OK;
}

/* The states of the variants, row by row; objects that are the same variant must have the same
 * bits. */
static fp3_status read_ends(const fp3_measure_run *e, const fp3_measure_problem *p, double *ends,
                            fp3_error *error) {
    const size_t states = p->model->state_count, objects = fp3_engine_objects(e->engine);
    float *column = calloc(objects, sizeof *column);
    fp3_status status = column ? FP3_OK : fp3_no_memory(error);
    for (size_t s = 0; !status && s < states; s++) {
        const char *name = p->model->states[s].name;
        const fp3_symbol *symbol =
            fp3_image_find(e->compiled->image, name, FP3_CLASS(FP3_SYMBOL_STATE));
        status = fp3_engine_read(e->engine, 0, objects, symbol->index, column);
        if (status)
            said(e, status, error);
        if (e->is_flipped) {
            uint32_t bits;
            memcpy(&bits, &column[0], sizeof bits);
            bits ^= 1;
            memcpy(&column[0], &bits, sizeof bits);
        }
        for (size_t i = 0; !status && i < objects; i++)
            if (i < p->variants)
                ends[i * states + s] = (double)column[i];
            else if (memcmp(&column[i], &column[i % p->variants], sizeof *column) != 0)
                status = fp3_fail(
                    error, FP3_E_MISMATCH,
                    "%s of object %zu is %.9g, of object %zu, which is the same, %.9g", name, i,
                    (double)column[i], i % p->variants, (double)column[i % p->variants]);
        if (!status)
            status = add_low_words(e, s, column, states,
                                   objects < p->variants ? objects : p->variants, ends, error);
    }
    free(column);
    return status;
}

/* NaNs have one form. */
static int is_same(double a, double b) { return memcmp(&a, &b, sizeof a) == 0; }

fp3_status fp3_measure_run_compare(const fp3_measure_problem *p, size_t variants,
                                   const double *ends, const char *who, const double *others,
                                   const char *whom, fp3_error *error) {
    const size_t states = p->model->state_count;
    for (size_t i = 0; i < variants * states; i++)
        if (!is_same(ends[i], others[i]))
            return fp3_fail(error, FP3_E_MISMATCH, "%s of variant %zu: %s has %.9g, %s %.9g",
                            p->model->states[i % states].name, i / states, who, ends[i], whom,
                            others[i]);
    return FP3_OK;
}

/* Of the variants: the others are the same. */
static fp3_status check_ends(const fp3_measure_run *e, const fp3_measure_problem *p,
                             fp3_error *error) {
    const size_t objects = fp3_engine_objects(e->engine);
    fp3_adaptive_report report;
    char text[FP3_ADAPTIVE_TEXT_SIZE];
    const fp3_status status = fp3_adaptive_report_make(
        e->engine, 0, objects < p->variants ? objects : p->variants, &report);
    if (status)
        return said(e, status, error);
    if (!report.failed)
        return FP3_OK;
    fp3_adaptive_text(report.first, &report.why, text);
    return fp3_fail(error, FP3_E_LIMIT, "%s", text);
}

static void set(fp3_model *model, const char *name, double value) {
    const uint32_t param = fp3_model_param(model, name);
    if (param != FP3_NONE)
        model->params[param].value = value;
}

static double smallest_scale(const fp3_measure_problem *p) {
    double least = INFINITY;
    for (uint32_t i = 0; i < p->model->state_count; i++)
        least = p->scale[i] > 0 ? fmin(least, p->scale[i]) : least;
    return isfinite(least) ? least : 1;
}

static void set_tolerance(fp3_model *model, const fp3_measure_problem *p, double tolerance) {
    set(model, "tolerance", tolerance);
    set(model, "absolute", tolerance * smallest_scale(p));
    set(model, "locate", tolerance * p->end);
}

static int has_condition(const fp3_model *model) {
    int has = 0;
    for (uint32_t i = 0; i < model->event_count; i++)
        has |= model->events[i].armed == FP3_NONE;
    return has;
}

/* A condition is looked for by halves, down to a part of the step; the first step is no longer. A
 * root is located as fp3/compile.h says. */
static void set_step(fp3_model *model, double h) {
    if (!has_condition(model))
        return;
    set(model, "locate", h / LOCATE_PART);
    model->states[fp3_model_state(model, "h_next")].value = h / LOCATE_PART;
}

fp3_status fp3_measure_run_solve(const fp3_measure_run *e, const fp3_measure_problem *p,
                                 const fp3_measure_pace *pace, double *ends, double *seconds,
                                 fp3_stats *stats, fp3_error *error) {
    if (e->adapted && pace->tolerance > 0)
        set_tolerance(e->adapted, p, pace->tolerance);
    else if (e->adapted)
        set_step(e->adapted, pace->h);
    fp3_status status = prepare(e, p, pace->h, error);
    if (status)
        return status;
    const double begin = fp3_measure_now();
    status = fp3_adaptive_run(e->engine, pace->count, stats);
    *seconds = fp3_measure_now() - begin;
    if (status)
        return said(e, status, error);
    if (e->adapted)
        status = check_ends(e, p, error);
    return status ? status : read_ends(e, p, ends, error);
}

uint64_t fp3_measure_run_objects(const fp3_measure_options *options, double steps, double each,
                                 unsigned threads) {
    const uint64_t least = (uint64_t)OBJECTS_LEAST * threads;
    uint64_t objects = options->objects;
    while (objects > least && ((double)objects * steps > (double)options->object_steps * threads ||
                               each / threads * (double)objects > options->patience))
        objects /= 2;
    return objects;
}
