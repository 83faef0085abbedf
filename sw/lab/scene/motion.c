/* SPDX-License-Identifier: Apache-2.0 */
/* motion.c - see motion.h. */
#include "motion.h"

#include "asked.h"
#include "base/host.h"
#include "changes.h"
#include "mover.h"
#include "sight.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- slopes ---- */

/* The derivatives of all states, or of those that are kicked; of who does not move 0. */
static void find_slopes(fp3_motion *m, uint32_t group, const fp3_span *at, double *slopes) {
    const fp3_crowd_group *g = &m->crowd->groups[group];
    fp3_mover *v = &m->movers[group];
    const fp3_moment moment = fp3_motion_moment(m, group, m->view, at);
    for (size_t first = 0; first < g->objects; first += FP3_ASKED_OBJECTS) {
        const size_t left = g->objects - first,
                     n = left < FP3_ASKED_OBJECTS ? left : FP3_ASKED_OBJECTS;
        size_t begin = first, end = first + n; /* of those that move */
        while (begin < end && !fp3_crowd_moves(g, begin))
            begin++;
        while (end > begin && !fp3_crowd_moves(g, end - 1))
            end--;
        if (begin < end)
            m->cost += fp3_asked_values(&v->slopes, &moment, begin, end - begin, v->room);
        for (uint32_t s = 0; s < g->model->state_count; s++) {
            const double *from = fp3_asked_column(v->room, g->model->states[s].derivative);
            double *to = slopes + s * g->objects;
            for (size_t i = first; i < first + n; i++)
                to[i] = fp3_crowd_moves(g, i) ? from[i - begin] : 0;
        }
    }
}

static int is_of(const fp3_motion *m, uint32_t group, const fp3_integrator *integrator) {
    return !m->movers[group].is_still &&
           strcmp(m->movers[group].integrator->name, integrator->name) == 0;
}

static size_t numbers(const fp3_crowd_group *g) { return g->objects * g->model->state_count; }

/* base + h times the sum of slopes with these weights. */
static void combine(const fp3_mover *v, size_t count, const double *weights, unsigned stages,
                    double h, const double *base, double *to) {
    memcpy(to, base, count * sizeof *to);
    for (unsigned j = 0; j < stages; j++) {
        const double c = h * weights[j];
        const double *k = v->stages + j * count;
        for (size_t i = 0; c != 0 && i < count; i++)
            to[i] += c * k[i];
    }
}

static int is_position(const fp3_model *m, uint32_t state) {
    const uint32_t velocity = m->states[state].velocity;
    return velocity != FP3_NONE && m->states[velocity].velocity == FP3_NONE;
}

/* Positions that get the new velocity. */
static void move_late(const fp3_crowd_group *g, double h, double *next) {
    for (uint32_t s = 0; s < g->model->state_count; s++)
        for (size_t i = 0; is_position(g->model, s) && i < g->objects; i++)
            if (fp3_crowd_moves(g, i))
                next[s * g->objects + i] = g->states[s * g->objects + i] +
                                           h * next[g->model->states[s].velocity * g->objects + i];
}

static fp3_status runge_kutta(fp3_motion *m, const fp3_integrator *table, const fp3_span *at,
                              fp3_error *error) {
    fp3_status status = FP3_OK;
    for (unsigned s = 0; !status && s <= table->stages; s++) {
        const int is_end = s == table->stages;
        for (uint32_t k = 0; k < m->crowd->group_count; k++) {
            const fp3_crowd_group *g = &m->crowd->groups[k];
            fp3_mover *v = &m->movers[k];
            if (!is_of(m, k, table))
                continue;
            combine(v, numbers(g), is_end ? table->b : table->a[s], s, g->h * at->share, g->states,
                    v->next);
            m->view[k] = v->next;
            if (is_end && table->is_position_late)
                move_late(g, g->h * at->share, v->next);
        }
        if (!is_end)
            status = fp3_sight_look(m->crowd, m->view, error);
        const fp3_span there = {at->from + (is_end ? 1 : table->c[s]) * at->share, at->share};
        for (uint32_t k = 0; !is_end && !status && k < m->crowd->group_count; k++)
            if (is_of(m, k, table))
                find_slopes(m, k, &there, m->movers[k].stages + s * numbers(&m->crowd->groups[k]));
    }
    return status;
}

