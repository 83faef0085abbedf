/* SPDX-License-Identifier: Apache-2.0 */
/* lower.c - expressions to operations of the machine, functions by the files of
 * sw/compiler/functions. */
#include "lower.h"

#include "compiler/functions/division.h"
#include "compiler/functions/exact.h"
#include "compiler/functions/functions.h"
#include "compiler/functions/logarithm.h"
#include "compiler/value/ops.h"
#include "language/evaluate.h"
#include "language/function_rows.h"
#include "language/turn.h"

#include <assert.h>
#include <fp3/compile.h>
#include <math.h>
#include <stdlib.h>

fp3_status fp3_lower_open(lowering *l, const fp3_model *model, dag *g, fp3_error *error) {
    *l = (lowering){.model = model, .g = g};
    l->value = calloc(model->expr_count + 1, sizeof *l->value);
    l->is_made = calloc(model->expr_count + 1, 1);
    l->is_wanted = calloc(model->expr_count + 1, 1);
    l->is_inverted = calloc(model->expr_count + 1, 1);
    return l->value && l->is_made && l->is_wanted && l->is_inverted ? FP3_OK : fp3_no_memory(error);
}

void fp3_lower_close(lowering *l) {
    free(l->value);
    free(l->is_made);
    free(l->is_wanted);
    free(l->is_inverted);
    l->value = NULL;
    l->is_made = l->is_wanted = l->is_inverted = NULL;
}

/* ---- expressions ---- */

static term at(const lowering *l, uint32_t expr) { return l->value[expr]; }

static uint32_t value(lowering *l, uint32_t expr) { return fp3_term_value(l->g, at(l, expr)); }

static const fp3_expr *expr_of(const lowering *l, uint32_t expr) { return &l->model->exprs[expr]; }

static int is_exact(const lowering *l) {
    return (l->g->passes & FP3_PASS(FP3_PASS_EXACT_DIVISION)) != 0;
}

/* Whether 1/sqrt(x) can be computed directly, without the root. */
static int is_unknown_root(const lowering *l, uint32_t expr) {
    return !is_exact(l) && expr_of(l, expr)->op == FP3_EXPR_SQRT && !expr_of(l, expr)->is_known;
}

/* Integers up to here by products, and halves for which products and a root stay within 4.2 units
 * in the last place. All other powers by exponent and logarithm. */
#define POWER_MAX 8
#define HALF_LEAST (-1.5)
#define HALF_MOST 3.5

/* How a power is made. */
typedef struct {
    enum { BY_PRODUCTS, BY_ROOT, BY_LOGARITHM } way;
    unsigned n; /* of products; of the root, if it is made of that */
    int is_below;
} way_of_power;

/* Of a power, or of 1 over it. */
static way_of_power way_of(const lowering *l, uint32_t expr, int is_denominator) {
    double n;
    if (!fp3_known_constant(l->g->known, expr_of(l, expr)->operand[1], &n))
        return (way_of_power){.way = BY_LOGARITHM};
    n = is_denominator ? -n : n;
    const int is_whole = n == floor(n), is_half = 2 * n == floor(2 * n) && !is_whole;
    if (is_whole && fabs(n) <= POWER_MAX)
        return (way_of_power){BY_PRODUCTS, (unsigned)fabs(n), n < 0};
    if (is_half && n >= HALF_LEAST && n <= HALF_MOST)
        return (way_of_power){BY_ROOT, (unsigned)fabs(2 * n), n < 0};
    return (way_of_power){.way = BY_LOGARITHM};
}

static int is_power(const lowering *l, uint32_t expr) {
    return expr_of(l, expr)->op == FP3_EXPR_POWER && !expr_of(l, expr)->is_known;
}

/* 1/sqrt(b) */
static term inverse_root(lowering *l, uint32_t base) {
    dag *g = l->g;
    const uint32_t b = value(l, base);
    return g->is_abstract ? fp3_term(op1(g, NODE_INVERSE_ROOT, b))
                          : fp3_corrected(g, one(g), fp3_inverse_root(g, b));
}

