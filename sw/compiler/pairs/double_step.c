/* SPDX-License-Identifier: Apache-2.0 */
/* double_step.c - nodes to pairs, from the first to the last. */
#include "double_step.h"

#include "language/function_rows.h"
#include "loose.h"
#include "pair_functions.h"

#include <assert.h>
#include <fp3/compile.h>
#include <fp3/isa.h>
#include <stdlib.h>

fp3_status fp3_double_check(const fp3_options *options, fp3_error *error) {
    if (options->arithmetic != FP3_DOUBLE_SINGLE || !fp3_has_pass(options, FP3_PASS_EXACT_DIVISION))
        return FP3_OK;
    return fp3_fail(
        error, FP3_E_ARGUMENT,
        "`exact-division` applies to plain floats: double-single has quotients and roots of "
        "its own");
}

/* The pair of a node. Counts of steps and truth values, 0 or 1, are exact floats. The control of
 * adaptive steps uses floats, without second words. */
typedef struct {
    fp3_loose value;
    int is_whole, is_truth, is_float, is_known;
} made;

typedef struct {
    fp3_step *step;
    const dag *from;
    dag *to;
    const uint32_t *low; /* of each variable: its second word, or FP3_NONE */
    made *made;          /* of each node */
    char *is_reached;
} doubling;

static uint32_t high_of(const doubling *d, uint32_t node) { return d->made[node].value.words.high; }

/* For others it stays as it is: what they make of it does not depend on who else reads it. */
static fp3_pair pair_of(const doubling *d, uint32_t node) {
    return fp3_loose_pair(d->to, d->made[node].value);
}

static fp3_loose single(uint32_t node) { return fp3_loose_of((fp3_pair){node, FP3_NONE}); }

static made of_known(const doubling *d, uint32_t known) {
    const fp3_pair pair = fp3_pair_known(d->to, known);
    const int is_zero = fp3_known_is(d->to->known, known, 0);
    const int is_one = fp3_known_is(d->to->known, known, 1);
    return (made){.value = fp3_loose_of(pair),
                  .is_whole = is_zero || is_one,
                  .is_truth = is_zero || is_one,
                  .is_known = 1};
}

/* Behind t, which is a pair: a model's own states come before it. */
static int is_control(const fp3_step *step, const variable *v) {
    const uint32_t t = fp3_model_adapted(step->model);
    return t != FP3_NONE && v->role == ROLE_STATE && v->state > t;
}

static made of_variable(const doubling *d, uint32_t variable) {
    const uint32_t low = d->low[variable];
    return (made){
        fp3_loose_of((fp3_pair){fp3_dag_variable(d->to, variable),
                                low == FP3_NONE ? FP3_NONE : fp3_dag_variable(d->to, low)}),
        d->step->variables[variable].role == ROLE_STEPS, 0,
        is_control(d->step, &d->step->variables[variable]), 0};
}

static uint32_t of_highs(const doubling *d, const dag_node *n) {
    return fp3_pair_op(d->to, n->op, high_of(d, n->a), high_of(d, n->b), FP3_NONE);
}

static made of_sum(const doubling *d, const dag_node *n) {
    const made *a = &d->made[n->a], *b = &d->made[n->b];
    if (a->is_whole && b->is_whole && !(a->is_known && b->is_known))
        return (made){.value = single(of_highs(d, n)), .is_whole = 1};
    if (n->op == FP3_OP_ADD)
        return (made){.value = fp3_loose_add(d->to, a->value, b->value)};
    if (fp3_dag_is_number(d->from, n->a, -0.0))
        return (made){.value = fp3_loose_negated(d->to, b->value)};
    return (made){.value = fp3_loose_sub(d->to, a->value, b->value)};
}

static made of_product(const doubling *d, const dag_node *n) {
    const made *a = &d->made[n->a], *b = &d->made[n->b];
    if (a->is_truth && b->is_truth)
        return (made){.value = single(of_highs(d, n)), .is_whole = 1, .is_truth = 1};
    return (made){.value = fp3_loose_mul(d->to, a->value, b->value)};
}

static made of_choice(const doubling *d, const dag_node *n) {
    const made *a = &d->made[n->a], *b = &d->made[n->b];
    return (made){
        fp3_loose_of(fp3_pair_select(d->to, high_of(d, n->c), pair_of(d, n->a), pair_of(d, n->b))),
        a->is_whole && b->is_whole, a->is_truth && b->is_truth, 0, 0};
}

