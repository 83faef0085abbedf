/* SPDX-License-Identifier: Apache-2.0 */
/* adapt.c - the states and params that adaptive steps add to a model. */
#include <fp3/compile.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "adapt.h"
#include "base/definition.h"
#include "base/host.h"
#include "options.h"
#include "switching.h"

#define TAKEN "adaptive steps add a '%s' of their own: found one in the model"
#define NO_STEP_YET 0x1p100 /* of `smallest`: beyond every step */
#define FINE 0x1p-24        /* of the time, which an event at a root is late by as a rule; */
#define FINEST 0x1p-44      /* likewise at least: t has 48 bits */
#define PART 0x1p-10        /* of a step, at most; */
#define COARSE 0x1p-6       /* of a step that is not chosen, which one at a condition is */

typedef struct {
    const char *name, *doc;
    double value;
    int is_shared;
} addition;

int fp3_model_chooses_steps(const fp3_model *model) {
    return fp3_model_adapted(model) != FP3_NONE && fp3_model_param(model, "tolerance") != FP3_NONE;
}

void fp3_adaptive_set_default(fp3_adaptive_def *def, size_t size) {
    if (fp3_definition_begin(def, size, sizeof *def))
        def->tolerance = 1e-5;
}

uint32_t fp3_model_adapted(const fp3_model *model) {
    return fp3_model_state(model, "t"); /* a text cannot declare it: t is reserved */
}

static int is_taken(const fp3_model *model, const char *name) {
    for (uint32_t i = 0; i < model->definition_count; i++)
        if (!strcmp(model->definitions[i].name, name))
            return 1;
    for (uint32_t i = 0; i < model->invariant_count; i++)
        if (!strcmp(model->invariants[i].name, name))
            return 1;
    for (uint32_t i = 0; i < model->group_invariant_count; i++)
        if (!strcmp(model->group_invariants[i].name, name))
            return 1;
    return fp3_model_state(model, name) != FP3_NONE || fp3_model_param(model, name) != FP3_NONE;
}

static int add_expr(fp3_model *model, fp3_expr e) {
    fp3_expr *exprs = realloc(model->exprs, (model->expr_count + 1u) * sizeof *exprs);
    if (!exprs)
        return 0;
    e.is_known = 1;
    for (int i = 0; i < 3; i++)
        e.operand[i] = FP3_NONE;
    model->exprs = exprs;
    model->exprs[model->expr_count++] = e;
    return 1;
}

static fp3_status add(fp3_model *model, fp3_quantity **list, uint32_t *count, const addition *what,
                      const char *dimension, fp3_error *error) {
    fp3_quantity *more;
    if (is_taken(model, what->name))
        return fp3_fail(error, FP3_E_PROGRAM, TAKEN, what->name);
    if (*count == FP3_STATES_MAX)
        return fp3_fail(error, FP3_E_PROGRAM,
                        "adaptive steps add '%s': a model has at most %d states and as many params",
                        what->name, FP3_STATES_MAX);
    if (!(more = realloc(*list, (*count + 1u) * sizeof *more)))
        return fp3_no_memory(error);
    *list = more;
    fp3_quantity *q = &more[*count];
    *q = (fp3_quantity){.value = what->value,
                        .is_shared = what->is_shared,
                        .derivative = FP3_NONE,
                        .velocity = FP3_NONE,
                        .start = FP3_NONE,
                        .exact = FP3_NONE,
                        .dimension = strdup(dimension),
                        .doc = strdup(what->doc)};
    strcpy(q->name, what->name);
    ++*count;
    return q->dimension && q->doc ? FP3_OK : fp3_no_memory(error);
}

/* Its derivative, a number, is for who solves the equations without steps. */
static fp3_status add_state(fp3_model *model, const addition *what, const char *dimension,
                            double derivative, fp3_error *error) {
    fp3_status status = add(model, &model->states, &model->state_count, what, dimension, error);
    if (!status && !add_expr(model, (fp3_expr){.op = FP3_EXPR_NUMBER, .number = derivative}))
        status = fp3_no_memory(error);
    if (!status)
        model->states[model->state_count - 1].derivative = model->expr_count - 1;
    return status;
}

