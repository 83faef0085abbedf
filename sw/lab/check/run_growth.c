/* SPDX-License-Identifier: Apache-2.0 */
/* run_growth.c - see run_growth.h. */
#include "run_growth.h"

#include "others.h"

#include "world/apply.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LOOKED 128    /* objects */
#define LOOKS 4194304 /* fewer, where to find their neighbours takes more pairs than this */
#define PAIRS 16384   /* fewer, where these see more neighbours together */
#define START 4096    /* the most whose start is computed */
#define WINDOW 8  /* steps: a disturbance that turns around has its largest size in each window */
#define STEPS 24  /* the last window ends here, the first one at half of it */
#define GROWS 1.2 /* a step: what is some percent beyond a limit of stability grows so */
#define SHORTER 4 /* h/4 and h/16 tell what the method does from what the motion does */
#define SHORTEST 16
#define BISECTIONS                                                                                 \
    5 /* for a step that is short enough: less than SETTLES in a step may also be a swing */
#define SETTLES 1.1
#define MARGIN 0.95
#define SMALL 1e-7 /* a disturbance, relative to the size of states */

typedef struct {
    const fp3_run_moment *of;
    const fp3_model *model;
    const fp3_integrator *integrator;
    fp3_others *others;
    size_t looked;
    double h;
    double *params; /* rows of the looked objects */
    size_t size;    /* of a disturbance: columns of a number for each looked object */
    double *now;    /* the disturbance */
    double *slopes; /* at the final states */
    double *stages, *sum, *kept;
    double *scale; /* of each state */
    double *values, *states;
    double *memory; /* all of these */
} lens;

/* ---- slopes ---- */

static void find_slopes(lens *l, double *slopes) {
    const fp3_run_moment *of = l->of;
    const fp3_model *m = l->model;
    for (size_t i = 0; i < l->looked; i++) {
        for (uint32_t s = 0; s < m->state_count; s++)
            l->states[s] = of->columns[s * of->objects + i];
        const fp3_point at = {
            .states = l->states, .params = l->params + i * m->param_count, .t = of->t};
        fp3_others_evaluate(l->others, i, &at, NULL, NULL, l->values);
        for (uint32_t s = 0; s < m->state_count; s++) {
            const uint32_t e = m->states[s].derivative;
            slopes[s * l->looked + i] = e == FP3_NONE ? 0 : l->values[e];
        }
    }
}

static void move(lens *l, const double *by, double share) {
    const fp3_run_moment *of = l->of;
    for (uint32_t s = 0; s < l->model->state_count; s++)
        for (size_t i = 0; i < l->looked; i++)
            of->columns[s * of->objects + i] += share * by[s * l->looked + i];
}

/* The largest part of a disturbance, relative to the size of states. */
static double size_of(const lens *l, const double *by, size_t *object) {
    const size_t looked = l->looked;
    double most = 0;
    for (size_t k = 0; k < l->size; k++) {
        const double part = fabs(by[k]) / l->scale[k / looked];
        if (part > most || isnan(part)) {
            most = part;
            *object = k % looked;
        }
    }
    return most;
}

/* J times a disturbance, by a difference: what is disturbed moves by SMALL. */
static void turn(lens *l, const double *by, double *turned) {
    size_t object;
    const double size = size_of(l, by, &object);
    const double share = size > 0 ? SMALL / size : 0;
    double *keep = l->kept;
    for (uint32_t s = 0; s < l->model->state_count; s++)
        memcpy(keep + s * l->looked, l->of->columns + s * l->of->objects, l->looked * sizeof *keep);
    move(l, by, share);
    find_slopes(l, turned);
    for (uint32_t s = 0; s < l->model->state_count; s++)
        memcpy(l->of->columns + s * l->of->objects, keep + s * l->looked, l->looked * sizeof *keep);
    for (size_t k = 0; k < l->size; k++)
        turned[k] = share > 0 ? (turned[k] - l->slopes[k]) / share : 0;
}

/* ---- steps of methods, on a disturbance ---- */

static void drift(lens *l, double h) {
    const fp3_model *m = l->model;
    const size_t looked = l->looked;
    for (uint32_t s = 0; s < m->state_count; s++)
        for (size_t i = 0; m->states[s].velocity != FP3_NONE && i < looked; i++)
            l->now[s * looked + i] += h * l->now[m->states[s].velocity * looked + i];
}