/* The same as nodes that something else makes quotients of: x/b, x (1/b)^n, x (1/sqrt(b))^n. */
static term divided_later(lowering *l, term x, uint32_t below, unsigned n, int is_root) {
    dag *g = l->g;
    const term b = at(l, below);
    if (is_root)
        return fp3_times_power(g, x, inverse_root(l, below), n);
    const uint32_t above = n == 1 ? x.node : num(g, 1);
    term result = fp3_term(op2(g, NODE_QUOTIENT, above, b.node));
    result = n == 1 ? (term){result.node, x.is_negative}
                    : fp3_term_mul(g, x, fp3_term_power(g, result, n));
    result.is_negative ^= b.is_negative && n % 2;
    return result;
}

/* x / base^n. A root in a denominator is never formed: the hardware estimates 1/sqrt(b). */
static term divided(lowering *l, term x, uint32_t base, unsigned n) {
    dag *g = l->g;
    const int is_root = is_unknown_root(l, base);
    const uint32_t below = is_root ? expr_of(l, base)->operand[0] : base;
    if (g->is_abstract)
        return divided_later(l, x, below, n, is_root);
    if (is_root) {
        const fp3_series s = fp3_inverse_root(g, value(l, below));
        return n == 1 ? fp3_over_root(g, x, s)
                      : fp3_times_power(g, x, fp3_corrected(g, one(g), s), n);
    }
    const term b = at(l, below);
    if (is_exact(l)) {
        const term all = fp3_term_power(g, b, n);
        return (term){fp3_exact_quotient(g, x.node, all.node), x.is_negative != all.is_negative};
    }
    term result = n == 1 ? fp3_quotient(g, x, b.node) : fp3_over_power(g, x, b.node, n);
    result.is_negative ^= b.is_negative && n % 2;
    return result;
}

static uint32_t root_of(lowering *l, uint32_t expr) {
    const uint32_t b = value(l, expr_of(l, expr)->operand[0]);
    if (l->g->is_abstract)
        return op1(l->g, NODE_ROOT, b);
    if (is_exact(l))
        return fp3_exact_root(l->g, b);
    return l->is_inverted[expr] ? fp3_root_beside_inverse(l->g, b) : fp3_root(l->g, b);
}

/* x^(n/2) for an odd n: powers of x times its root. */
static term root_power(lowering *l, uint32_t base, unsigned n) {
    dag *g = l->g;
    const uint32_t b = value(l, base);
    const term root = fp3_term(g->is_abstract ? op1(g, NODE_ROOT, b) : fp3_root(g, b));
    return n == 1 ? root : fp3_term_mul(g, fp3_term_power(g, fp3_term(b), n / 2), root);
}

static term by_logarithm(lowering *l, const fp3_expr *e, int is_denominator) {
    known_table *known = l->g->known;
    double number;
    uint32_t n = fp3_known_constant(known, e->operand[1], &number)
                     ? fp3_known_number(known, number)
                     : fp3_known_model(known, e->operand[1]);
    if (is_denominator)
        n = fp3_known_make(known, KNOWN_NEGATE, n, 0);
    const uint32_t x = value(l, e->operand[0]);
    return fp3_term(l->g->is_abstract
                        ? op2(l->g, NODE_FUNCTION + FP3_EXPR_POWER, x, fp3_dag_known(l->g, n))
                        : fp3_power(l->g, x, n));
}

/* x times the power, or x over it. */
static term times_power(lowering *l, term x, uint32_t expr, int is_denominator) {
    const fp3_expr *e = expr_of(l, expr);
    const way_of_power w = way_of(l, expr, is_denominator);
    if (w.way == BY_PRODUCTS && w.is_below)
        return divided(l, x, e->operand[0], w.n);
    if (w.way == BY_ROOT && w.is_below)
        return fp3_times_power(l->g, x, inverse_root(l, e->operand[0]), w.n);
    const term p = w.way == BY_PRODUCTS ? fp3_term_power(l->g, at(l, e->operand[0]), w.n)
                   : w.way == BY_ROOT   ? root_power(l, e->operand[0], w.n)
                                        : by_logarithm(l, e, is_denominator);
    return fp3_dag_is_number(l->g, x.node, 1) && !x.is_negative ? p : fp3_term_mul(l->g, x, p);
}

