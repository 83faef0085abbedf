/* SPDX-License-Identifier: Apache-2.0 */
/* switching.c - see switching.h. */
#include "switching.h"

#include <stdlib.h>

#include "language/turn.h"

/* ---- which there are ---- */

/* What is equal to a time holds for none. */
static int matters(const fp3_model *model, const char *kind, uint32_t expr) {
    return fp3_turn_is_of_time(model, kind, expr) && model->exprs[expr].op != FP3_EXPR_EQUAL &&
           kind[expr] & (FP3_TURN_RATE | FP3_TURN_CONDITION);
}

fp3_status fp3_switchings_find(const fp3_model *model, fp3_switchings *s, fp3_error *error) {
    *s = (fp3_switchings){.kind = calloc(model->expr_count + 1u, 1), .unknown = FP3_NONE};
    if (!s->kind)
        return fp3_no_memory(error);
    fp3_turn_kinds(model, s->kind);
    for (uint32_t i = 0; i < model->expr_count; i++) {
        if (!matters(model, s->kind, i))
            continue;
        if (fp3_turn_is_linear(model, s->kind, i) && s->count < FP3_SWITCHINGS_MOST)
            s->expr[s->count++] = i;
        else if (s->unknown == FP3_NONE)
            s->unknown = i;
    }
    return FP3_OK;
}

void fp3_switchings_close(fp3_switchings *s) {
    free(s->kind);
    *s = (fp3_switchings){0};
}

int fp3_switchings_time(const fp3_model *model, const fp3_switchings *s, const fp3_event *event) {
    const fp3_expr *e = &model->exprs[event->condition];
    int has_end = 0;
    for (uint32_t i = 0; i < s->count; i++)
        has_end |= s->expr[i] == event->condition;
    return has_end && event->armed != FP3_NONE && model->exprs[e->operand[0]].is_known &&
           model->exprs[e->operand[1]].op == FP3_EXPR_TIME;
}

/* ---- when ---- */

/* slope t + offset, of known values. */
typedef struct {
    uint32_t slope, offset;
} line;

static int is_zero(const known_table *known, uint32_t id) { return fp3_known_is(known, id, 0); }

static uint32_t negated(known_table *known, uint32_t a) {
    return is_zero(known, a) ? a : fp3_known_make(known, KNOWN_NEGATE, a, 0);
}

static uint32_t less(known_table *known, uint32_t a, uint32_t b) {
    return is_zero(known, a)   ? negated(known, b)
           : is_zero(known, b) ? a
                               : fp3_known_make(known, KNOWN_SUB, a, b);
}

static uint32_t plus(known_table *known, uint32_t a, uint32_t b) {
    return is_zero(known, a) ? b : is_zero(known, b) ? a : fp3_known_make(known, KNOWN_ADD, a, b);
}

static uint32_t scaled(known_table *known, known_op op, uint32_t a, uint32_t by) {
    return is_zero(known, a) ? a : fp3_known_make(known, op, a, by);
}

/* lines: of its operands. */
static line make_line(known_table *known, uint32_t expr, const line *lines) {
    const fp3_model *model = known->model;
    const fp3_expr *e = &model->exprs[expr];
    const uint32_t zero = fp3_known_number(known, 0);
    if (e->is_known)
        return (line){zero, fp3_known_model(known, expr)};
    if (e->op == FP3_EXPR_TIME)
        return (line){fp3_known_number(known, 1), zero};
    const line a = lines[e->operand[0]];
    if (e->op == FP3_EXPR_NEGATE)
        return (line){negated(known, a.slope), negated(known, a.offset)};
    const line b = lines[e->operand[1]];
    if (e->op == FP3_EXPR_MUL || e->op == FP3_EXPR_DIV) { /* by what is known: it has no slope */
        const int is_left_known = model->exprs[e->operand[0]].is_known;
        const known_op op = e->op == FP3_EXPR_MUL ? KNOWN_MUL : KNOWN_DIV;
        const line of = is_left_known ? b : a;
        const uint32_t by = is_left_known ? a.offset : b.offset;
        return (line){scaled(known, op, of.slope, by), scaled(known, op, of.offset, by)};
    }
    return e->op == FP3_EXPR_ADD
               ? (line){plus(known, a.slope, b.slope), plus(known, a.offset, b.offset)}
               : (line){less(known, a.slope, b.slope), less(known, a.offset, b.offset)};
}

/* Each expression once, however often it is read. */
static line line_of(known_table *known, uint32_t expr) {
    const fp3_model *model = known->model;
    line *lines = calloc(expr + 1u, sizeof *lines), found = {0};
    char *is_wanted = calloc(expr + 1u, 1);
    if (lines && is_wanted) {
        is_wanted[expr] = 1;
        for (uint32_t i = expr + 1; i-- > 0;)
            for (int k = 0; is_wanted[i] && !model->exprs[i].is_known && k < 3; k++)
                if (model->exprs[i].operand[k] != FP3_NONE)
                    is_wanted[model->exprs[i].operand[k]] = 1;
        for (uint32_t i = 0; i <= expr; i++)
            if (is_wanted[i])
                lines[i] = make_line(known, i, lines);
        found = lines[expr];
    } else
        known->has_failed = 1;
    free(lines);
    free(is_wanted);
    return found;
}

uint32_t fp3_switching_time(known_table *known, const fp3_switchings *s, uint32_t number) {
    const fp3_expr *e = &known->model->exprs[s->expr[number]];
    const uint32_t zero = fp3_known_number(known, 0);
    const line a = line_of(known, e->operand[0]);
    const line b = e->op == FP3_EXPR_ABS ? (line){zero, zero} : line_of(known, e->operand[1]);
    const line flat = is_zero(known, a.slope) ? a : b, steep = is_zero(known, a.slope) ? b : a;
    const uint32_t slope = less(known, steep.slope, flat.slope);
    if (is_zero(known, slope))
        return FP3_NONE;
    const uint32_t way = less(known, flat.offset, steep.offset);
    return scaled(known, KNOWN_DIV, way, slope);
}
