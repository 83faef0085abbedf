/* SPDX-License-Identifier: Apache-2.0 */
/* events.c - a condition, and a selection for each state that it changes. */
#include "events.h"

#include "compiler/adaptive/root.h"
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
    if (!status && fp3_root_is(a, event)) {
        const fp3_reach r = fp3_root_reach(a, event, &before, l);
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
