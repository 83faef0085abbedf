/* events.c - a condition, and a selection for each state that it changes. */
#include "events.h"

#include "compiler/value/ops.h"

#include <fp3/isa.h>
#include <inttypes.h>

static uint32_t chosen(dag *g, uint32_t condition, term then, term otherwise) {
    return fp3_fold(g, FP3_OP_SEL, fp3_term_value(g, then), fp3_term_value(g, otherwise),
                    condition);
}

/* A state that the event sets has no rounding error yet. */
static void set(const fp3_advance *a, const fp3_event *event, uint32_t state, uint32_t condition,
                term value) {
    dag *g = &a->step->values;
    const char *name = fp3_advance_name(a, state);
    g->note = fp3_note(&a->step->notes, "line %" PRIu32 ": new %s", event->line, name);
    a->now[state] = fp3_term(chosen(g, condition, value, a->now[state]));
    if (a->options->arithmetic != FP3_COMPENSATED)
        return;
    g->note = fp3_note(&a->step->notes, "line %" PRIu32 ": what is lost of %s", event->line, name);
    const term none = fp3_term(fp3_dag_number(g, 0));
    a->lost[state] = fp3_term(chosen(g, condition, none, a->lost[state]));
}

/* Whether it compares t itself with a time that is known, at which steps end. */
static int is_timed(const fp3_advance *a, const fp3_event *event) {
    const fp3_model *model = a->step->model;
    const fp3_expr *e = &model->exprs[event->condition];
    int has_end = !a->is_adaptive; /* there nothing is looked for */
    for (uint32_t i = 0; i < a->switchings.count; i++)
        has_end |= a->switchings.expr[i] == event->condition;
    return has_end && model->exprs[e->operand[0]].is_known &&
           model->exprs[e->operand[1]].op == FP3_EXPR_TIME;
}

int fp3_event_is_root(const fp3_advance *a, const fp3_event *event) {
    return event->armed != FP3_NONE && !is_timed(a, event);
}

/* What the condition of a root is the sign of: b - a of a <= b. */
static term gap(lowering *l, const fp3_expr *e) {
    const term a = fp3_lower(l, e->operand[0]), b = fp3_lower(l, e->operand[1]);
    if (fp3_dag_is_number(l->g, a.node, 0))
        return b;
    return fp3_dag_is_number(l->g, b.node, 0) ? fp3_term_negated(a) : fp3_term_sub(l->g, b, a);
}

/* Of a pair the first word has its sign. A NaN before the step is below no root; one after it stays. */
fp3_reach fp3_event_reach(const fp3_advance *a, const fp3_event *event, lowering *before,
                          lowering *after) {
    dag *g = &a->step->values;
    const fp3_model *model = a->step->model;
    const fp3_expr *e = &model->exprs[event->condition];
    const uint32_t op =
        model->exprs[event->armed].op == FP3_EXPR_LESS_EQUAL ? FP3_OP_LE : FP3_OP_LT;
    const term g0 = gap(before, e), g1 = gap(after, e);
    const int is_falling = g0.is_negative && g1.is_negative;
    g->note = fp3_note(&a->step->notes, "line %" PRIu32 ": on which side of the root", event->line);
    const uint32_t from = fp3_dag_first(g, is_falling ? g0.node : fp3_term_value(g, g0));
    const uint32_t to = fp3_dag_first(g, is_falling ? g1.node : fp3_term_value(g, g1));
    const uint32_t zero = num(g, 0);
    const uint32_t is_armed = is_falling ? op2(g, op, zero, from) : op2(g, op, from, zero);
    return (fp3_reach){from, sel(g, is_armed, to, num(g, is_falling ? 1 : -1)), is_falling};
}

/* Whether it happens. */
static fp3_status happens(const fp3_advance *a, const fp3_event *event, lowering *l,
                          uint32_t *condition, fp3_error *error) {
    dag *g = &a->step->values;
    lowering before = {0};
    if (event->armed == FP3_NONE) {
        *condition = fp3_lower(l, event->condition).node;
        return FP3_OK;
    }
    const fp3_status status = fp3_advance_event(a, event, 0, &before, error);
    if (!status && fp3_event_is_root(a, event)) {
        const fp3_reach r = fp3_event_reach(a, event, &before, l);
        g->note = fp3_note(&a->step->notes, "line %" PRIu32 ": is the root reached", event->line);
        *condition =
            r.is_falling ? op2(g, FP3_OP_LE, r.to, num(g, 0)) : op2(g, FP3_OP_LE, num(g, 0), r.to);
    } else if (!status) {
        const uint32_t is = fp3_lower(l, event->condition).node;
        const uint32_t was = fp3_lower(&before, event->armed).node;
        g->note = fp3_note(&a->step->notes, "line %" PRIu32 ": becomes true", event->line);
        *condition = sel(g, was, is, num(g, 0));
    }
    fp3_lower_close(&before);
    return status;
}

/* All values come from the states before any of them changes. */
static void fire(fp3_advance *a, const fp3_event *event, lowering *l, uint32_t condition) {
    const fp3_model *model = a->step->model;
    const fp3_assignment *list = &model->assignments[event->first];
    term value[FP3_STATES_MAX];
    for (uint32_t i = 0; i < event->count; i++)
        if (fp3_fit_is_live(a->fit, list[i].state))
            value[i] = fp3_lower(l, list[i].expr);
    for (uint32_t i = 0; i < event->count; i++)
        if (fp3_fit_is_live(a->fit, list[i].state))
            set(a, event, list[i].state, condition, value[i]);
    if (!event->stops)
        return;
    a->step->values.note = fp3_note(&a->step->notes, "line %" PRIu32 ": stop", event->line);
    a->stops = a->stops == FP3_NONE
                   ? condition
                   : chosen(&a->step->values, condition,
                            fp3_term(fp3_dag_number(&a->step->values, 1)), fp3_term(a->stops));
}

fp3_status fp3_events(fp3_advance *a, fp3_error *error) {
    const fp3_model *model = a->step->model;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < model->event_count; i++) {
        const fp3_event *event = &model->events[i];
        uint32_t condition = FP3_NONE;
        lowering l;
        if (!fp3_fit_has_event(a->fit, model, event))
            continue;
        status = fp3_advance_event(a, event, 1, &l, error);
        if (!status)
            status = happens(a, event, &l, &condition, error);
        if (!status)
            fire(a, event, &l, condition);
        fp3_lower_close(&l);
    }
    return status;
}
