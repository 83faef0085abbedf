/* meter.c - see meter.h.
 *
 * Objects with fixed steps have looks in common. Of adaptive ones, an object that ends at a look makes the same
 * steps until there as one that goes on, but for its last one. So each object of the sample runs once for each
 * look, all at once, and the steps of those that run the whole span are what they are without looks.
 */
#include "meter.h"

#include "batch/fields.h"

#include <fp3/compile.h>
#include <fp3/engine.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LAST (FP3_TUNE_LOOKS - 1)
#define PART_LEAST 16 /* attempts between two looks at how many there are */

/* One measurement. */
typedef struct {
    fp3_meter *meter;
    const fp3_sample *sample;
    const fp3_compiled *compiled;
    const fp3_model *model; /* that the program is of */
    const fp3_stepping *how;
    double h;
    unsigned blocks; /* how often the sample runs: object i in block b is object b * count + i */
} measurement;

static int is_adaptive(const fp3_stepping *how) { return how->steps == 0; }

static size_t objects_of(const measurement *k) { return k->blocks * k->sample->count; }

void fp3_meter_close(fp3_meter *meter) {
    fp3_engine_close(&meter->engine);
    free(meter->room);
    meter->room = NULL;
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
    def.config = FP3_METER_CONFIG;
    def.objects = (uint32_t)objects;
    def.threads = 1;
    def.is_interpreted = 1; /* many programs, short runs */
    def.error = &m->why;
    m->objects = objects;
    m->room = calloc(2 * objects + 1, sizeof *m->room);
    if (!m->room)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    return judge(m, fp3_engine_open(&def, &m->engine), error);
}

float fp3_meter_h(const fp3_sample *sample, uint64_t steps) {
    return (float)(sample->times[LAST] / (double)steps);
}

/* ---- the start ---- */

static void put_row(double *row, const double *own, uint32_t own_count, const fp3_quantity *all,
                    uint32_t count) {
    memcpy(row, own, own_count * sizeof *row);
    for (uint32_t i = own_count; i < count; i++)
        row[i] = all[i].value;
}

/* Rows of all objects of the engine. */
static void fill(const measurement *k, double *params, double *initial) {
    const fp3_model *m = k->model, *own = k->sample->model;
    const uint32_t until = is_adaptive(k->how) ? fp3_model_param(m, "until") : FP3_NONE;
    for (size_t at = 0; at < objects_of(k); at++) {
        const size_t i = at % k->sample->count;
        double *row = params + at * m->param_count;
        put_row(row, k->sample->params + i * own->param_count, own->param_count, m->params,
                m->param_count);
        put_row(initial + at * m->state_count, k->sample->initial + i * own->state_count,
                own->state_count, m->states, m->state_count);
        if (until != FP3_NONE)
            row[until] = (float)k->sample->times[at / k->sample->count];
    }
}

/* FP3_E_ARGUMENT: a value has no room in FP32. */
static fp3_status load(const measurement *k, const double *params, const double *initial,
                       fp3_error *error) {
    fp3_engine *engine = k->meter->engine;
    const fp3_fields_def def = {.engine = engine,
                                .objects = objects_of(k),
                                .image = k->compiled->image,
                                .compiled = k->compiled,
                                .h = k->h};
    fp3_fields *fields = NULL;
    k->meter->why.text[0] = '\0';
    fp3_status status = fp3_engine_load(engine, k->compiled->image);
    if (!status)
        status = fp3_fields_open(&def, &fields, error);
    if (!status)
        status = fp3_fields_write_rows(fields, 0, objects_of(k), params, initial, error);
    if (!status)
        status = fp3_fields_settle(fields, error);
    fp3_fields_close(&fields);
    /* A load leaves asleep who fell asleep before it. */
    return status || !is_adaptive(k->how) ? status : fp3_engine_wake(engine, 0, objects_of(k));
}

/* Gives an engine the program and its objects. *has_room: all their numbers have room in FP32; else they
 * have not all of them. */
static fp3_status start(const measurement *k, int *has_room, fp3_error *error) {
    double *params = calloc(objects_of(k) * k->model->param_count + 1, sizeof *params);
    double *initial = calloc(objects_of(k) * k->model->state_count + 1, sizeof *initial);
    fp3_status status = params && initial ? open_engine(k->meter, objects_of(k), error)
                                          : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
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

/* Of one state at one look. A state that is 0 all the time must stay it. low: what the sum of its two
 * words has more than `got`. */
static double worst_of(const fp3_sample *s, unsigned look, uint32_t state, double late,
                       const float *got, const float *low) {
    double worst = 0;
    for (size_t i = 0; i < s->count; i++) {
        const double size = s->sizes[i * s->model->state_count + state];
        const double is = (double)got[i] + (double)low[i];
        const double away = fabs(is - fp3_sample_truth(s, i, look, state, late));
        const double e = away == 0 ? 0 : away / size;
        if (!(e <= worst)) /* a NaN, too */
            worst = isfinite(e) ? e : INFINITY;
    }
    return worst;
}

/* Of objects first .. first+count-1 of the engine, which are those of the sample `late` behind the look; *worst
 * grows to it. */
static fp3_status look_at(fp3_meter *m, const fp3_sample *s, const fp3_compiled *c, unsigned look,
                          size_t first, double late, double *worst) {
    float *low = m->room + s->count;
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; !status && k < s->model->state_count; k++) {
        const fp3_symbol *symbol =
            fp3_image_find(c->image, s->model->states[k].name, FP3_CLASS(FP3_SYMBOL_STATE));
        const int second = fp3_compiled_low(c, k);
        memset(low, 0, s->count * sizeof *low);
        status = fp3_engine_read(m->engine, first, s->count, symbol->index, m->room);
        if (!status && second >= 0)
            status = fp3_engine_read(m->engine, first, s->count, (uint32_t)second, low);
        if (!status)
            *worst = fmax(*worst, worst_of(s, look, k, late, m->room, low));
    }
    return status;
}

