/* SPDX-License-Identifier: Apache-2.0 */
#include "finish.h"

#include <stdio.h>
#include <string.h>

#include "dimension_check.h"
#include "relation.h"
#include "remember.h"
#include "vector.h"

/* The state that is the right side of the equation, all by itself; or FP3_NONE. */
static uint32_t bare_state(const ode_parser *p, const ode_equation *e) {
    if (!fp3_token_exists(e->at) || e->expr == FP3_NONE || p->exprs[e->expr].op != FP3_EXPR_STATE)
        return FP3_NONE;
    return p->exprs[e->expr].index;
}

/* From s'' = e and s' = v follows v' = e. */
static void resolve_second(ode_parser *p, ode_quantity *s) {
    uint32_t v = bare_state(p, &s->first);
    if (v == FP3_NONE) {
        if (!fp3_token_exists(s->first.at) || s->first.expr != FP3_NONE)
            fp3_ode_wrong(&p->in, s->second.at,
                          "an equation %s' = v as well, where v is a state: %s'' is then v'",
                          s->quantity.name, s->quantity.name);
    } else if (fp3_token_exists(p->states[v].first.at)) {
        fp3_ode_wrong(&p->in, s->second.at, "only one equation for '%s' (line %u has one)",
                      p->states[v].quantity.name, p->states[v].first.at.location.line);
    } else {
        p->states[v].first = s->second;
    }
}

/* Without any equation the model is a map: projections alone change its states. */
static int is_map(const ode_parser *p) {
    for (uint32_t i = 0; i < p->state_count; i++)
        if (fp3_token_exists(p->states[i].first.at) || fp3_token_exists(p->states[i].second.at))
            return 0;
    return p->projection_count > 0;
}

static void finish_states(ode_parser *p) {
    const char *last_missing = NULL;
    if (is_map(p))
        for (uint32_t i = 0; i < p->state_count; i++) {
            const fp3_token at = p->states[i].at;
            p->states[i].first = (ode_equation){
                .at = at, .expr = fp3_ode_leaf(p, at, FP3_EXPR_NUMBER, 0, 0).expr[0]};
        }
    for (uint32_t i = 0; i < p->state_count; i++)
        if (fp3_token_exists(p->states[i].second.at))
            resolve_second(p, &p->states[i]);
    for (uint32_t i = 0; i < p->state_count; i++) {
        ode_quantity *s = &p->states[i];
        if (!fp3_token_exists(s->first.at) && s->at.text != last_missing) {
            fp3_ode_wrong(&p->in, s->at, "an equation for this state, %s' = ...", s->quantity.name);
            last_missing = s->at.text;
        }
        uint32_t v = bare_state(p, &s->first);
        s->quantity.derivative = s->first.expr;
        s->quantity.velocity = v == i ? FP3_NONE : v;
        s->quantity.exact = fp3_token_exists(s->exact.at) ? s->exact.expr : FP3_NONE;
    }
}

/* Without its brackets. */
static void name_unit(const ode_parser *p, const ode_dimension *dimension,
                      char unit[FP3_UNIT_SIZE]) {
    char text[ODE_DIMENSION_TEXT_SIZE];
    *unit = '\0';
    if (dimension->kind != ODE_DIMENSION_KNOWN)
        return;
    fp3_ode_dimension_text(&p->dimension_names, dimension, text);
    snprintf(unit, FP3_UNIT_SIZE, "%.*s", (int)strcspn(text + 1, "]"), text + 1);
}

static void name_units(ode_parser *p) {
    for (uint32_t i = 0; i < p->definition_count; i++)
        name_unit(p, &p->dimensions[p->definitions[i].expr], p->definitions[i].unit);
    for (uint32_t i = 0; i < p->invariant_count; i++)
        name_unit(p, &p->dimensions[p->invariants[i].expr], p->invariants[i].unit);
    for (uint32_t i = 0; i < p->group_invariant_count; i++)
        name_unit(p, &p->dimensions[p->group_invariants[i].expr], p->group_invariants[i].unit);
    name_unit(p, &p->step.dimension, p->time_unit);
}

static void check_time(ode_parser *p, const ode_time *time) {
    if (fp3_token_exists(time->at) && !fp3_ode_dimension_fits(&p->step.dimension, &time->dimension))
        fp3_ode_wrong(&p->in, time->at, "the unit of the step (line %u)", p->step.at.location.line);
}

void fp3_ode_finish(ode_parser *p) {
    fp3_ode_check_dimensions(p, 0);
    fp3_ode_check_equations(p);
    finish_states(p);
    if (!p->state_count)
        fp3_ode_wrong(&p->in, p->in.next, "a state, as in: state v = 0");
    if (!fp3_token_exists(p->step.at))
        fp3_ode_wrong(&p->in, p->in.next, "a time step, as in: step 0.01");
    check_time(p, &p->span);
    check_time(p, &p->rest);
    fp3_ode_finish_invariants(p);
    fp3_ode_check_memories(p);
    if (!p->in.report.count)
        name_units(p);
}
