/* SPDX-License-Identifier: Apache-2.0 */
/* changes.c - see changes.h.
 *
 * All groups make their first projection from what all of them were, then their second, and so on;
 * events likewise, and then what entries remember: docs/relations.md.
 */
#include "changes.h"

#include "base/host.h"
#include "sight.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- what is computed for each ---- */

static fp3_status open_events(const fp3_model *m, const fp3_event *list, uint32_t count,
                              fp3_asked **asked, fp3_error *error) {
    fp3_status status = FP3_OK;
    *asked = calloc(count + 1u, sizeof **asked);
    if (!*asked)
        return fp3_no_memory(error);
    for (uint32_t i = 0; !status && i < count; i++) {
        uint32_t *exprs = calloc(list[i].count + 2u, sizeof *exprs), n = 0;
        if (!exprs)
            return fp3_no_memory(error);
        for (uint32_t k = 0; k < list[i].count; k++)
            exprs[n++] = m->assignments[list[i].first + k].expr;
        if (list[i].condition != FP3_NONE)
            exprs[n++] = list[i].condition;
        status = fp3_asked_open(m, exprs, n, &(*asked)[i], error);
        free(exprs);
    }
    return status;
}

static void expand(const fp3_model *m, uint32_t *order, uint32_t *count) {
    uint32_t made = 0;
    *count = 0;
    for (uint32_t r = 0; r <= m->repeat_count; r++) {
        const fp3_repeat *repeat = r < m->repeat_count ? &m->repeats[r] : NULL;
        const uint32_t until = repeat ? repeat->first : m->projection_count;
        for (; made < until; made++)
            order[(*count)++] = made;
        for (uint32_t n = 0; repeat && n < repeat->times; n++)
            for (uint32_t i = 0; i < repeat->count; i++)
                order[(*count)++] = repeat->first + i;
        if (repeat)
            made = repeat->first + repeat->count;
    }
}

static fp3_status open_memories(const fp3_model *m, fp3_mover *v, fp3_error *error) {
    fp3_status status = FP3_OK;
    v->memories = calloc(m->memory_count + 1u, sizeof *v->memories);
    if (!v->memories)
        return fp3_no_memory(error);
    for (uint32_t i = 0; !status && i < m->memory_count; i++)
        status = fp3_asked_open_entries(m, m->memories[i].expr, m->memories[i].relation,
                                        &v->memories[i], error);
    return status;
}

static fp3_status open_armed(const fp3_model *m, fp3_mover *v, fp3_error *error) {
    uint32_t exprs[64], n = 0;
    for (uint32_t i = 0; i < m->event_count; i++)
        if (m->events[i].armed != FP3_NONE)
            exprs[n++] = m->events[i].armed;
    return fp3_asked_open(m, exprs, n, &v->armed, error);
}

fp3_status fp3_changes_open(const fp3_crowd_group *g, fp3_mover *v, fp3_error *error) {
    const fp3_model *m = g->model;
    v->order = calloc((m->projection_count + 1u) * (size_t)(FP3_REPEAT_MAX + 1), sizeof *v->order);
    v->changed = calloc((m->state_count + 2u) * (g->objects + 1), sizeof *v->changed);
    v->is_armed = calloc((m->event_count + 1u) * (g->objects + 1), 1);
    v->is_stopping = calloc(g->objects + 1, 1);
    if (!v->order || !v->changed || !v->is_armed || !v->is_stopping)
        return fp3_no_memory(error);
    expand(m, v->order, &v->order_count);
    fp3_status status = open_events(m, m->projections, m->projection_count, &v->projections, error);
    if (!status)
        status = open_events(m, m->events, m->event_count, &v->events, error);
    if (!status)
        status = open_armed(m, v, error);
    return status ? status : open_memories(m, v, error);
}

static void close_all(fp3_asked *list, uint32_t count) {
    for (uint32_t i = 0; list && i < count; i++)
        fp3_asked_close(&list[i]);
    free(list);
}

void fp3_changes_close(const fp3_crowd_group *g, fp3_mover *v) {
    close_all(v->projections, g->model->projection_count);
    close_all(v->events, g->model->event_count);
    close_all(v->memories, g->model->memory_count);
    fp3_asked_close(&v->armed);
    free(v->order);
    free(v->changed);
    free(v->is_armed);
    free(v->is_stopping);
}

