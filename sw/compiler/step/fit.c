/* SPDX-License-Identifier: Apache-2.0 */
/* fit.c - positions, velocities, and what depends on what. */
#include "fit.h"

#include "notes.h"
#include "switching.h"

#include <fp3/compile.h>

#include <assert.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#define BIT(state) (UINT64_C(1) << (state))

typedef struct {
    const fp3_model *model;
    const fp3_integrator *integrator;
    fp3_fit *fit;
    uint64_t *needs;  /* of each expression: the states that it depends on */
    char *needs_time; /* and whether it depends on t */
} fitting;

/* It advances every state alike. */
static int has_stages(const fp3_integrator *integrator) {
    return integrator->kind != FP3_SPLITTING && integrator->kind != FP3_STOERMER;
}

static uint64_t find_positions(const fp3_model *model) {
    uint64_t found = 0;
    for (uint32_t s = 0; s < model->state_count; s++) {
        const uint32_t velocity = model->states[s].velocity;
        if (velocity != FP3_NONE && model->states[velocity].velocity == FP3_NONE)
            found |= BIT(s);
    }
    return found;
}

uint32_t fp3_fit_position_of(const fp3_fit *fit, const fp3_model *model, uint32_t velocity) {
    for (uint32_t s = 0; s < model->state_count; s++)
        if (fp3_fit_is_position(fit, s) && model->states[s].velocity == velocity)
            return s;
    return FP3_NONE;
}

int fp3_fit_has_event(const fp3_fit *fit, const fp3_model *model, const fp3_event *event) {
    int has = event->stops;
    for (uint32_t i = 0; i < event->count; i++)
        has |= fp3_fit_is_live(fit, model->assignments[event->first + i].state);
    return has;
}

static int has_any(const fp3_fit *fit, const fp3_model *model, const fp3_event *list,
                   uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        if (fp3_fit_has_event(fit, model, &list[i]))
            return 1;
    return 0;
}

int fp3_fit_has_events(const fp3_fit *fit, const fp3_model *model) {
    return has_any(fit, model, model->events, model->event_count);
}

int fp3_fit_has_projections(const fp3_fit *fit, const fp3_model *model) {
    return has_any(fit, model, model->projections, model->projection_count);
}

static void find_needs(const fitting *f) {
    for (uint32_t i = 0; i < f->model->expr_count; i++) {
        const fp3_expr *e = &f->model->exprs[i];
        f->needs[i] =
            e->op == FP3_EXPR_STATE || e->op == FP3_EXPR_OTHER_STATE || e->op == FP3_EXPR_BEFORE
                ? BIT(e->index)
                : 0;
        f->needs_time[i] = e->op == FP3_EXPR_TIME;
        for (int j = 0; j < 3; j++)
            if (e->operand[j] != FP3_NONE) {
                f->needs[i] |= f->needs[e->operand[j]];
                f->needs_time[i] |= f->needs_time[e->operand[j]];
            }
    }
}

static uint64_t needs_of(const fitting *f, uint32_t state) {
    return f->needs[f->model->states[state].derivative];
}

/* Stoermer finds a velocity by its position. */
static uint64_t found_by(const fitting *f, uint32_t state) {
    const uint32_t position = fp3_fit_position_of(f->fit, f->model, state);
    return f->integrator->kind == FP3_STOERMER && position != FP3_NONE ? BIT(position) : 0;
}

/* Those behind state t. */
static uint64_t find_control(const fp3_model *model) {
    const uint32_t first = fp3_model_adapted(model);
    return first == FP3_NONE
               ? 0
               : (UINT64_MAX >> (FP3_STATES_MAX - (model->state_count - first))) << first;
}

/* What an event reads to set this state; nothing if it does not. */
static uint64_t needs_of_event(const fitting *f, const fp3_event *event, uint32_t state) {
    uint64_t needs = 0;
    for (uint32_t j = 0; j < event->count; j++) {
        const fp3_assignment *a = &f->model->assignments[event->first + j];
        if (a->state == state)
            needs |=
                f->needs[a->expr] | (event->condition == FP3_NONE ? 0 : f->needs[event->condition]);
    }
    return needs;
}

