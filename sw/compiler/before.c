/* SPDX-License-Identifier: Apache-2.0 */
/* before.c - states at the start, and one step before it. */
#include "before.h"

#include <stdlib.h>

#include "backwards.h"
#include "base/number.h"

static int needs_before(const fp3_step *step) {
    for (uint32_t i = 0; i < step->variable_count; i++)
        if (step->variables[i].role == ROLE_BEFORE)
            return 1;
    return 0;
}

/* Makes (x - x_before) + lost_before in FP32 equal its value in double: else h v would be off by
 * half a unit of x for the whole run, and v by that over h. */
static double lost_before(double x, double before) {
    return (double)(float)((x - before) - ((double)(float)x - (double)(float)before));
}

/* One object, whose numbers are gathered in row. */
static fp3_status follow(const fp3_step *step, fp3_backwards *back, const double *params,
                         const double *initial, double h, size_t count, double *row, double *before,
                         fp3_error *error) {
    const fp3_model *model = step->model;
    const unsigned words = step->known.words;
    double *start = row + model->param_count, *found = start + model->state_count;
    for (uint32_t i = 0; i < model->param_count; i++)
        row[i] = fp3_number_given(params[i * count], words);
    for (uint32_t i = 0; i < model->state_count; i++)
        start[i] = fp3_number_given(initial[i * count], words);
    const fp3_status status =
        fp3_backwards_go(back, row, start, fp3_number_given(h, words), found, error);
    for (uint32_t i = 0; !status && i < model->state_count; i++)
        before[i * count] = found[i];
    return status;
}

static fp3_status follow_all(const fp3_step *step, const double *params, const double *initial,
                             double h, size_t count, double *before, fp3_error *error) {
    const fp3_model *model = step->model;
    double *row = calloc(model->param_count + 2u * model->state_count + 1u, sizeof *row);
    fp3_backwards *back = NULL;
    fp3_status status = row ? fp3_backwards_open(model, &back, error) : fp3_no_memory(error);
    for (size_t i = 0; !status && i < count; i++)
        status = follow(step, back, params + i, initial + i, h, count, row, before + i, error);
    fp3_backwards_close(&back);
    free(row);
    return status;
}

static double start_of(role role, double x, double before) {
    switch (role) {
    case ROLE_STATE:
        return x;
    case ROLE_LOW:
        return fp3_known_low(x);
    case ROLE_BEFORE:
        return before;
    case ROLE_LOW_BEFORE:
        return fp3_known_low(before);
    case ROLE_LOST_BEFORE:
        return lost_before(fp3_number_given(x, 1), before);
    default:
        return 0;
    }
}

fp3_status fp3_before_start(const fp3_step *step, const double *params, const double *initial,
                            double h, size_t count, double *start, fp3_error *error) {
    const fp3_model *model = step->model;
    double *before = calloc(model->state_count * count + 1u, sizeof *before);
    fp3_status status = before ? FP3_OK : fp3_no_memory(error);
    if (!status && needs_before(step))
        status = follow_all(step, params, initial, h, count, before, error);
    for (uint32_t i = 0; !status && i < step->variable_count; i++) {
        const variable *v = &step->variables[i];
        const int is_of_state =
            v->state != FP3_NONE && v->role != ROLE_LIST && v->role != ROLE_WORST;
        const size_t column = is_of_state ? v->state * count : 0;
        for (size_t n = 0; n < count; n++)
            start[i * count + n] = start_of(v->role, initial[column + n], before[column + n]);
    }
    free(before);
    return status;
}
