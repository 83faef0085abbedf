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
    int is_others; /* a word of a neighbour */
} made;

typedef struct {
    fp3_step *step;
    const dag *from;
    dag *to;
    const uint32_t *low; /* of each variable: its second word, or FP3_NONE */
    made *made;          /* of each node */
    char *is_reached;
    fp3_seen *seen; /* of each value that others see both words; FP3_NONE: not made yet */
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
                  .is_whole = is_zero || is_one || fp3_known_is(d->to->known, known, -0.0),
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
        d->step->variables[variable].role == ROLE_STEPS,
        0,
        is_control(d->step, &d->step->variables[variable]),
        0,
        0};
}

/* Whether a node is a zero of any sign. */
static int is_zero(const doubling *d, uint32_t node) {
    return fp3_dag_is_number(d->from, node, 0) || fp3_dag_is_number(d->from, node, -0.0);
}

/* A word of a neighbour, or of its entry. */
static uint32_t others_word(const doubling *d, const dag_node *n, uint32_t word) {
    return fp3_dag_neighbour(d->to, n->op, n->a, n->b, word);
}

static made of_neighbour(const doubling *d, const dag_node *n) {
    const fp3_pair words = {others_word(d, n, 0), others_word(d, n, 1)};
    return (made){.value = fp3_loose_of(words), .is_others = 1};
}

/* A sum of exact floats is one, and so is the largest of truth values. All other folds have two
 * words, which are nodes side by side: what they begin with, and their terms, come before both. A
 * sum begins at +0: a term of zeros of any sign leaves such a pair alone in every bit, as one
 * leaves a float that begins at -0. */
static made of_fold(const doubling *d, const dag_node *n) {
    const made *a = &d->made[n->a], *b = &d->made[n->b];
    const int is_total = n->op == NODE_TOTAL;
    if (a->is_whole && b->is_whole)
        return (made){.value = single(fp3_dag_neighbour(d->to, n->op, high_of(d, n->a),
                                                        high_of(d, n->b), n->c)),
                      .is_whole = 1,
                      .is_truth = !is_total && a->is_truth && b->is_truth};
    const fp3_pair term = pair_of(d, n->a), start = pair_of(d, n->b);
    const uint32_t low = fp3_pair_low(d->to, term), start_low = fp3_pair_low(d->to, start);
    const uint32_t begin = is_total && is_zero(d, n->b) ? fp3_dag_number(d->to, 0) : start.high;
    const uint32_t fold = fp3_dag_make(d->to, n->op, term.high, begin, n->c);
    return (made){.value = fp3_loose_of(
                      (fp3_pair){fold, fp3_dag_make(d->to, NODE_SECOND, low, start_low, n->c)})};
}

/* What all objects compare is one word: a float, or exact. */
static made of_worst(const doubling *d, const dag_node *n) {
    const made *a = &d->made[n->a];
    return (made){.value = single(fp3_dag_worst(d->to, fp3_loose_first(d->to, a->value), n->c)),
                  .is_whole = a->is_whole,
                  .is_truth = a->is_truth,
                  .is_float = !a->is_whole};
}

static uint32_t of_highs(const doubling *d, const dag_node *n) {
    return fp3_pair_op(d->to, n->op, high_of(d, n->a), high_of(d, n->b), FP3_NONE);
}

/* A difference with what a neighbour has mostly cancels, and what is made of it is small: it is as
 * exact as it is small. */
static made of_sum(const doubling *d, const dag_node *n) {
    const made *a = &d->made[n->a], *b = &d->made[n->b];
    if (a->is_whole && b->is_whole && !(a->is_known && b->is_known))
        return (made){.value = single(of_highs(d, n)), .is_whole = 1};
    if (n->op == FP3_OP_ADD)
        return (made){.value = fp3_loose_add(d->to, a->value, b->value)};
    if (fp3_dag_is_number(d->from, n->a, -0.0))
        return (made){.value = fp3_loose_negated(d->to, b->value)};
    if (a->is_others || b->is_others)
        return (made){.value =
                          fp3_loose_of(fp3_pair_sub(d->to, pair_of(d, n->a), pair_of(d, n->b)))};
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
        a->is_whole && b->is_whole,
        a->is_truth && b->is_truth,
        0,
        0,
        0};
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
    return (made){single(fp3_pair_op(d->to, n->op, high_of(d, n->a), b, c)),
                  is_truth,
                  is_truth,
                  !is_truth,
                  0,
                  0};
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
    case NODE_OTHER_STATE:
    case NODE_OTHER_PARAM:
    case NODE_FIELD:
        return of_neighbour(d, n);
    case NODE_TOTAL:
    case NODE_LEAST:
    case NODE_MOST:
        return of_fold(d, n);
    case NODE_WORST:
        return of_worst(d, n);
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

