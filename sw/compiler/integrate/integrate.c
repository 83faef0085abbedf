/* SPDX-License-Identifier: Apache-2.0 */
/* integrate.c - the variables of a step, and what becomes of them. */
#include "integrate.h"

#include "chebyshev.h"
#include "compiler/adaptive/adaptive.h"
#include "compiler/pairs/double_step.h"
#include "compiler/step/advance.h"
#include "compiler/value/ops.h"
#include "events.h"
#include "project.h"
#include "remember.h"
#include "repeat.h"
#include "rosenbrock.h"
#include "runge_kutta.h"
#include "splitting.h"
#include "stoermer.h"

#include <fp3/compile.h>
#include <stdlib.h>

static int add_variables(const fp3_advance *a, role role, int positions, int others) {
    for (uint32_t s = 0; s < a->step->model->state_count; s++)
        if ((role == ROLE_STATE ? fp3_fit_is_live : fp3_fit_is_moved)(a->fit, s) &&
            (fp3_fit_is_position(a->fit, s) ? positions : others) &&
            !fp3_step_add(a->step, role, s))
            return 0;
    return 1;
}

/* States first: the host finds them where the model has them. */
static fp3_status make_variables(fp3_advance *a, fp3_error *error) {
    const int is_stoermer = a->integrator->kind == FP3_STOERMER;
    const int has_lost = a->options->arithmetic == FP3_COMPENSATED;
    if (!add_variables(a, ROLE_STATE, 1, 1) ||
        !add_variables(a, ROLE_LOST, has_lost, has_lost && !is_stoermer) ||
        !add_variables(a, ROLE_BEFORE, is_stoermer, 0) ||
        !add_variables(a, ROLE_LOST_BEFORE, is_stoermer && has_lost, 0) ||
        (a->fit->has_time && !a->is_adaptive && !fp3_step_add(a->step, ROLE_STEPS, FP3_NONE)) ||
        (a->is_adaptive && a->options->arithmetic != FP3_DOUBLE_SINGLE &&
         !fp3_step_add(a->step, ROLE_LOW, fp3_model_adapted(a->step->model))) ||
        (fp3_advance_may_stop(a) && !fp3_step_add(a->step, ROLE_STOPPED, FP3_NONE)))
        return fp3_no_memory(error);
    fp3_advance_begin(a);
    return fp3_repeat_prepare(a, error);
}

/* Whether the step is one, and no attempt that is rejected. */
static uint32_t is_made(const fp3_advance *a) {
    return a->is_adaptive ? a->is_good : num(&a->step->values, 1);
}

/* What a variable has after the step. */
static term next_of(const fp3_advance *a, uint32_t i) {
    const variable *v = &a->step->variables[i];
    dag *g = &a->step->values;
    switch (v->role) {
    case ROLE_STATE:
        return a->now[v->state];
    case ROLE_LOST:
        return a->lost[v->state];
    case ROLE_STEPS:
        g->note = fp3_note(&a->step->notes, "steps made");
        return fp3_term_add(g, fp3_advance_held(a, g, v->role, v->state),
                            fp3_term(fp3_dag_number(g, 1)));
    case ROLE_SLEPT:
    case ROLE_CARRIED:
    case ROLE_WORST:
        return fp3_term(fp3_dag_variable(g, i));
    case ROLE_STOPPED:
        g->note = fp3_note(&a->step->notes, "whether an event has stopped the object");
        return fp3_term(a->stops == FP3_NONE ? num(g, 0) : sel(g, a->stops, is_made(a), num(g, 0)));
    default:
        return fp3_advance_held(a, g, v->role == ROLE_BEFORE ? ROLE_STATE : ROLE_LOST, v->state);
    }
}

static fp3_status advance(fp3_advance *a, fp3_error *error) {
    switch (a->integrator->kind) {
    case FP3_RUNGE_KUTTA:
        return fp3_runge_kutta(a, error);
    case FP3_SPLITTING:
        return fp3_splitting(a, error);
    case FP3_ROSENBROCK:
        return fp3_rosenbrock(a, a->options->partial, error);
    case FP3_CHEBYSHEV:
        return fp3_chebyshev(a, error);
    default:
        return fp3_stoermer(a, error);
    }
}

