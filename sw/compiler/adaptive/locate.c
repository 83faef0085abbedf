/* locate.c - see locate.h. */
#include "locate.h"

#include "compiler/value/ops.h"

#include <inttypes.h>

#define HALF 0.5 /* of a step within which a condition becomes true */
#define NEVER 0x1p100

static void note(const fp3_advance *a, const char *text) {
    a->step->values.note = fp3_note(&a->step->notes, "%s", text);
}

static uint32_t either(dag *g, uint32_t a, uint32_t b) { return sel(g, a, num(g, 1), b); }

/* Whether so_far, or a part of the condition that it needs (is_true: to be true) was so before the step, and no
 * longer is. */
static uint32_t has_lost(lowering *before, lowering *after, uint32_t expr, int is_true,
                         uint32_t so_far) {
    const fp3_expr *e = &before->model->exprs[expr];
    dag *g = before->g;
    if (e->op == FP3_EXPR_NOT)
        return has_lost(before, after, e->operand[0], !is_true, so_far);
    if (e->op == FP3_EXPR_AND || e->op == FP3_EXPR_OR)
        return has_lost(before, after, e->operand[1], is_true,
                        has_lost(before, after, e->operand[0], is_true, so_far));
    const uint32_t b = fp3_lower(before, expr).node, a = fp3_lower(after, expr).node;
    const uint32_t lost = is_true ? sel(g, a, num(g, 0), b) : sel(g, b, num(g, 0), a);
    return either(g, lost, so_far);
}

/* Whether the condition is false before the step, and true after it or, as far as its parts tell, on the way: `x > wall
 * and v > 0` may be on the way if v > 0 is no longer true, as x then has been largest within the step. If no part of it is lost, it is
 * true on the way only if it is in the end. */
static uint32_t becomes(const fp3_advance *a, const fp3_event *event, lowering *before,
                        lowering *after) {
    const fp3_expr_op op = a->step->model->exprs[event->condition].op;
    const int has_parts = op == FP3_EXPR_AND || op == FP3_EXPR_OR || op == FP3_EXPR_NOT;
    dag *g = before->g;
    const uint32_t is_before = fp3_lower(before, event->condition).node;
    const uint32_t is_after = fp3_lower(after, event->condition).node;
    g->note = fp3_note(&a->step->notes, "line %" PRIu32 ": becomes true", event->line);
    return sel(g, is_before, num(g, 0),
               has_parts ? has_lost(before, after, event->condition, 1, is_after) : is_after);
}

/* What the condition of a root is the sign of: b - a of a < b or a <= b. */
static term gap(lowering *l, const fp3_expr *e) {
    const term a = fp3_lower(l, e->operand[0]), b = fp3_lower(l, e->operand[1]);
    if (fp3_dag_is_number(l->g, a.node, 0))
        return b;
    return fp3_dag_is_number(l->g, b.node, 0) ? fp3_term_negated(a) : fp3_term_sub(l->g, b, a);
}

/* How long before the end of the step the root is, by a straight line from the gap before to that after; below 0: how long after it. The estimate of the quotient is at most 0.25 % too small. A NaN if g has
 * become one: then nobody knows. */
static uint32_t since_root(const fp3_advance *a, const fp3_event *event, lowering *before,
                           lowering *after) {
    dag *g = before->g;
    const fp3_expr *e = &a->step->model->exprs[event->condition];
    const int is_held = a->step->model->exprs[event->unless].op == FP3_EXPR_LESS;
    const term g0 = gap(before, e), g1 = gap(after, e);
    g->note = fp3_note(&a->step->notes, "line %" PRIu32 ": how late", event->line);
    const uint32_t whole = fp3_dag_first(g, fp3_term_value(g, fp3_term_sub(g, g1, g0)));
    const uint32_t is_armed =
        op2(g, is_held ? FP3_OP_LE : FP3_OP_LT, fp3_term_value(g, g0), num(g, 0));
    const uint32_t is_ahead = sel(g, op2(g, FP3_OP_LE, whole, num(g, 0)), num(g, 0), is_armed);
    const uint32_t part = mul(g, fp3_dag_first(g, fp3_term_value(g, g1)),
                              op1(g, FP3_OP_RCP, sel(g, is_ahead, whole, num(g, 1))));
    return sel(g, is_ahead, mul(g, fp3_dag_first(g, a->h.node), part), num(g, -NEVER));
}

/* Whatever becomes true within a step may have been so since its beginning. */
static uint32_t since_begin(const fp3_advance *a, const fp3_event *event, lowering *before,
                            lowering *after) {
    dag *g = before->g;
    return sel(g, becomes(a, event, before, after), fp3_dag_first(g, a->h.node), num(g, 0));
}

static uint32_t larger(dag *g, uint32_t so_far, uint32_t other) {
    return so_far == FP3_NONE ? other : op2(g, FP3_OP_MAX, so_far, other);
}

static uint32_t both(dag *g, uint32_t so_far, uint32_t other) {
    return so_far == FP3_NONE ? other : mul(g, so_far, other);
}

/* Not if nobody knows how long it is. */
static uint32_t is_short(const fp3_advance *a, uint32_t since) {
    dag *g = &a->step->values;
    note(a, "does an event happen late enough in the step");
    return op2(g, FP3_OP_LE, since, fp3_dag_known(g, fp3_known_param(g->known, "locate")));
}

static uint32_t halved(dag *g, uint32_t x) { return mul(g, num(g, HALF), x); }

fp3_status fp3_locate(fp3_advance *a, fp3_error *error) {
    const fp3_model *model = a->step->model;
    dag *g = &a->step->values;
    fp3_status status = FP3_OK;
    uint32_t root = FP3_NONE, begin = FP3_NONE, is_in_time = FP3_NONE;
    for (uint32_t i = 0; !status && i < model->event_count; i++) {
        const fp3_event *event = &model->events[i];
        lowering before = {0}, after = {0};
        if (!fp3_fit_has_event(a->fit, model, event))
            continue;
        status = fp3_advance_event(a, event, 0, &before, error);
        if (!status)
            status = fp3_advance_event(a, event, 1, &after, error);
        const int is_root = event->unless != FP3_NONE;
        if (!status) {
            const uint32_t since = (is_root ? since_root : since_begin)(a, event, &before, &after);
            is_in_time = both(g, is_in_time, is_short(a, since));
            *(is_root ? &root : &begin) = larger(g, is_root ? root : begin, since);
        }
        fp3_lower_close(&before);
        fp3_lower_close(&after);
    }
    if (status || (root == FP3_NONE && begin == FP3_NONE))
        return status;
    note(a, "an event happens too early in the step");
    a->is_late = sub(g, num(g, 1), is_in_time);
    a->since = root;
    note(a, "how much earlier it has to end");
    a->back = begin == FP3_NONE  ? root
              : root == FP3_NONE ? halved(g, begin)
                                 : larger(g, root, halved(g, begin));
    return FP3_OK;
}
