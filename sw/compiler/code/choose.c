/* SPDX-License-Identifier: Apache-2.0 */
/* choose.c - each addition may take in one product that no other node reads, or that only additions
 * read that all take it in. */
#include "choose.h"

#include "machine/cycles.h"

#include <assert.h>
#include <fp3/isa.h>
#include <stdlib.h>

typedef struct {
    const fp3_part *p;
    const dag *g;
    uint32_t *ready;   /* cycles from the beginning, as if there were nothing else to do */
    uint32_t *due;     /* the latest that it may be ready without making its users late */
    char *is_absorbed; /* a product that an addition takes in */
    char *is_free;     /* a product that nothing but additions reads which can all take it in */
} chooser;

static uint32_t latency(const chooser *c, uint32_t op) {
    return fp3_cycles_latency(c->p->options->config, op);
}

static uint32_t later(uint32_t a, uint32_t b) { return a > b ? a : b; }

static int is_executed(const chooser *c, uint32_t node) {
    return c->p->uses[node] && !c->p->is_leaf[node];
}

/* ---- time ---- */

static void count_uses(const chooser *c) {
    for (uint32_t i = c->g->count; i-- > 0;)
        for (int j = 0; is_executed(c, i) && j < 3; j++)
            if (fp3_dag_operand(c->g, i, j) != FP3_NONE)
                c->p->uses[fp3_dag_operand(c->g, i, j)]++;
}

static void find_ready(const chooser *c) {
    for (uint32_t i = 0; i < c->g->count; i++) {
        if (!is_executed(c, i))
            continue;
        for (int j = 0; j < 3; j++)
            if (fp3_dag_operand(c->g, i, j) != FP3_NONE)
                c->ready[i] = later(c->ready[i], c->ready[fp3_dag_operand(c->g, i, j)]);
        c->ready[i] += latency(c, c->g->nodes[i].op);
    }
}

/* As late as the longest path through the part allows. */
static void find_due(const chooser *c) {
    uint32_t longest = 0;
    for (uint32_t i = 0; i < c->g->count; i++)
        longest = later(longest, c->ready[i]);
    for (uint32_t i = 0; i < c->g->count; i++)
        c->due[i] = longest;
    for (uint32_t i = c->g->count; i-- > 0;)
        for (int j = 0; is_executed(c, i) && j < 3; j++) {
            const uint32_t at = fp3_dag_operand(c->g, i, j);
            const uint32_t due = c->due[i] - latency(c, c->g->nodes[i].op);
            if (at != FP3_NONE && due < c->due[at])
                c->due[at] = due;
        }
}

/* ---- half, twice, chains ---- */

static int is_product(const chooser *c, uint32_t node) {
    return !c->p->is_leaf[node] && c->g->nodes[node].op == FP3_OP_MUL;
}

static int is_free_product(const chooser *c, uint32_t node) { return c->is_free[node]; }

/* Whether node i always takes in operand j: an addition whose other operand is no product. */
static int takes(const chooser *c, uint32_t i, int j) {
    const dag_node *n = &c->g->nodes[i];
    if (n->op == FP3_OP_ADD)
        return !is_product(c, j ? n->a : n->b);
    return n->op == FP3_OP_SUB && j == 1 && !is_product(c, n->a);
}

/* A product that is read twice and taken in twice costs one instruction less. With one object its
 * operands would be needed longer, and the product would be late, so this is not done. */
static void find_free(const chooser *c, uint32_t *taken) {
    for (uint32_t i = 0; i < c->g->count; i++)
        for (int j = 0; is_executed(c, i) && j < 2; j++) {
            const uint32_t at = fp3_dag_operand(c->g, i, j);
            if (at != FP3_NONE && is_product(c, at))
                taken[at] += takes(c, i, j);
        }
    for (uint32_t i = 0; i < c->g->count; i++)
        c->is_free[i] =
            is_product(c, i) && (c->p->uses[i] == 1 ||
                                 (c->p->options->config->interleave && taken[i] == c->p->uses[i]));
}

/* The scaled form of op whose second operand is this product, or 0. */
static uint32_t scaled(const chooser *c, uint32_t op, uint32_t product, uint32_t *other) {
    const fp3_options *options = c->p->options;
    if (!options->config->scale || !fp3_has_pass(options, FP3_PASS_SCALE) ||
        !is_free_product(c, product))
        return 0;
    for (int i = 0; i < 2; i++) {
        const uint32_t factor = fp3_dag_operand(c->g, product, !i);
        *other = fp3_dag_operand(c->g, product, i);
        if (fp3_dag_is_number(c->g, factor, 2))
            return op == FP3_OP_ADD ? FP3_OP_ADDT : FP3_OP_SUBT;
        if (fp3_dag_is_number(c->g, factor, 0.5))
            return op == FP3_OP_ADD ? FP3_OP_ADDH : FP3_OP_SUBH;
    }
    return 0;
}

