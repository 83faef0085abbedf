/* SPDX-License-Identifier: Apache-2.0 */
/* crossing.c - the time of an event or a turn by bisection, as far as double can tell two times
 * apart. */
#include "crossing.h"

#include "path.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "part.h"

#define RESOLUTION                                                                                 \
    0x1p-60       /* of the whole time: near 0 double tells more apart than anybody needs */
#define SLIDES 32 /* turns with no step between them: the solution stays on the switch */

int fp3_crossing_open(fp3_crossing *c, fp3_switches *switches, const gsl_odeiv2_system *system,
                      const gsl_odeiv2_step_type *how) {
    const fp3_model *model = switches->model;
    const size_t count = model->state_count + 1u;
    *c = (fp3_crossing){.model = model,
                        .params = switches->params,
                        .switches = switches,
                        .system = system,
                        .step = gsl_odeiv2_step_alloc(how, model->state_count),
                        .values = calloc(model->expr_count + 1u, sizeof(double)),
                        .from = calloc(5 * count, sizeof(double))};
    if (!c->step || !c->values || !c->from)
        return GSL_ENOMEM;
    c->there = c->from + count;
    c->next = c->from + 2 * count;
    return GSL_SUCCESS;
}

void fp3_crossing_close(fp3_crossing *c) {
    if (c->step)
        gsl_odeiv2_step_free(c->step);
    free(c->values);
    free(c->from);
    *c = (fp3_crossing){0};
}

static size_t bytes(const fp3_crossing *c) { return c->model->state_count * sizeof(double); }

/* Whether an event happens here, in a step that has begun at t0 with c->from, or in none (NAN);
 * c->next are the states after it. */
static int happens(const fp3_crossing *c, double t0, double t, const double *y) {
    const fp3_point before = {.states = c->from, .params = c->params, .t = t0};
    memcpy(c->next, y, bytes(c));
    return fp3_model_fire(c->model, isnan(t0) ? NULL : &before, c->params, t, c->next, c->values);
}

const fp3_event *fp3_crossing_of(const fp3_model *model, const double *params, double t,
                                 const double *y, double *values) {
    fp3_model_evaluate(model, &(fp3_point){.states = y, .params = params, .t = t}, values);
    for (uint32_t i = 0; i < model->event_count; i++) {
        const fp3_event *event = &model->events[i];
        const fp3_assignment *set = &model->assignments[event->first];
        for (uint32_t k = 0;
             event->armed == FP3_NONE && values[event->condition] != 0 && k < event->count; k++)
            if (values[set[k].expr] != y[set[k].state])
                return event;
    }
    return NULL;
}

static int is_over(const fp3_crossing *c, double t0, double t, const double *y) {
    return fp3_switches_have_turned(c->switches, t, y) || happens(c, t0, t, y);
}

static int fire(fp3_crossing *c, double t0, double t, double *y) {
    const int fired = happens(c, t0, t, y);
    c->is_event = fired != 0;
    c->has_stopped = (fired & FP3_FIRE_STOPPED) != 0;
    if (!c->is_event)
        return GSL_SUCCESS;
    memcpy(y, c->next, bytes(c));
    if (c->has_stopped)
        return GSL_SUCCESS;
    if (happens(c, NAN, t, y))
        return FP3_CROSSING_STAYS;
    return ++c->happened > FP3_EVENTS_MOST ? FP3_CROSSING_MOST : GSL_SUCCESS;
}

static int fire_and_hold(fp3_crossing *c, double t0, double t, double *y) {
    const int result = fire(c, t0, t, y);
    fp3_switches_hold(c->switches, t, y);
    return result;
}

int fp3_crossing_start(fp3_crossing *c, double *y) { return fire_and_hold(c, NAN, 0, y); }

/* c->there: the states at t0 + h. */
static int go(const fp3_crossing *c, double t0, double h) {
    const size_t count = c->model->state_count + 1u;
    memcpy(c->there, c->from, bytes(c));
    return fp3_part_go(c->step, c->system, t0, h, c->there, c->from + 3 * count);
}

/* A turn right at the beginning of a step, again and again, is none that the solution gets past. */
static int count_turn(fp3_crossing *c, double t0, double t, const double *y) {
    if (!fp3_switches_have_turned(c->switches, t, y))
        return GSL_SUCCESS;
    const double least = 4 * RESOLUTION * fabs(c->switches->end) + 4 * 0x1p-53 * fabs(t);
    c->slid = fabs(t - t0) <= least ? c->slid + 1 : 0;
    return c->slid > SLIDES || ++c->turned > FP3_TURNS_MOST ? FP3_CROSSING_SLIDES : GSL_SUCCESS;
}

int fp3_crossing_find(fp3_crossing *c, double t0, double *t, double *y, int *is_found) {
    const double least = RESOLUTION * fabs(c->switches->end);
    double before = t0;
    *is_found = is_over(c, t0, *t, y);
    while (*is_found && fabs(*t - before) > least) {
        const double middle = before + (*t - before) / 2;
        if (middle == before || middle == *t)
            break;
        const int result = go(c, t0, middle - t0);
        if (result)
            return result;
        if (!is_over(c, t0, middle, c->there)) {
            before = middle;
            continue;
        }
        *t = middle;
        memcpy(y, c->there, bytes(c));
    }
    if (!*is_found)
        return GSL_SUCCESS;
    int result = count_turn(c, t0, *t, y);
    if (!result && c->path)
        result = fp3_path_stop(c->path, *t);
    return result ? result : fire_and_hold(c, t0, *t, y);
}
