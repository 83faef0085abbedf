/* meter_adaptive.c - see meter_adaptive.h.
 *
 * An object that ends at a look makes the same steps until there as one that goes on, but for its last one.
 * So each object of the sample runs once for each look, all at once, and the steps of those that run the
 * whole span are what they are without looks.
 */
#include "meter_adaptive.h"

#include <fp3/adaptive.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LAST (FP3_TUNE_LOOKS - 1)
#define PART_LEAST 16 /* attempts between two looks at how many there are */

/* A model with the params and states that these numbers give it. */
static fp3_status adapt(const fp3_sample *s, const fp3_meter_control *control, fp3_model **adapted,
                        fp3_error *error) {
    const fp3_adaptive_def def = {.tolerance = control->tolerance,
                                  .absolute = control->absolute,
                                  .until = (float)s->times[LAST]};
    const fp3_status status = fp3_model_copy(s->model, adapted, error);
    return status ? status : fp3_model_adapt(*adapted, &def, error);
}

static void put_row(double *row, const double *own, uint32_t own_count, const fp3_quantity *all,
                    uint32_t count) {
    memcpy(row, own, own_count * sizeof *row);
    for (uint32_t i = own_count; i < count; i++)
        row[i] = all[i].value;
}

/* Object i of the sample, until look l, is object l * count + i. */
static void put_rows(const fp3_sample *s, const fp3_model *m, double *params, double *initial) {
    const uint32_t until = fp3_model_param(m, "until");
    for (unsigned look = 0; look < FP3_TUNE_LOOKS; look++)
        for (size_t i = 0; i < s->count; i++) {
            const size_t at = look * s->count + i;
            put_row(params + at * m->param_count, s->params + i * s->model->param_count,
                    s->model->param_count, m->params, m->param_count);
            put_row(initial + at * m->state_count, s->initial + i * s->model->state_count,
                    s->model->state_count, m->states, m->state_count);
            params[at * m->param_count + until] = (float)s->times[look];
        }
}

static fp3_status start(fp3_meter *meter, const fp3_sample *s, const fp3_compiled *compiled,
                        const fp3_model *m, int *has_room, fp3_error *error) {
    const size_t objects = s->count * FP3_TUNE_LOOKS;
    double *params = calloc(objects * m->param_count + 1, sizeof *params);
    double *initial = calloc(objects * m->state_count + 1, sizeof *initial);
    const fp3_meter_rows rows = {.objects = objects,
                                 .param_count = m->param_count,
                                 .state_count = m->state_count,
                                 .params = params,
                                 .initial = initial,
                                 .h = m->step};
    fp3_status status = params && initial ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    if (!status) {
        put_rows(s, m, params, initial);
        status = fp3_meter_start(meter, compiled, &rows, has_room, error);
    }
    free(params);
    free(initial);
    return status;
}

/* Of all objects that run the whole span. */
static fp3_status count_attempts(fp3_meter *meter, const fp3_sample *s, const fp3_compiled *c,
                                 double *attempts) {
    static const char *const names[] = {"accepted", "rejected"};
    fp3_status status = FP3_OK;
    *attempts = 0;
    for (size_t k = 0; !status && k < sizeof names / sizeof *names; k++) {
        const fp3_symbol *symbol = fp3_image_find(c->image, names[k], FP3_CLASS(FP3_SYMBOL_STATE));
        status =
            fp3_engine_read(meter->engine, LAST * s->count, s->count, symbol->index, meter->room);
        for (size_t i = 0; !status && i < s->count; i++)
            *attempts += (double)meter->room[i];
    }
    *attempts /= (double)s->count;
    return status;
}

/* In parts, until all objects sleep or the whole costs too much. */
static fp3_status go(fp3_meter *meter, const fp3_sample *s, const fp3_compiled *c, double most,
                     fp3_meter_found *found) {
    const uint64_t part = (uint64_t)fmin(fmax(most, PART_LEAST), FP3_ADAPTIVE_ATTEMPTS);
    fp3_stats stats = {.object_steps = 1};
    fp3_status status = FP3_OK;
    while (!status && !found->is_out && stats.object_steps) {
        status = fp3_adaptive_run(meter->engine, part, &stats);
        if (!status)
            status = count_attempts(meter, s, c, &found->attempts);
        found->is_out = found->attempts > most;
    }
    return status;
}

/* Whether every object has reached its end. */
static fp3_status look_at_ends(fp3_meter *meter, size_t objects, int *have_ended) {
    fp3_status status = FP3_OK;
    *have_ended = 1;
    for (size_t i = 0; !status && *have_ended && i < objects; i++) {
        fp3_adaptive_object o;
        status = fp3_adaptive_look(meter->engine, i, &o);
        *have_ended = o.end == FP3_ADAPTIVE_ENDED;
    }
    return status;
}

static fp3_status run(fp3_meter *meter, const fp3_sample *s, const fp3_compiled *c, double most,
                      fp3_meter_found *found) {
    int have_ended = 0;
    const size_t objects = s->count * FP3_TUNE_LOOKS;
    found->is_out = 0;
    /* A load leaves asleep who fell asleep before it. */
    fp3_status status = fp3_engine_wake(meter->engine, 0, objects);
    if (!status)
        status = go(meter, s, c, most, found);
    if (!status && !found->is_out)
        status = look_at_ends(meter, objects, &have_ended);
    if (status || !have_ended)
        return status;
    found->worst = 0;
    for (unsigned i = 0; !status && isfinite(found->worst) && i < FP3_TUNE_LOOKS; i++)
        status = fp3_meter_look(meter, s, c, i, i * s->count, (float)s->times[i] - s->times[i],
                                &found->worst);
    return status;
}

fp3_status fp3_meter_adaptive(fp3_meter *meter, const fp3_sample *sample,
                              const fp3_compiled *compiled, const fp3_meter_control *control,
                              fp3_meter_found *found, fp3_error *error) {
    fp3_model *model = NULL;
    int has_room = 0;
    *found = (fp3_meter_found){.worst = INFINITY, .is_out = 1};
    fp3_status status = adapt(sample, control, &model, error);
    if (!status)
        status = start(meter, sample, compiled, model, &has_room, error);
    if (!status && has_room)
        status = fp3_meter_judge(meter, run(meter, sample, compiled, control->most, found), error);
    fp3_model_free(&model);
    return status;
}
