/* SPDX-License-Identifier: Apache-2.0 */
#include "event.h"

#include "expression.h"
#include "quantity.h"
#include "side.h"
#include "symbol.h"
#include "vector.h"

#include "base/number.h"

#include <string.h>

/* What is read is FP3_NONE after an error. */
static ode_value number(ode_parser *p, ode_context context, const char *what) {
    const fp3_token at = p->in.next;
    const ode_value value = fp3_ode_expression(p, context);
    if (value.size <= 1)
        return value;
    fp3_ode_wrong(&p->in, at, "a number as the %s (this is %s)", what, fp3_ode_shape(value.size));
    return (ode_value){0};
}

static uint32_t taken(ode_value value) { return value.size == 1 ? value.expr[0] : FP3_NONE; }

/* `root` and `at` are names as well: what follows tells. */
static int is_followed_by(const ode_parser *p, const char *text) {
    ode_lexer ahead = p->in.lexer;
    return fp3_token_is(fp3_ode_next(&ahead), text);
}

/* 0 after an error. */
static int add(ode_parser *p, fp3_token name, uint32_t state, uint32_t expr, ode_event *event) {
    for (uint32_t i = event->first; i < p->assignment_count; i++)
        if (p->assignments[i].state == state) {
            fp3_ode_wrong(&p->in, name, "another state (this `when` already gives it a value)");
            return 0;
        }
    if (p->assignment_count == ODE_ASSIGNMENTS) {
        fp3_ode_over(&p->in, name, "at most %d values given by events", ODE_ASSIGNMENTS);
        return 0;
    }
    p->assignments[p->assignment_count++] =
        (ode_assignment){state, fp3_ode_equation(p, name, expr)};
    event->count++;
    return 1;
}

/* "x = expression" */
static void assignment(ode_parser *p, ode_event *event) {
    unsigned start = 0, size = 0;
    const fp3_token name = p->in.next;
    if (name.kind != FP3_TOKEN_NAME) {
        fp3_ode_lost(&p->in, "the name of a state, as in `when x < 0: x = -x, v = -v`");
        return;
    }
    fp3_ode_advance(&p->in);
    if (fp3_ode_at(&p->in, "'"))
        fp3_ode_lost(&p->in, "'=' (an event gives a state its value, not its derivative)");
    const ode_symbol *s = fp3_ode_target(p, name, &start, &size);
    const ode_value value = fp3_ode_right_side(p, ODE_IN_EQUATION, size);
    for (unsigned i = 0; s && value.size && i < size; i++)
        if (!add(p, name, s->first + start + i, value.expr[i], event))
            return;
}

/* A state that engines know by its name; no equation moves it. FP3_NONE after an error. */
static uint32_t add_known(ode_parser *p, fp3_token keyword, const char *known, const char *doc) {
    const ode_constant nothing = {.expr = {FP3_NONE}};
    const uint32_t state = p->state_count;
    fp3_token name = keyword;
    name.text = known;
    name.length = strlen(known);
    const ode_symbol *other = fp3_ode_occupied(p, name, 1);
    if (other) {
        fp3_ode_wrong(&p->in, keyword, "no '%s' beside it (line %u declares this one)", known,
                      other->at.location.line);
        return FP3_NONE;
    }
    fp3_ode_add_quantity(p, name, ODE_STATE, 1, 0, &nothing, doc);
    if (p->state_count == state)
        return FP3_NONE;
    const ode_value zero = fp3_ode_leaf(p, keyword, FP3_EXPR_NUMBER, 0, 0);
    p->states[state].first = fp3_ode_equation(p, keyword, taken(zero));
    return state;
}

/* `stop` and `remove` are names as well: what follows tells. */
static int is_end(const ode_parser *p) {
    return (fp3_ode_at(&p->in, "stop") || fp3_ode_at(&p->in, "remove")) &&
           !is_followed_by(p, "=") && !is_followed_by(p, "[") && !is_followed_by(p, ".") &&
           !is_followed_by(p, "'");
}

/* Sets the state by which an engine knows; all events have one. */
static void set_removed(ode_parser *p, fp3_token keyword, ode_event *event) {
    if (!p->has_removed)
        p->removed = add_known(p, keyword, FP3_NAME_REMOVED, "1: an event has removed the object");
    p->has_removed = 1;
    const ode_value one = fp3_ode_leaf(p, keyword, FP3_EXPR_NUMBER, 0, 1);
    if (p->removed != FP3_NONE)
        add(p, keyword, p->removed, taken(one), event);
}

