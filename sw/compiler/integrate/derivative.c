/* SPDX-License-Identifier: Apache-2.0 */
/* derivative.c - rules of differentiation on expressions, as their arrays are: operands come first.
 */
#include "derivative.h"

#include "language/function_rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    fp3_model *model;
    uint32_t room;
    uint32_t begin; /* of the expressions that are added */
    uint32_t *d;    /* of each expression of the text, by what is asked for now */
    uint32_t by;    /* a state, or state_count: t */
    uint32_t at;    /* the expression that is differentiated: where messages point */
    int has_failed;
} differentiation;

/* ---- making expressions ---- */

static uint32_t find(const differentiation *k, const fp3_expr *wanted) {
    for (uint32_t i = k->begin; i < k->model->expr_count; i++) {
        const fp3_expr *e = &k->model->exprs[i];
        if (e->op == wanted->op && e->index == wanted->index &&
            memcmp(e->operand, wanted->operand, sizeof e->operand) == 0 &&
            memcmp(&e->number, &wanted->number, sizeof e->number) == 0)
            return i;
    }
    return FP3_NONE;
}

static uint32_t put(differentiation *k, fp3_expr e) {
    fp3_model *model = k->model;
    const uint32_t there = find(k, &e);
    if (there != FP3_NONE || k->has_failed)
        return there == FP3_NONE ? 0 : there;
    if (model->expr_count == k->room) {
        fp3_expr *exprs = realloc(model->exprs, 2 * (size_t)k->room * sizeof *exprs);
        if (!exprs) {
            k->has_failed = 1;
            return 0;
        }
        model->exprs = exprs;
        k->room *= 2;
    }
    e.line = model->exprs[k->at].line;
    e.column = model->exprs[k->at].column;
    model->exprs[model->expr_count] = e;
    return model->expr_count++;
}

static uint32_t number(differentiation *k, double x) {
    return put(k, (fp3_expr){.op = FP3_EXPR_NUMBER,
                             .operand = {FP3_NONE, FP3_NONE, FP3_NONE},
                             .number = x,
                             .is_known = 1});
}

static uint32_t make(differentiation *k, fp3_expr_op op, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t operands[] = {a, b, c};
    fp3_expr e = {.op = op, .operand = {a, b, c}, .is_known = 1};
    for (int i = 0; i < 3 && !k->has_failed; i++)
        if (operands[i] != FP3_NONE && !k->model->exprs[operands[i]].is_known)
            e.is_known = 0;
    return put(k, e);
}

/* A derivative that is FP3_NONE is 0. */
static uint32_t one(differentiation *k, fp3_expr_op op, uint32_t a) {
    return make(k, op, a, FP3_NONE, FP3_NONE);
}

static uint32_t two(differentiation *k, fp3_expr_op op, uint32_t a, uint32_t b) {
    return make(k, op, a, b, FP3_NONE);
}

static int is_number(const differentiation *k, uint32_t expr, double x) {
    const fp3_expr *e = &k->model->exprs[expr];
    return e->op == FP3_EXPR_NUMBER && e->number == x;
}

static uint32_t negated(differentiation *k, uint32_t a) {
    return a == FP3_NONE ? a : one(k, FP3_EXPR_NEGATE, a);
}

static uint32_t sum(differentiation *k, uint32_t a, uint32_t b) {
    return a == FP3_NONE ? b : b == FP3_NONE ? a : two(k, FP3_EXPR_ADD, a, b);
}

static uint32_t difference(differentiation *k, uint32_t a, uint32_t b) {
    return b == FP3_NONE ? a : a == FP3_NONE ? negated(k, b) : two(k, FP3_EXPR_SUB, a, b);
}

static uint32_t product(differentiation *k, uint32_t a, uint32_t b) {
    if (a == FP3_NONE || b == FP3_NONE)
        return FP3_NONE;
    return is_number(k, a, 1) ? b : is_number(k, b, 1) ? a : two(k, FP3_EXPR_MUL, a, b);
}

static uint32_t quotient(differentiation *k, uint32_t a, uint32_t b) {
    return a == FP3_NONE ? a : two(k, FP3_EXPR_DIV, a, b);
}

static uint32_t square(differentiation *k, uint32_t a) { return product(k, a, a); }

