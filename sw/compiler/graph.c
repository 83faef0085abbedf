/* graph.c - nodes, each once, and terms with signs. */
#include "graph.h"

#include <isa.h>
#include <stdlib.h>
#include <string.h>

void fp3_graph_open(graph *g, known_table *known) {
    *g = (graph){.known = known, .note = FP3_NONE};
    memset(g->bucket, 0xff, sizeof g->bucket);
}

void fp3_graph_close(graph *g) {
    free(g->nodes);
    g->nodes = NULL;
}

static uint32_t hash(uint32_t op, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t h = op * 0x9e3779b1u;
    h = (h ^ a) * 0x85ebca6bu;
    h = (h ^ b) * 0xc2b2ae35u;
    h = (h ^ c) * 0x27d4eb2fu;
    return (h ^ h >> 15) % GRAPH_BUCKETS;
}

/* x + y and x * y have the bits and flags of y + x and y * x. */
static void order(uint32_t op, uint32_t *a, uint32_t *b) {
    if ((op == FP3_OP_ADD || op == FP3_OP_MUL) && *a > *b) {
        const uint32_t t = *a;
        *a = *b;
        *b = t;
    }
}

static uint32_t find(const graph *g, uint32_t op, uint32_t a, uint32_t b, uint32_t c) {
    order(op, &a, &b);
    for (uint32_t i = g->bucket[hash(op, a, b, c)]; i != FP3_NONE; i = g->nodes[i].next) {
        uint32_t x = g->nodes[i].a, y = g->nodes[i].b;
        order(op, &x, &y);
        if (g->nodes[i].op == op && x == a && y == b && g->nodes[i].c == c)
            return i;
    }
    return FP3_NONE;
}