/* Whether the host knows it before a run: what is made of numbers and params, and h itself if all
 * steps have one length. */
static int is_known(const lowering *l, uint32_t expr) {
    const fp3_expr *e = expr_of(l, expr);
    return e->is_known || (e->op == FP3_EXPR_STEP && fp3_dag_is_known(l->g, l->h.node) != FP3_NONE);
}

static term divide(lowering *l, const fp3_expr *e) {
    const uint32_t below = e->operand[1];
    const term x = at(l, e->operand[0]);
    if (is_known(l, below)) {
        known_table *known = l->g->known;
        const uint32_t by =
            expr_of(l, below)->is_known ? fp3_known_model(known, below) : fp3_known_step(known);
        const uint32_t over = fp3_known_make(known, KNOWN_DIV, fp3_known_number(known, 1), by);
        return fp3_term_mul(l->g, x, fp3_term(fp3_dag_known(l->g, over)));
    }
    return is_power(l, below) ? times_power(l, x, below, 1) : divided(l, x, below, 1);
}

static int is_comparison(fp3_expr_op op) {
    return op == FP3_EXPR_LESS || op == FP3_EXPR_LESS_EQUAL || op == FP3_EXPR_EQUAL;
}

/* Whether an expression is 0 or 1 and nothing else. */
static int is_truth(const lowering *l, uint32_t expr) {
    const fp3_expr_op op = expr_of(l, expr)->op;
    return is_comparison(op) || op == FP3_EXPR_AND || op == FP3_EXPR_OR || op == FP3_EXPR_NOT;
}

static uint32_t truth(lowering *l, uint32_t expr) {
    return is_truth(l, expr) ? value(l, expr)
                             : sel(l->g, value(l, expr), num(l->g, 1), num(l->g, 0));
}

static term equal(dag *g, uint32_t a, uint32_t b) {
    return fp3_term(mul(g, op2(g, FP3_OP_LE, a, b), op2(g, FP3_OP_LE, b, a)));
}

static term made_later(lowering *l, const fp3_expr *e) {
    const uint32_t b = e->operand[1] == FP3_NONE ? FP3_NONE : value(l, e->operand[1]);
    return fp3_term(op2(l->g, NODE_FUNCTION + (uint32_t)e->op, value(l, e->operand[0]), b));
}

#define LOWER_INSTRUCTIONS(OP, name)
#define LOWER_POLYNOMIAL(OP, name)                                                                 \
    case FP3_EXPR_##OP:                                                                            \
        return fp3_##name(g, at(l, o[0]));
#define LOWER_POLYNOMIAL_2(OP, name)                                                               \
    case FP3_EXPR_##OP:                                                                            \
        return fp3_##name(g, at(l, o[0]), at(l, o[1]));

/* A comparison that does not change within the step, whatever t is at the ends: if the host knows
 * the time of the change, a step ends there. */
static int is_inside(const lowering *l, uint32_t expr) {
    return l->inside && is_comparison(expr_of(l, expr)->op) &&
           fp3_turn_is_linear(l->model, l->kind, expr);
}

static int is_seen(const lowering *l, uint32_t state) {
    const fp3_sight *sight = l->sight;
    uint32_t i = 0;
    while (i < sight->count && (sight->list[i].place != l->index || sight->list[i].state != state))
        i++;
    return i < sight->count;
}

/* The node comes in finished: making it makes earlier places, which add to this list themselves. */
static void add_seen(lowering *l, uint32_t state, uint32_t node) {
    fp3_sight *sight = l->sight;
    if (sight->count == sight->room) {
        const uint32_t room = sight->room ? 2 * sight->room : 16;
        fp3_seen *list = realloc(sight->list, room * sizeof *list);
        sight->has_failed |= !list;
        if (!list)
            return;
        sight->list = list;
        sight->room = room;
    }
    if (sight->stopped != FP3_NONE && node != sight->start[state])
        node = sel(l->g, sight->stopped, sight->start[state], node);
    sight->list[sight->count++] = (fp3_seen){l->index, state, node, 0};
}

