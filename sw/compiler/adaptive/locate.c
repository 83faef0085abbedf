/* SPDX-License-Identifier: Apache-2.0 */
/* locate.c - see locate.h. */
#include "locate.h"

#include "compiler/value/ops.h"
#include "root.h"

#include <inttypes.h>

/* A root is found by halves to within this share of `locate`: as a rule the event is hardly late.
 */
#define FINE 0x1p-4
/* Of the step: two ends that are closer may be neighbours in FP32. */
#define FINEST 0x1p-21
/* Likewise, in double-single: then the search goes on from the end that is before the event. */
#define LEAVE 0x1p-10
/* As a share of "near enough": the next attempt ends this much before the root that the line
 * predicts, or BEYOND behind it. */
#define SHORT 0x1p-1
#define BEYOND 0x1p-4
/* A new end is a gain if it is nearer to this end by this factor; else the next attempt ends in the
 * middle. */
#define GAIN 0.75
/* Of the sum of both ends. Between neighbours this is not the first of them again. */
#define MIDDLE (0.5 + 0x1p-24)
#define NOTHING 0x1p-126 /* of a root, but a divisor */
#define WRONG 0x1p6      /* the event is not where it was said to be, so close before that end */

static void note(const fp3_advance *a, const char *text) {
    a->step->values.note = fp3_note(&a->step->notes, "%s", text);
}

static uint32_t either(dag *g, uint32_t a, uint32_t b) { return sel(g, a, num(g, 1), b); }

/* Whether so_far, or a part of the condition that had the needed value (is_true: true) before the
 * step, has lost that value. */
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

/* Whether the condition is false before the step, and true after the step or, by its parts, within
 * it: `x > wall and v > 0` may be true within the step if v > 0 has become false, because x was
 * then largest within the step. If no part has become false, the condition is true within the step
 * only if it is true at the end. */
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

/* What the events of a step tell. Nodes, FP3_NONE where there is no such event. */
typedef struct {
    uint32_t is_ahead; /* 1: the step ends before all roots */
    uint32_t late; /* from the step that ends before the event, a NaN where a root has become one */
    uint32_t from,
        to; /* the nearest root before and after the step, if a line is to tell where it is 0 */
    uint32_t begins; /* 1: a condition has become true */
} sight;

static uint32_t both(dag *g, uint32_t op, uint32_t so_far, uint32_t other) {
    return so_far == FP3_NONE ? other : op2(g, op, so_far, other);
}

static uint32_t held(const fp3_advance *a, const char *name) {
    const uint32_t state = fp3_model_state(a->step->model, name);
    return fp3_dag_first(&a->step->values,
                         fp3_advance_held(a, &a->step->values, ROLE_STATE, state).node);
}

static uint32_t since(const fp3_advance *a) {
    dag *g = &a->step->values;
    note(a, "from the step that ends before the event");
    return sub(g, fp3_dag_first(g, a->h.node), held(a, FP3_STATE_BEFORE));
}

/* Each root times 0, as the sum of large roots may be infinite. */
static void see_root(const fp3_advance *a, const fp3_event *event, lowering *before,
                     lowering *after, sight *seen) {
    dag *g = &a->step->values;
    const fp3_reach r = fp3_root_reach(a, event, before, after);
    seen->is_ahead = both(g, FP3_OP_MUL, seen->is_ahead, fp3_root_is_ahead(a, event, &r));
    const uint32_t late = seen->late == FP3_NONE ? since(a) : seen->late;
    note(a, "has a root no value");
    seen->late = add(g, late, mul(g, r.to, num(g, 0)));
    if (a->is_chosen)
        fp3_root_nearest(a, event, &r, &seen->from, &seen->to);
}

/* ---- the search ----
 *
 * Of two steps from here, one ends before the event and one behind it. Attempts between them narrow
 * this bracket, until the step behind the event is accepted. All attempts begin here, so rounding
 * errors of attempts do not add up, and each attempt shortens the bracket, whatever the function.
 */

/* Nodes: the bracket so far; the distances from its ends to the end of this attempt; whether that
 * end is before all events; how far apart both ends may be. */
