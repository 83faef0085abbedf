/* SPDX-License-Identifier: Apache-2.0 */
/* locate.c - see locate.h. */
#include "locate.h"

#include "compiler/value/ops.h"
#include "root.h"

#include <inttypes.h>

#define NOTHING 0x1p-126     /* of a root, but a divisor */
#define HALF 0.5             /* of a step within which a condition becomes true */
#define NEARER (1 - 0x1p-20) /* to the beginning of the step: h less a short time may be h */
/* Of the way back to a root. Where steps are short a line is nearly the root's way: who is a little beyond it gets closer by one
 * line more, and who falls short of it begins with a whole step again. */
#define SHORT (1 - 0x1p-6)
#define LEAST 0.0625 /* of a step that has to end earlier, which is left */

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

/* Which part of the step comes after the root, by a straight line from before to after; 0 if it is not reached. Never a quotient
 * without a value, but a NaN if the root has become one: then nobody knows. The estimate of the quotient is at most 0.25 % too
 * small. `min` and `max` give their second operand where one is a NaN. */
static uint32_t since_root(const fp3_advance *a, const fp3_event *event, lowering *before,
                           lowering *after) {
    dag *g = &a->step->values;
    const fp3_reach r = fp3_root_reach(a, event, before, after);
    const uint32_t nearest = r.is_falling ? FP3_OP_MAX : FP3_OP_MIN;
    const uint32_t farthest = r.is_falling ? FP3_OP_MIN : FP3_OP_MAX;
    g->note = fp3_note(&a->step->notes, "line %" PRIu32 ": how late", event->line);
    const uint32_t from = op2(g, nearest, r.from, num(g, r.is_falling ? NOTHING : -NOTHING));
    const uint32_t beyond = op2(g, farthest, num(g, 0), r.to);
    return mul(g, beyond, op1(g, FP3_OP_RCP, sub(g, beyond, from)));
}

static uint32_t sum(dag *g, uint32_t so_far, uint32_t other) {
    return so_far == FP3_NONE ? other : other == FP3_NONE ? so_far : add(g, so_far, other);
}

/* roots: the sum of the parts behind them, so that no NaN is lost; begins: 1 if a condition has become true, which may have been so
 * since the beginning. */
static void judge(fp3_advance *a, uint32_t roots, uint32_t begins) {
    dag *g = &a->step->values;
    const uint32_t h = fp3_dag_first(g, a->h.node);
    const uint32_t locate = fp3_dag_first(g, fp3_dag_known(g, fp3_known_param(g->known, "locate")));
    note(a, "does an event happen late enough in the step");
    a->is_in_time = op2(g, FP3_OP_LE, mul(g, h, sum(g, roots, begins)), locate);
    note(a, "the part of the step that is made again if not");
    const uint32_t half = begins == FP3_NONE ? FP3_NONE : mul(g, num(g, HALF), begins);
    const double share = a->is_chosen ? 1 : SHORT;
    const uint32_t left = sub(g, num(g, NEARER), mul(g, num(g, share), sum(g, roots, half)));
    a->part = op2(g, FP3_OP_MAX, left, num(g, LEAST));
}

fp3_status fp3_locate(fp3_advance *a, fp3_error *error) {
    const fp3_model *model = a->step->model;
    dag *g = &a->step->values;
    fp3_status status = FP3_OK;
    uint32_t roots = FP3_NONE, begins = FP3_NONE;
    for (uint32_t i = 0; !status && i < model->event_count; i++) {
        const fp3_event *event = &model->events[i];
        const int is_root = fp3_root_is(a, event);
        lowering before = {0}, after = {0};
        if (!fp3_fit_has_event(a->fit, model, event) || (!is_root && event->armed != FP3_NONE))
            continue;
        status = fp3_advance_event(a, event, 0, &before, error);
        if (!status)
            status = fp3_advance_event(a, event, 1, &after, error);
        if (!status && is_root) {
            roots = sum(g, roots, since_root(a, event, &before, &after));
        } else if (!status) {
            const uint32_t has_begun = becomes(a, event, &before, &after);
            begins = begins == FP3_NONE ? has_begun : either(g, begins, has_begun);
        }
        fp3_lower_close(&before);
        fp3_lower_close(&after);
    }
    if (!status && (roots != FP3_NONE || begins != FP3_NONE))
        judge(a, roots, begins);
    return status;
}
