/* SPDX-License-Identifier: Apache-2.0 */
/* meter.c - see meter.h. */
#include "meter.h"

#include "machine/config.h"
#include "world/fields.h"

#include <fp3/compile.h>
#include <fp3/engine.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One measurement. */
typedef struct {
    fp3_meter *meter;
    const fp3_sample *sample;
    const fp3_compiled *compiled;
    const fp3_model *model; /* that the program is of */
    const fp3_stepping *how;
    double h;
    double *times, *before; /* of each object, now and at the look before */
    double *next;           /* adaptive: its next step; -0 if it has stopped */
    double *states;         /* a row for each object */
} measurement;

/* Each object has a time of its own, and sleeps at its end. */
static int is_timed(const fp3_stepping *how) { return how->steps == 0 || how->is_cut; }

const char *fp3_meter_config(const char *config) {
    static const char usual[] = "many_full";
    return fp3_config_computes_as(fp3_config_find(config), fp3_config_find(usual)) ? usual : config;
}

void fp3_meter_close(fp3_meter *meter) {
    fp3_engine_close(&meter->engine);
    free(meter->column);
    meter->column = NULL;
    meter->objects = 0;
}

/* What the engine has told becomes the error. */
static fp3_status judge(const fp3_meter *meter, fp3_status status, fp3_error *error) {
    return status && meter->why.text[0] ? fp3_fail(error, status, "%s", meter->why.text) : status;
}

static fp3_status open_engine(fp3_meter *m, size_t objects, fp3_error *error) {
    fp3_engine_def def = fp3_engine_default();
    if (m->engine && m->objects == objects)
        return FP3_OK;
    fp3_meter_close(m);
    def.engine = "fast";
    def.config = m->config;
    def.objects = (uint32_t)objects;
    def.threads = 1;
    def.is_interpreted = 1; /* many programs, short runs */
    def.error = &m->why;
    m->objects = objects;
    m->column = calloc(objects, sizeof *m->column);
    if (!m->column)
        return fp3_no_memory(error);
    return judge(m, fp3_engine_open(&def, &m->engine), error);
}

float fp3_meter_h(const fp3_sample *sample, uint64_t steps, int is_cut) {
    const float h = (float)(sample->span / (double)steps);
    return is_cut && (double)h * (double)steps < (double)(float)sample->span
               ? nextafterf(h, INFINITY)
               : h;
}

/* ---- the start ---- */

static void put_row(double *row, const double *own, uint32_t own_count, const fp3_quantity *all,
                    uint32_t count) {
    memcpy(row, own, own_count * sizeof *row);
    for (uint32_t i = own_count; i < count; i++)
        row[i] = all[i].value;
}

static void fill(const measurement *k, double *params, double *initial) {
    const fp3_model *m = k->model, *own = k->sample->model;
    for (size_t i = 0; i < k->sample->count; i++) {
        put_row(params + i * m->param_count, k->sample->params + i * own->param_count,
                own->param_count, m->params, m->param_count);
        put_row(initial + i * m->state_count, k->sample->initial + i * own->state_count,
                own->state_count, m->states, m->state_count);
    }
}

/* FP3_E_ARGUMENT: a value has no room in FP32. */
static fp3_status load(const measurement *k, const double *params, const double *initial,
                       fp3_error *error) {
    fp3_engine *engine = k->meter->engine;
    const fp3_fields_def def = {.engine = engine,
                                .objects = k->sample->count,
                                .image = k->compiled->image,
                                .compiled = k->compiled,
                                .h = k->h};
    fp3_fields *fields = NULL;
    k->meter->why.text[0] = '\0';
    fp3_status status = fp3_engine_load(engine, k->compiled->image);
    if (!status)
        status = fp3_fields_open(&def, &fields, error);
    if (!status)
        status = fp3_fields_write_rows(fields, 0, k->sample->count, params, initial, error);
    if (!status)
        status = fp3_fields_settle(fields, error);
    fp3_fields_close(&fields);
    /* A load leaves asleep who fell asleep before it. */
    return status || !is_timed(k->how) ? status : fp3_engine_wake(engine, 0, k->sample->count);
}