/* What is needed to change the states of this set, if events or projections do. */
static uint64_t needs_of_events(const fitting *f, uint64_t states) {
    uint64_t needs = 0;
    for (uint32_t s = 0; s < f->model->state_count; s++) {
        for (uint32_t i = 0; states & BIT(s) && i < f->model->event_count; i++)
            needs |= needs_of_event(f, &f->model->events[i], s);
        for (uint32_t i = 0; states & BIT(s) && i < f->model->projection_count; i++)
            needs |= needs_of_event(f, &f->model->projections[i], s);
    }
    return needs;
}

static void find_live(const fitting *f, const fp3_options *options) {
    const uint32_t count = f->model->state_count;
    const uint64_t all = count == 64 ? UINT64_MAX : BIT(count) - 1;
    uint64_t *live = &f->fit->live;
    *live = fp3_has_pass(options, FP3_PASS_DEAD) ? options->observed : all;
    static const char *const located[] = {"h_cut", FP3_STATE_BEFORE, FP3_STATE_BEHIND,
                                          FP3_STATE_ROOT_BEFORE, FP3_STATE_ROOT_BEHIND};
    if (f->fit->control) /* an object needs t and h, whoever looks */
        *live |= UINT64_C(3) << fp3_model_adapted(f->model);
    for (size_t i = 0; f->fit->control && i < sizeof located / sizeof *located; i++) {
        const uint32_t state = fp3_model_state(f->model, located[i]);
        *live |= state == FP3_NONE ? 0 : BIT(state);
    }
    static const char *const known[] = {FP3_NAME_REST, FP3_NAME_REMOVED};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) { /* an engine looks at them */
        const uint32_t state = fp3_model_state(f->model, known[i]);
        *live |= state == FP3_NONE ? 0 : BIT(state);
    }
    for (uint32_t i = 0; i < f->model->event_count; i++)
        if (f->model->events[i].stops)
            *live |= f->needs[f->model->events[i].condition];
    for (uint32_t i = 0; i < f->model->memory_count; i++)
        *live |= f->needs[f->model->memories[i].expr];
    for (uint64_t before = ~*live; before != *live;) {
        before = *live;
        for (uint32_t s = 0; s < count; s++)
            if (before & BIT(s))
                *live |= needs_of(f, s) | found_by(f, s);
        *live |= needs_of_events(f, before);
    }
}

static int has_stop(const fp3_model *model) {
    int has = 0;
    for (uint32_t i = 0; i < model->event_count; i++)
        has |= model->events[i].stops == FP3_STOPS;
    return has;
}

static int event_has_time(const fitting *f, const fp3_event *event) {
    int has = fp3_fit_has_event(f->fit, f->model, event) && event->condition != FP3_NONE &&
              f->needs_time[event->condition];
    for (uint32_t j = 0; j < event->count; j++) {
        const fp3_assignment *a = &f->model->assignments[event->first + j];
        has |= fp3_fit_is_live(f->fit, a->state) && f->needs_time[a->expr];
    }
    return has;
}

static int has_time(const fitting *f) {
    for (uint32_t s = 0; s < f->model->state_count; s++)
        if (fp3_fit_is_live(f->fit, s) && f->needs_time[f->model->states[s].derivative])
            return 1;
    for (uint32_t i = 0; i < f->model->event_count; i++)
        if (event_has_time(f, &f->model->events[i]))
            return 1;
    for (uint32_t i = 0; i < f->model->projection_count; i++)
        if (event_has_time(f, &f->model->projections[i]))
            return 1;
    for (uint32_t i = 0; i < f->model->memory_count; i++)
        if (f->needs_time[f->model->memories[i].expr])
            return 1;
    return 0;
}

/* Kinds that see each other have one method: where some have positions, others may have none. */
static fp3_status check_splitting(const fitting *f, fp3_error *error) {
    if (f->fit->positions || (f->model->kind_count && f->integrator->kind == FP3_SPLITTING))
        return FP3_OK;
    return fp3_fail(error, FP3_E_PROGRAM,
                    "integrator '%s' moves positions: found no state whose derivative is another "
                    "state (as in s' = v), expected one",
                    f->integrator->name);
}

