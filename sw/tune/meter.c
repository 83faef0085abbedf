/* meter.c - see meter.h. */
#include "meter.h"

#include "bench/variants.h"

#include <fp3/start.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void fp3_meter_close(fp3_meter *meter) {
    fp3_engine_close(&meter->engine);
    free(meter->room);
    meter->room = NULL;
    meter->objects = 0;
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
    return fp3_meter_judge(m, fp3_engine_open(&def, &m->engine), error);
}

float fp3_meter_h(const fp3_sample *sample, uint64_t steps) {
    return (float)(sample->times[FP3_TUNE_LOOKS - 1] / (double)steps);
}

/* A column for each input, a row for each object. FP3_E_ARGUMENT: a value has no room in FP32. */
static fp3_status fill(const fp3_meter_rows *r, const fp3_compiled *c, float *columns,
                       fp3_error *error) {
    float *row = calloc(c->input_count + 1u, sizeof *row);
    fp3_status status = row ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    for (size_t i = 0; !status && i < r->objects; i++) {
        status = fp3_compiled_inputs(c, r->params + i * r->param_count,
                                     r->initial + i * r->state_count, r->h, row, error);
        for (uint32_t k = 0; !status && k < c->input_count; k++)
            columns[k * r->objects + i] = row[k];
    }
    free(row);
    return status;
}

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

fp3_status fp3_meter_look(fp3_meter *m, const fp3_sample *s, const fp3_compiled *c, unsigned look,
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

fp3_status fp3_meter_judge(const fp3_meter *meter, fp3_status status, fp3_error *error) {
    return status && meter->why.text[0] ? fp3_fail(error, status, "%s", meter->why.text) : status;
}

fp3_status fp3_meter_start(fp3_meter *meter, const fp3_compiled *compiled,
                           const fp3_meter_rows *rows, int *has_room, fp3_error *error) {
    float *columns = calloc((compiled->input_count + 1u) * rows->objects, sizeof *columns);
    fp3_status status = columns ? open_engine(meter, rows->objects, error)
                                : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    *has_room = 1;
    if (!status)
        status = fill(rows, compiled, columns, error);
    if (status == FP3_E_ARGUMENT) {
        *has_room = 0;
        free(columns);
        return FP3_OK;
    }
    meter->why.text[0] = '\0';
    if (!status)
        status = fp3_engine_load(meter->engine, compiled->image);
    if (!status)
        status = fp3_bench_write(meter->engine, compiled, rows->objects, columns);
    free(columns);
    return fp3_meter_judge(meter, status, error);
}

static fp3_status go(fp3_meter *m, const fp3_sample *s, const fp3_compiled *c, uint64_t steps,
                     double *worst) {
    const double h = fp3_meter_h(s, steps);
    fp3_status status = FP3_OK;
    *worst = 0;
    for (unsigned i = 0; !status && isfinite(*worst) && i < FP3_TUNE_LOOKS; i++) {
        const double now = h * (double)(steps * (i + 1) / FP3_TUNE_LOOKS);
        status = fp3_engine_run(m->engine, steps / FP3_TUNE_LOOKS, NULL);
        if (!status)
            status = fp3_meter_look(m, s, c, i, 0, now - s->times[i], worst);
    }
    return status;
}

fp3_status fp3_meter_read(fp3_meter *meter, const fp3_sample *sample, const fp3_compiled *compiled,
                          uint64_t steps, double *worst, fp3_error *error) {
    const fp3_meter_rows rows = {.objects = sample->count,
                                 .param_count = sample->model->param_count,
                                 .state_count = sample->model->state_count,
                                 .params = sample->params,
                                 .initial = sample->initial,
                                 .h = fp3_meter_h(sample, steps)};
    int has_room;
    *worst = INFINITY;
    const fp3_status status = fp3_meter_start(meter, compiled, &rows, &has_room, error);
    if (status || !has_room)
        return status;
    return fp3_meter_judge(meter, go(meter, sample, compiled, steps, worst), error);
}