void fp3_lower_show(lowering *l, uint64_t states) {
    for (uint32_t s = 0; s < l->model->state_count; s++)
        if (states >> s & 1 && !is_seen(l, s))
            add_seen(l, s, fp3_term_value(l->g, l->state(l, s)));
}

void fp3_lower_look(lowering *l, uint32_t relation) {
    const fp3_relation *r = &l->model->relations[relation];
    if (r->kind == FP3_NEAR)
        fp3_lower_show(l, ((UINT64_C(1) << r->dimensions) - 1) << r->position);
}

/* What the neighbour has there, objects see of each other. */
static term others_state(lowering *l, uint32_t state) {
    if (!is_seen(l, state))
        add_seen(l, state, fp3_term_value(l->g, l->state(l, state)));
    return fp3_term(fp3_dag_neighbour(l->g, NODE_OTHER_STATE, state, l->index, 0));
}

static term fold(lowering *l, const fp3_expr *e) {
    const uint32_t over = value(l, e->operand[0]), start = value(l, e->operand[1]);
    fp3_lower_look(l, e->index);
    return fp3_term(fp3_dag_neighbour(l->g, NODE_TOTAL + (uint32_t)(e->op - FP3_EXPR_TOTAL), over,
                                      start, fp3_dag_seen(e->index, l->index)));
}

static term lower(lowering *l, uint32_t expr) {
    const fp3_expr *e = expr_of(l, expr);
    const uint32_t *o = e->operand;
    dag *g = l->g;
    if (is_inside(l, expr))
        return fp3_lower(l->inside, expr);
    if (e->is_known)
        return fp3_term(fp3_dag_known(g, fp3_known_model(g->known, expr)));
    if (g->is_abstract && fp3_ode_has_constants(e->op) && e->op != FP3_EXPR_POWER)
        return made_later(l, e);
    switch (e->op) {
    case FP3_EXPR_STATE:
        return l->state(l, e->index);
    case FP3_EXPR_TIME:
        return l->time;
    case FP3_EXPR_STEP:
        return l->h;
    case FP3_EXPR_BEFORE:
        return l->before(l, e->index);
    case FP3_EXPR_OTHER_STATE:
        return others_state(l, e->index);
    case FP3_EXPR_OTHER_PARAM:
        return fp3_term(fp3_dag_neighbour(g, NODE_OTHER_PARAM, e->index, FP3_NONE, 0));
    case FP3_EXPR_FIELD:
        return fp3_term(fp3_dag_neighbour(g, NODE_FIELD, e->index, FP3_NONE, 0));
    case FP3_EXPR_TOTAL:
    case FP3_EXPR_LEAST:
    case FP3_EXPR_MOST:
        return fold(l, e);
    case FP3_EXPR_NEGATE:
        return fp3_term_negated(at(l, o[0]));
    case FP3_EXPR_ADD:
        return fp3_term_add(g, at(l, o[0]), at(l, o[1]));
    case FP3_EXPR_SUB:
        return fp3_term_sub(g, at(l, o[0]), at(l, o[1]));
    case FP3_EXPR_MUL:
        return fp3_term_mul(g, at(l, o[0]), at(l, o[1]));
    case FP3_EXPR_DIV:
        return divide(l, e);
    case FP3_EXPR_POWER:
        return times_power(l, one(g), expr, 0);
    case FP3_EXPR_SQRT:
        return fp3_term(root_of(l, expr));
    case FP3_EXPR_MIN:
        return fp3_term(op2(g, FP3_OP_MIN, value(l, o[0]), value(l, o[1])));
    case FP3_EXPR_MAX:
        return fp3_term(op2(g, FP3_OP_MAX, value(l, o[0]), value(l, o[1])));
    case FP3_EXPR_ABS:
        return fp3_term(op1(g, FP3_OP_ABS, at(l, o[0]).node));
    case FP3_EXPR_LESS:
        return fp3_term(op2(g, FP3_OP_LT, value(l, o[0]), value(l, o[1])));
    case FP3_EXPR_LESS_EQUAL:
        return fp3_term(op2(g, FP3_OP_LE, value(l, o[0]), value(l, o[1])));
    case FP3_EXPR_EQUAL:
        return equal(g, value(l, o[0]), value(l, o[1]));
    case FP3_EXPR_AND:
        return fp3_term(mul(g, truth(l, o[0]), truth(l, o[1])));
    case FP3_EXPR_OR:
        return fp3_term(sel(g, at(l, o[0]).node, num(g, 1), truth(l, o[1])));
    case FP3_EXPR_NOT:
        return fp3_term(sel(g, at(l, o[0]).node, num(g, 0), num(g, 1)));
    case FP3_EXPR_SELECT:
        return fp3_term(sel(g, at(l, o[0]).node, value(l, o[1]), value(l, o[2])));
#define X(OP, name, MADE, ...) LOWER_##MADE(OP, name)
        FP3_FUNCTION_ROWS(X)
#undef X
    case FP3_EXPR_NUMBER: /* known, as params are */
    case FP3_EXPR_PARAM:
    case FP3_EXPR_INITIAL: /* of closed forms alone */
    case FP3_EXPR_OBJECTS: /* of invariants alone */
    case FP3_EXPR_PAIRS:
    case FP3_EXPR_OP_COUNT:
        break;
    }
    assert(!"an operation of a step");
    return fp3_term(num(g, NAN));
}