static fp3_status add_param(fp3_model *model, const addition *what, const char *dimension,
                            fp3_error *error) {
    const uint32_t index = model->param_count;
    fp3_status status = add(model, &model->params, &model->param_count, what, dimension, error);
    if (!status && !add_expr(model, (fp3_expr){.op = FP3_EXPR_PARAM, .index = index}))
        status = fp3_no_memory(error);
    return status;
}

/* A run may begin late, or make many steps: then this share of the end time may be long. A root is
 * found by prediction, a condition by bisection, until a step may be so short that FP32 rounds off
 * its increments. */
static double default_locate(const fp3_model *model, double tolerance, double until) {
    double locate = fmax(FINEST * fabs(until), fmin(FINE * fabs(until), PART * model->step));
    for (uint32_t i = 0; i < model->event_count; i++)
        if (model->events[i].armed == FP3_NONE)
            locate = fmax(locate, tolerance != 0 ? fmin(tolerance * fabs(until), model->step)
                                                 : COARSE * model->step);
    return locate;
}

static int has_condition(const fp3_model *model) {
    int has = 0;
    for (uint32_t i = 0; i < model->event_count; i++)
        has |= model->events[i].armed == FP3_NONE;
    return has;
}

/* Whether there is an event to look for; is_root: at a root. */
static int has_located(const fp3_model *model, const fp3_switchings *switchings, int is_root) {
    int has = 0;
    for (uint32_t i = 0; switchings->kind && i < model->event_count; i++)
        has |= !fp3_switchings_time(model, switchings, &model->events[i]) &&
               (!is_root || model->events[i].armed != FP3_NONE);
    return has;
}

/* If a condition is true at the start, its event happens at once: the first step is as long as an
 * event may be late. */
static void start_short(fp3_model *model, int is_chosen, double locate) {
    const uint32_t param = fp3_model_param(model, "locate");
    fp3_quantity *first = &model->states[fp3_model_state(model, is_chosen ? "h_cut" : "h_next")];
    first->value = locate;
    for (uint32_t i = 0; i < model->expr_count; i++)
        if (model->exprs[i].op == FP3_EXPR_PARAM && model->exprs[i].index == param)
            first->start = i;
}

fp3_status fp3_model_adapt(fp3_model *model, const fp3_adaptive_def *def, fp3_error *error) {
    FP3_HOST;
    if (fp3_definition_check(def, sizeof *def, "fp3_adaptive_def", error))
        return FP3_E_ARGUMENT;
    if (fp3_model_is_map(model))
        return fp3_fail(
            error, FP3_E_PROGRAM,
            "'%s' has no equations, so its steps have no length that could be chosen or "
            "cut: give their number",
            model->name);
    const double until = def->until != 0 ? def->until : model->span;
    const int is_chosen = def->tolerance != 0, has_events = model->event_count > 0;
    fp3_switchings switchings;
    fp3_status status = fp3_switchings_find(model, &switchings, error);
    const int is_located = has_located(model, &switchings, 0);
    const int has_line = is_chosen && has_located(model, &switchings, 1);
    const struct {
        addition what;
        int is_wanted, is_time;
    } states[] = {
        {{"t", "time", 0, 0}, 1, 1},
        {{"h_next", "the step that is tried next", is_chosen ? model->step : NO_STEP_YET, 0}, 1, 1},
        {{"accepted", "steps", 0, 0}, 1, 0},
        {{"rejected", "attempts", 0, 0}, 1, 0},
        {{"smallest", "accepted step, as it was meant", NO_STEP_YET, 0}, is_chosen, 1},
        {{"largest", "accepted step", 0, 0}, is_chosen, 1},
        {{"h_cut", "the longest step up to an event", NO_STEP_YET, 0}, has_events && is_chosen, 1},
        {{FP3_STATE_BEFORE, "a step that ends before the event", 0, 0}, is_located, 1},
        {{FP3_STATE_BEHIND, "a step that ends behind it", 0, 0}, is_located, 1},
        {{FP3_STATE_ROOT_BEFORE, "the root there", 0, 0}, has_line, 0},
        {{FP3_STATE_ROOT_BEHIND, "the root there", 0, 0}, has_line, 0},
    };
    const addition params[] = {
        {"until", "where the object ends", until, 0},
        {"tolerance", "of a step's error, relative", def->tolerance, 1},
        {"absolute", "of a step's error", def->absolute != 0 ? def->absolute : def->tolerance, 1},
        {"locate", "how late an event may be",
         def->locate != 0 ? def->locate : default_locate(model, def->tolerance, until), 1},
        {"maxstep", "the longest step", def->maxstep, 1},
    };
    const char *unit = model->time_unit;
    const int is_short = has_condition(model);
    const int is_wanted[] = {1, is_chosen, is_chosen, has_events,
                             is_chosen && (def->maxstep != 0 || switchings.unknown != FP3_NONE)};
    fp3_switchings_close(&switchings);
    if (!status && is_taken(model, "t_low"))
        status = fp3_fail(error, FP3_E_PROGRAM, TAKEN, "t_low");
    if (!status && is_taken(model, "maxstep"))
        status = fp3_fail(error, FP3_E_PROGRAM, TAKEN, "maxstep");
    for (size_t i = 0; !status && i < sizeof params / sizeof *params; i++)
        if (is_wanted[i])
            status = add_param(model, &params[i], i == 1 || i == 2 ? "" : unit, error);
    for (size_t i = 0; !status && i < sizeof states / sizeof *states; i++)
        if (states[i].is_wanted)
            status =
                add_state(model, &states[i].what, states[i].is_time ? unit : "", i == 0, error);
    if (!status && is_short)
        start_short(model, is_chosen, params[3].value);
    return status;
}