/* ---- the run ---- */

/* Of adaptive steps, of all objects that run the whole span. */
static fp3_status count_attempts(const measurement *k, double *attempts) {
    static const char *const names[] = {"accepted", "rejected"};
    const size_t count = k->sample->count;
    fp3_status status = FP3_OK;
    *attempts = 0;
    for (size_t n = 0; !status && n < sizeof names / sizeof *names; n++) {
        const fp3_symbol *symbol =
            fp3_image_find(k->compiled->image, names[n], FP3_CLASS(FP3_SYMBOL_STATE));
        status =
            fp3_engine_read(k->meter->engine, LAST * count, count, symbol->index, k->meter->room);
        for (size_t i = 0; !status && i < count; i++)
            *attempts += (double)k->meter->room[i];
    }
    *attempts /= (double)count;
    return status;
}

/* In parts, until all objects sleep or the whole costs too much. *is_there: every object has reached its end. */
static fp3_status run_to_ends(const measurement *k, fp3_meter_found *found, int *is_there) {
    fp3_engine *engine = k->meter->engine;
    const uint64_t part = (uint64_t)fmin(fmax(k->how->most, PART_LEAST), FP3_ADAPTIVE_ATTEMPTS);
    fp3_stats stats = {.object_steps = 1};
    fp3_status status = FP3_OK;
    while (!status && !found->is_out && stats.object_steps) {
        status = fp3_engine_advance(engine, part, &stats);
        if (!status)
            status = count_attempts(k, &found->made);
        found->is_out = found->made > k->how->most;
    }
    *is_there = !found->is_out;
    for (size_t i = 0; !status && *is_there && i < objects_of(k); i++) {
        fp3_adaptive_object o;
        status = fp3_adaptive_look(engine, i, &o);
        *is_there = o.end == FP3_ADAPTIVE_ENDED;
    }
    return status;
}

/* From the look before to this one. *late: how far behind it the objects are. */
static fp3_status reach(const measurement *k, unsigned look, fp3_meter_found *found, double *late,
                        int *is_there) {
    const uint64_t steps = k->how->steps;
    const double time = k->sample->times[look];
    if (is_adaptive(k->how)) {
        *late = (float)time - time;
        return look ? FP3_OK : run_to_ends(k, found, is_there);
    }
    *late = k->h * (double)(steps * (look + 1) / FP3_TUNE_LOOKS) - time;
    return fp3_engine_advance(k->meter->engine, steps / FP3_TUNE_LOOKS, NULL);
}

static fp3_status run(const measurement *k, fp3_meter_found *found) {
    double late, worst = 0;
    int is_there = 1;
    fp3_status status = FP3_OK;
    found->is_out = 0;
    for (unsigned i = 0; !status && is_there && isfinite(worst) && i < FP3_TUNE_LOOKS; i++) {
        status = reach(k, i, found, &late, &is_there);
        if (!status && is_there)
            status = look_at(k->meter, k->sample, k->compiled, i,
                             k->blocks == 1 ? 0 : i * k->sample->count, late, &worst);
    }
    if (!status && is_there)
        found->worst = worst;
    return status;
}

/* The sample's model with the params and states of adaptive steps. */
static fp3_status adapt(const fp3_sample *s, const fp3_stepping *how, fp3_model **adapted,
                        fp3_error *error) {
    const fp3_adaptive_def def = {.tolerance = how->tolerance,
                                  .absolute = how->absolute,
                                  .until = (float)s->times[LAST],
                                  .maxstep = how->maxstep};
    const fp3_status status = fp3_model_copy(s->model, adapted, error);
    return status ? status : fp3_model_adapt(*adapted, &def, error);
}

fp3_status fp3_meter_read(fp3_meter *meter, const fp3_sample *sample, const fp3_compiled *compiled,
                          const fp3_stepping *how, fp3_meter_found *found, fp3_error *error) {
    fp3_model *adapted = NULL;
    int has_room = 0;
    *found = (fp3_meter_found){
        .worst = INFINITY, .made = (double)how->steps, .is_out = is_adaptive(how)};
    fp3_status status = is_adaptive(how) ? adapt(sample, how, &adapted, error) : FP3_OK;
    const measurement k = {.meter = meter,
                           .sample = sample,
                           .compiled = compiled,
                           .model = adapted ? adapted : sample->model,
                           .how = how,
                           .h = adapted ? adapted->step : fp3_meter_h(sample, how->steps),
                           .blocks = is_adaptive(how) ? FP3_TUNE_LOOKS : 1};
    if (!status)
        status = start(&k, &has_room, error);
    if (!status && has_room)
        status = judge(meter, run(&k, found), error);
    fp3_model_free(&adapted);
    return status;
}