static fp3_status check_stoermer_events(const fitting *f, const fp3_event *list, uint32_t count,
                                        const char *what, fp3_error *error) {
    for (uint32_t i = 0; i < count; i++)
        if (fp3_fit_has_event(f->fit, f->model, &list[i]))
            return fp3_fail(error, FP3_E_PROGRAM,
                            "line %" PRIu32 ": integrator '%s' works from the positions of two "
                            "steps: found %s, which would change only one of them",
                            list[i].line, f->integrator->name, what);
    return FP3_OK;
}

/* Every live state is a position, or a velocity that is found from two of them. */
static fp3_status check_stoermer(const fitting *f, fp3_error *error) {
    for (uint32_t s = 0; s < f->model->state_count; s++) {
        const fp3_quantity *q = &f->model->states[s];
        if (!fp3_fit_is_live(f->fit, s) || fp3_fit_is_position(f->fit, s))
            continue;
        const fp3_expr *e = &f->model->exprs[q->derivative];
        if (fp3_fit_position_of(f->fit, f->model, s) == FP3_NONE)
            return fp3_fail_at(error, FP3_E_PROGRAM, NULL, e->line, e->column,
                               "integrator '%s' has positions and their "
                               "accelerations: found state '%s', which is neither",
                               f->integrator->name, q->name);
        if (needs_of(f, s) & ~f->fit->positions)
            return fp3_fail_at(error, FP3_E_PROGRAM, NULL, e->line, e->column,
                               "integrator '%s' has no velocity within a step: found "
                               "'%s', whose derivative depends on more than positions",
                               f->integrator->name, q->name);
    }
    const fp3_status status =
        check_stoermer_events(f, f->model->events, f->model->event_count, "an event", error);
    return status ? status
                  : check_stoermer_events(f, f->model->projections, f->model->projection_count,
                                          "a projection", error);
}

static fp3_status check_adaptive(const fitting *f, fp3_error *error) {
    if (f->fit->control && f->integrator->kind == FP3_STOERMER)
        return fp3_fail(error, FP3_E_PROGRAM,
                        "integrator '%s' works from the positions of two steps of the same length: "
                        "steps that end at events or at a time are not",
                        f->integrator->name);
    if (!fp3_model_chooses_steps(f->model) || f->integrator->embedded_order)
        return FP3_OK;
    return fp3_fail(error, FP3_E_PROGRAM,
                    "adaptive steps need an estimate of the error: integrator '%s' has none "
                    "(`embedded` in its table)",
                    f->integrator->name);
}

/* An object that stops makes no more steps, and the others do. Where objects see each other none
 * can choose its own end: then one that has stopped makes steps that change nothing. */
static fp3_status check_stop(const fitting *f, fp3_error *error) {
    const int is_together = f->model->relation_count > 0;
    if (f->fit->control && fp3_model_removes(f->model))
        return fp3_fail(error, FP3_E_PROGRAM,
                        "line %" PRIu32 ": `remove` ends a life after a step that all objects "
                        "make: run with --steps, or let the event `stop` the object",
                        fp3_model_removes(f->model));
    for (uint32_t i = 0; !f->fit->control && !is_together && i < f->model->event_count; i++)
        if (f->model->events[i].stops == FP3_STOPS)
            return fp3_fail(error, FP3_E_PROGRAM,
                            "line %" PRIu32 ": `stop` needs each object to choose its own end: "
                            "run with --until or --tolerance instead of --steps",
                            f->model->events[i].line);
    return FP3_OK;
}

static fp3_status check(const fitting *f, fp3_error *error) {
    fp3_status status = check_stop(f, error);
    if (!status)
        status = check_adaptive(f, error);
    if (status)
        return status;
    if (has_stages(f->integrator))
        return FP3_OK;
    const fp3_status split = check_splitting(f, error);
    return split || f->integrator->kind == FP3_SPLITTING ? split : check_stoermer(f, error);
}

