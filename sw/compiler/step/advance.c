/* SPDX-License-Identifier: Apache-2.0 */
/* advance.c - places, coefficients and updates. */
#include "advance.h"

#include "compiler/value/ops.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Places that sums over other kinds cannot have. */
#define UNSEEN_PROJECTION 0x10000u
#define UNSEEN_EVENT 0x20000u
#define REMEMBER 0x30000u

#define COEFFICIENT_ERROR 1e-9 /* of a table's row sums; the order conditions allow 1e-10 */

fp3_status fp3_advance_places(fp3_advance *a, uint32_t count, const char *prefix,
                              term (*state)(lowering *l, uint32_t state), void *user,
                              fp3_error *error) {
    a->places = calloc(count + 1u, sizeof *a->places);
    if (!a->places)
        return fp3_no_memory(error);
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < count; i++) {
        lowering *l = &a->places[i];
        status = fp3_lower_open(l, a->step->model, &a->step->values, error);
        l->state = state;
        l->user = user;
        l->notes = &a->step->notes;
        l->index = i;
        l->sight = &a->step->sight;
        l->inside = a->inside.model ? &a->inside : NULL;
        l->kind = a->switchings.kind;
        snprintf(l->place, sizeof l->place, "%s%" PRIu32, prefix, i + 1);
        a->place_count = i + 1;
    }
    return status;
}

void fp3_advance_begin(fp3_advance *a) {
    fp3_step *step = a->step;
    if (fp3_advance_may_stop(a))
        step->sight.stopped = fp3_advance_held(a, &step->values, ROLE_STOPPED, FP3_NONE).node;
    for (uint32_t i = 0; i < step->variable_count; i++) {
        const variable *v = &step->variables[i];
        if (v->role == ROLE_STATE) {
            a->now[v->state] = fp3_term(fp3_dag_variable(&step->values, i));
            step->sight.start[v->state] = a->now[v->state].node;
        }
        if (v->role == ROLE_LOST)
            a->lost[v->state] = fp3_term(fp3_dag_variable(&step->values, i));
    }
}

uint32_t fp3_advance_next(const fp3_advance *a, uint32_t variable, term next) {
    dag *g = &a->step->values;
    const uint32_t node = fp3_term_value(g, next);
    const struct variable *v = &a->step->variables[variable];
    if (!fp3_advance_may_stop(a) || (v->role == ROLE_STATE && a->fit->control >> v->state & 1))
        return node;
    g->note = fp3_note(&a->step->notes, "nothing changes in an object that has stopped");
    return sel(g, a->step->sight.stopped, fp3_dag_variable(g, variable), node);
}

static int has_slope(const fp3_model *model, uint32_t state) {
    const fp3_expr *derivative = &model->exprs[model->states[state].derivative];
    return derivative->op != FP3_EXPR_NUMBER || derivative->number != 0;
}

/* If nothing ever changes a state, a step has an instruction that adds 0, because a step must not
 * be empty. */
int fp3_advance_rests(const fp3_advance *a, uint32_t state) {
    const fp3_model *model = a->step->model;
    int moves = a->is_adaptive;
    for (uint32_t i = 0; i < model->assignment_count; i++)
        moves |= fp3_fit_is_live(a->fit, model->assignments[i].state);
    for (uint32_t s = 0; !moves && s < model->state_count; s++)
        moves = fp3_fit_is_moved(a->fit, s) && has_slope(model, s);
    return moves && fp3_has_pass(a->options, FP3_PASS_ZERO) && !has_slope(model, state);
}

term fp3_advance_held(const fp3_advance *a, dag *g, role role, uint32_t state) {
    return fp3_term(fp3_dag_variable(g, fp3_step_find(a->step, role, state)));
}

/* Both words of t and c h, rounded to one. */
static term own_time(const fp3_advance *a, dag *g, double c) {
    const int is_end = fabs(c - 1) < COEFFICIENT_ERROR, is_begin = fabs(c) < COEFFICIENT_ERROR;
    const uint32_t outside = g->note;
    if (is_begin || is_end)
        return is_end ? a->end : a->begin;
    g->note = fp3_note(&a->step->notes, "t + %.6g h", c);
    const term moved = fp3_advance_scaled_step(a, c, 1);
    const term since = g->is_abstract ? moved : fp3_term_add(g, a->begin_low, moved);
    const term t = fp3_term_add(g, a->begin, since);
    g->note = outside;
    return t;
}

