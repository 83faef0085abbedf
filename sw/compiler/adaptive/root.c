/* SPDX-License-Identifier: Apache-2.0 */
/* root.c - on which side of a root a step begins and ends. */
#include "root.h"

#include "compiler/value/ops.h"

#include <inttypes.h>

/* Whether it compares t itself with a time that is known, at which steps end. */
static int is_timed(const fp3_advance *a, const fp3_event *event) {
    const fp3_model *model = a->step->model;
    const fp3_expr *e = &model->exprs[event->condition];
    int has_end = !a->is_adaptive; /* there nothing is looked for */
    for (uint32_t i = 0; i < a->switchings.count; i++)
        has_end |= a->switchings.expr[i] == event->condition;
    return has_end && model->exprs[e->operand[0]].is_known &&
           model->exprs[e->operand[1]].op == FP3_EXPR_TIME;
}

int fp3_root_is(const fp3_advance *a, const fp3_event *event) {
    return event->armed != FP3_NONE && !is_timed(a, event);
}

/* What the condition of a root is the sign of: b - a of a <= b. */
static term gap(lowering *l, const fp3_expr *e) {
    const term a = fp3_lower(l, e->operand[0]), b = fp3_lower(l, e->operand[1]);
    if (fp3_dag_is_number(l->g, a.node, 0))
        return b;
    return fp3_dag_is_number(l->g, b.node, 0) ? fp3_term_negated(a) : fp3_term_sub(l->g, b, a);
}

/* Of a pair the first word has its sign. A NaN before the step is below no root; one after it stays. */
fp3_reach fp3_root_reach(const fp3_advance *a, const fp3_event *event, lowering *before,
                         lowering *after) {
    dag *g = &a->step->values;
    const fp3_model *model = a->step->model;
    const fp3_expr *e = &model->exprs[event->condition];
    const uint32_t op =
        model->exprs[event->armed].op == FP3_EXPR_LESS_EQUAL ? FP3_OP_LE : FP3_OP_LT;
    const term g0 = gap(before, e), g1 = gap(after, e);
    const int is_falling = g0.is_negative && g1.is_negative;
    g->note = fp3_note(&a->step->notes, "line %" PRIu32 ": on which side of the root", event->line);
    const uint32_t from = fp3_dag_first(g, is_falling ? g0.node : fp3_term_value(g, g0));
    const uint32_t to = fp3_dag_first(g, is_falling ? g1.node : fp3_term_value(g, g1));
    const uint32_t zero = num(g, 0);
    const uint32_t is_armed = is_falling ? op2(g, op, zero, from) : op2(g, op, from, zero);
    return (fp3_reach){from, sel(g, is_armed, to, num(g, is_falling ? 1 : -1)), is_falling};
}