static void drift_or_kick(fp3_motion *m, uint32_t group, const fp3_substep *substep, double h) {
    const fp3_crowd_group *g = &m->crowd->groups[group];
    fp3_mover *v = &m->movers[group];
    for (uint32_t s = 0; s < g->model->state_count; s++) {
        if (is_position(g->model, s) == (substep->is_kick != 0))
            continue;
        const double *slope = substep->is_kick
                                  ? v->stages + s * g->objects
                                  : v->next + g->model->states[s].velocity * g->objects;
        double *to = v->next + s * g->objects;
        for (size_t i = 0; i < g->objects; i++)
            if (fp3_crowd_moves(g, i))
                to[i] += substep->coefficient * h * slope[i];
    }
}

/* Time moves with the positions. */
static fp3_status splitting(fp3_motion *m, const fp3_integrator *table, const fp3_span *at,
                            fp3_error *error) {
    fp3_status status = FP3_OK;
    fp3_span there = *at;
    for (uint32_t k = 0; k < m->crowd->group_count; k++)
        if (is_of(m, k, table)) {
            const fp3_crowd_group *g = &m->crowd->groups[k];
            memcpy(m->movers[k].next, g->states, numbers(g) * sizeof *g->states);
            m->view[k] = m->movers[k].next;
        }
    for (unsigned s = 0; !status && s < table->stages; s++) {
        const fp3_substep *substep = &table->substeps[s];
        if (substep->is_kick)
            status = fp3_sight_look(m->crowd, m->view, error);
        for (uint32_t k = 0; !status && substep->is_kick && k < m->crowd->group_count; k++)
            if (is_of(m, k, table))
                find_slopes(m, k, &there, m->movers[k].stages);
        for (uint32_t k = 0; !status && k < m->crowd->group_count; k++)
            if (is_of(m, k, table))
                drift_or_kick(m, k, substep, m->crowd->groups[k].h * at->share);
        if (!substep->is_kick)
            there.from += substep->coefficient * at->share;
    }
    return status;
}

/* Groups that do not see each other may have different integrators: each set begins from where all
 * were. */
static fp3_status integrate(fp3_motion *m, const fp3_span *at, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; !status && k < m->crowd->group_count; k++) {
        const fp3_integrator *table = m->movers[k].integrator;
        int is_done = m->movers[k].is_still;
        for (uint32_t j = 0; j < k; j++)
            is_done |= is_of(m, j, table);
        if (is_done)
            continue;
        for (uint32_t j = 0; j < m->crowd->group_count; j++)
            m->view[j] = m->crowd->groups[j].states;
        status = (table->kind == FP3_SPLITTING ? splitting : runge_kutta)(m, table, at, error);
    }
    for (uint32_t k = 0; !status && k < m->crowd->group_count; k++)
        if (!m->movers[k].is_still)
            memcpy(m->crowd->groups[k].states, m->movers[k].next,
                   numbers(&m->crowd->groups[k]) * sizeof(double));
    fp3_motion_see_states(m);
    return status;
}

/* ---- a step ---- */

static void keep(fp3_motion *m) {
    for (uint32_t k = 0; k < m->crowd->group_count; k++)
        memcpy(m->movers[k].before, m->crowd->groups[k].states,
               numbers(&m->crowd->groups[k]) * sizeof(double));
    fp3_motion_see_states(m);
}

static void go_back(fp3_motion *m) {
    for (uint32_t k = 0; k < m->crowd->group_count; k++)
        memcpy(m->crowd->groups[k].states, m->movers[k].before,
               numbers(&m->crowd->groups[k]) * sizeof(double));
    fp3_motion_see_states(m);
}