/* n h, or (n + 1) h: one rounding each, and (n + 1) h is the n h of the next step. Between them n h
 * + c h, where c h is a known value. n is exact, so no error adds up over steps. */
term fp3_advance_time(const fp3_advance *a, dag *g, double c) {
    if (a->is_adaptive)
        return own_time(a, g, c);
    const uint32_t outside = g->note;
    const int is_end = fabs(c - 1) < COEFFICIENT_ERROR, is_begin = fabs(c) < COEFFICIENT_ERROR;
    term n = fp3_advance_held(a, g, ROLE_STEPS, FP3_NONE);
    const term h = fp3_term(fp3_dag_known(g, fp3_known_step(g->known)));
    if (is_end) {
        g->note = fp3_note(&a->step->notes, "steps made");
        n = fp3_term_add(g, n, fp3_term(fp3_dag_number(g, 1)));
    }
    g->note = fp3_note(&a->step->notes, "t = steps*h");
    term t = fp3_term_mul(g, n, h);
    if (!is_begin && !is_end) {
        g->note = fp3_note(&a->step->notes, "t = steps*h + %.6g h", c);
        t = fp3_term_add(g, t, fp3_advance_scaled_step(a, c, 1));
    }
    g->note = outside;
    return t;
}

int fp3_advance_compares(const fp3_advance *a, fp3_compared which) {
    const fp3_coupling *c = a->options->coupling;
    return a->is_common && c && c->compared >> which & 1;
}

/* What is known is the same for all objects of a kind. */
uint32_t fp3_advance_worst(const fp3_advance *a, fp3_compared which, uint32_t node) {
    dag *g = &a->step->values;
    const int is_known = fp3_dag_is_known(g, node) != FP3_NONE;
    return a->is_common && (!is_known || fp3_advance_compares(a, which))
               ? fp3_dag_worst(g, node, which)
               : node;
}

uint32_t fp3_advance_least(const fp3_advance *a, fp3_compared which, uint32_t node) {
    dag *g = &a->step->values;
    return a->is_common ? sub(g, num(g, 0), fp3_advance_worst(a, which, sub(g, num(g, 0), node)))
                        : node;
}

uint32_t fp3_advance_moving(const fp3_advance *a, uint32_t node, uint32_t stopped) {
    return fp3_advance_may_stop(a) ? sel(&a->step->values, a->step->sight.stopped, stopped, node)
                                   : node;
}

/* coefficient * h^n where the object has its own h. */
static term own_scaled_step(const fp3_advance *a, double coefficient, unsigned n) {
    dag *g = &a->step->values;
    term made = fp3_term(fp3_dag_number(g, fabs(coefficient)));
    for (; n; n--)
        made = fp3_dag_is_number(g, made.node, 1) ? a->h : fp3_term_mul(g, made, a->h);
    return coefficient < 0 ? fp3_term_negated(made) : made;
}

term fp3_advance_scaled_step(const fp3_advance *a, double coefficient, unsigned n) {
    known_table *known = &a->step->known;
    if (a->is_adaptive)
        return own_scaled_step(a, coefficient, n);
    uint32_t made = fp3_known_number(known, fabs(coefficient));
    for (; n; n--)
        made = fp3_known_make(known, KNOWN_MUL, made, fp3_known_step(known));
    return (term){fp3_dag_known(&a->step->values, made), coefficient < 0};
}

/* As -(lost - d), where d may be a product and go straight into the difference. */
term fp3_advance_with_lost(const fp3_advance *a, uint32_t state, term d) {
    return fp3_term_negated(fp3_term_sub(&a->step->values, a->lost[state], d));
}

term fp3_advance_keep(const fp3_advance *a, uint32_t state, term base, term y) {
    dag *g = &a->step->values;
    const term sum = fp3_term_add(g, base, y);
    g->note = fp3_note(&a->step->notes, "what is lost of %s", fp3_advance_name(a, state));
    a->lost[state] = fp3_term_sub(g, fp3_term_sub(g, sum, base), y);
    return sum;
}