/* ---- one of them, of all objects of a group ---- */

static fp3_span end_of(const fp3_span *at) { return (fp3_span){at->from + at->share, at->share}; }

/* The values of the assignments become columns of v->changed, and behind them comes the condition,
 * if there is one. */
static void find_values(struct fp3_motion *m, uint32_t group, const fp3_asked *asked,
                        const fp3_event *event, const fp3_span *at) {
    const fp3_crowd_group *g = &m->crowd->groups[group];
    fp3_mover *v = &m->movers[group];
    const fp3_span end = end_of(at);
    const fp3_moment moment = fp3_motion_moment(m, group, m->view, &end);
    const uint32_t columns = event->count + (event->condition != FP3_NONE);
    for (size_t first = 0; first < g->objects; first += FP3_ASKED_OBJECTS) {
        const size_t left = g->objects - first,
                     n = left < FP3_ASKED_OBJECTS ? left : FP3_ASKED_OBJECTS;
        m->cost += fp3_asked_values(asked, &moment, first, n, v->room);
        for (uint32_t k = 0; k < columns; k++)
            memcpy(v->changed + k * g->objects + first,
                   fp3_asked_column(v->room, k < event->count
                                                 ? g->model->assignments[event->first + k].expr
                                                 : event->condition),
                   n * sizeof(double));
    }
}

static int is_other(double a, double b) { return a != b && !(isnan(a) && isnan(b)); }

/* Takes the values where the event happens, or only looks whether something would change. */
static int take(const fp3_crowd_group *g, fp3_mover *v, const fp3_event *event, uint32_t number,
                int is_look) {
    const double *condition = v->changed + event->count * g->objects;
    int is_changed = 0;
    for (size_t i = 0; i < g->objects; i++) {
        const int happens = event->condition == FP3_NONE ||
                            (condition[i] != 0 &&
                             (event->armed == FP3_NONE || v->is_armed[number * g->objects + i]));
        if (!fp3_crowd_moves(g, i) || !happens)
            continue;
        for (uint32_t k = 0; k < event->count; k++) {
            double *state =
                g->states + g->model->assignments[event->first + k].state * g->objects + i;
            is_changed |= is_other(*state, v->changed[k * g->objects + i]);
            if (!is_look)
                *state = v->changed[k * g->objects + i];
        }
        is_changed |= event->stops == FP3_STOPS;
        if (event->stops == FP3_STOPS && !is_look)
            v->is_stopping[i] = 1;
    }
    return is_changed;
}

/* ---- in their order ---- */

fp3_status fp3_changes_arm(struct fp3_motion *m, const fp3_span *at, fp3_error *error) {
    fp3_status status = fp3_sight_look(m->crowd, m->view, error);
    for (uint32_t k = 0; !status && k < m->crowd->group_count; k++) {
        const fp3_crowd_group *g = &m->crowd->groups[k];
        fp3_mover *v = &m->movers[k];
        const fp3_moment moment = fp3_motion_moment(m, k, m->view, at);
        for (size_t first = 0; v->armed.count && first < g->objects; first += FP3_ASKED_OBJECTS) {
            const size_t left = g->objects - first,
                         n = left < FP3_ASKED_OBJECTS ? left : FP3_ASKED_OBJECTS;
            m->cost += fp3_asked_values(&v->armed, &moment, first, n, v->room);
            for (uint32_t e = 0; e < g->model->event_count; e++)
                for (size_t i = 0; g->model->events[e].armed != FP3_NONE && i < n; i++)
                    v->is_armed[e * g->objects + first + i] =
                        fp3_asked_column(v->room, g->model->events[e].armed)[i] != 0;
        }
    }
    return status;
}

fp3_status fp3_changes_project(struct fp3_motion *m, const fp3_span *at, fp3_error *error) {
    fp3_status status = FP3_OK;
    uint32_t most = 0;
    for (uint32_t k = 0; k < m->crowd->group_count; k++)
        most = m->movers[k].order_count > most ? m->movers[k].order_count : most;
    for (uint32_t p = 0; !status && p < most; p++) {
        status = fp3_sight_look(m->crowd, m->view, error);
        for (int is_taken = 0; !status && is_taken < 2; is_taken++)
            for (uint32_t k = 0; k < m->crowd->group_count; k++) {
                const fp3_crowd_group *g = &m->crowd->groups[k];
                fp3_mover *v = &m->movers[k];
                if (p >= v->order_count)
                    continue;
                const uint32_t number = v->order[p];
                const fp3_event *event = &g->model->projections[number];
                if (is_taken)
                    take(g, v, event, number, 0);
                else
                    find_values(m, k, &v->projections[number], event, at);
            }
    }
    return status;
}

