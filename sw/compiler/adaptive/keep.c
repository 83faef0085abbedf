/* SPDX-License-Identifier: Apache-2.0 */
/* keep.c - if a step is accepted, the next step begins with the slopes of the stage at its end. */
#include "keep.h"

#include "compiler/value/ops.h"
#include "language/turn.h"

#include <fp3/compile.h>

static int is_first_of_any(const fp3_step *step, uint32_t node) {
    for (uint32_t i = 0; i < step->variable_count; i++)
        if (step->variables[i].first == node)
            return 1;
    return 0;
}

fp3_status fp3_keep(fp3_step *step, uint32_t first, uint32_t next, fp3_error *error) {
    if (!fp3_step_add(step, ROLE_CARRIED, FP3_NONE))
        return fp3_no_memory(error);
    step->variables[step->variable_count - 1].first = first;
    step->variables[step->variable_count - 1].next = next;
    return FP3_OK;
}

/* The slopes at the new states are the first slopes of the next step; after a rejected step the old
 * slopes are. In double-single each slope would be two variables. If an event may change the new
 * states, or time the equations, the slopes are computed again. */
static fp3_status keep_slopes(const fp3_advance *a, fp3_error *error) {
    dag *g = &a->step->values;
    fp3_status status = FP3_OK;
    if (!a->has_slope || g->is_abstract || !fp3_has_pass(a->options, FP3_PASS_CARRY) ||
        a->switchings.count || fp3_fit_has_events(a->fit, a->step->model) ||
        fp3_fit_has_projections(a->fit, a->step->model))
        return FP3_OK;
    for (uint32_t s = 0; !status && s < a->step->model->state_count; s++) {
        if (!fp3_fit_is_moved(a->fit, s))
            continue;
        const term f = fp3_lower(&a->places[0], a->step->model->states[s].derivative);
        const term to = f.is_negative ? fp3_term_negated(a->slope[s]) : a->slope[s];
        if (fp3_dag_is_leaf(g, f.node) || is_first_of_any(a->step, f.node))
            continue;
        g->note = fp3_note(&a->step->notes, "first slope of %s for the next step",
                           fp3_advance_name(a, s));
        status =
            fp3_keep(a->step, f.node, sel(g, a->is_good, fp3_term_value(g, to), f.node), error);
    }
    return status;
}

/* Whether the expression is made of t and what is known, and no step ends where it changes. */
static int is_of_time(const fp3_advance *a, uint32_t expr) {
    const fp3_expr *e = &a->step->model->exprs[expr];
    const int dependence = FP3_TURN_TIME | FP3_TURN_STATE;
    int is = (a->switchings.kind[expr] & dependence) == FP3_TURN_TIME && !fp3_turn_can(e->op);
    for (int k = 0; is && k < 3; k++)
        is = e->operand[k] == FP3_NONE || !(a->switchings.kind[e->operand[k]] & dependence) ||
             is_of_time(a, e->operand[k]);
    return is;
}

/* Whether something else of t is made of it. */
static int is_part(const fp3_advance *a, const lowering *l, uint32_t expr) {
    const fp3_model *model = a->step->model;
    for (uint32_t i = expr + 1; i < model->expr_count; i++)
        for (int k = 0; l->is_made[i] && k < 3; k++)
            if (model->exprs[i].operand[k] == expr && is_of_time(a, i))
                return 1;
    return 0;
}

/* The next step begins with the functions of t from the stage at the end of this step; after a
 * rejected step, with the old ones. This pays for functions. */
static fp3_status keep_times(const fp3_advance *a, fp3_error *error) {
    dag *g = &a->step->values;
    fp3_status status = FP3_OK;
    uint32_t last = 0;
    while (last < a->place_count && a->places[last].time.node != a->end.node)
        last++;
    if (!a->fit->has_time || g->is_abstract || !fp3_has_pass(a->options, FP3_PASS_CARRY) ||
        last == a->place_count)
        return FP3_OK;
    const lowering *from = &a->places[0], *to = &a->places[last];
    for (uint32_t i = 0; !status && i < a->step->model->expr_count; i++) {
        if (!from->is_made[i] || !to->is_made[i] || !is_of_time(a, i) || is_part(a, from, i))
            continue;
        const term f = from->value[i], next = to->value[i];
        if (f.is_negative != next.is_negative || fp3_dag_is_leaf(g, f.node) ||
            is_first_of_any(a->step, f.node))
            continue;
        g->note = fp3_note(&a->step->notes, "%s", "for the next step, of t");
        status = fp3_keep(a->step, f.node, sel(g, a->is_good, next.node, f.node), error);
    }
    return status;
}

fp3_status fp3_keep_stages(const fp3_advance *a, fp3_error *error) {
    const fp3_status status = keep_slopes(a, error);
    return status ? status : keep_times(a, error);
}
