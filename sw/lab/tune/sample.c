/* SPDX-License-Identifier: Apache-2.0 */
/* sample.c - see sample.h. */
#include "sample.h"

#include "base/number.h"
#include "world/apply.h"
#include "world/values.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LOOKS 64
#define STILL 1e-9 /* of a state's size */

uint32_t fp3_sample_ranges(const fp3_params *params) {
    uint32_t ranges = 0;
    fp3_value_look look;
    for (size_t i = 0; fp3_values_look(params, i, &look); i++)
        ranges += look.is_spread != 0;
    return ranges;
}

void fp3_sample_open(fp3_sample *sample, const fp3_model *model, double span) {
    *sample = (fp3_sample){.model = model, .span = span};
}

void fp3_sample_close(fp3_sample *sample) {
    for (size_t i = 0; i < sample->count; i++)
        fp3_path_close(&sample->paths[i]);
    free(sample->paths);
    free(sample->params);
    free(sample->initial);
    free(sample->sizes);
    free(sample->there);
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
    fp3_path **paths = realloc(s->paths, count * sizeof *paths);
    if (paths)
        s->paths = paths;
    if (!paths || !grow(&s->params, count, s->model->param_count) ||
        !grow(&s->initial, count, states) || !grow(&s->sizes, count, states) ||
        !grow(&s->there, 2, states))
        return fp3_no_memory(error);
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

static fp3_status find_truth(fp3_sample *s, fp3_error *error) {
    const size_t states = s->model->state_count;
    fp3_error why;
    const fp3_status status = fp3_path_open(
        s->model, s->params + s->count * s->model->param_count, s->initial + s->count * states,
        s->span, s->sizes + s->count * states, &s->paths[s->count], &why);
    if (status == FP3_E_ARGUMENT || status == FP3_E_MISMATCH)
        return fp3_fail(error, FP3_E_FAILED, "no truth to measure errors against: %s", why.text);
    return status ? fp3_fail(error, status, "%s", why.text) : FP3_OK;
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

fp3_status fp3_sample_join(fp3_sample *s, fp3_sample *other, fp3_error *error) {
    const size_t states = s->model->state_count, count = s->count, more = other->count;
    const fp3_status status = make_room(s, count + more, error);
    if (status || !more)
        return status;
    append(s->params, count, other->params, more, s->model->param_count);
    append(s->initial, count, other->initial, more, states);
    append(s->sizes, count, other->sizes, more, states);
    memcpy(s->paths + count, other->paths, more * sizeof *s->paths);
    s->count += more;
    other->count = 0;
    return FP3_OK;
}

/* ---- errors ---- */

double fp3_sample_error(const fp3_sample *s, size_t object, double t, const double *states) {
    const fp3_path_scale scale = {s->sizes + object * s->model->state_count, s->span, s->there};
    return fp3_path_error(s->paths[object], &scale, t, states);
}

/* By more than a path is exact. */
static int moves(const fp3_sample *s, size_t object) {
    const size_t states = s->model->state_count;
    for (int n = 1; n <= LOOKS; n++) {
        fp3_path_at(s->paths[object], s->span * n / LOOKS, s->there);
        for (size_t k = 0; k < states; k++) {
            const double way = fabs(s->there[k] - s->initial[object * states + k]);
            if (way > STILL * s->sizes[object * states + k] || isnan(way))
                return 1;
        }
    }
    return 0;
}

int fp3_sample_moves(const fp3_sample *s) {
    for (size_t i = 0; i < s->count; i++)
        if (moves(s, i))
            return 1;
    return 0;
}

double fp3_sample_gap(const fp3_sample *s, double t) {
    double worst = 0, *end = s->there + s->model->state_count;
    for (size_t i = 0; i < s->count; i++) {
        fp3_path_at(s->paths[i], s->span, end);
        worst = fmax(worst, fp3_sample_error(s, i, t, end));
    }
    return worst;
}