typedef struct {
    uint32_t before, behind, since, until, is_before, near;
} attempt;

/* Of a step that is not chosen the host knows it, unless the search goes on from elsewhere. */
static uint32_t near_enough(const fp3_advance *a, const sight *seen, uint32_t h) {
    dag *g = &a->step->values;
    known_table *known = &a->step->known;
    const double share = a->is_chosen || seen->is_ahead == FP3_NONE ? 1 : FINE;
    const uint32_t locate = fp3_known_make(known, KNOWN_MUL, fp3_known_number(known, share),
                                           fp3_known_param(known, "locate"));
    note(a, "how far apart both steps may be");
    if (a->is_chosen || g->is_abstract)
        return add(g, fp3_dag_first(g, fp3_dag_known(g, locate)), mul(g, num(g, FINEST), h));
    const uint32_t least =
        fp3_known_make(known, KNOWN_MUL, fp3_known_number(known, FINEST), fp3_known_step(known));
    return fp3_dag_known(g, fp3_known_make(known, KNOWN_ADD, locate, least));
}

/* If the step ends before the event, this distance must be near enough; without a search nothing
 * must. If the other end is next to this end, the event is not at the predicted place. Step control
 * uses floats; double-single tells closer steps apart. */
static uint32_t gap_before(const fp3_advance *a, const attempt *is, uint32_t h) {
    dag *g = &a->step->values;
    return g->is_abstract ? sub(g, is->until, mul(g, num(g, LEAVE), h))
                          : mul(g, num(g, WRONG), is->until);
}

/* Where the line between both ends of the bracket crosses 0, seen from the new end, and a little
 * beyond, so that the root is soon between two close ends. The values usually have different signs,
 * so their sizes are added. If the signs are equal (a condition has become true, and roots are far
 * away or do not move) the quotient is still at most 1, and raises no flag. */
static uint32_t by_line(fp3_advance *a, const sight *seen, const attempt *is) {
    dag *g = &a->step->values;
    note(a, "the root at the step that ends before the event");
    const uint32_t before = held(a, FP3_STATE_ROOT_BEFORE);
    const uint32_t first = sel(g, is->behind, before, seen->from);
    const uint32_t behind = held(a, FP3_STATE_ROOT_BEHIND);
    a->root_before = sel(g, is->is_before, seen->to, first);
    note(a, "the root at the step that ends behind the event");
    a->root_behind = sel(g, is->is_before, behind, seen->to);
    note(a, "from here to the root");
    const uint32_t other = sel(g, is->is_before, behind, first);
    const uint32_t room = sel(g, is->is_before, is->until, is->since);
    const uint32_t sum = add(g, op1(g, FP3_OP_ABS, seen->to), op1(g, FP3_OP_ABS, other));
    const uint32_t apart = op2(g, FP3_OP_MAX, sum, num(g, NOTHING));
    const uint32_t share = mul(g, seen->to, op1(g, FP3_OP_RCP, apart));
    const uint32_t far = mul(g, room, share);
    note(a, "and a little further");
    return add(g, far, mul(g, sel(g, is->is_before, num(g, BEYOND), num(g, -SHORT)), is->near));
}

/* The end of the next attempt: where the line says, if that is much closer to this end; else in the
 * middle. */
static uint32_t next_end(fp3_advance *a, const sight *seen, const attempt *is, uint32_t h) {
    dag *g = &a->step->values;
    note(a, "the middle between both steps");
    const uint32_t middle = mul(g, num(g, MIDDLE), add(g, a->before, a->behind));
    if (seen->to == FP3_NONE)
        return middle;
    const uint32_t by = by_line(a, seen, is);
    note(a, "is the root there");
    const uint32_t nearest = op2(g, FP3_OP_MIN, is->since, op1(g, FP3_OP_ABS, is->until));
    uint32_t is_good = op2(g, FP3_OP_LE, op1(g, FP3_OP_ABS, by), mul(g, num(g, GAIN), nearest));
    if (seen->begins != FP3_NONE)
        is_good = sel(g, seen->begins, num(g, 0), is_good);
    note(a, "where the next attempt ends");
    return sel(g, is_good, add(g, h, by), middle);
}

/* ---- objects that make the same steps ---- */