static uint32_t choice(differentiation *k, uint32_t condition, uint32_t a, uint32_t b) {
    if (a == FP3_NONE && b == FP3_NONE)
        return FP3_NONE;
    return make(k, FP3_EXPR_SELECT, condition, a == FP3_NONE ? number(k, 0) : a,
                b == FP3_NONE ? number(k, 0) : b);
}

/* ---- rules ---- */

/* sqrt(1 - a^2) */
static uint32_t other_side(differentiation *k, uint32_t a) {
    return one(k, FP3_EXPR_SQRT, difference(k, number(k, 1), square(k, a)));
}

/* n a^(n-1) da */
static uint32_t of_power(differentiation *k, uint32_t a, uint32_t n, uint32_t da) {
    const fp3_expr *exponent = &k->model->exprs[n];
    if (da == FP3_NONE)
        return da;
    if (exponent->op != FP3_EXPR_NUMBER) {
        const uint32_t less = two(k, FP3_EXPR_SUB, n, number(k, 1));
        return product(k, product(k, n, two(k, FP3_EXPR_POWER, a, less)), da);
    }
    const double p = exponent->number;
    if (p == 0 || p == 1)
        return p == 0 ? FP3_NONE : da;
    const uint32_t lower = p == 2 ? a : two(k, FP3_EXPR_POWER, a, number(k, p - 1));
    return product(k, product(k, n, lower), da);
}

static int is_minus_zero(const differentiation *k, uint32_t expr) {
    return is_number(k, expr, 0) && signbit(k->model->exprs[expr].number);
}

/* Each term moves with the object's own states; neighbours stay where they are. One that is too far
 * adds -0, as it does to the sum itself: else bits would tell who is in the list. */
static uint32_t of_total(differentiation *k, const fp3_expr *total, uint32_t da) {
    const fp3_expr term = k->model->exprs[total->operand[0]];
    if (da == FP3_NONE)
        return da;
    if (term.op == FP3_EXPR_SELECT && is_minus_zero(k, term.operand[2]))
        da = make(k, FP3_EXPR_SELECT, term.operand[0], k->d[term.operand[1]], term.operand[2]);
    return put(k, (fp3_expr){.op = FP3_EXPR_TOTAL,
                             .operand = {da, total->operand[1], FP3_NONE},
                             .index = total->index});
}

static uint32_t derivative_of(differentiation *k, uint32_t f) {
    const fp3_expr e = k->model->exprs[f]; /* a copy: expressions move as others are added */
    uint32_t d[3];
    for (int j = 0; j < 3; j++)
        d[j] = e.operand[j] == FP3_NONE ? FP3_NONE : k->d[e.operand[j]];
    const uint32_t a = e.operand[0], b = e.operand[1], da = d[0], db = d[1], dc = d[2];
    if (e.op == FP3_EXPR_STATE)
        return e.index == k->by ? number(k, 1) : FP3_NONE;
    if (e.op == FP3_EXPR_TIME)
        return k->by == k->model->state_count ? number(k, 1) : FP3_NONE;
    if (da == FP3_NONE && db == FP3_NONE && dc == FP3_NONE)
        return FP3_NONE;
    switch (e.op) {
    case FP3_EXPR_NEGATE:
        return negated(k, da);
    case FP3_EXPR_ADD:
        return sum(k, da, db);
    case FP3_EXPR_SUB:
        return difference(k, da, db);
    case FP3_EXPR_MUL:
        return sum(k, product(k, da, b), product(k, a, db));
    case FP3_EXPR_DIV:
        return quotient(k, difference(k, da, product(k, f, db)), b);
    case FP3_EXPR_POWER:
        return of_power(k, a, b, da);
#define X(OP, name, MADE, UNIT, VALUE, SLOPE, ...)                                                 \
    case FP3_EXPR_##OP:                                                                            \
        return SLOPE;
        FP3_FUNCTION_ROWS(X)
#undef X
    case FP3_EXPR_TOTAL:
        return of_total(k, &e, da);
    case FP3_EXPR_LESS: /* steps */
    case FP3_EXPR_LESS_EQUAL:
    case FP3_EXPR_EQUAL:
    case FP3_EXPR_AND:
    case FP3_EXPR_OR:
    case FP3_EXPR_NOT:
    case FP3_EXPR_NUMBER: /* leaves */
    case FP3_EXPR_PARAM:
    case FP3_EXPR_STATE:
    case FP3_EXPR_TIME:
    case FP3_EXPR_INITIAL:
    case FP3_EXPR_OTHER_STATE: /* of neighbours */
    case FP3_EXPR_OTHER_PARAM:
    case FP3_EXPR_FIELD:
    case FP3_EXPR_LEAST: /* which of them it is of is not kept: derivative.h */
    case FP3_EXPR_MOST:
    case FP3_EXPR_STEP: /* of projections, which have no derivatives */
    case FP3_EXPR_BEFORE:
    case FP3_EXPR_OBJECTS: /* of invariants alone */
    case FP3_EXPR_PAIRS:
    case FP3_EXPR_OP_COUNT:
        break;
    }
    return FP3_NONE;
}