/* ---- models whose objects see each other ---- */

static fp3_quantity *quantity(const fp3_model *m, const char *name) {
    const uint32_t state = fp3_model_state(m, name), param = fp3_model_param(m, name);
    return state != FP3_NONE ? &m->states[state] : param != FP3_NONE ? &m->params[param] : NULL;
}

/* The first that has it. */
static const fp3_quantity *any(fp3_model *const *list, size_t count, const char *name) {
    const fp3_quantity *found = NULL;
    for (size_t i = 0; !found && i < count; i++)
        found = quantity(list[i], name);
    return found;
}

static fp3_status add_to_all(fp3_model *const *list, size_t count, const char *name, int is_param,
                             fp3_error *error) {
    const fp3_quantity *of = any(list, count, name);
    fp3_status status = FP3_OK;
    for (size_t i = 0; of && !status && i < count; i++) {
        const addition what = {name, of->doc, of->value, of->is_shared};
        if (!quantity(list[i], name))
            status = is_param ? add_param(list[i], &what, of->dimension, error)
                              : add_state(list[i], &what, of->dimension, 0, error);
    }
    return status;
}

/* The same value for all: the least, or the largest. */
static void agree(fp3_model *const *list, size_t count, const char *name, int is_least) {
    const fp3_quantity *of = any(list, count, name);
    double value = of ? of->value : 0;
    for (size_t i = 0; of && i < count; i++)
        value = (is_least ? fmin : fmax)(value, quantity(list[i], name)->value);
    for (size_t i = 0; of && i < count; i++)
        quantity(list[i], name)->value = value;
}

fp3_status fp3_models_adapt_alike(fp3_model *const *list, size_t count, fp3_error *error) {
    static const char *const states[] = {"h_cut", FP3_STATE_BEFORE, FP3_STATE_BEHIND,
                                         FP3_STATE_ROOT_BEFORE, FP3_STATE_ROOT_BEHIND};
    fp3_status status = FP3_OK;
    int is_short = 0;
    for (size_t i = 0; i < count; i++)
        is_short |= has_condition(list[i]);
    for (size_t k = 0; !status && k < sizeof states / sizeof *states; k++)
        status = add_to_all(list, count, states[k], 0, error);
    if (!status)
        status = add_to_all(list, count, "locate", 1, error);
    if (!status)
        status = add_to_all(list, count, "maxstep", 1, error);
    if (status)
        return status;
    agree(list, count, "h_next", 1);
    agree(list, count, "maxstep", 1);
    agree(list, count, "locate", 0);
    for (size_t i = 0; is_short && i < count; i++)
        start_short(list[i], fp3_model_chooses_steps(list[i]), quantity(list[i], "locate")->value);
    return FP3_OK;
}
