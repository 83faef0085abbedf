/* SPDX-License-Identifier: Apache-2.0 */
/* root.c - on which side of a root a step begins and ends. */
#include "root.h"

#include "compiler/value/ops.h"

#include <inttypes.h>

/* Steps that are not adaptive end where they do: there nothing is looked for. */
int fp3_root_is(const fp3_advance *a, const fp3_event *event) {
    const fp3_model *model = a->step->model;
    if (event->armed == FP3_NONE)
        return 0;
    if (a->is_adaptive)
        return !fp3_switchings_time(model, &a->switchings, event);
    const fp3_expr *e = &model->exprs[event->condition];
    return !model->exprs[e->operand[0]].is_known || model->exprs[e->operand[1]].op != FP3_EXPR_TIME;
}

/* What the condition of a root is the sign of: b - a of a <= b. */
static term gap(lowering *l, const fp3_expr *e) {
    const term a = fp3_lower(l, e->operand[0]), b = fp3_lower(l, e->operand[1]);
    if (fp3_dag_is_number(l->g, a.node, 0))
        return b;
    return fp3_dag_is_number(l->g, b.node, 0) ? fp3_term_negated(a) : fp3_term_sub(l->g, b, a);
}

/* The side on which a step begins: at the root, the side to which the value moves. A value that an
 * event holds at its root is on the side that it came from. */
static uint32_t side(const fp3_advance *a, const fp3_event *event, lowering *before, uint32_t from,
                     int is_falling) {
    dag *g = &a->step->values;
    const fp3_model *model = a->step->model;
    const uint32_t rate = a->options->rate ? a->options->rate[event - model->events] : FP3_NONE;
    if (rate == FP3_NONE || model->exprs[event->armed].op == FP3_EXPR_LESS_EQUAL)
        return from;
    const term r = fp3_lower(before, rate), way = is_falling ? fp3_term_negated(r) : r;
    return sel(g, from, from, fp3_dag_first(g, fp3_term_value(g, way)));
}

/* The first word of a pair has its sign. A NaN before the step is below no root; a NaN after the
 * step stays. */
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
    const uint32_t begin = side(a, event, before, from, is_falling);
    const uint32_t is_armed = is_falling ? op2(g, op, zero, begin) : op2(g, op, begin, zero);
    const double far = (a->is_chosen ? FP3_ROOT_FAR : 1) * (is_falling ? 1 : -1);
    return (fp3_reach){from, sel(g, is_armed, to, num(g, far)), is_armed, is_falling};
}

uint32_t fp3_root_is_ahead(const fp3_advance *a, const fp3_event *event, const fp3_reach *r) {
    dag *g = &a->step->values;
    const uint32_t zero = num(g, 0);
    g->note = fp3_note(&a->step->notes, "line %" PRIu32 ": is the root still ahead", event->line);
    return r->is_falling ? op2(g, FP3_OP_LT, zero, r->to) : op2(g, FP3_OP_LT, r->to, zero);
}

static uint32_t above_zero(dag *g, const fp3_reach *r, uint32_t value) {
    return r->is_falling ? value : sub(g, num(g, 0), value);
}

void fp3_root_nearest(const fp3_advance *a, const fp3_event *event, const fp3_reach *r,
                      uint32_t *from, uint32_t *to) {
    dag *g = &a->step->values;
    g->note = fp3_note(&a->step->notes, "line %" PRIu32 ": is this root the nearest", event->line);
    const uint32_t begin = sel(g, r->is_armed, above_zero(g, r, r->from), num(g, FP3_ROOT_FAR));
    const uint32_t end = above_zero(g, r, r->to);
    *from = *from == FP3_NONE ? begin : op2(g, FP3_OP_MIN, *from, begin);
    *to = *to == FP3_NONE ? end : op2(g, FP3_OP_MIN, *to, end);
}