/* Gives an engine the program and its objects. *has_room: all their numbers have room in FP32; else
 * they have not all of them. */
static fp3_status start(const measurement *k, int *has_room, fp3_error *error) {
    double *params = calloc(k->sample->count * k->model->param_count + 1, sizeof *params);
    double *initial = calloc(k->sample->count * k->model->state_count + 1, sizeof *initial);
    fp3_status status =
        params && initial ? open_engine(k->meter, k->sample->count, error) : fp3_no_memory(error);
    *has_room = 1;
    if (!status) {
        fill(k, params, initial);
        status = load(k, params, initial, error);
    }
    free(params);
    free(initial);
    if (status == FP3_E_ARGUMENT) {
        *has_room = 0;
        return FP3_OK;
    }
    return judge(k->meter, status, error);
}

/* ---- looks ---- */

/* Adds the register of each object to a number of each object's row. */
static fp3_status add_column(const measurement *k, uint32_t reg, double *to, size_t width) {
    const size_t count = k->sample->count;
    const fp3_status status = fp3_engine_read(k->meter->engine, 0, count, reg, k->meter->column);
    for (size_t i = 0; !status && i < count; i++)
        to[i * width] += (double)k->meter->column[i];
    return status;
}

static fp3_status add_named(const measurement *k, const char *name, double *to, size_t width) {
    return add_column(
        k, fp3_image_find(k->compiled->image, name, FP3_CLASS(FP3_SYMBOL_STATE))->index, to, width);
}

/* A state may have two words. */
static fp3_status read_states(const measurement *k) {
    const size_t width = k->sample->model->state_count;
    fp3_status status = FP3_OK;
    memset(k->states, 0, k->sample->count * width * sizeof *k->states);
    for (uint32_t i = 0; !status && i < width; i++) {
        const int low = fp3_compiled_low(k->compiled, i);
        status = add_named(k, k->sample->model->states[i].name, k->states + i, width);
        if (!status && low >= 0)
            status = add_column(k, (uint32_t)low, k->states + i, width);
    }
    return status;
}

static fp3_status read_times(const measurement *k, uint64_t made) {
    for (size_t i = 0; i < k->sample->count; i++)
        k->times[i] = is_timed(k->how) ? 0 : (double)made * k->h;
    if (!is_timed(k->how))
        return FP3_OK;
    for (size_t i = 0; i < k->sample->count; i++)
        k->next[i] = -0.0;
    fp3_status status = add_named(k, "t", k->times, 1);
    if (!status)
        status = add_named(k, "t_low", k->times, 1);
    return status ? status : add_named(k, "h_next", k->next, 1);
}

/* Then its time is the span: steps may end a little beside it, and one that has stopped stays as it
 * is. */
static int is_at_end(const measurement *k, size_t object, uint64_t made) {
    if (!is_timed(k->how))
        return made == k->how->steps;
    return k->times[object] >= (float)k->sample->span ||
           (k->next[object] == 0 && signbit(k->next[object]));
}

/* After so many steps, or attempts; those that have made none since the look before are not looked
 * at again. */
static fp3_status look_at(const measurement *k, uint64_t made, double *worst) {
    const fp3_sample *s = k->sample;
    fp3_status status = read_times(k, made);
    if (!status)
        status = read_states(k);
    for (size_t i = 0; !status && i < s->count; i++) {
        if (k->times[i] == k->before[i])
            continue;
        k->before[i] = k->times[i];
        *worst = fmax(*worst, fp3_sample_error(s, i, is_at_end(k, i, made) ? s->span : k->times[i],
                                               k->states + i * s->model->state_count));
    }
    return status;
}

/* ---- the run ---- */