static void kick(lens *l, double h) {
    const fp3_model *m = l->model;
    turn(l, l->now, l->sum);
    for (size_t k = 0; k < l->size; k++)
        if (m->states[k / l->looked].velocity == FP3_NONE)
            l->now[k] += h * l->sum[k];
}

/* A position that is advanced late keeps its place meanwhile. */
static void step_runge_kutta(lens *l, double h) {
    const fp3_integrator *rk = l->integrator;
    const fp3_model *m = l->model;
    for (unsigned i = 0; i < rk->stages; i++) {
        double *stage = l->stages + i * l->size;
        memcpy(l->sum, l->now, l->size * sizeof *l->sum);
        for (unsigned j = 0; j < i; j++)
            for (size_t k = 0; rk->a[i][j] != 0 && k < l->size; k++)
                l->sum[k] += rk->a[i][j] * l->stages[j * l->size + k];
        turn(l, l->sum, stage);
        for (size_t k = 0; k < l->size; k++)
            stage[k] *=
                rk->is_position_late && m->states[k / l->looked].velocity != FP3_NONE ? 0 : h;
    }
    for (unsigned i = 0; i < rk->stages; i++)
        for (size_t k = 0; k < l->size; k++)
            l->now[k] += rk->b[i] * l->stages[i * l->size + k];
    if (rk->is_position_late)
        drift(l, h);
}

static void step(lens *l, double h) {
    const fp3_integrator *by = l->integrator;
    if (by->kind != FP3_SPLITTING) {
        step_runge_kutta(l, h);
        return;
    }
    for (unsigned i = 0; i < by->stages; i++)
        if (by->substeps[i].is_kick)
            kick(l, by->substeps[i].coefficient * h);
        else
            drift(l, by->substeps[i].coefficient * h);
}

/* ---- growth ---- */

/* The same disturbance each time. */
static void disturb(lens *l) {
    uint32_t random = 1;
    for (size_t k = 0; k < l->size; k++) {
        random = random * 1664525u + 1013904223u;
        l->now[k] = l->scale[k / l->looked] * ((double)random / 2147483648.0 - 1);
    }
}

/* By which factor a disturbance grows in a step of h/parts, made `parts` times. It is made small
 * again after each, so that it never overflows. */
static double growth(lens *l, double h, unsigned parts, size_t *object) {
    double sum = 0, early = -INFINITY, late = -INFINITY; /* logarithms */
    disturb(l);
    for (int n = 1; n <= STEPS; n++) {
        for (unsigned p = 0; p < parts; p++)
            step(l, h / parts);
        const double size = size_of(l, l->now, object);
        if (!(size > 0) || !isfinite(size))
            return size > 0 ? INFINITY : isnan(size) ? NAN : 0;
        sum += log(size);
        for (size_t k = 0; k < l->size; k++)
            l->now[k] /= size;
        if (n > STEPS / 2 - WINDOW && n <= STEPS / 2)
            early = fmax(early, sum);
        if (n > STEPS - WINDOW)
            late = fmax(late, sum);
    }
    return exp((late - early) / (STEPS - STEPS / 2));
}

/* What grows with h, and not with shorter steps over the same time, is the method's. */
static void judge(lens *l, fp3_run_growth *found) {
    const double h = l->h;
    size_t object;
    const double factor = growth(l, h, 1, &found->object);
    if (!(factor > GROWS))
        return;
    const double motion = 1 + (factor - 1) / 2;
    unsigned parts = SHORTER;
    while (parts <= SHORTEST && !(growth(l, h, parts, &object) < motion))
        parts *= SHORTER;
    if (parts > SHORTEST) {
        found->factor = factor > 2 ? factor : 1;
        return;
    }
    found->factor = factor;
    double short_enough = h / parts, too_long = SHORTER * short_enough;
    for (int i = 0; i < BISECTIONS; i++) {
        const double half = (short_enough + too_long) / 2;
        *(growth(l, half, 1, &object) > SETTLES ? &too_long : &short_enough) = half;
    }
    found->stable = MARGIN * short_enough;
}

static void find_scale(lens *l) {
    const fp3_run_moment *of = l->of;
    for (uint32_t s = 0; s < l->model->state_count; s++) {
        for (size_t i = 0; i < l->looked; i++)
            l->scale[s] = fmax(l->scale[s], fabs(of->columns[s * of->objects + i]));
        l->scale[s] = l->scale[s] > 0 ? l->scale[s] : 1;
    }
}