/* After either of them nothing changes, so it comes last. */
static void end_of_object(ode_parser *p, ode_event *event) {
    const fp3_token keyword = p->in.next;
    const int removes = fp3_token_is(keyword, "remove");
    fp3_ode_advance(&p->in);
    event->stops = removes ? FP3_REMOVES : FP3_STOPS;
    if (!fp3_ode_at_end(&p->in))
        fp3_ode_lost(&p->in, "the end of the line (`%s` comes last)", removes ? "remove" : "stop");
    else if (removes && !p->skipping)
        set_removed(p, keyword, event);
}

static void assignments(ode_parser *p, ode_event *event) {
    do
        assignment(p, event);
    while (fp3_ode_accept(&p->in, ",") && !is_end(p));
}

/* What follows the condition. */
static void consequence(ode_parser *p, ode_event *event) {
    fp3_ode_expect(&p->in, ":", "an operator or ':', and then a new value, as in `x = 0`");
    if (!is_end(p))
        assignments(p, event);
    if (is_end(p))
        end_of_object(p, event);
}

static void add_event(ode_parser *p, ode_event event, ode_event *list, uint32_t *count) {
    if (p->skipping)
        return;
    if (*count == ODE_EVENTS)
        fp3_ode_over(&p->in, event.at, "at most %d events, and as many projections", ODE_EVENTS);
    else if (!p->in.is_over)
        list[(*count)++] = event;
}

/* Whether the event keeps the object from leaving the root: it stops or removes the object, or sets
 * a state that the expression is made of. */
static int holds(const ode_parser *p, const ode_event *event, uint32_t expr) {
    char is_part[ODE_EXPRS] = {0};
    if (event->stops)
        return 1;
    is_part[expr] = 1;
    for (uint32_t i = expr + 1; i-- > 0;)
        for (int k = 0; is_part[i] && k < 3; k++)
            if (p->exprs[i].operand[k] != FP3_NONE)
                is_part[p->exprs[i].operand[k]] = 1;
    for (uint32_t i = 0; i <= expr; i++)
        for (uint32_t k = 0; is_part[i] && p->exprs[i].op == FP3_EXPR_STATE && k < event->count;
             k++)
            if (p->assignments[event->first + k].state == p->exprs[i].index)
                return 1;
    return 0;
}

/* a <= b becomes true. What the event puts on the root itself, as a ball on the floor, has to leave
 * it before the step ends, or the event happens again; what only passes the root is past it where a
 * is b. */
static void rise(ode_parser *p, fp3_token at, ode_value a, ode_value b, uint32_t g,
                 ode_event event) {
    event.condition = taken(fp3_ode_binary(p, at, FP3_EXPR_LESS_EQUAL, a, b));
    const int is_held = g != FP3_NONE && holds(p, &event, g);
    event.armed = taken(fp3_ode_binary(p, at, is_held ? FP3_EXPR_LESS_EQUAL : FP3_EXPR_LESS, b, a));
    add_event(p, event, p->events, &p->event_count);
}

/* `(g) rising`, and what happens. */
static void root_event(ode_parser *p, ode_event event) {
    const fp3_token at = p->in.next;
    fp3_ode_advance(&p->in);
    fp3_ode_expect(&p->in, "(", "'('");
    const ode_value g = number(p, ODE_IN_EQUATION, "root");
    const ode_value zero = fp3_ode_leaf(p, at, FP3_EXPR_NUMBER, 0, 0);
    fp3_ode_expect(&p->in, ")", "an operator or ')'");
    const int is_any = fp3_ode_accept(&p->in, "any");
    const int is_rising = !is_any && fp3_ode_accept(&p->in, "rising");
    if (!is_any && !is_rising && !fp3_ode_accept(&p->in, "falling"))
        fp3_ode_lost(&p->in, "rising, falling or any");
    consequence(p, &event);
    if (g.size != 1 || zero.size != 1)
        return;
    if (is_any || is_rising)
        rise(p, at, zero, g, g.expr[0], event);
    if (!is_rising)
        rise(p, at, g, zero, g.expr[0], event);
}

static void conditioned(ode_parser *p, fp3_token keyword) {
    ode_event event = {.first = p->assignment_count, .armed = FP3_NONE, .at = keyword};
    if (fp3_ode_at(&p->in, "root") && is_followed_by(p, "(")) {
        root_event(p, event);
        return;
    }
    event.condition = taken(number(p, ODE_IN_EQUATION, "condition"));
    consequence(p, &event);
    add_event(p, event, p->events, &p->event_count);
}

static int is_timed(const ode_parser *p, fp3_token first) {
    return fp3_token_is(first, "at") && fp3_ode_at(&p->in, "t") && is_followed_by(p, "=");
}