/* *made: in all, per object. */
static fp3_status advance(const measurement *k, uint64_t steps, double *made) {
    fp3_stats stats;
    const fp3_status status = fp3_adaptive_run(k->meter->engine, steps, &stats);
    if (!status)
        *made += (double)stats.object_steps / (double)k->sample->count;
    return status;
}

static fp3_status run_fixed(const measurement *k, fp3_meter_found *found, double *worst) {
    const uint64_t steps = k->how->steps, every = fp3_path_every(steps);
    fp3_status status = FP3_OK;
    for (uint64_t made = 0; !status && made < steps && isfinite(*worst);) {
        const uint64_t more = every < steps - made ? every : steps - made;
        status = advance(k, more, &found->made);
        made += more;
        if (!status)
            status = look_at(k, made, worst);
    }
    return status;
}

/* Until all objects sleep, or the whole costs too much. */
static fp3_status run_timed(const measurement *k, fp3_meter_found *found, double *worst) {
    fp3_status status = FP3_OK;
    double before = -1;
    for (uint64_t made = 0, more;
         !status && found->made > before && !found->is_out && isfinite(*worst); made += more) {
        before = found->made;
        more = fp3_path_every(made);
        status = advance(k, more, &found->made);
        if (!status)
            status = look_at(k, made, worst);
        found->is_out = found->made > k->how->most;
    }
    for (size_t i = 0; i < k->sample->count; i++)
        if (!is_at_end(k, i, 0))
            *worst = INFINITY;
    return status;
}

static fp3_status run(const measurement *k, fp3_meter_found *found) {
    double worst = 0;
    for (size_t i = 0; i < k->sample->count; i++)
        k->before[i] = NAN;
    found->is_out = 0;
    const fp3_status status =
        is_timed(k->how) ? run_timed(k, found, &worst) : run_fixed(k, found, &worst);
    if (!status)
        found->worst = worst;
    return status;
}

/* The sample's model with the params and states of adaptive steps. */
static fp3_status adapt(const fp3_sample *s, const fp3_stepping *how, fp3_model **adapted,
                        fp3_error *error) {
    fp3_adaptive_def def = fp3_adaptive_default();
    def.tolerance = how->is_cut ? 0 : how->tolerance;
    def.absolute = how->absolute;
    def.until = (float)s->span;
    def.maxstep = how->maxstep;
    const fp3_status status = fp3_model_copy(s->model, adapted, error);
    return status ? status : fp3_model_adapt(*adapted, &def, error);
}

static fp3_status measure(measurement *k, fp3_meter_found *found, fp3_error *error) {
    const size_t count = k->sample->count;
    int has_room = 0;
    k->times = calloc(count * (3 + k->sample->model->state_count), sizeof *k->times);
    if (!k->times)
        return fp3_no_memory(error);
    k->before = k->times + count;
    k->next = k->before + count;
    k->states = k->next + count;
    fp3_status status = start(k, &has_room, error);
    if (!status && has_room)
        status = judge(k->meter, run(k, found), error);
    free(k->times);
    return status;
}

fp3_status fp3_meter_read(fp3_meter *meter, const fp3_sample *sample, const fp3_compiled *compiled,
                          const fp3_stepping *how, fp3_meter_found *found, fp3_error *error) {
    fp3_model *adapted = NULL;
    *found = (fp3_meter_found){.worst = INFINITY, .is_out = is_timed(how)};
    fp3_status status = is_timed(how) ? adapt(sample, how, &adapted, error) : FP3_OK;
    measurement k = {.meter = meter,
                     .sample = sample,
                     .compiled = compiled,
                     .model = adapted ? adapted : sample->model,
                     .how = how,
                     .h = how->steps ? fp3_meter_h(sample, how->steps, how->is_cut)
                                     : sample->model->step};
    if (!status)
        status = measure(&k, found, error);
    fp3_model_free(&adapted);
    return status;
}
