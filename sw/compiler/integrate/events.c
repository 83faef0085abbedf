/* events.c - a condition, and a selection for each state that it changes. */
#include "events.h"

#include "compiler/value/fold.h"

#include <fp3/isa.h>
#include <inttypes.h>
#include <stdio.h>

static term state_now(lowering *l, uint32_t state) {
    const fp3_advance *a = l->user;
    return a->now[state];
}

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

/* All values come from the states before any of them changes. */
static void fire(const fp3_advance *a, const fp3_event *event, lowering *l) {
    const fp3_model *model = a->step->model;
    const fp3_assignment *list = &model->assignments[event->first];
    term value[FP3_STATES_MAX];
    const uint32_t condition = fp3_lower(l, event->condition).node; /* -x is 0 where x is */
    for (uint32_t i = 0; i < event->count; i++)
        if (fp3_fit_is_live(a->fit, list[i].state))
            value[i] = fp3_lower(l, list[i].expr);
    for (uint32_t i = 0; i < event->count; i++)
        if (fp3_fit_is_live(a->fit, list[i].state))
            set(a, event, list[i].state, condition, value[i]);
}

fp3_status fp3_events(fp3_advance *a, fp3_error *error) {
    const fp3_model *model = a->step->model;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < model->event_count; i++) {
        const fp3_event *event = &model->events[i];
        lowering l;
        if (!fp3_fit_has_event(a->fit, model, event))
            continue;
        status = fp3_lower_open(&l, model, &a->step->values, error);
        l.state = state_now;
        l.user = a;
        l.notes = &a->step->notes;
        snprintf(l.place, sizeof l.place, "line %" PRIu32, event->line);
        if (!status && a->fit->has_time)
            l.time = fp3_advance_time(a, l.g, 1);
        if (!status)
            fire(a, event, &l);
        fp3_lower_close(&l);
    }
    return status;
}