static fp3_status take_params(lens *l, fp3_error *error) {
    const uint32_t count = l->model->param_count;
    const size_t last = l->of->objects - 1;
    fp3_object_values values;
    fp3_status status = fp3_object_values_open(l->of->program, l->of->params, &values, error);
    for (size_t i = 0; !status && i < l->looked; i++) {
        status = fp3_object_values_at(&values, last ? (double)i / (double)last : 0, error);
        if (!status)
            memcpy(l->params + i * count, values.params, count * sizeof *l->params);
        l->h = values.h;
    }
    fp3_object_values_free(&values);
    return status;
}

/* l->memory and l->others are what the caller frees. */
static fp3_status open_lens(lens *l, fp3_error *error) {
    const fp3_model *m = l->model;
    const size_t stages = l->integrator->stages, objects = l->of->objects;
    const size_t most = LOOKS / objects + 1 < LOOKED ? LOOKS / objects + 1 : LOOKED;
    const fp3_status found =
        fp3_others_open(l->of->program, l->of->params, objects, objects < most ? objects : most,
                        l->of->columns, &l->others, error);
    if (found)
        return found;
    l->looked = fp3_others_within(l->others, PAIRS);
    l->size = m->state_count * l->looked;
    l->memory = calloc((4 + stages) * l->size + l->looked * m->param_count + 2u * m->state_count +
                           m->expr_count + 1u,
                       sizeof *l->memory);
    if (!l->memory)
        return fp3_no_memory(error);
    l->now = l->memory;
    l->slopes = l->now + l->size;
    l->sum = l->slopes + l->size;
    l->kept = l->sum + l->size;
    l->stages = l->kept + l->size;
    l->params = l->stages + stages * l->size;
    l->scale = l->params + l->looked * m->param_count;
    l->states = l->scale + m->state_count;
    l->values = l->states + m->state_count;
    return take_params(l, error);
}

fp3_status fp3_run_growth_find(const fp3_run_moment *moment, fp3_run_growth *found,
                               fp3_error *error) {
    const fp3_integrator *by = moment->program->integrator;
    lens l = {.of = moment, .model = moment->program->model, .integrator = by};
    *found = (fp3_run_growth){.factor = 1};
    if (fp3_adaptive_is(moment->program->image) || by->kind == FP3_STOERMER ||
        by->kind == FP3_ROSENBROCK)
        return FP3_OK;
    const fp3_status status = open_lens(&l, error);
    found->h = l.h;
    if (!status) {
        find_scale(&l);
        find_slopes(&l, l.slopes);
        judge(&l, found);
    }
    fp3_others_close(&l.others);
    free(l.memory);
    return status;
}

fp3_status fp3_run_growth_find_at_start(const fp3_program *program, const fp3_params *params,
                                        size_t objects, fp3_run_growth *found, fp3_error *error) {
    const uint32_t states = program->model->state_count;
    fp3_object_values values = {0};
    *found = (fp3_run_growth){.factor = 1};
    if (objects > START)
        return FP3_OK;
    double *columns = calloc(states * objects + 1, sizeof *columns);
    fp3_status status =
        columns ? fp3_object_values_open(program, params, &values, error) : fp3_no_memory(error);
    for (size_t i = 0; !status && i < objects; i++) {
        status = fp3_object_values_at(&values, objects > 1 ? (double)i / (double)(objects - 1) : 0,
                                      error);
        for (uint32_t s = 0; !status && s < states; s++)
            columns[s * objects + i] = (double)(float)values.initial[s];
    }
    fp3_object_values_free(&values);
    if (!status)
        status = fp3_run_growth_find(&(fp3_run_moment){program, params, columns, objects, 0}, found,
                                     error);
    free(columns);
    return status;
}

void fp3_run_growth_text(const fp3_run_growth *found, const fp3_program *program, size_t first,
                         char text[FP3_RUN_GROWTH_TEXT_SIZE]) {
    char shorter[64] = "";
    if (found->stable > 0)
        snprintf(shorter, sizeof shorter, "; with h = %.2g it does not grow", found->stable);
    snprintf(text, FP3_RUN_GROWTH_TEXT_SIZE,
             "object %zu: the step is too long: a small error grows %.3g times in each step of "
             "h = %.3g by %s%s",
             first + found->object, found->factor, found->h, program->integrator->name, shorter);
}