/* ---- the model ---- */

/* What passes a root that it starts from: it has no derivative if it sees others. */
static int has_rate(const fp3_model *model, uint32_t event) {
    return model->events[event].armed != FP3_NONE && !model->relation_count;
}

/* What the derivatives of states are made of, and roots. */
static void mark_needed(const fp3_model *model, int has_partial, char *is_needed) {
    for (uint32_t s = 0; has_partial && s < model->state_count; s++)
        is_needed[model->states[s].derivative] = 1;
    for (uint32_t e = 0; e < model->event_count; e++)
        for (int j = 0; has_rate(model, e) && j < 2; j++)
            is_needed[model->exprs[model->events[e].condition].operand[j]] = 1;
    for (uint32_t i = model->expr_count; i-- > 0;)
        for (int j = 0; is_needed[i] && j < 3; j++)
            if (model->exprs[i].operand[j] != FP3_NONE)
                is_needed[model->exprs[i].operand[j]] = 1;
}

/* The derivatives by one state times that of the state, or by t. */
static void add_rates(differentiation *k, uint32_t *rate) {
    for (uint32_t e = 0; e < k->model->event_count; e++) {
        if (!has_rate(k->model, e))
            continue;
        const uint32_t condition = k->model->events[e].condition;
        const uint32_t *operand = k->model->exprs[condition].operand;
        const uint32_t a = k->d[operand[0]], b = k->d[operand[1]];
        k->at = condition;
        const uint32_t by = difference(k, b, a);
        rate[e] = sum(k, rate[e],
                      k->by == k->model->state_count
                          ? by
                          : product(k, by, k->model->states[k->by].derivative));
    }
}

static void differentiate_all(differentiation *k, const char *is_needed, uint32_t *partial,
                              uint32_t *rate) {
    const uint32_t states = k->model->state_count;
    for (k->by = 0; k->by <= states; k->by++) {
        for (uint32_t i = 0; i < k->begin; i++) {
            k->at = i;
            k->d[i] = is_needed[i] ? derivative_of(k, i) : FP3_NONE;
        }
        for (uint32_t s = 0; s < states; s++)
            partial[s * (states + 1) + k->by] = k->d[k->model->states[s].derivative];
        add_rates(k, rate);
    }
}

fp3_status fp3_differentiate(const fp3_model *model, int has_partial, fp3_differentiated *made,
                             fp3_error *error) {
    const uint32_t count = model->expr_count, room = 2 * count + 64;
    const size_t cells = (size_t)model->state_count * (model->state_count + 1u) + 1u;
    *made = (fp3_differentiated){.model = *model};
    made->model.exprs = malloc(room * sizeof *made->model.exprs);
    made->partial = calloc(cells, sizeof *made->partial);
    made->rate = malloc((model->event_count + 1u) * sizeof *made->rate);
    differentiation k = {
        .model = &made->model, .room = room, .begin = count, .d = calloc(count + 1u, sizeof *k.d)};
    char *is_needed = calloc(count + 1u, 1);
    k.has_failed = !made->model.exprs || !made->partial || !made->rate || !k.d || !is_needed;
    if (!k.has_failed) {
        if (count)
            memcpy(made->model.exprs, model->exprs, count * sizeof *model->exprs);
        mark_needed(model, has_partial, is_needed);
        for (uint32_t e = 0; e < model->event_count; e++)
            made->rate[e] = FP3_NONE;
        differentiate_all(&k, is_needed, made->partial, made->rate);
    }
    free(k.d);
    free(is_needed);
    return k.has_failed ? fp3_no_memory(error) : FP3_OK;
}

void fp3_differentiated_close(fp3_differentiated *made) {
    free(made->model.exprs);
    free(made->partial);
    free(made->rate);
    *made = (fp3_differentiated){0};
}