static uint32_t most_events(const struct fp3_motion *m) {
    uint32_t most = 0;
    for (uint32_t k = 0; k < m->crowd->group_count; k++)
        if (m->crowd->groups[k].model->event_count > most)
            most = m->crowd->groups[k].model->event_count;
    return most;
}

static fp3_status fire(struct fp3_motion *m, const fp3_span *at, int is_look, int *would,
                       fp3_error *error) {
    fp3_status status = FP3_OK;
    *would = 0;
    for (uint32_t e = 0, most = most_events(m); !status && e < most; e++) {
        status = fp3_sight_look(m->crowd, m->view, error);
        for (int is_taken = 0; !status && is_taken < 2; is_taken++)
            for (uint32_t k = 0; k < m->crowd->group_count; k++) {
                const fp3_crowd_group *g = &m->crowd->groups[k];
                if (e >= g->model->event_count)
                    continue;
                const fp3_event *event = &g->model->events[e];
                if (is_taken)
                    *would |= take(g, &m->movers[k], event, e, is_look);
                else
                    find_values(m, k, &m->movers[k].events[e], event, at);
            }
    }
    return status;
}

fp3_status fp3_changes_would_fire(struct fp3_motion *m, const fp3_span *at, int *would,
                                  fp3_error *error) {
    return fire(m, at, 1, would, error);
}

fp3_status fp3_changes_fire(struct fp3_motion *m, const fp3_span *at, fp3_error *error) {
    int would;
    const fp3_status status = fire(m, at, 0, &would, error);
    for (uint32_t k = 0; !status && k < m->crowd->group_count; k++)
        for (size_t i = 0; i < m->crowd->groups[k].objects; i++)
            m->crowd->groups[k].is_stopped[i] |= m->movers[k].is_stopping[i];
    return status;
}

/* Links keep what they have unless both ends live; who is far away is forgotten. */
static void remember(struct fp3_motion *m, uint32_t group, uint32_t memory, const fp3_span *at) {
    const fp3_crowd_group *g = &m->crowd->groups[group];
    fp3_mover *v = &m->movers[group];
    const fp3_memory *what = &g->model->memories[memory];
    const fp3_relation *r = &g->model->relations[what->relation];
    const fp3_crowd_sight *s = &g->sights[what->relation];
    const fp3_span end = end_of(at);
    const fp3_moment moment = fp3_motion_moment(m, group, m->view, &end);
    const size_t count = s->begin[g->objects], at_field = (what->field - r->first_field) * count;
    double *to = s->next + at_field;
    if (r->kind == FP3_NEAR)
        memset(to, 0, count * sizeof *to);
    else
        memcpy(to, s->fields + at_field, count * sizeof *to);
    for (size_t first = 0; first < g->objects; first += FP3_ASKED_OBJECTS) {
        const size_t left = g->objects - first,
                     n = left < FP3_ASKED_OBJECTS ? left : FP3_ASKED_OBJECTS;
        m->cost += fp3_asked_entries(&v->memories[memory], &moment, first, n, v->room, to);
    }
}

fp3_status fp3_changes_remember(struct fp3_motion *m, const fp3_span *at, fp3_error *error) {
    const fp3_status status = fp3_sight_look(m->crowd, m->view, error);
    for (int is_taken = 0; !status && is_taken < 2; is_taken++)
        for (uint32_t k = 0; k < m->crowd->group_count; k++) {
            const fp3_crowd_group *g = &m->crowd->groups[k];
            for (uint32_t i = 0; i < g->model->memory_count; i++) {
                const fp3_memory *what = &g->model->memories[i];
                const fp3_relation *r = &g->model->relations[what->relation];
                const fp3_crowd_sight *s = &g->sights[what->relation];
                const size_t count = s->begin[g->objects],
                             field = (what->field - r->first_field) * count;
                if (is_taken)
                    memcpy(s->fields + field, s->next + field, count * sizeof *s->fields);
                else
                    remember(m, k, i, at);
            }
        }
    return status;
}