static uint32_t make(graph *g, uint32_t op, uint32_t a, uint32_t b, uint32_t c) {
    if (g->count == GRAPH_LIMIT) {
        g->is_full = 1;
        return 0;
    }
    if (g->count == g->room) {
        const uint32_t room = g->room ? 2 * g->room : 256;
        graph_node *nodes = realloc(g->nodes, room * sizeof *nodes);
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
        (graph_node){.op = op, .a = a, .b = b, .c = c, .note = g->note, .next = g->bucket[at]};
    g->bucket[at] = g->count;
    return g->count++;
}

static uint32_t leaf(graph *g, uint32_t op, uint32_t index) {
    const uint32_t there = find(g, op, index, FP3_NONE, FP3_NONE);
    return there != FP3_NONE ? there : make(g, op, index, FP3_NONE, FP3_NONE);
}

uint32_t fp3_graph_known(graph *g, uint32_t known) { return leaf(g, NODE_KNOWN, known); }

uint32_t fp3_graph_number(graph *g, double number) {
    return fp3_graph_known(g, fp3_known_number(g->known, number));
}

uint32_t fp3_graph_variable(graph *g, uint32_t index) { return leaf(g, NODE_VARIABLE, index); }

uint32_t fp3_graph_is_known(const graph *g, uint32_t node) {
    return node < g->count && g->nodes[node].op == NODE_KNOWN ? g->nodes[node].a : FP3_NONE;
}

int fp3_graph_is_number(const graph *g, uint32_t node, double number) {
    const uint32_t known = fp3_graph_is_known(g, node);
    return known != FP3_NONE && fp3_known_is(g->known, known, number);
}

static uint32_t fold(graph *g, uint32_t op, uint32_t a, uint32_t b) {
    const uint32_t x = fp3_graph_is_known(g, a), y = fp3_graph_is_known(g, b);
    if (x == FP3_NONE || y == FP3_NONE)
        return FP3_NONE;
    switch (op) {
    case FP3_OP_ADD:
        return fp3_graph_known(g, fp3_known_make(g->known, KNOWN_ADD, x, y));
    case FP3_OP_SUB:
        return fp3_graph_known(g, fp3_known_make(g->known, KNOWN_SUB, x, y));
    case FP3_OP_MUL:
        return fp3_graph_known(g, fp3_known_make(g->known, KNOWN_MUL, x, y));
    default:
        return FP3_NONE;
    }
}

/* known * (x * known) as x * known: other bits. */
static uint32_t fold_product(graph *g, uint32_t a, uint32_t b) {
    const uint32_t x = fp3_graph_is_known(g, a);
    if (x == FP3_NONE)
        return fp3_graph_is_known(g, b) != FP3_NONE ? fold_product(g, b, a) : FP3_NONE;
    if (b >= g->count || g->nodes[b].op != FP3_OP_MUL)
        return FP3_NONE;
    uint32_t inner = g->nodes[b].a, other = g->nodes[b].b;
    if (fp3_graph_is_known(g, inner) == FP3_NONE) {
        inner = g->nodes[b].b;
        other = g->nodes[b].a;
    }
    const uint32_t y = fp3_graph_is_known(g, inner);
    if (y == FP3_NONE)
        return FP3_NONE;
    return fp3_graph_op(g, FP3_OP_MUL, other,
                        fp3_graph_known(g, fp3_known_make(g->known, KNOWN_MUL, x, y)), FP3_NONE);
}

/* What costs nothing: x * 1, x + -0, x - 0. */
static uint32_t drop_unit(const graph *g, uint32_t op, uint32_t a, uint32_t b) {
    if (op == FP3_OP_MUL && fp3_graph_is_number(g, a, 1.0))
        return b;
    if (op == FP3_OP_MUL && fp3_graph_is_number(g, b, 1.0))
        return a;
    if (op == FP3_OP_ADD && fp3_graph_is_number(g, a, -0.0))
        return b;
    if (op == FP3_OP_ADD && fp3_graph_is_number(g, b, -0.0))
        return a;
    if (op == FP3_OP_SUB && fp3_graph_is_number(g, b, 0.0))
        return a;
    return FP3_NONE;
}

uint32_t fp3_graph_op(graph *g, uint32_t op, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t easier = fold(g, op, a, b);
    if (easier == FP3_NONE && g->drops_units)
        easier = drop_unit(g, op, a, b);
    if (easier == FP3_NONE && g->folds_products && op == FP3_OP_MUL)
        easier = fold_product(g, a, b);
    if (easier == FP3_NONE && g->is_shared)
        easier = find(g, op, a, b, c);
    return easier != FP3_NONE ? easier : make(g, op, a, b, c);
}

uint32_t fp3_graph_look(const graph *g, uint32_t op, uint32_t a, uint32_t b, uint32_t c) {
    return find(g, op, a, b, c);
}

/* ---- terms ---- */

term fp3_term(uint32_t node) { return (term){.node = node}; }

term fp3_term_negated(term t) {
    t.is_negative = !t.is_negative;
    return t;
}

uint32_t fp3_term_value(graph *g, term t) {
    if (!t.is_negative)
        return t.node;
    const uint32_t known = fp3_graph_is_known(g, t.node);
    if (known != FP3_NONE)
        return fp3_graph_known(g, fp3_known_make(g->known, KNOWN_NEGATE, known, 0));
    /* -(k x) is (-k) x. */
    const graph_node n = t.node < g->count ? g->nodes[t.node] : (graph_node){0};
    for (int i = 0; n.op == FP3_OP_MUL && i < 2; i++) {
        const uint32_t factor = fp3_graph_is_known(g, i ? n.b : n.a);
        if (factor != FP3_NONE)
            return fp3_graph_op(
                g, FP3_OP_MUL,
                fp3_graph_known(g, fp3_known_make(g->known, KNOWN_NEGATE, factor, 0)),
                i ? n.a : n.b, FP3_NONE);
    }
    /* -0 - x is -x for every x. */
    return fp3_graph_op(g, FP3_OP_SUB, fp3_graph_number(g, -0.0), t.node, FP3_NONE);
}

term fp3_term_add(graph *g, term a, term b) {
    if (b.is_negative)
        return fp3_term_sub(g, a, fp3_term_negated(b));
    if (a.is_negative)
        return fp3_term_sub(g, b, fp3_term_negated(a));
    return fp3_term(fp3_graph_op(g, FP3_OP_ADD, a.node, b.node, FP3_NONE));
}

term fp3_term_sub(graph *g, term a, term b) {
    /* -(a + b) would have another zero: its sign is paid for at a. */
    const uint32_t x = fp3_term_value(g, a);
    return fp3_term(fp3_graph_op(g, b.is_negative ? FP3_OP_ADD : FP3_OP_SUB, x, b.node, FP3_NONE));
}

term fp3_term_mul(graph *g, term a, term b) {
    const uint32_t product = fp3_graph_op(g, FP3_OP_MUL, a.node, b.node, FP3_NONE);
    return (term){product, a.is_negative != b.is_negative};
}