/* A dag, and what refers to its nodes. */
typedef struct {
    dag *values;
    uint32_t *next, *first; /* of each variable: a node, or FP3_NONE; first may be NULL */
    fp3_sight *sight;       /* NULL: nobody sees anything */
    fp3_kept *kept;         /* what entries remember */
    uint32_t *kept_count;   /* NULL: nothing */
} part;

static void reach(const doubling *d, uint32_t node) {
    if (node != FP3_NONE)
        d->is_reached[node] = 1;
}

static int operand_nodes(const dag *g, uint32_t node) {
    const uint32_t op = g->nodes[node].op;
    if (fp3_dag_is_leaf(g, node) || (op >= NODE_OTHER_STATE && op <= NODE_FIELD))
        return 0;
    return op == NODE_WORST ? 1 : fp3_dag_is_fold(op) ? 2 : 3;
}

/* The nodes that something comes from. */
static void find_reached(const doubling *d, const part *p, uint32_t variables) {
    for (uint32_t i = 0; i < variables; i++) {
        reach(d, p->next[i]);
        if (p->first)
            reach(d, p->first[i]);
    }
    for (uint32_t i = 0; p->sight && i < p->sight->count; i++)
        reach(d, p->sight->list[i].node);
    for (uint32_t i = 0; p->kept_count && i < *p->kept_count; i++)
        reach(d, p->kept[i].node);
    for (uint32_t i = d->from->count; i-- > 0;)
        for (int j = 0; d->is_reached[i] && j < operand_nodes(d->from, i); j++)
            reach(d, fp3_dag_operand(d->from, i, j));
}

/* The pair of a node, with the note that this had. */
static fp3_pair noted(const doubling *d, uint32_t node) {
    d->to->note = d->from->nodes[node].note;
    return pair_of(d, node);
}

/* What others see at a place; FP3_NONE: at all places. */
static void double_seen(const doubling *d, const fp3_sight *sight, uint32_t place) {
    for (uint32_t i = 0; sight && i < sight->count; i++) {
        const fp3_seen seen = sight->list[i];
        if (d->seen[2 * i].node != FP3_NONE || (place != FP3_NONE && seen.place != place))
            continue;
        const fp3_pair pair = noted(d, seen.node);
        d->seen[2 * i] = (fp3_seen){seen.place, seen.state, pair.high, 0};
        d->seen[2 * i + 1] = (fp3_seen){seen.place, seen.state, fp3_pair_low(d->to, pair), 1};
    }
}

/* What a fold reads of others comes before it: the plan goes through the nodes in their order. */
static void double_nodes(const doubling *d, const fp3_sight *sight) {
    for (uint32_t i = 0; i < d->from->count; i++) {
        const dag_node *n = &d->from->nodes[i];
        if (!d->is_reached[i])
            continue;
        if (fp3_dag_is_fold(n->op))
            double_seen(d, sight, fp3_dag_place(d->from, i));
        d->to->note = n->note;
        d->made[i] = of_node(d, n);
    }
}

static void double_variables(const doubling *d, const part *p, uint32_t variables) {
    for (uint32_t i = 0; i < variables; i++) {
        if (p->first && p->first[i] != FP3_NONE)
            p->first[i] = pair_of(d, p->first[i]).high;
        if (p->next[i] == FP3_NONE)
            continue;
        const fp3_pair pair = noted(d, p->next[i]);
        p->next[i] = pair.high;
        if (d->low[i] != FP3_NONE)
            p->next[d->low[i]] = fp3_pair_low(d->to, pair);
    }
}

/* Others see both words of a state at once. */
static void take_seen(doubling *d, fp3_sight *sight) {
    free(sight->list);
    sight->list = d->seen;
    sight->count = sight->room = 2 * sight->count;
    d->seen = NULL;
}

static void double_kept(const doubling *d, fp3_kept *kept, uint32_t *count) {
    for (uint32_t i = *count; i-- > 0;) {
        const fp3_kept one = kept[i];
        const fp3_pair pair = noted(d, one.node);
        kept[2 * i] = (fp3_kept){one.relation, one.field, pair.high, 0};
        kept[2 * i + 1] = (fp3_kept){one.relation, one.field, fp3_pair_low(d->to, pair), 1};
    }
    *count *= 2;
}