term fp3_advance_update(const fp3_advance *a, uint32_t state, term base, term d) {
    dag *g = &a->step->values;
    if (a->options->arithmetic != FP3_COMPENSATED)
        return fp3_term_add(g, base, d);
    const uint32_t new_state = g->note;
    g->note = fp3_note(&a->step->notes, "what is added to %s, with what was lost before",
                       fp3_advance_name(a, state));
    const term y = fp3_advance_with_lost(a, state, d);
    g->note = new_state;
    return fp3_advance_keep(a, state, base, y);
}

static term state_after(lowering *l, uint32_t state) {
    const fp3_advance *a = l->user;
    return a->now[state];
}

static term state_before(lowering *l, uint32_t state) {
    const fp3_advance *a = l->user;
    return a->step->segment_count ? fp3_term(fp3_dag_variable(l->g, a->previous[state]))
                                  : fp3_advance_held(a, l->g, ROLE_STATE, state);
}

/* Neighbours see at each event, and at each projection, what those before it left of all objects;
 * before the step they see another state again. */
static uint32_t place_of(const fp3_advance *a, const fp3_event *event, int is_after) {
    const fp3_model *model = a->step->model;
    const int is_projection = event->condition == FP3_NONE;
    const uint32_t number = is_projection ? a->projected : (uint32_t)(event - model->events);
    const uint32_t first = is_projection ? a->place_count + 1 : FP3_PLACE_EVENTS,
                   end = is_projection ? FP3_PLACE_EVENTS : FP3_LAST_PLACE;
    if (!is_after)
        return a->place_count;
    if (first + number < end)
        return first + number;
    return (is_projection ? UNSEEN_PROJECTION : UNSEEN_EVENT) + number;
}

static fp3_status open_at(const fp3_advance *a, uint32_t place, int is_after, lowering *l,
                          fp3_error *error) {
    const fp3_status status = fp3_lower_open(l, a->step->model, &a->step->values, error);
    l->state = is_after ? state_after : state_before;
    l->before = state_before;
    l->h = fp3_advance_scaled_step(a, 1, 1);
    l->user = (void *)a;
    l->notes = &a->step->notes;
    l->index = place;
    l->sight = &a->step->sight;
    if (!status && a->fit->has_time)
        l->time = fp3_advance_time(a, l->g, is_after);
    return status;
}

void fp3_advance_show(const fp3_advance *a, lowering *l) {
    const fp3_coupling *c = a->options->coupling;
    const uint32_t place = fp3_step_place(a->step, l->index);
    if (!c || place == FP3_NONE || !(c->looked >> place & 1))
        return;
    fp3_lower_show(l, c->seen);
    a->step->shown |= UINT64_C(1) << place;
}

/* Where this model has no expression that is read before the step, others may still look. */
void fp3_advance_show_start(fp3_advance *a) {
    lowering l = {.model = a->step->model,
                  .g = &a->step->values,
                  .state = state_before,
                  .user = a,
                  .index = a->place_count,
                  .sight = &a->step->sight};
    fp3_advance_show(a, &l);
}

void fp3_advance_show_rest(fp3_advance *a, int is_after_events) {
    const fp3_coupling *c = a->options->coupling;
    const uint32_t end = is_after_events ? FP3_LAST_PLACE : FP3_PLACE_EVENTS;
    lowering l = {.model = a->step->model,
                  .g = &a->step->values,
                  .state = state_after,
                  .user = a,
                  .sight = &a->step->sight};
    for (l.index = is_after_events ? FP3_PLACE_EVENTS : a->place_count + 1; c && l.index < end;
         l.index++)
        if (!(a->step->shown >> l.index & 1))
            fp3_advance_show(a, &l);
}

fp3_status fp3_advance_behind(const fp3_advance *a, lowering *l, fp3_error *error) {
    const fp3_status status = open_at(a, REMEMBER, 1, l, error);
    strcpy(l->place, "remember");
    return status;
}

fp3_status fp3_advance_event(const fp3_advance *a, const fp3_event *event, int is_after,
                             lowering *l, fp3_error *error) {
    const fp3_status status = open_at(a, place_of(a, event, is_after), is_after, l, error);
    snprintf(l->place, sizeof l->place, "line %" PRIu32, event->line);
    return status;
}