/* A function's own constants are no known factors: its error is that of these products. */
static term lower_as_written(lowering *l, uint32_t expr) {
    const fp3_expr_op op = expr_of(l, expr)->op;
    const unsigned passes = l->g->passes;
    if (fp3_ode_has_constants(op))
        l->g->passes &= ~FP3_PASS(FP3_PASS_FOLD_PRODUCT);
    const term made = lower(l, expr);
    l->g->passes = passes;
    return made;
}

/* The base of a denominator, of which a root is never formed. */
static void want_base(lowering *l, uint32_t base) {
    l->is_inverted[base] = (char)is_unknown_root(l, base);
    l->is_wanted[is_unknown_root(l, base) ? expr_of(l, base)->operand[0] : base] = 1;
}

static void want_power(lowering *l, uint32_t expr, int is_denominator) {
    const way_of_power w = way_of(l, expr, is_denominator);
    if (w.way == BY_PRODUCTS && w.is_below)
        want_base(l, expr_of(l, expr)->operand[0]);
    else
        l->is_wanted[expr_of(l, expr)->operand[0]] = 1;
}

static void want_below(lowering *l, uint32_t below) {
    if (is_known(l, below))
        return;
    if (is_power(l, below))
        want_power(l, below, 1);
    else
        want_base(l, below);
}

static void want_operands(lowering *l, uint32_t expr) {
    const fp3_expr *e = expr_of(l, expr);
    if (e->is_known || is_inside(l, expr))
        return;
    if (e->op == FP3_EXPR_POWER) {
        want_power(l, expr, 0);
        return;
    }
    for (int i = 0; i < 3 && e->operand[i] != FP3_NONE; i++)
        if (e->op == FP3_EXPR_DIV && i == 1)
            want_below(l, e->operand[i]);
        else
            l->is_wanted[e->operand[i]] = 1;
}

/* Marks the needed expressions from the root down, then makes them from the leaves up: operands
 * come first. */
term fp3_lower(lowering *l, uint32_t root) {
    const uint32_t outside = l->g->note;
    l->is_wanted[root] = 1;
    for (uint32_t i = root + 1; i-- > 0;)
        if (l->is_wanted[i] && !l->is_made[i])
            want_operands(l, i);
    for (uint32_t i = 0; i <= root; i++) {
        if (!l->is_wanted[i] || l->is_made[i])
            continue;
        l->g->note = fp3_note_expr(l->notes, l->model, i, l->place);
        l->value[i] = lower_as_written(l, i);
        l->is_made[i] = 1;
    }
    l->g->note = outside;
    return at(l, root);
}