fp3_status fp3_motion_slopes(fp3_motion *m, double at, double *slopes, fp3_error *error) {
    const fp3_span here = {at, 1};
    keep(m);
    const fp3_status status = fp3_sight_look(m->crowd, m->view, error);
    for (uint32_t k = 0; !status && k < m->crowd->group_count; k++) {
        find_slopes(m, k, &here, slopes);
        slopes += numbers(&m->crowd->groups[k]);
    }
    return status;
}

fp3_status fp3_motion_flow(fp3_motion *m, double at, double share, fp3_error *error) {
    keep(m);
    return integrate(m, &(fp3_span){at, share}, error);
}

static fp3_status check_finite(const fp3_motion *m, const fp3_span *at, fp3_error *error) {
    for (uint32_t k = 0; k < m->crowd->group_count; k++) {
        const fp3_crowd_group *g = &m->crowd->groups[k];
        for (size_t n = 0; n < numbers(g); n++)
            if (!isfinite(g->states[n]) && g->is_alive[n % g->objects])
                return fp3_fail(error, FP3_E_FAILED,
                                "in double '%s' of object %zu of group '%s' is %g at time %.9g",
                                g->model->states[n / g->objects].name, n % g->objects, g->of->name,
                                g->states[n], (at->from + at->share) * g->h);
    }
    return FP3_OK;
}

/* Up to the events. */
static fp3_status advance(fp3_motion *m, const fp3_span *at, fp3_error *error) {
    fp3_status status = integrate(m, at, error);
    if (!status)
        status = check_finite(m, at, error);
    return status ? status : fp3_changes_project(m, at, error);
}

static fp3_status end(fp3_motion *m, const fp3_span *at, fp3_error *error) {
    fp3_status status = fp3_changes_fire(m, at, error);
    if (!status)
        status = fp3_changes_remember(m, at, error);
    return status ? status : check_finite(m, at, error);
}

fp3_status fp3_motion_step(fp3_motion *m, uint64_t step, uint64_t parts, fp3_error *error) {
    const fp3_span at = {(double)step / (double)parts, 1 / (double)parts};
    fp3_crowd_live(m->crowd, step, parts);
    keep(m);
    fp3_status status = fp3_changes_arm(m, &at, error);
    if (!status)
        status = advance(m, &at, error);
    return status ? status : end(m, &at, error);
}

enum { HALVINGS = 44, EVENTS_MOST = 1000, AT_ONCE = 16 };

/* The shortest step from here, up to all of it, behind which an event happens. */
static fp3_status find_event(fp3_motion *m, fp3_span *at, int *is_found, fp3_error *error) {
    double low = 0, high = at->share;
    fp3_status status = advance(m, at, error);
    if (!status)
        status = fp3_changes_would_fire(m, at, is_found, error);
    for (int n = 0; !status && *is_found && n < HALVINGS; n++) {
        int is_before = 0;
        go_back(m);
        at->share = low + (high - low) / 2;
        status = advance(m, at, error);
        if (!status)
            status = fp3_changes_would_fire(m, at, &is_before, error);
        *(is_before ? &high : &low) = at->share;
    }
    if (status || !*is_found)
        return status;
    go_back(m);
    at->share = high;
    return advance(m, at, error);
}

fp3_status fp3_motion_step_to_events(fp3_motion *m, uint64_t step, uint64_t parts,
                                     fp3_error *error) {
    const double last = (double)(step + 1) / (double)parts;
    fp3_span at = {(double)step / (double)parts, 0};
    fp3_status status = FP3_OK;
    fp3_crowd_live(m->crowd, step, parts);
    for (int is_found = 1, at_once = 0; !status && is_found; at.from += at.share) {
        at.share = last - at.from;
        keep(m);
        status = fp3_changes_arm(m, &at, error);
        if (!status)
            status = find_event(m, &at, &is_found, error);
        if (!status)
            status = end(m, &at, error);
        if (status || !is_found)
            continue;
        fp3_crowd_live(m->crowd, step, parts);
        at_once = at.share * (double)parts < 1e-9 ? at_once + 1 : 0;
        if (++m->events > EVENTS_MOST || at_once > AT_ONCE)
            return fp3_fail(error, FP3_E_FAILED,
                            at_once > AT_ONCE
                                ? "events happen again and again at step %.9g of the scene"
                                : "more than 1000 events until step %.9g of the scene",
                            at.from);
    }
    return status;
}

