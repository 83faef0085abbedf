/* SPDX-License-Identifier: Apache-2.0 */
/* project.c - the value that a projection gives or, compensated, its increment.
 *
 * A compensated state has more digits than its value: the rounding errors of its updates are in
 * a->lost. So a projection is one more increment. The increment of x E is x (E - 1), and E - 1 is
 * exact if E is near 1. It moves x along itself, so rounding errors change the length alone, which
 * the next projection corrects.
 */
#include "project.h"

#include "lu.h"
#include "repeat.h"

#include <inttypes.h>

static int is_state(const fp3_model *model, uint32_t expr, uint32_t state) {
    return model->exprs[expr].op == FP3_EXPR_STATE && model->exprs[expr].index == state;
}

/* E - 1 of x E, E x and x/E; a term without a node for what is none of these. */
static term less_one(lowering *l, const fp3_assignment *to) {
    const fp3_expr *e = &l->model->exprs[to->expr];
    const term one = fp3_term(fp3_dag_number(l->g, 1));
    if (e->op == FP3_EXPR_MUL && is_state(l->model, e->operand[0], to->state))
        return fp3_term_sub(l->g, fp3_lower(l, e->operand[1]), one);
    if (e->op == FP3_EXPR_MUL && is_state(l->model, e->operand[1], to->state))
        return fp3_term_sub(l->g, fp3_lower(l, e->operand[0]), one);
    if (e->op != FP3_EXPR_DIV || !is_state(l->model, e->operand[0], to->state))
        return fp3_term(FP3_NONE);
    const term by = fp3_lower(l, e->operand[1]);
    return fp3_term_mul(l->g, fp3_term_sub(l->g, one, by), fp3_one_over(l->g, by));
}

/* What is added to the state, compensated, or else its new value. */
static term move_of(const fp3_advance *a, lowering *l, const fp3_assignment *to) {
    if (a->options->arithmetic != FP3_COMPENSATED)
        return fp3_lower(l, to->expr);
    const term share = less_one(l, to);
    return share.node == FP3_NONE ? fp3_term_sub(l->g, fp3_lower(l, to->expr), a->now[to->state])
                                  : fp3_term_mul(l->g, a->now[to->state], share);
}

/* All moves come from the states before any of them changes. */
static void project(const fp3_advance *a, const fp3_event *event, lowering *l) {
    const fp3_assignment *list = &a->step->model->assignments[event->first];
    term move[FP3_STATES_MAX];
    for (uint32_t i = 0; i < event->count; i++)
        if (fp3_fit_is_live(a->fit, list[i].state))
            move[i] = move_of(a, l, &list[i]);
    for (uint32_t i = 0; i < event->count; i++) {
        const uint32_t s = list[i].state;
        if (!fp3_fit_is_live(a->fit, s))
            continue;
        l->g->note = fp3_note(&a->step->notes, "line %" PRIu32 ": new %s", event->line,
                              fp3_advance_name(a, s));
        a->now[s] = a->options->arithmetic == FP3_COMPENSATED
                        ? fp3_advance_update(a, s, a->now[s], move[i])
                        : move[i];
    }
}

static fp3_status project_all(fp3_advance *a, uint32_t first, uint32_t end, fp3_error *error) {
    const fp3_model *model = a->step->model;
    fp3_status status = FP3_OK;
    for (uint32_t i = first; !status && i < end; i++, a->projected++) {
        lowering l;
        if (!fp3_fit_has_event(a->fit, model, &model->projections[i]))
            continue;
        status = fp3_advance_event(a, &model->projections[i], 1, &l, error);
        if (!status) {
            fp3_advance_show(a, &l);
            project(a, &model->projections[i], &l);
        }
        fp3_lower_close(&l);
    }
    return status;
}

static fp3_status repeat(fp3_advance *a, const fp3_repeat *r, fp3_error *error) {
    const uint32_t end = r->first + r->count;
    int is_live = 0;
    for (uint32_t i = r->first; i < end; i++)
        is_live |= fp3_fit_has_event(a->fit, a->step->model, &a->step->model->projections[i]);
    const int loops = fp3_repeat_loops(a) && r->times > 1;
    if (!is_live) {
        a->projected += loops ? r->count : r->count * r->times;
        return FP3_OK;
    }
    fp3_status status = loops ? fp3_repeat_cut(a, 0, error) : FP3_OK;
    for (uint32_t i = 0; !status && i < (loops ? 1 : r->times); i++)
        status = project_all(a, r->first, end, error);
    return status || !loops ? status : fp3_repeat_cut(a, r->times, error);
}

fp3_status fp3_project(fp3_advance *a, fp3_error *error) {
    const fp3_model *model = a->step->model;
    fp3_status status = FP3_OK;
    uint32_t made = 0;
    for (uint32_t i = 0; !status && i < model->repeat_count; i++) {
        const fp3_repeat *r = &model->repeats[i];
        status = project_all(a, made, r->first, error);
        if (!status)
            status = repeat(a, r, error);
        made = r->first + r->count;
    }
    return status ? status : project_all(a, made, model->projection_count, error);
}
