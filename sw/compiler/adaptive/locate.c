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

static fp3_status condition_at(const fp3_advance *a, const fp3_event *event, int is_after,
                               uint32_t *node, fp3_error *error) {
    lowering l;
    fp3_status status = fp3_lower_open(&l, a->step->model, &a->step->values, error);
    l.state = is_after ? state_after : state_before;
    l.user = (void *)a;
    l.notes = &a->step->notes;
    snprintf(l.place, sizeof l.place, "line %" PRIu32, event->line);
    if (!status && a->fit->has_time)
        l.time = fp3_advance_time(a, l.g, is_after);
    if (!status)
        *node = fp3_lower(&l, event->condition).node; /* -x is 0 where x is */
    fp3_lower_close(&l);
    return status;
}

fp3_status fp3_locate(const fp3_advance *a, uint32_t *is_late, fp3_error *error) {
    const fp3_model *model = a->step->model;
    dag *g = &a->step->values;
    fp3_status status = FP3_OK;
    uint32_t any = FP3_NONE;
    for (uint32_t i = 0; !status && i < model->event_count; i++) {
        const fp3_event *event = &model->events[i];
        uint32_t before = FP3_NONE, after = FP3_NONE;
        if (!fp3_fit_has_event(a->fit, model, event))
            continue;
        status = condition_at(a, event, 0, &before, error);
        if (!status)
            status = condition_at(a, event, 1, &after, error);
        if (status)
            break;
        g->note = fp3_note(&a->step->notes, "line %" PRIu32 ": becomes true", event->line);
        const uint32_t becomes = sel(g, before, num(g, 0), after);
        any = any == FP3_NONE ? becomes : sel(g, becomes, num(g, 1), any);
    }
    if (status || any == FP3_NONE)
        return status;
    const uint32_t locate = fp3_dag_known(g, fp3_known_param(g->known, "locate"));
    *is_late = sel(g, any, op2(g, FP3_OP_LT, locate, a->h.node), num(g, 0));
    return FP3_OK;
}