static int is_chained(const chooser *c, uint32_t product, uint32_t base) {
    const fp3_options *options = c->p->options;
    if (!fp3_has_pass(options, FP3_PASS_CHAIN) || c->p->policy == CHAIN_NONE ||
        !is_free_product(c, product))
        return 0;
    const dag_node *n = &c->g->nodes[product];
    return c->p->policy != CHAIN_EARLY || options->config->interleave ||
           c->ready[base] <= later(c->ready[n->a], c->ready[n->b]);
}

static uint32_t chain(const chooser *c, uint32_t op) {
    const int is_fused = c->p->options->config->fused != 0;
    return op == FP3_OP_ADD ? (is_fused ? FP3_OP_FMADD : FP3_OP_MADD)
                            : (is_fused ? FP3_OP_FMSUB : FP3_OP_MSUB);
}

/* Node i = x +/- y, where it may take y in. */
static int absorb(const chooser *c, uint32_t i, uint32_t x, uint32_t y, fp3_choice_of_node *made) {
    const dag_node *n = &c->g->nodes[i], *product = &c->g->nodes[y];
    uint32_t other = 0;
    const uint32_t scale = scaled(c, n->op, y, &other), own = c->is_absorbed[y] ? 1 : 2;
    if (scale)
        *made = (fp3_choice_of_node){scale, {x, other, FP3_NONE}, own};
    else if (is_chained(c, y, x))
        *made = (fp3_choice_of_node){chain(c, n->op), {product->a, product->b, x}, own};
    else
        return 0;
    c->is_absorbed[y] = 1;
    return 1;
}

/* Of two products an addition takes in the later one: the other must be there when it begins. */
static int absorb_one(const chooser *c, uint32_t i, fp3_choice_of_node *made) {
    const dag_node *n = &c->g->nodes[i];
    if (n->op != FP3_OP_ADD && n->op != FP3_OP_SUB)
        return 0;
    const int turned = n->op == FP3_OP_ADD && c->ready[n->a] > c->ready[n->b];
    const uint32_t first = turned ? n->a : n->b, second = turned ? n->b : n->a;
    return absorb(c, i, second, first, made) ||
           (n->op == FP3_OP_ADD && absorb(c, i, first, second, made));
}

static int has_slack(const chooser *c, uint32_t i) {
    return c->p->policy == CHAIN_LONG ||
           c->due[i] >= c->ready[i] + latency(c, chain(c, FP3_OP_ADD));
}

/* a + b as a + 1 b and a b as -0 + a b: the same bits and flags, as late as a chain. */
static void lengthen(const chooser *c, uint32_t i, fp3_choice_of_node *made) {
    const dag_node *n = &c->g->nodes[i];
    if (c->p->policy < CHAIN_SLACK || c->p->one == FP3_NONE || !has_slack(c, i))
        return;
    if (n->op == FP3_OP_ADD || n->op == FP3_OP_SUB)
        *made = (fp3_choice_of_node){chain(c, n->op), {n->b, c->p->one, n->a}, 1};
    else if (n->op == FP3_OP_MUL)
        *made = (fp3_choice_of_node){chain(c, FP3_OP_ADD), {n->a, n->b, c->p->minus_zero}, 1};
}

/* Users come after what they use, and they decide: from the last node to the first. */
static void choose_all(const chooser *c, fp3_choice_of_node *choices) {
    for (uint32_t i = c->g->count; i-- > 0;) {
        const dag_node *n = &c->g->nodes[i];
        choices[i] = (fp3_choice_of_node){0};
        if (!is_executed(c, i) || c->is_absorbed[i])
            continue;
        choices[i] = (fp3_choice_of_node){n->op, {n->a, n->b, n->c}, 1};
        if (!absorb_one(c, i, &choices[i]))
            lengthen(c, i, &choices[i]);
        assert(choices[i].operations && choices[i].op);
    }
}

fp3_status fp3_choices_make(const fp3_part *part, fp3_choice_of_node *choices, fp3_error *error) {
    const size_t count = part->g->count + 1u;
    const chooser c = {.p = part,
                       .g = part->g,
                       .ready = calloc(count, sizeof *c.ready),
                       .due = calloc(count, sizeof *c.due),
                       .is_absorbed = calloc(count, 1),
                       .is_free = calloc(count, 1)};
    uint32_t *taken = calloc(count, sizeof *taken);
    const int is_open = c.ready && c.due && c.is_absorbed && c.is_free && taken;
    if (is_open) {
        count_uses(&c);
        find_free(&c, taken);
        find_ready(&c);
        find_due(&c);
        choose_all(&c, choices);
    }
    free(c.ready);
    free(c.due);
    free(c.is_absorbed);
    free(c.is_free);
    free(taken);
    return is_open ? FP3_OK : fp3_no_memory(error);
}
