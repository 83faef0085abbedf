/* SPDX-License-Identifier: Apache-2.0 */
/* stoermer.c - positions within a step, velocities at the end of a run. */
#include "stoermer.h"

static term state_at_begin(lowering *l, uint32_t state) {
    const fp3_advance *a = l->user;
    return fp3_advance_held(a, l->g, ROLE_STATE, state);
}

/* x - x_before: compensated, without what was lost of them. */
static term way_from_before(const fp3_advance *a, dag *g, uint32_t s) {
    const term way = fp3_term_sub(g, fp3_advance_held(a, g, ROLE_STATE, s),
                                  fp3_advance_held(a, g, ROLE_BEFORE, s));
    return a->options->arithmetic != FP3_COMPENSATED
               ? way
               : fp3_term_sub(g, way,
                              fp3_term_sub(g, fp3_advance_held(a, g, ROLE_LOST, s),
                                           fp3_advance_held(a, g, ROLE_LOST_BEFORE, s)));
}

/* (2 x - x_before) + h^2 a; compensated, x + ((x - x_before) + h^2 a). */
static void advance_position(const fp3_advance *a, uint32_t s) {
    const fp3_model *model = a->step->model;
    dag *g = &a->step->values;
    const term x = fp3_advance_held(a, g, ROLE_STATE, s);
    const term f = fp3_lower(&a->places[0], model->states[model->states[s].velocity].derivative);
    const term kick = fp3_term_mul(g, fp3_advance_scaled_step(a, 1, 2), f);
    g->note = fp3_note(&a->step->notes, "new %s", fp3_advance_name(a, s));
    if (a->options->arithmetic != FP3_COMPENSATED) {
        const term twice = fp3_term_mul(g, fp3_term(fp3_dag_number(g, 2)), x);
        const term before = fp3_advance_held(a, g, ROLE_BEFORE, s);
        a->now[s] = fp3_term_add(g, fp3_term_sub(g, twice, before), kick);
        return;
    }
    const term way = way_from_before(a, g, s);
    a->now[s] = fp3_advance_update(a, s, x, fp3_term_add(g, way, kick));
}

/* The velocity at the end of a run: (x - x_before)/h + h/2 a(x). */
static fp3_status find_velocity(fp3_advance *a, uint32_t s, fp3_error *error) {
    dag *g = &a->step->last;
    known_table *known = &a->step->known;
    const uint32_t v = a->step->model->states[s].velocity;
    lowering l;
    fp3_status status = fp3_lower_open(&l, a->step->model, g, error);
    l.state = state_at_begin;
    l.user = a;
    l.notes = &a->step->notes;
    l.place[0] = '1';
    if (!status && a->fit->has_time)
        l.time = fp3_advance_time(a, g, 0);
    if (status) {
        fp3_lower_close(&l);
        return status;
    }
    const term f = fp3_lower(&l, a->step->model->states[v].derivative);
    fp3_lower_close(&l);
    const uint32_t over_h =
        fp3_known_make(known, KNOWN_DIV, fp3_known_number(known, 1), fp3_known_step(known));
    const uint32_t half_h =
        fp3_known_make(known, KNOWN_MUL, fp3_known_number(known, 0.5), fp3_known_step(known));
    g->note = fp3_note(&a->step->notes, "%s at the end", fp3_advance_name(a, v));
    const term way = fp3_term_mul(g, way_from_before(a, g, s), fp3_term(fp3_dag_known(g, over_h)));
    const term end = fp3_term_add(g, way, fp3_term_mul(g, fp3_term(fp3_dag_known(g, half_h)), f));
    a->step->variables[fp3_step_find(a->step, ROLE_STATE, v)].last = fp3_term_value(g, end);
    return FP3_OK;
}

fp3_status fp3_stoermer(fp3_advance *a, fp3_error *error) {
    const fp3_model *model = a->step->model;
    fp3_status status = fp3_advance_places(a, 1, "", state_at_begin, a, error);
    if (!status && a->fit->has_time)
        a->places[0].time = fp3_advance_time(a, &a->step->values, 0);
    for (uint32_t s = 0; !status && s < model->state_count; s++)
        if (fp3_fit_is_live(a->fit, s) && fp3_fit_is_position(a->fit, s)) {
            advance_position(a, s);
            if (fp3_fit_position_of(a->fit, model, model->states[s].velocity) == s)
                status = find_velocity(a, s, error);
        }
    return status;
}
