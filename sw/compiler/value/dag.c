/* SPDX-License-Identifier: Apache-2.0 */
/* dag.c - nodes, found again by a hash table. */
#include "dag.h"

#include "machine/operation.h"

#include <assert.h>
#include <fp3/isa.h>
#include <stdlib.h>
#include <string.h>

void fp3_dag_open(dag *g, known_table *known, unsigned passes) {
    *g = (dag){.known = known, .passes = passes, .note = FP3_NONE, .terms = FP3_DAG_TERMS};
    memset(g->bucket, 0xff, sizeof g->bucket);
}

void fp3_dag_close(dag *g) {
    free(g->nodes);
    g->nodes = NULL;
}

static uint32_t hash(uint32_t op, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t h = op * 0x9e3779b1u;
    h = (h ^ a) * 0x85ebca6bu;
    h = (h ^ b) * 0xc2b2ae35u;
    h = (h ^ c) * 0x27d4eb2fu;
    return (h ^ h >> 15) % FP3_DAG_BUCKETS;
}

/* x + y has the bits and flags of y + x. */
static void order(uint32_t op, uint32_t *a, uint32_t *b) {
    const fp3_operation *operation = fp3_operation_find(op);
    if (operation && operation->commutes && *a > *b) {
        const uint32_t t = *a;
        *a = *b;
        *b = t;
    }
}

uint32_t fp3_dag_find(const dag *g, uint32_t op, uint32_t a, uint32_t b, uint32_t c) {
    order(op, &a, &b);
    for (uint32_t i = g->bucket[hash(op, a, b, c)]; i != FP3_NONE; i = g->nodes[i].next) {
        uint32_t x = g->nodes[i].a, y = g->nodes[i].b;
        order(op, &x, &y);
        if (g->nodes[i].op == op && x == a && y == b && g->nodes[i].c == c)
            return i;
    }
    return FP3_NONE;
}

uint32_t fp3_dag_make(dag *g, uint32_t op, uint32_t a, uint32_t b, uint32_t c) {
    assert(op >= NODE_KNOWN || a < g->count || g->has_failed); /* operands come first */
    if (g->count == FP3_DAG_LIMIT) {
        g->is_full = 1;
        return 0;
    }
    if (g->count == g->room) {
        const uint32_t room = g->room ? 2 * g->room : 256;
        dag_node *nodes = realloc(g->nodes, room * sizeof *nodes);
        if (!nodes) {
            g->has_failed = 1;
            return 0;
        }
        g->nodes = nodes;
        g->room = room;
    }
    uint32_t x = a, y = b;
    order(op, &x, &y);
    const uint32_t at = hash(op, x, y, c);
    g->nodes[g->count] =
        (dag_node){.op = op, .a = a, .b = b, .c = c, .note = g->note, .next = g->bucket[at]};
    g->bucket[at] = g->count;
    return g->count++;
}

static uint32_t leaf(dag *g, uint32_t op, uint32_t index) {
    const uint32_t there = fp3_dag_find(g, op, index, FP3_NONE, FP3_NONE);
    return there != FP3_NONE ? there : fp3_dag_make(g, op, index, FP3_NONE, FP3_NONE);
}

uint32_t fp3_dag_known(dag *g, uint32_t known) { return leaf(g, NODE_KNOWN, known); }

uint32_t fp3_dag_number(dag *g, double number) {
    return fp3_dag_known(g, fp3_known_number(g->known, number));
}

uint32_t fp3_dag_first(dag *g, uint32_t node) {
    if (!g->is_abstract)
        return node;
    const uint32_t there = fp3_dag_find(g, NODE_FIRST, node, FP3_NONE, FP3_NONE);
    return there != FP3_NONE ? there : fp3_dag_make(g, NODE_FIRST, node, FP3_NONE, FP3_NONE);
}

uint32_t fp3_dag_variable(dag *g, uint32_t index) { return leaf(g, NODE_VARIABLE, index); }

uint32_t fp3_dag_neighbour(dag *g, uint32_t op, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t there = fp3_dag_find(g, op, a, b, c);
    return there != FP3_NONE ? there : fp3_dag_make(g, op, a, b, c);
}

uint32_t fp3_dag_worst(dag *g, uint32_t node, uint32_t which) {
    return fp3_dag_neighbour(g, NODE_WORST, node, FP3_NONE, which);
}

uint32_t fp3_dag_is_known(const dag *g, uint32_t node) {
    return node < g->count && g->nodes[node].op == NODE_KNOWN ? g->nodes[node].a : FP3_NONE;
}

int fp3_dag_is_number(const dag *g, uint32_t node, double number) {
    const uint32_t known = fp3_dag_is_known(g, node);
    return known != FP3_NONE && fp3_known_is(g->known, known, number);
}