/* Whether nothing ever gives the state another value. */
static int is_still(const fp3_model *model, uint32_t state) {
    const fp3_expr *derivative = &model->exprs[model->states[state].derivative];
    for (uint32_t i = 0; i < model->assignment_count; i++)
        if (model->assignments[i].state == state)
            return 0;
    return derivative->op == FP3_EXPR_NUMBER && derivative->number == 0;
}

/* Params that other kinds read are known, whether or not this model reads them. A state that ends
 * as it began is seen as the same at all places. */
static void couple(fp3_step *step) {
    const fp3_model *model = step->model;
    const fp3_coupling *c = step->coupling;
    for (uint32_t e = 0; e < model->expr_count; e++)
        if (model->exprs[e].op == FP3_EXPR_PARAM && c->params >> model->exprs[e].index & 1)
            fp3_known_seen(&step->known, e);
    step->is_still = 1;
    for (uint32_t i = 0; i < step->variable_count; i++) {
        const variable *v = &step->variables[i];
        if (v->role == ROLE_STATE && c->seen >> v->state & 1)
            step->is_still &=
                v->next == fp3_dag_variable(&step->values, i) || is_still(model, v->state);
    }
    if (step->is_still)
        step->shown = 0;
}

fp3_status fp3_integrate(const fp3_model *model, const fp3_integrator *integrator,
                         const fp3_options *options, const fp3_fit *fit, fp3_step *step,
                         fp3_error *error) {
    fp3_advance a = {.step = step, .integrator = integrator, .options = options, .fit = fit};
    a.now = calloc(model->state_count + 1u, sizeof *a.now);
    a.lost = calloc(model->state_count + 1u, sizeof *a.lost);
    a.error = calloc(model->state_count + 1u, sizeof *a.error);
    a.slope = calloc(model->state_count + 1u, sizeof *a.slope);
    a.is_adaptive = fit->control != 0;
    a.is_chosen = fp3_model_chooses_steps(model);
    const fp3_coupling *c = options->coupling;
    a.is_common =
        a.is_adaptive && (model->relation_count || (c && (c->seen || c->params || c->is_common)));
    a.is_in_time = a.next = a.root_before = a.root_behind = a.stops = FP3_NONE;
    a.error_scale = fp3_term(FP3_NONE);
    fp3_status status = fp3_step_open(step, model, options, error);
    if (!status && (!a.now || !a.lost || !a.error || !a.slope))
        status = fp3_no_memory(error);
    if (!status)
        status = make_variables(&a, error);
    if (!status)
        status = fp3_adaptive_begin(&a, error);
    if (!status)
        status = advance(&a, error);
    if (!status)
        fp3_advance_show_start(&a);
    if (!status)
        status = fp3_project(&a, error);
    if (!status)
        fp3_advance_show_rest(&a, 0);
    if (!status)
        status = fp3_adaptive_judge(&a, error);
    if (!status)
        status = fp3_events(&a, error);
    if (!status)
        fp3_advance_show_rest(&a, 1);
    if (!status)
        status = fp3_remember(&a, error);
    if (!status)
        status = fp3_adaptive_accept(&a, error);
    for (uint32_t i = 0; !status && i < step->variable_count; i++)
        if (step->variables[i].next == FP3_NONE) /* else fp3_adaptive_accept has made it */
            step->variables[i].next = fp3_advance_next(&a, i, next_of(&a, i));
    if (!status && step->coupling)
        couple(step);
    for (uint32_t i = 0; i < a.place_count; i++)
        fp3_lower_close(&a.places[i]);
    free(a.places);
    fp3_lower_close(&a.inside);
    fp3_switchings_close(&a.switchings);
    free(a.now);
    free(a.lost);
    free(a.error);
    free(a.slope);
    free(a.previous);
    if (!status)
        status = fp3_step_check(step, error);
    if (status || options->arithmetic != FP3_DOUBLE_SINGLE)
        return status;
    status = fp3_double_step(step, error);
    return status ? status : fp3_step_check(step, error);
}