/* min(a, b) is a where a < b, max(a, b) is a where b < a. */
static fp3_pair extreme(const doubling *d, const dag_node *n) {
    const fp3_pair a = pair_of(d, n->a), b = pair_of(d, n->b);
    const fp3_pair is_first =
        n->op == FP3_OP_MIN ? fp3_pair_less(d->to, a, b) : fp3_pair_less(d->to, b, a);
    return fp3_pair_select(d->to, is_first.high, a, b);
}

#define DOUBLE_INSTRUCTIONS(OP, name)
#define DOUBLE_POLYNOMIAL(OP, name)                                                                \
    case FP3_EXPR_##OP:                                                                            \
        return fp3_pair_##name(d->to, a);
#define DOUBLE_POLYNOMIAL_2(OP, name)                                                              \
    case FP3_EXPR_##OP:                                                                            \
        return fp3_pair_##name(d->to, a, pair_of(d, n->b));

static fp3_pair of_function(const doubling *d, const dag_node *n) {
    const fp3_pair a = pair_of(d, n->a);
    switch (n->op - NODE_FUNCTION) {
#define X(OP, name, MADE, ...) DOUBLE_##MADE(OP, name)
        FP3_FUNCTION_ROWS(X)
#undef X
    }
    assert(n->op == NODE_FUNCTION + FP3_EXPR_POWER);
    return fp3_pair_power(d->to, a, fp3_dag_is_known(d->from, n->b));
}

static int operand_count(const dag_node *n) {
    return n->b == FP3_NONE ? 1 : n->c == FP3_NONE ? 2 : 3;
}

/* All values are floats, or known values or truth values beside a float. The condition of a choice
 * does not count. Estimates are of known values alone where nothing moves: the error is 0 then. */
static int is_of_floats(const doubling *d, const dag_node *n) {
    const uint32_t of[] = {n->a, n->b};
    int is_any = 0;
    for (int i = 0; i < 2 && i < operand_count(n); i++) {
        const made *m = &d->made[of[i]];
        if (!m->is_float && !m->is_known && !m->is_truth)
            return 0;
        is_any |= m->is_float;
    }
    return is_any || (n->op >= FP3_OP_RCP && n->op <= FP3_OP_LOGB);
}

static made of_floats(const doubling *d, const dag_node *n) {
    const uint32_t b = n->b == FP3_NONE ? FP3_NONE : high_of(d, n->b);
    const uint32_t c = n->c == FP3_NONE ? FP3_NONE : high_of(d, n->c);
    const int is_truth = n->op == FP3_OP_LT || n->op == FP3_OP_LE;
    return (made){single(fp3_pair_op(d->to, n->op, high_of(d, n->a), b, c)), is_truth, is_truth,
                  !is_truth, 0};
}

/* Of two pairs as they come: their order, or the larger. */
static made compared(const doubling *d, const dag_node *n) {
    const fp3_pair a = pair_of(d, n->a), b = pair_of(d, n->b);
    const fp3_pair is_so =
        n->op == FP3_OP_LT ? fp3_pair_less(d->to, a, b) : fp3_pair_less_equal(d->to, a, b);
    return (made){.value = fp3_loose_of(is_so), .is_whole = 1, .is_truth = 1};
}

/* Of what is not a sum, nor a product. */
static fp3_pair of_pairs(const doubling *d, const dag_node *n) {
    switch (n->op) {
    case FP3_OP_MIN:
    case FP3_OP_MAX:
        return extreme(d, n);
    case FP3_OP_ABS:
        return fp3_pair_abs(d->to, pair_of(d, n->a));
    case NODE_QUOTIENT:
        return fp3_pair_quotient(d->to, pair_of(d, n->a), pair_of(d, n->b));
    case NODE_ROOT:
        return fp3_pair_root(d->to, pair_of(d, n->a));
    case NODE_INVERSE_ROOT:
        return fp3_pair_inverse_root(d->to, pair_of(d, n->a));
    default:
        return of_function(d, n);
    }
}

static made of_node(const doubling *d, const dag_node *n) {
    if (n->op < NODE_KNOWN && is_of_floats(d, n))
        return of_floats(d, n);
    switch (n->op) {
    case NODE_KNOWN:
        return of_known(d, n->a);
    case NODE_VARIABLE:
        return of_variable(d, n->a);
    case NODE_FIRST:
        return (made){.value = single(fp3_loose_first(d->to, d->made[n->a].value)), .is_float = 1};
    case FP3_OP_ADD:
    case FP3_OP_SUB:
        return of_sum(d, n);
    case FP3_OP_MUL:
        return of_product(d, n);
    case FP3_OP_SEL:
        return of_choice(d, n);
    case FP3_OP_LT:
    case FP3_OP_LE:
        return compared(d, n);
    default:
        return (made){.value = fp3_loose_of(of_pairs(d, n))};
    }
}