static uint32_t first_of(uint64_t states) {
    uint32_t s = 0;
    while (!(states >> s & 1))
        s++;
    return s;
}

static unsigned order_of(const fitting *f) {
    const fp3_integrator *integrator = f->integrator;
    if (!f->fit->control && fp3_fit_has_events(f->fit, f->model)) /* each up to a step late */
        return 1;
    if (has_stages(integrator))
        return integrator->is_position_late && f->fit->live & f->fit->positions
                   ? integrator->position_order
                   : integrator->order;
    for (uint32_t s = 0; s < f->model->state_count; s++)
        if (fp3_fit_is_live(f->fit, s) && !fp3_fit_is_position(f->fit, s) &&
            needs_of(f, s) & ~f->fit->positions) {
            f->fit->fallen = s;
            f->fit->by = first_of(needs_of(f, s) & ~f->fit->positions);
            return 1;
        }
    return integrator->order;
}

/* The first event that a step without a `maxstep` may pass over; NULL: none. */
static fp3_status find_passed(const fp3_fit *fit, const fp3_model *model, const fp3_event **event,
                              fp3_error *error) {
    fp3_switchings switchings;
    *event = NULL;
    if (!fp3_model_chooses_steps(model) || fp3_model_param(model, "maxstep") != FP3_NONE)
        return FP3_OK;
    const fp3_status status = fp3_switchings_find(model, &switchings, error);
    for (uint32_t i = 0; !status && !*event && i < model->event_count; i++)
        if (fp3_fit_has_event(fit, model, &model->events[i]) &&
            !fp3_switchings_time(model, &switchings, &model->events[i]))
            *event = &model->events[i];
    fp3_switchings_close(&switchings);
    return status;
}

fp3_status fp3_fit_warn(const fp3_fit *fit, const fp3_model *model,
                        const fp3_integrator *integrator, char **warning, fp3_error *error) {
    const fp3_event *event;
    *warning = NULL;
    const fp3_status status = find_passed(fit, model, &event, error);
    if (status)
        return status;
    /* Never both: only methods with stages have an estimate, and only splittings fall. */
    assert(!event || fit->fallen == FP3_NONE);
    if (event &&
        asprintf(warning,
                 "line %" PRIu32
                 ": a step that is as long as the tolerance allows may pass over this event, if "
                 "its condition comes and goes within the step: give a shorter 'maxstep'",
                 event->line) < 0) {
        *warning = NULL;
        return fp3_no_memory(error);
    }
    if (event || fit->fallen == FP3_NONE || integrator->order <= fit->order)
        return FP3_OK;
    const fp3_quantity *q = &model->states[fit->fallen];
    const int length = asprintf(
        warning,
        "line %" PRIu32 ": '%s' has order %u here, not %u: %s' depends on %s, which is not a "
        "position, and a splitting advances it by Euler's method",
        model->exprs[q->derivative].line, integrator->name, fit->order, integrator->order, q->name,
        model->states[fit->by].name);
    if (length >= 0)
        return FP3_OK;
    *warning = NULL;
    return fp3_no_memory(error);
}

fp3_status fp3_fit_find(const fp3_model *model, const fp3_integrator *integrator,
                        const fp3_options *options, fp3_fit *fit, fp3_error *error) {
    fitting f = {.model = model, .integrator = integrator, .fit = fit};
    assert(model->state_count <= FP3_STATES_MAX);
    *fit = (fp3_fit){.positions = find_positions(model),
                     .control = find_control(model),
                     .has_stop = has_stop(model),
                     .fallen = FP3_NONE,
                     .by = FP3_NONE};
    f.needs = calloc(model->expr_count + 1u, sizeof *f.needs);
    f.needs_time = calloc(model->expr_count + 1u, 1);
    fp3_status status = f.needs && f.needs_time ? FP3_OK : fp3_no_memory(error);
    if (!status) {
        find_needs(&f);
        find_live(&f, options);
        fit->has_time = has_time(&f);
        status = check(&f, error);
    }
    if (!status)
        fit->order = order_of(&f);
    free(f.needs);
    free(f.needs_time);
    return status;
}
