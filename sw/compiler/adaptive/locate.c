/* locate.c - whether a condition has become true within the step. */
#include "locate.h"

#include "compiler/value/ops.h"

#include <inttypes.h>
#include <stdio.h>

static term state_after(lowering *l, uint32_t state) {
    const fp3_advance *a = l->user;
    return a->now[state];
}

static term state_before(lowering *l, uint32_t state) {
    const fp3_advance *a = l->user;
    return fp3_advance_held(a, l->g, ROLE_STATE, state);
}

static fp3_status open_at(const fp3_advance *a, const fp3_event *event, int is_after, lowering *l,
                          fp3_error *error) {
    const fp3_status status = fp3_lower_open(l, a->step->model, &a->step->values, error);
    l->state = is_after ? state_after : state_before;
    l->user = (void *)a;
    l->notes = &a->step->notes;
    snprintf(l->place, sizeof l->place, "line %" PRIu32, event->line);
    if (!status && a->fit->has_time)
        l->time = fp3_advance_time(a, l->g, is_after);
    return status;
}

static uint32_t either(dag *g, uint32_t a, uint32_t b) { return sel(g, a, num(g, 1), b); }

/* Whether so_far, or a part of the condition that it needs (is_true: to be true) was so before the step, and no
 * longer is. */
static uint32_t has_lost(lowering *before, lowering *after, uint32_t expr, int is_true,
                         uint32_t so_far) {
    const fp3_expr *e = &before->model->exprs[expr];
    dag *g = before->g;
    if (e->op == FP3_EXPR_NOT)
        return has_lost(before, after, e->operand[0], !is_true, so_far);
    if (e->op == FP3_EXPR_AND || e->op == FP3_EXPR_OR)
        return has_lost(before, after, e->operand[1], is_true,
                        has_lost(before, after, e->operand[0], is_true, so_far));
    const uint32_t b = fp3_lower(before, expr).node, a = fp3_lower(after, expr).node;
    const uint32_t lost = is_true ? sel(g, a, num(g, 0), b) : sel(g, b, num(g, 0), a);
    return either(g, lost, so_far);
}

/* Whether the condition is false before the step, and true after it or, as far as its parts tell, on the way: `x > wall
 * and v > 0` may be on the way if v > 0 is no longer true, as x then has been largest within the step. If no part of it is lost, it is
 * true on the way only if it is in the end. */
static uint32_t becomes(const fp3_advance *a, const fp3_event *event, lowering *before,
                        lowering *after) {
    const fp3_expr_op op = a->step->model->exprs[event->condition].op;
    const int has_parts = op == FP3_EXPR_AND || op == FP3_EXPR_OR || op == FP3_EXPR_NOT;
    dag *g = before->g;
    const uint32_t is_before = fp3_lower(before, event->condition).node;
    const uint32_t is_after = fp3_lower(after, event->condition).node;
    g->note = fp3_note(&a->step->notes, "line %" PRIu32 ": becomes true", event->line);
    return sel(g, is_before, num(g, 0),
               has_parts ? has_lost(before, after, event->condition, 1, is_after) : is_after);
}

fp3_status fp3_locate(const fp3_advance *a, uint32_t *is_late, fp3_error *error) {
    const fp3_model *model = a->step->model;
    dag *g = &a->step->values;
    fp3_status status = FP3_OK;
    uint32_t any = FP3_NONE;
    for (uint32_t i = 0; !status && i < model->event_count; i++) {
        const fp3_event *event = &model->events[i];
        lowering before = {0}, after = {0};
        if (!fp3_fit_has_event(a->fit, model, event))
            continue;
        status = open_at(a, event, 0, &before, error);
        if (!status)
            status = open_at(a, event, 1, &after, error);
        if (!status) {
            const uint32_t it = becomes(a, event, &before, &after);
            any = any == FP3_NONE ? it : sel(g, it, num(g, 1), any);
        }
        fp3_lower_close(&before);
        fp3_lower_close(&after);
    }
    if (status || any == FP3_NONE)
        return status;
    const uint32_t locate = fp3_dag_known(g, fp3_known_param(g->known, "locate"));
    *is_late = sel(g, any, op2(g, FP3_OP_LT, locate, a->h.node), num(g, 0));
    return FP3_OK;
}