/* A dag to one of pairs, which takes its place. */
static fp3_status double_dag(fp3_step *step, const part *p, const uint32_t *low, uint32_t variables,
                             fp3_error *error) {
    dag to, *from = p->values;
    fp3_dag_open(&to, &step->known, from->passes & ~FP3_PASS(FP3_PASS_FOLD_PRODUCT));
    const uint32_t seen = p->sight ? 2 * p->sight->count : 0;
    doubling d = {.step = step,
                  .from = from,
                  .to = &to,
                  .low = low,
                  .made = calloc(from->count + 1u, sizeof *d.made),
                  .is_reached = calloc(from->count + 1u, 1),
                  .seen = malloc((seen + 1u) * sizeof *d.seen)};
    fp3_status status = d.made && d.is_reached && d.seen ? FP3_OK : fp3_no_memory(error);
    if (!status) {
        for (uint32_t i = 0; i < seen; i++)
            d.seen[i].node = FP3_NONE;
        find_reached(&d, p, variables);
        double_nodes(&d, p->sight);
        double_variables(&d, p, variables);
        if (p->kept_count)
            double_kept(&d, p->kept, p->kept_count);
        double_seen(&d, p->sight, FP3_NONE);
        if (p->sight)
            take_seen(&d, p->sight);
    }
    free(d.seen);
    free(d.made);
    free(d.is_reached);
    fp3_dag_close(from);
    *from = to;
    return status;
}

static uint32_t *next_place(variable *v) { return &v->next; }
static uint32_t *first_place(variable *v) { return &v->first; }
static uint32_t *last_place(variable *v) { return &v->last; }

/* A member of all variables, as a list, which the caller frees. */
static uint32_t *list_of(fp3_step *step, uint32_t *(*place)(variable *v)) {
    uint32_t *list = malloc((step->variable_count + 1u) * sizeof *list);
    for (uint32_t i = 0; list && i < step->variable_count; i++)
        list[i] = *place(&step->variables[i]);
    return list;
}

static void put_back(fp3_step *step, const uint32_t *list, uint32_t *(*place)(variable *v)) {
    for (uint32_t i = 0; i < step->variable_count; i++)
        *place(&step->variables[i]) = list[i];
}

/* The values of the step, or its last part. */
static fp3_status double_own(fp3_step *step, int is_last, const uint32_t *low, uint32_t variables,
                             fp3_error *error) {
    uint32_t *next = list_of(step, is_last ? last_place : next_place);
    uint32_t *first = list_of(step, first_place);
    const part of = {.values = is_last ? &step->last : &step->values,
                     .next = next,
                     .first = is_last ? NULL : first,
                     .sight = is_last ? NULL : &step->sight,
                     .kept = step->kept,
                     .kept_count = is_last ? NULL : &step->kept_count};
    fp3_status status = next && first ? FP3_OK : fp3_no_memory(error);
    if (!status) {
        status = double_dag(step, &of, low, variables, error);
        put_back(step, next, is_last ? last_place : next_place);
        put_back(step, first, first_place);
    }
    free(next);
    free(first);
    return status;
}

static fp3_status double_segment(fp3_step *step, fp3_segment *s, const uint32_t *low,
                                 uint32_t variables, fp3_error *error) {
    uint32_t *next = realloc(s->next, (step->variable_count + 1u) * sizeof *next);
    if (!next)
        return fp3_no_memory(error);
    s->next = next;
    for (uint32_t i = variables; i < step->variable_count; i++)
        next[i] = FP3_NONE;
    const part of = {.values = &s->values, .next = next, .sight = &s->sight};
    return double_dag(step, &of, low, variables, error);
}

/* What the second word of a variable is; ROLE_STATE: it has none. */
static role low_role(const fp3_step *step, const variable *v) {
    if (v->role == ROLE_STATE && !is_control(step, v))
        return ROLE_LOW;
    if (v->role == ROLE_BEFORE)
        return ROLE_LOW_BEFORE;
    return v->role == ROLE_CARRIED && v->state != FP3_NONE ? ROLE_CARRIED : ROLE_STATE;
}

static fp3_status add_low_words(fp3_step *step, uint32_t *low, fp3_error *error) {
    const uint32_t count = step->variable_count;
    for (uint32_t i = 0; i < count; i++) {
        const variable v = step->variables[i];
        const role role = low_role(step, &v);
        low[i] = role == ROLE_STATE ? FP3_NONE : step->variable_count;
        if (role != ROLE_STATE && !fp3_step_add(step, role, v.state))
            return fp3_no_memory(error);
    }
    return FP3_OK;
}

fp3_status fp3_double_step(fp3_step *step, fp3_error *error) {
    const uint32_t variables = step->variable_count;
    uint32_t *low = calloc(variables + 1u, sizeof *low);
    fp3_status status = low ? add_low_words(step, low, error) : fp3_no_memory(error);
    for (uint32_t i = 0; !status && i < step->segment_count; i++)
        status = double_segment(step, &step->segments[i], low, variables, error);
    for (int is_last = 0; !status && is_last < 2; is_last++)
        status = double_own(step, is_last, low, variables, error);
    free(low);
    return status;
}