/* ---- room ---- */

static fp3_status check_integrator(const fp3_crowd_group *g, const fp3_mover *v, fp3_error *error) {
    if (v->is_still ||
        (v->integrator->kind != FP3_ROSENBROCK && v->integrator->kind != FP3_STOERMER))
        return FP3_OK;
    return fp3_fail(error, FP3_E_PROGRAM, "group '%s': there is no integrator '%s' in double, %s",
                    g->of->name, v->integrator->name,
                    v->integrator->kind == FP3_ROSENBROCK
                        ? "which needs the Jacobian of each object with its neighbours"
                        : "which works from the positions of two steps");
}

static fp3_status open_mover(const fp3_crowd_group *g, const fp3_integrator *instead, fp3_mover *v,
                             fp3_error *error) {
    const fp3_model *m = g->model;
    uint32_t rates[64];
    v->is_still = 1;
    for (uint32_t s = 0; s < m->state_count; s++) {
        const fp3_expr *e = &m->exprs[rates[s] = m->states[s].derivative];
        v->is_still &= e->op == FP3_EXPR_NUMBER && e->number == 0;
    }
    v->integrator = instead ? instead : g->integrator;
    fp3_status status = check_integrator(g, v, error);
    if (status)
        return status;
    const unsigned stages = v->integrator->kind == FP3_SPLITTING ? 1 : v->integrator->stages;
    v->before = calloc(numbers(g) + 1, sizeof *v->before);
    v->next = calloc(numbers(g) + 1, sizeof *v->next);
    v->stages = calloc(stages * numbers(g) + 1, sizeof *v->stages);
    v->room = fp3_asked_room(m);
    if (!v->before || !v->next || !v->stages || !v->room)
        return fp3_no_memory(error);
    status = fp3_asked_open(m, rates, m->state_count, &v->slopes, error);
    return status ? status : fp3_changes_open(g, v, error);
}

fp3_status fp3_motion_open(fp3_crowd *crowd, const fp3_integrator *instead, fp3_motion **motion,
                           fp3_error *error) {
    fp3_motion *m = *motion = calloc(1, sizeof *m);
    if (!m)
        return fp3_no_memory(error);
    m->crowd = crowd;
    m->movers = calloc(crowd->group_count + 1u, sizeof *m->movers);
    m->view = calloc(crowd->group_count + 1u, sizeof *m->view);
    fp3_status status = m->movers && m->view ? FP3_OK : fp3_no_memory(error);
    for (uint32_t k = 0; !status && k < crowd->group_count; k++)
        status = open_mover(&crowd->groups[k], instead, &m->movers[k], error);
    if (status)
        fp3_motion_close(motion);
    else
        fp3_motion_see_states(m);
    return status;
}

void fp3_motion_close(fp3_motion **motion) {
    fp3_motion *m = *motion;
    if (!m)
        return;
    for (uint32_t k = 0; m->movers && k < m->crowd->group_count; k++) {
        fp3_mover *v = &m->movers[k];
        fp3_asked_close(&v->slopes);
        fp3_changes_close(&m->crowd->groups[k], v);
        free(v->before);
        free(v->next);
        free(v->stages);
        free(v->room);
    }
    free(m->movers);
    free(m->view);
    free(m);
    *motion = NULL;
}

uint64_t fp3_motion_cost(const fp3_motion *motion) { return motion->cost; }