/* What one sees who sees no event. */
static void see_nothing(const fp3_advance *a, sight *seen) {
    dag *g = &a->step->values;
    if (seen->is_ahead == FP3_NONE && fp3_advance_compares(a, FP3_COMPARED_AHEAD))
        seen->is_ahead = num(g, 1);
    if (seen->late == FP3_NONE && fp3_advance_compares(a, FP3_COMPARED_LATE))
        seen->late = since(a);
    if (seen->begins == FP3_NONE && fp3_advance_compares(a, FP3_COMPARED_BEGINS))
        seen->begins = num(g, 0);
    if (seen->to == FP3_NONE && fp3_advance_compares(a, FP3_COMPARED_TO))
        seen->from = seen->to = num(g, FP3_ROOT_FAR);
}

/* All objects see what any of them does, but for those that have stopped. */
static void share(const fp3_advance *a, sight *seen) {
    dag *g = &a->step->values;
    if (!a->is_common)
        return;
    note(a, "does an object see an event");
    see_nothing(a, seen);
    if (seen->is_ahead != FP3_NONE)
        seen->is_ahead = fp3_advance_least(a, FP3_COMPARED_AHEAD,
                                           fp3_advance_moving(a, seen->is_ahead, num(g, 1)));
    if (seen->late != FP3_NONE)
        seen->late =
            fp3_advance_worst(a, FP3_COMPARED_LATE, fp3_advance_moving(a, seen->late, since(a)));
    if (seen->begins != FP3_NONE)
        seen->begins = fp3_advance_worst(a, FP3_COMPARED_BEGINS,
                                         fp3_advance_moving(a, seen->begins, num(g, 0)));
    if (seen->to == FP3_NONE)
        return;
    seen->from = fp3_advance_least(a, FP3_COMPARED_FROM,
                                   fp3_advance_moving(a, seen->from, num(g, FP3_ROOT_FAR)));
    seen->to = fp3_advance_least(a, FP3_COMPARED_TO,
                                 fp3_advance_moving(a, seen->to, num(g, FP3_ROOT_FAR)));
}

static void judge(fp3_advance *a, const sight *seen) {
    dag *g = &a->step->values;
    const uint32_t h = fp3_dag_first(g, a->h.node);
    attempt is = {.before = held(a, FP3_STATE_BEFORE), .behind = held(a, FP3_STATE_BEHIND)};
    note(a, "does the step end before all events");
    is.is_before = seen->is_ahead == FP3_NONE ? num(g, 1) : seen->is_ahead;
    if (seen->begins != FP3_NONE)
        is.is_before = sel(g, seen->begins, num(g, 0), is.is_before);
    is.since = since(a);
    note(a, "to the step that ends behind the event");
    is.until = sub(g, is.behind, h);
    is.near = near_enough(a, seen, h);
    note(a, "may the step end here");
    uint32_t gap = seen->late == FP3_NONE ? is.since : seen->late;
    gap = sel(g, is.is_before, gap_before(a, &is, h), gap);
    a->is_in_time = op2(g, FP3_OP_LE, gap, is.near);
    note(a, "between which two steps an event is");
    a->before = sel(g, is.is_before, h, is.before);
    a->behind = sel(g, is.is_before, is.behind, h);
    a->next = next_end(a, seen, &is, h);
}

fp3_status fp3_locate(fp3_advance *a, fp3_error *error) {
    const fp3_model *model = a->step->model;
    fp3_status status = FP3_OK;
    sight seen = {FP3_NONE, FP3_NONE, FP3_NONE, FP3_NONE, FP3_NONE};
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
            see_root(a, event, &before, &after, &seen);
        } else if (!status) {
            const uint32_t has_begun = becomes(a, event, &before, &after);
            seen.begins = seen.begins == FP3_NONE
                              ? has_begun
                              : either(&a->step->values, seen.begins, has_begun);
        }
        fp3_lower_close(&before);
        fp3_lower_close(&after);
    }
    if (!status)
        share(a, &seen);
    if (!status && (seen.is_ahead != FP3_NONE || seen.begins != FP3_NONE))
        judge(a, &seen);
    return status;
}
