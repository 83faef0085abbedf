#include "event.h"

#include "expression.h"
#include "side.h"
#include "vector.h"

/* FP3_NONE after an error. */
static uint32_t condition(ode_parser *p, fp3_token at) {
    const ode_value value = fp3_ode_expression(p, ODE_IN_EQUATION);
    if (value.size > 1)
        fp3_ode_wrong(&p->in, at, "a number as the condition (this is %s)",
                      fp3_ode_shape(value.size));
    return value.size == 1 ? value.expr[0] : FP3_NONE;
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
    p->assignments[p->assignment_count++] = (ode_assignment){state, {name, expr}};
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

void fp3_ode_event(ode_parser *p, fp3_token keyword) {
    ode_event event = {.first = p->assignment_count, .at = keyword};
    event.condition = condition(p, p->in.next);
    fp3_ode_expect(&p->in, ":", "an operator or ':', and then what happens, as in `x = 0`");
    do
        assignment(p, &event);
    while (fp3_ode_accept(&p->in, ","));
    if (p->event_count == ODE_EVENTS)
        fp3_ode_over(&p->in, keyword, "at most %d events", ODE_EVENTS);
    else
        p->events[p->event_count++] = event;
}
