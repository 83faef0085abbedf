/* sample.c - see sample.h. */
#include "sample.h"

#include "scene/apply.h"
#include "scene/values.h"
#include "text/number.h"

#include <fp3/tune.h>
#include <stdlib.h>
#include <string.h>

uint32_t fp3_sample_ranges(const fp3_params *params) {
    uint32_t ranges = 0;
    fp3_value_look look;
    for (size_t i = 0; fp3_values_look(params, i, &look); i++)
        ranges += look.is_spread != 0;
    return ranges;
}

void fp3_sample_open(fp3_sample *sample, const fp3_model *model, double span) {
    *sample = (fp3_sample){.model = model};
    for (int i = 0; i < FP3_TUNE_LOOKS; i++)
        sample->times[i] = span * (i + 1) / FP3_TUNE_LOOKS;
}

void fp3_sample_close(fp3_sample *sample) {
    free(sample->params);
    free(sample->initial);
    free(sample->sizes);
    free(sample->truth);
    free(sample->slopes);
    *sample = (fp3_sample){0};
}

static int grow(double **rows, size_t count, size_t width) {
    double *more = realloc(*rows, (count * width + 1) * sizeof *more);
    if (more)
        *rows = more;
    return more != NULL;
}

static fp3_status make_room(fp3_sample *s, size_t count, fp3_error *error) {
    const size_t states = s->model->state_count;
    if (count <= s->room)
        return FP3_OK;
    if (!grow(&s->params, count, s->model->param_count) || !grow(&s->initial, count, states) ||
        !grow(&s->sizes, count, states) || !grow(&s->truth, count, FP3_TUNE_LOOKS * states) ||
        !grow(&s->slopes, count, FP3_TUNE_LOOKS * states))
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    s->room = count;
    return FP3_OK;
}

/* The values of one object, each a number. */
static fp3_status place(const fp3_params *params, const double *shares, fp3_params **own,
                        fp3_error *error) {
    fp3_value_look look;
    size_t range = 0;
    fp3_status status = fp3_params_copy(params, own, error);
    for (size_t i = 0; !status && fp3_values_look(params, i, &look); i++)
        if (look.is_spread) {
            const double share = shares[range++];
            status = fp3_params_put(*own, look.name, (1 - share) * look.first + share * look.last,
                                    error);
        }
    return status;
}

static fp3_status read_values(fp3_sample *s, const fp3_program *program, const fp3_params *own,
                              fp3_error *error) {
    double *params = s->params + s->count * s->model->param_count;
    double *initial = s->initial + s->count * s->model->state_count;
    fp3_object_values of;
    fp3_status status = fp3_object_values_open(program, own, &of, error);
    if (!status)
        status = fp3_object_values_at(&of, 0, error);
    for (uint32_t i = 0; !status && i < s->model->param_count; i++)
        params[i] = fp3_number_given(of.params[i], 1);
    for (uint32_t i = 0; !status && i < s->model->state_count; i++)
        initial[i] = (float)of.initial[i];
    fp3_object_values_free(&of);
    return status;
}

static fp3_status find_slopes(fp3_sample *s, fp3_error *error) {
    const fp3_model *model = s->model;
    const size_t states = model->state_count, first = s->count * FP3_TUNE_LOOKS * states;
    double *values = calloc(model->expr_count + 1u, sizeof *values);
    if (!values)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    for (size_t i = 0; i < FP3_TUNE_LOOKS; i++) {
        const fp3_point at = {.states = s->truth + first + i * states,
                              .params = s->params + s->count * model->param_count,
                              .initial = s->initial + s->count * states,
                              .t = s->times[i]};
        fp3_model_evaluate(model, &at, values);
        for (size_t k = 0; k < states; k++)
            s->slopes[first + i * states + k] = values[model->states[k].derivative];
    }
    free(values);
    return FP3_OK;
}

static fp3_status find_truth(fp3_sample *s, fp3_error *error) {
    const size_t states = s->model->state_count;
    fp3_error why;
    const fp3_status status = fp3_model_truths(
        s->model, s->params + s->count * s->model->param_count, s->initial + s->count * states,
        s->times, FP3_TUNE_LOOKS, s->truth + s->count * FP3_TUNE_LOOKS * states,
        s->sizes + s->count * states, &why);
    if (status == FP3_E_ARGUMENT || status == FP3_E_MISMATCH)
        return fp3_fail(error, FP3_E_FAILED, "no truth to measure errors against: %s", why.text);
    return status ? fp3_fail(error, status, "%s", why.text) : find_slopes(s, error);
}

fp3_status fp3_sample_add(fp3_sample *sample, const fp3_program *program, const fp3_params *params,
                          const double *shares, fp3_error *error) {
    fp3_params *own = NULL;
    fp3_status status = make_room(sample, sample->count + 1, error);
    if (!status)
        status = place(params, shares, &own, error);
    if (!status)
        status = read_values(sample, program, own, error);
    if (!status)
        status = find_truth(sample, error);
    fp3_params_free(&own);
    sample->count += !status;
    return status;
}

static void append(double *to, size_t count, const double *from, size_t more, size_t width) {
    memcpy(to + count * width, from, more * width * sizeof *to);
}

fp3_status fp3_sample_join(fp3_sample *s, const fp3_sample *other, fp3_error *error) {
    const size_t states = s->model->state_count, count = s->count, more = other->count;
    const fp3_status status = make_room(s, count + more, error);
    if (status || !more)
        return status;
    append(s->params, count, other->params, more, s->model->param_count);
    append(s->initial, count, other->initial, more, states);
    append(s->sizes, count, other->sizes, more, states);
    append(s->truth, count, other->truth, more, FP3_TUNE_LOOKS * states);
    append(s->slopes, count, other->slopes, more, FP3_TUNE_LOOKS * states);
    s->count += more;
    return FP3_OK;
}

double fp3_sample_truth(const fp3_sample *sample, size_t object, unsigned look, uint32_t state,
                        double late) {
    const size_t cell = (object * FP3_TUNE_LOOKS + look) * sample->model->state_count + state;
    return sample->truth[cell] + late * sample->slopes[cell];
}
