/* SPDX-License-Identifier: Apache-2.0 */
/* repeat.c - see repeat.h. */
#include "repeat.h"

#include <inttypes.h>
#include <stdlib.h>

int fp3_repeat_loops(const fp3_advance *a) {
    const fp3_model *model = a->step->model;
    int is_fold = 0;
    for (uint32_t e = 0; e < model->expr_count; e++)
        is_fold |= fp3_expr_is_fold(model->exprs[e].op);
    const fp3_coupling *c = a->options->coupling;
    return is_fold && model->repeat_count && !a->is_adaptive && !(c && c->is_one_by_one);
}

/* What the armed expressions of events are made of. */
static char *find_armed(const fp3_model *model) {
    char *is_armed = calloc(model->expr_count + 1u, 1);
    for (uint32_t i = 0; is_armed && i < model->event_count; i++)
        if (model->events[i].armed != FP3_NONE)
            is_armed[model->events[i].armed] = 1;
    for (uint32_t e = model->expr_count; is_armed && e-- > 0;)
        for (int k = 0; is_armed[e] && k < 3; k++)
            if (model->exprs[e].operand[k] != FP3_NONE)
                is_armed[model->exprs[e].operand[k]] = 1;
    return is_armed;
}

/* Whether something behind the first segment reads what the state was when the step began. */
static int is_needed(const fp3_model *model, const char *is_armed, uint32_t state) {
    for (uint32_t e = 0; e < model->expr_count; e++)
        if (model->exprs[e].index == state &&
            (model->exprs[e].op == FP3_EXPR_BEFORE ||
             (model->exprs[e].op == FP3_EXPR_STATE && is_armed[e])))
            return 1;
    return 0;
}

static fp3_status check_armed(const fp3_model *model, const char *is_armed, fp3_error *error) {
    for (uint32_t e = 0; e < model->expr_count; e++)
        if (is_armed[e] && fp3_expr_is_fold(model->exprs[e].op))
            return fp3_fail_at(
                error, FP3_E_PROGRAM, NULL, model->exprs[e].line, model->exprs[e].column,
                "this event compares a sum over neighbours with what it was when "
                "the step began, and `repeat` (line %" PRIu32 ") has changed the neighbours since",
                model->repeats[0].line);
    return FP3_OK;
}

fp3_status fp3_repeat_prepare(fp3_advance *a, fp3_error *error) {
    const fp3_model *model = a->step->model;
    if (!fp3_repeat_loops(a))
        return FP3_OK;
    char *is_armed = find_armed(model);
    a->previous = calloc(model->state_count + 1u, sizeof *a->previous);
    fp3_status status =
        is_armed && a->previous ? check_armed(model, is_armed, error) : fp3_no_memory(error);
    for (uint32_t s = 0; !status && s < model->state_count; s++) {
        a->previous[s] = FP3_NONE;
        if (!fp3_fit_is_live(a->fit, s) || !is_needed(model, is_armed, s))
            continue;
        a->previous[s] = a->step->variable_count;
        if (!fp3_step_add(a->step, ROLE_CARRIED, s))
            status = fp3_no_memory(error);
    }
    free(is_armed);
    return status;
}

/* What a variable gets at the end of a segment. */
static uint32_t next_of(const fp3_advance *a, uint32_t i) {
    const variable *v = &a->step->variables[i];
    dag *g = &a->step->values;
    switch (v->role) {
    case ROLE_STATE:
        return fp3_advance_next(a, i, a->now[v->state]);
    case ROLE_LOST:
        return fp3_advance_next(a, i, a->lost[v->state]);
    case ROLE_CARRIED:
        return a->step->segment_count ? FP3_NONE
                                      : fp3_advance_held(a, g, ROLE_STATE, v->state).node;
    default:
        return FP3_NONE;
    }
}

fp3_status fp3_repeat_cut(fp3_advance *a, uint32_t times, fp3_error *error) {
    for (uint32_t i = 0; i < a->step->variable_count; i++)
        a->step->variables[i].next = next_of(a, i);
    if (!fp3_step_cut(a->step, times))
        return fp3_no_memory(error);
    fp3_advance_begin(a);
    return FP3_OK;
}