/* ---- the step ---- */

/* The nodes that variables come from, by `root`. */
static void find_reached(const doubling *d, uint32_t (*root)(const variable *v)) {
    for (uint32_t i = 0; i < d->step->variable_count; i++) {
        const variable *v = &d->step->variables[i];
        if (root(v) != FP3_NONE)
            d->is_reached[root(v)] = 1;
        if (d->from == &d->step->values && v->first != FP3_NONE)
            d->is_reached[v->first] = 1;
    }
    for (uint32_t i = d->from->count; i-- > 0;)
        for (int j = 0; d->is_reached[i] && !fp3_dag_is_leaf(d->from, i) && j < 3; j++)
            if (fp3_dag_operand(d->from, i, j) != FP3_NONE)
                d->is_reached[fp3_dag_operand(d->from, i, j)] = 1;
}

static void double_nodes(const doubling *d) {
    for (uint32_t i = 0; i < d->from->count; i++) {
        const dag_node *n = &d->from->nodes[i];
        if (!d->is_reached[i])
            continue;
        d->to->note = n->note;
        d->made[i] = of_node(d, n);
    }
}

static uint32_t next_root(const variable *v) { return v->next; }
static uint32_t last_root(const variable *v) { return v->last; }
static uint32_t *next_place(variable *v) { return &v->next; }
static uint32_t *last_place(variable *v) { return &v->last; }

/* A dag to one of pairs, which takes its place. */
static fp3_status double_dag(fp3_step *step, dag *from, const uint32_t *low, uint32_t variables,
                             uint32_t (*root)(const variable *v), uint32_t *(*place)(variable *v),
                             fp3_error *error) {
    dag to;
    fp3_dag_open(&to, &step->known, from->passes & ~FP3_PASS(FP3_PASS_FOLD_PRODUCT));
    const doubling d = {.step = step,
                        .from = from,
                        .to = &to,
                        .low = low,
                        .made = calloc(from->count + 1u, sizeof *d.made),
                        .is_reached = calloc(from->count + 1u, 1)};
    fp3_status status = d.made && d.is_reached ? FP3_OK : fp3_no_memory(error);
    if (!status) {
        find_reached(&d, root);
        double_nodes(&d);
    }
    for (uint32_t i = 0; !status && i < variables; i++) {
        const uint32_t node = root(&step->variables[i]);
        uint32_t *first = &step->variables[i].first;
        if (from == &step->values && *first != FP3_NONE)
            *first = pair_of(&d, *first).high;
        if (node == FP3_NONE)
            continue;
        to.note = from->nodes[node].note;
        const fp3_pair pair = pair_of(&d, node);
        *place(&step->variables[i]) = pair.high;
        if (low[i] != FP3_NONE)
            *place(&step->variables[low[i]]) = fp3_pair_low(&to, pair);
    }
    free(d.made);
    free(d.is_reached);
    fp3_dag_close(from);
    *from = to;
    return status;
}

static fp3_status add_low_words(fp3_step *step, uint32_t *low, fp3_error *error) {
    const uint32_t count = step->variable_count;
    for (uint32_t i = 0; i < count; i++) {
        const variable v = step->variables[i];
        low[i] = FP3_NONE;
        if ((v.role != ROLE_STATE && v.role != ROLE_BEFORE) || is_control(step, &v))
            continue;
        low[i] = step->variable_count;
        if (!fp3_step_add(step, v.role == ROLE_STATE ? ROLE_LOW : ROLE_LOW_BEFORE, v.state))
            return fp3_no_memory(error);
    }
    return FP3_OK;
}

fp3_status fp3_double_step(fp3_step *step, fp3_error *error) {
    const uint32_t variables = step->variable_count;
    uint32_t *low = calloc(variables + 1u, sizeof *low);
    fp3_status status = low ? add_low_words(step, low, error) : fp3_no_memory(error);
    if (!status)
        status = double_dag(step, &step->values, low, variables, next_root, next_place, error);
    if (!status)
        status = double_dag(step, &step->last, low, variables, last_root, last_place, error);
    free(low);
    return status;
}