static void timed(ode_parser *p, fp3_token keyword) {
    ode_event event = {.first = p->assignment_count, .at = keyword};
    const fp3_token at = p->in.next;
    const ode_value t = fp3_ode_leaf(p, at, FP3_EXPR_TIME, 0, 0);
    fp3_ode_advance(&p->in);
    fp3_ode_expect(&p->in, "=", "'='");
    const ode_value time = number(p, ODE_IN_START, "time");
    p->context = ODE_IN_EQUATION;
    consequence(p, &event);
    rise(p, at, time, t, FP3_NONE, event);
}

static int is_projection(const ode_parser *p, fp3_token first) {
    return fp3_token_is(first, "project") && p->in.next.kind == FP3_TOKEN_NAME;
}

static void projection(ode_parser *p, fp3_token keyword) {
    ode_event event = {
        .condition = FP3_NONE, .first = p->assignment_count, .armed = FP3_NONE, .at = keyword};
    p->context = ODE_IN_EQUATION;
    p->is_in_projection = 1;
    assignments(p, &event);
    p->is_in_projection = 0;
    if (is_end(p))
        fp3_ode_lost_at(&p->in, keyword, "an event (a projection %s nothing)",
                        fp3_ode_at(&p->in, "stop") ? "stops" : "removes");
    add_event(p, event, p->projections, &p->projection_count);
}

static int is_rest(const ode_parser *p, fp3_token first) {
    return fp3_token_is(first, "rest") && fp3_ode_at(&p->in, "when");
}

/* The time behind `for`. 0 after an error. */
static int read_rest(ode_parser *p, fp3_token keyword) {
    const fp3_token at = p->in.next;
    const uint32_t line = p->rest.at.location.line;
    const int is_first = !fp3_token_exists(p->rest.at);
    ode_constant time;
    float single;
    if (!fp3_ode_measured(p, ODE_IN_CONSTANT, 1, &time))
        return 0;
    const char *expected =
        time.value[0] > 0 ? fp3_number_step(time.value[0], &single) : "a time above 0";
    if (expected)
        fp3_ode_wrong(&p->in, at, "%s", expected);
    else if (!is_first)
        fp3_ode_wrong(&p->in, keyword, "only one 'rest' (line %u has one)", line);
    else
        p->rest = (ode_time){time.value[0], time.dimension, at};
    return !expected && is_first;
}

/* `rest when c for T` is the projection at_rest = c ? at_rest + h/T : 0. */
static void rest(ode_parser *p, fp3_token keyword) {
    ode_event event = {.condition = FP3_NONE, .armed = FP3_NONE, .at = keyword};
    fp3_ode_advance(&p->in);
    p->is_in_projection = 1;
    const ode_value condition = number(p, ODE_IN_EQUATION, "condition");
    p->is_in_projection = 0;
    fp3_ode_expect(&p->in, "for", "an operator or `for`, and then a time");
    if (!read_rest(p, keyword) || condition.size != 1)
        return;
    const uint32_t state =
        add_known(p, keyword, FP3_NAME_REST, "how long the object has been at rest");
    if (state == FP3_NONE)
        return;
    event.first = p->assignment_count;
    const ode_value step = fp3_ode_leaf(p, keyword, FP3_EXPR_STEP, 0, 0),
                    whole = fp3_ode_leaf(p, keyword, FP3_EXPR_NUMBER, 0, p->rest.value),
                    before = fp3_ode_leaf(p, keyword, FP3_EXPR_STATE, state, 0),
                    zero = fp3_ode_leaf(p, keyword, FP3_EXPR_NUMBER, 0, 0);
    const ode_value more = fp3_ode_binary(p, keyword, FP3_EXPR_ADD, before,
                                          fp3_ode_binary(p, keyword, FP3_EXPR_DIV, step, whole));
    const ode_value value = fp3_ode_select(p, keyword, condition, more, zero);
    if (value.size == 1 && add(p, keyword, state, value.expr[0], &event))
        add_event(p, event, p->projections, &p->projection_count);
}

int fp3_ode_is_event(const ode_parser *p, fp3_token first) {
    return fp3_token_is(first, "when") || is_timed(p, first) || is_projection(p, first) ||
           is_rest(p, first);
}

void fp3_ode_event(ode_parser *p, fp3_token first) {
    if (is_timed(p, first))
        timed(p, first);
    else if (is_projection(p, first))
        projection(p, first);
    else if (is_rest(p, first))
        rest(p, first);
    else
        conditioned(p, first);
}
