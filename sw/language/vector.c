/* SPDX-License-Identifier: Apache-2.0 */
/* vector.c - a vector is only its components: an operation on it becomes one expression for each.
 */
#include "vector.h"

#include <assert.h>
#include <string.h>

#include "evaluate.h"

#define OF(n) "a vector of " #n
#define TEN(t)                                                                                     \
    OF(t##0), OF(t##1), OF(t##2), OF(t##3), OF(t##4), OF(t##5), OF(t##6), OF(t##7), OF(t##8),      \
        OF(t##9)

const char *fp3_ode_shape(unsigned size) {
    static const char *const shapes[] = {
        "nothing", "a number", OF(2),  OF(3),  OF(4),  OF(5),  OF(6),  OF(7),  OF(8),  OF(9),
        TEN(1),    TEN(2),     TEN(3), TEN(4), TEN(5), OF(60), OF(61), OF(62), OF(63), OF(64),
    };
    static_assert(sizeof shapes / sizeof *shapes == ODE_VECTOR + 1, "one for each size");
    return shapes[size];
}

static const ode_value nothing = {0};

static int shown(fp3_token t) { return t.length < 20 ? (int)t.length : 20; }

/* NULL after an error. */
static fp3_expr *new_expr(ode_parser *p, fp3_token at, fp3_expr_op op) {
    if (p->expr_count == ODE_EXPRS) {
        fp3_ode_over(&p->in, at, "a model of at most %d numbers, names and operations", ODE_EXPRS);
        return NULL;
    }
    uint32_t i = p->expr_count++;
    p->expr_at[i] = at;
    p->has_state[i] = p->has_time[i] = p->is_number[i] = p->is_lost[i] = 0;
    p->values[i] = 0;
    p->dimensions[i] = (ode_dimension){0};
    memcpy(p->expr_note[i], p->in.note, sizeof p->in.note);
    p->exprs[i] = (fp3_expr){.op = op,
                             .operand = {FP3_NONE, FP3_NONE, FP3_NONE},
                             .line = at.location.line,
                             .column = at.location.column};
    return &p->exprs[i];
}

ode_value fp3_ode_leaf(ode_parser *p, fp3_token at, fp3_expr_op op, uint32_t index, double number) {
    fp3_expr *e = p->skipping ? NULL : new_expr(p, at, op);
    if (!e)
        return nothing;
    e->index = index;
    e->number = number;
    e->is_known = op == FP3_EXPR_NUMBER || op == FP3_EXPR_PARAM;
    p->has_state[p->expr_count - 1] = op == FP3_EXPR_STATE || op == FP3_EXPR_OTHER_STATE ||
                                      op == FP3_EXPR_OTHER_PARAM || op == FP3_EXPR_FIELD ||
                                      op == FP3_EXPR_BEFORE;
    p->has_time[p->expr_count - 1] = op == FP3_EXPR_TIME || op == FP3_EXPR_STEP;
    p->is_number[p->expr_count - 1] = op == FP3_EXPR_NUMBER;
    p->values[p->expr_count - 1] = number;
    return (ode_value){1, {(uint16_t)(p->expr_count - 1)}};
}

/* Whether the hardware can compute it. Reports it if not. varies: it is not known before a run. */
static int possible(ode_parser *p, fp3_token at, fp3_expr_op op, const uint32_t operand[3],
                    int varies) {
    if (!varies)
        return 1;
    if (op == FP3_EXPR_POWER && !p->exprs[operand[1]].is_known) {
        fp3_ode_wrong(
            &p->in, at,
            "an exponent of numbers and params only (write exp(y*log(x)) for any other x^y)");
        return 0;
    }
    return 1;
}

static uint32_t operation(ode_parser *p, fp3_token at, fp3_expr_op op, uint32_t a, uint32_t b,
                          uint32_t c) {
    const uint32_t operand[3] = {a, b, c};
    int has_state = 0, has_time = 0, is_known = 1, is_number = 1;
    if (p->in.is_over)
        return FP3_NONE;
    for (unsigned i = 0; i < fp3_ode_operands(op); i++) {
        assert(operand[i] < p->expr_count); /* operands stand before the operation */
        has_state |= p->has_state[operand[i]];
        has_time |= p->has_time[operand[i]];
        is_known &= p->exprs[operand[i]].is_known;
        is_number &= p->is_number[operand[i]];
    }
    /* The host computes closed forms, and there t is a number. */
    const int varies = has_state || (has_time && p->context == ODE_IN_EQUATION);
    fp3_expr *e = possible(p, at, op, operand, varies) ? new_expr(p, at, op) : NULL;
    if (!e)
        return FP3_NONE;
    memcpy(e->operand, operand, sizeof operand);
    e->is_known = is_known;
    p->has_state[p->expr_count - 1] = (char)has_state;
    p->has_time[p->expr_count - 1] = (char)has_time;
    p->is_number[p->expr_count - 1] = (char)is_number;
    if (is_number)
        p->values[p->expr_count - 1] = fp3_ode_compute(e, NULL, p->values);
    return p->expr_count - 1;
}

/* The operation on each component; an operand of size 1 is the same for all. */
static ode_value each(ode_parser *p, fp3_token at, fp3_expr_op op, const ode_value operand[3],
                      unsigned size) {
    ode_value result = {.size = size};
    for (unsigned i = 0; i < size; i++) {
        uint32_t of[3] = {FP3_NONE, FP3_NONE, FP3_NONE};
        for (unsigned j = 0; j < fp3_ode_operands(op); j++)
            of[j] = operand[j].expr[operand[j].size > 1 ? i : 0];
        const uint32_t made = operation(p, at, op, of[0], of[1], of[2]);
        if (made == FP3_NONE)
            return nothing;
        result.expr[i] = (uint16_t)made;
    }
    return result;
}

ode_value fp3_ode_unary(ode_parser *p, fp3_token at, fp3_expr_op op, ode_value a) {
    const ode_value operand[3] = {a};
    if (!a.size)
        return nothing;
    if (a.size == 1 || op == FP3_EXPR_NEGATE)
        return each(p, at, op, operand, a.size);
    fp3_ode_wrong(&p->in, at, "a number for '%.*s' (this is %s)", shown(at), at.text,
                  fp3_ode_shape(a.size));
    return nothing;
}

/* The size of the result; 0 after an error. */
static unsigned common_size(ode_parser *p, fp3_token at, fp3_expr_op op, ode_value a, ode_value b) {
    switch (op) {
    case FP3_EXPR_ADD:
    case FP3_EXPR_SUB:
        if (a.size == b.size)
            return a.size;
        fp3_ode_wrong(&p->in, at,
                      "two numbers, or two vectors of the same size (these are %s and %s)",
                      fp3_ode_shape(a.size), fp3_ode_shape(b.size));
        return 0;
    case FP3_EXPR_MUL:
        if (a.size == 1 || b.size == 1)
            return a.size > b.size ? a.size : b.size;
        fp3_ode_wrong(&p->in, at, "a number on one side (dot and cross multiply vectors)");
        return 0;
    case FP3_EXPR_DIV:
        if (b.size == 1)
            return a.size;
        fp3_ode_wrong(&p->in, at, "a number to divide by (this is %s)", fp3_ode_shape(b.size));
        return 0;
    default:
        if (a.size == 1 && b.size == 1)
            return 1;
        fp3_ode_wrong(&p->in, at, "numbers for '%.*s' (these are %s and %s)", shown(at), at.text,
                      fp3_ode_shape(a.size), fp3_ode_shape(b.size));
        return 0;
    }
}

ode_value fp3_ode_binary(ode_parser *p, fp3_token at, fp3_expr_op op, ode_value a, ode_value b) {
    const ode_value operand[3] = {a, b};
    unsigned size = a.size && b.size ? common_size(p, at, op, a, b) : 0;
    return size ? each(p, at, op, operand, size) : nothing;
}

ode_value fp3_ode_select(ode_parser *p, fp3_token at, ode_value c, ode_value a, ode_value b) {
    const ode_value operand[3] = {c, a, b};
    if (!a.size || !b.size || !c.size)
        return nothing;
    if (c.size == 1 && a.size == b.size)
        return each(p, at, FP3_EXPR_SELECT, operand, a.size);
    fp3_ode_wrong(&p->in, at, "a number and two choices of the same size (these are %s, %s and %s)",
                  fp3_ode_shape(c.size), fp3_ode_shape(a.size), fp3_ode_shape(b.size));
    return nothing;
}

/* What is made of several objects is not known before a run. */
static ode_value over(ode_parser *p, uint32_t relation, ode_value made) {
    for (unsigned i = 0; i < made.size; i++) {
        const uint32_t e = made.expr[i];
        p->exprs[e].index = relation;
        p->exprs[e].is_known = p->is_number[e] = 0;
        p->has_state[e] = 1;
    }
    return made;
}

ode_value fp3_ode_total(ode_parser *p, fp3_token at, fp3_expr_op op, uint32_t relation,
                        ode_value term, ode_value start) {
    const ode_value operand[3] = {term, start};
    const unsigned size = !start.size            ? 0
                          : op == FP3_EXPR_TOTAL ? term.size
                                                 : common_size(p, at, op, term, start);
    return over(p, relation, each(p, at, op, operand, size));
}

ode_value fp3_ode_sum_of_group(ode_parser *p, fp3_token at, fp3_expr_op op, uint32_t relation,
                               ode_value term) {
    const ode_value operand[3] = {term};
    return over(p, relation, each(p, at, op, operand, term.size));
}

static ode_value component(ode_value a, unsigned i) { return (ode_value){1, {a.expr[i]}}; }

ode_value fp3_ode_fold(ode_parser *p, fp3_token at, fp3_expr_op op, ode_value a) {
    if (a.size == 1)
        fp3_ode_wrong(&p->in, at, "a vector for '%.*s' (this is a number)", shown(at), at.text);
    if (a.size < 2)
        return nothing;
    ode_value all = component(a, 0);
    for (unsigned i = 1; i < a.size; i++)
        all = fp3_ode_binary(p, at, op, all, component(a, i));
    return all;
}

int fp3_ode_is_number(const ode_parser *p, ode_value value) {
    return value.size == 1 && p->is_number[value.expr[0]];
}

void fp3_ode_forget(ode_parser *p, uint32_t from) { p->expr_count = from; }

static int two_vectors(ode_parser *p, fp3_token at, ode_value a, ode_value b) {
    if (!a.size || !b.size)
        return 0;
    if (a.size == b.size && a.size > 1)
        return 1;
    fp3_ode_wrong(&p->in, at, "two vectors of the same size for '%.*s' (these are %s and %s)",
                  shown(at), at.text, fp3_ode_shape(a.size), fp3_ode_shape(b.size));
    return 0;
}

static ode_value product(ode_parser *p, fp3_token at, ode_value a, unsigned i, ode_value b,
                         unsigned j) {
    return fp3_ode_binary(p, at, FP3_EXPR_MUL, component(a, i), component(b, j));
}

ode_value fp3_ode_dot(ode_parser *p, fp3_token at, ode_value a, ode_value b) {
    if (!two_vectors(p, at, a, b))
        return nothing;
    ode_value sum = product(p, at, a, 0, b, 0);
    for (unsigned i = 1; i < a.size; i++)
        sum = fp3_ode_binary(p, at, FP3_EXPR_ADD, sum, product(p, at, a, i, b, i));
    return sum;
}

ode_value fp3_ode_cross(ode_parser *p, fp3_token at, ode_value a, ode_value b) {
    if (!two_vectors(p, at, a, b))
        return nothing;
    if (a.size > 3) {
        fp3_ode_wrong(&p->in, at, "two vectors of 2 or 3 for 'cross' (these are vectors of %u)",
                      a.size);
        return nothing;
    }
    ode_value result = {.size = a.size == 2 ? 1 : 3};
    for (unsigned k = 0; k < result.size; k++) {
        unsigned i = a.size == 2 ? 0 : (k + 1) % 3, j = a.size == 2 ? 1 : (k + 2) % 3;
        ode_value left = product(p, at, a, i, b, j), right = product(p, at, a, j, b, i);
        ode_value difference = fp3_ode_binary(p, at, FP3_EXPR_SUB, left, right);
        if (!difference.size)
            return nothing;
        result.expr[k] = difference.expr[0];
    }
    return result;
}

/* ---- component by component ---- */

void fp3_ode_append(ode_parser *p, fp3_token open, ode_value part, ode_components *all) {
    if (part.size > 1)
        fp3_ode_wrong(&p->in, open, "a vector of numbers (there is %s in it)",
                      fp3_ode_shape(part.size));
    all->is_good &= part.size == 1;
    if (all->size < ODE_VECTOR)
        all->value.expr[all->size] = part.expr[0];
    all->size++;
}

ode_value fp3_ode_vector_of(ode_parser *p, fp3_token open, ode_components *all) {
    const int fits = all->size > 0 && all->size <= ODE_VECTOR;
    if (!fits)
        fp3_ode_wrong(&p->in, open, "a vector of 2 to %d (this has %u components)", ODE_VECTOR,
                      all->size);
    all->value.size = all->is_good && fits ? all->size : 0;
    return all->value;
}
