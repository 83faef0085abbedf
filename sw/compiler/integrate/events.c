/* SPDX-License-Identifier: Apache-2.0 */
/* events.c - a condition, and a selection for each state that it changes. */
#include "events.h"

#include "compiler/adaptive/root.h"
#include "compiler/value/ops.h"

#include <fp3/isa.h>
#include <inttypes.h>

/* Whether an event happens: if the node is not 0, or, where it is the opposite, if it is. */
typedef struct {
    uint32_t node;
    int is_opposite;
} occurrence;

static uint32_t chosen(dag *g, occurrence when, term then, term otherwise) {
    const uint32_t a = fp3_term_value(g, then), b = fp3_term_value(g, otherwise);
    return when.is_opposite ? sel(g, when.node, b, a) : sel(g, when.node, a, b);
}

/* A state that the event sets has no rounding error yet. */
static void set(const fp3_advance *a, const fp3_event *event, uint32_t state, occurrence when,
                term value) {
    dag *g = &a->step->values;
    const char *name = fp3_advance_name(a, state);
    g->note = fp3_note(&a->step->notes, "line %" PRIu32 ": new %s", event->line, name);
    a->now[state] = fp3_term(chosen(g, when, value, a->now[state]));
    if (a->options->arithmetic != FP3_COMPENSATED)
        return;
    g->note = fp3_note(&a->step->notes, "line %" PRIu32 ": what is lost of %s", event->line, name);
    const term none = fp3_term(fp3_dag_number(g, 0));
    a->lost[state] = fp3_term(chosen(g, when, none, a->lost[state]));
}

/* Whether it happens. */
static fp3_status happens(const fp3_advance *a, const fp3_event *event, lowering *l,
                          occurrence *when, fp3_error *error) {
    dag *g = &a->step->values;
    lowering before = {0};
    if (event->armed == FP3_NONE) {
        when->node = fp3_lower(l, event->condition).node;
        return FP3_OK;
    }
    const fp3_status status = fp3_advance_event(a, event, 0, &before, error);
    if (!status && fp3_root_is(a, event)) {
        const fp3_reach r = fp3_root_reach(a, event, &before, l);
        if (a->is_adaptive) { /* the search needs it; a step that ends without a value is not
                                 accepted */
            *when = (occurrence){fp3_root_is_ahead(a, event, &r), 1};
        } else {
            g->note =
                fp3_note(&a->step->notes, "line %" PRIu32 ": is the root reached", event->line);
            when->node = r.is_falling ? op2(g, FP3_OP_LE, r.to, num(g, 0))
                                      : op2(g, FP3_OP_LE, num(g, 0), r.to);
        }
    } else if (!status) {
        const uint32_t is = fp3_lower(l, event->condition).node;
        const uint32_t was = fp3_lower(&before, event->armed).node;
        g->note = fp3_note(&a->step->notes, "line %" PRIu32 ": becomes true", event->line);
        when->node = sel(g, was, is, num(g, 0));
    }
    fp3_lower_close(&before);
    return status;
}

/* All values come from the states before any of them changes. */
static void fire(fp3_advance *a, const fp3_event *event, lowering *l, occurrence when) {
    const fp3_model *model = a->step->model;
    const fp3_assignment *list = &model->assignments[event->first];
    term value[FP3_STATES_MAX];
    for (uint32_t i = 0; i < event->count; i++)
        if (fp3_fit_is_live(a->fit, list[i].state))
            value[i] = fp3_lower(l, list[i].expr);
    for (uint32_t i = 0; i < event->count; i++)
        if (fp3_fit_is_live(a->fit, list[i].state))
            set(a, event, list[i].state, when, value[i]);
    if (event->stops != FP3_STOPS)
        return;
    a->step->values.note = fp3_note(&a->step->notes, "line %" PRIu32 ": stop", event->line);
    const term yes = fp3_term(num(&a->step->values, 1));
    const term so_far = fp3_term(a->stops == FP3_NONE ? num(&a->step->values, 0) : a->stops);
    a->stops = a->stops == FP3_NONE && !when.is_opposite
                   ? when.node
                   : chosen(&a->step->values, when, yes, so_far);
}

fp3_status fp3_events(fp3_advance *a, fp3_error *error) {
    const fp3_model *model = a->step->model;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < model->event_count; i++) {
        const fp3_event *event = &model->events[i];
        occurrence when = {FP3_NONE, 0};
        lowering l;
        if (!fp3_fit_has_event(a->fit, model, event))
            continue;
        status = fp3_advance_event(a, event, 1, &l, error);
        if (!status)
            fp3_advance_show(a, &l);
        if (!status)
            status = happens(a, event, &l, &when, error);
        if (!status)
            fire(a, event, &l, when);
        fp3_lower_close(&l);
    }
    return status;
}
