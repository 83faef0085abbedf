/* SPDX-License-Identifier: Apache-2.0 */
/* order.c - list scheduling: of what may issue, the best by some rule. */
#include "order.h"

#include "machine/cycles.h"
#include "machine/operation.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    const fp3_block *block;
    const fp3_dependences *graph;
    fp3_next next;
    uint32_t *waits;   /* of each node, for how many others */
    uint32_t *readers; /* of its value, still to issue */
    uint32_t *height;  /* cycles from its issue to the end of all that depends on it */
    uint64_t *soonest; /* cycle in which its operands are there */
    uint32_t *issued;  /* position + 1, 0: not yet */
    uint32_t *ready;   /* the nodes that may issue, by their number */
    uint32_t ready_count;
    uint64_t now;
    uint32_t count;
    unsigned units; /* of what was issued last */
} list;

static int is_within(const fp3_edge *e, const fp3_block *block) {
    return !e->distance && e->from < block->count && e->to < block->count;
}

static int is_data(const fp3_edge *e, const fp3_block *block) {
    return is_within(e, block) && !e->is_anti;
}

/* The caller's order respects operands; any node may use added nodes. So the pass repeats as often
 * as needed. */
static void find_heights(list *l) {
    for (int is_news = 1; is_news;) {
        is_news = 0;
        for (uint32_t e = l->graph->edge_count; e-- > 0;) {
            const fp3_edge *edge = &l->graph->edges[e];
            if (!is_within(edge, l->block))
                continue;
            const uint32_t height = l->height[edge->to] + edge->weight;
            if (height > l->height[edge->from]) {
                l->height[edge->from] = height;
                is_news = 1;
            }
        }
    }
}

static void prepare(list *l) {
    for (uint32_t e = 0; e < l->graph->edge_count; e++) {
        const fp3_edge *edge = &l->graph->edges[e];
        l->waits[edge->to] += (uint32_t)is_within(edge, l->block);
        l->readers[edge->from] += (uint32_t)is_data(edge, l->block);
    }
    for (uint32_t i = 0; i < l->block->count; i++)
        l->height[i] = l->block->nodes[i].delay;
    find_heights(l);
}

/* ---- how good a choice is ---- */

static unsigned units_of(const list *l, uint32_t i) {
    return fp3_operation_find(l->block->nodes[i].op.op)->path;
}

/* Values that are no longer waited for after node i, less the one that it makes. */
static int releases(const list *l, uint32_t i) {
    const fp3_node *node = &l->block->nodes[i];
    int released = node->fixed == FP3_NONE_INDEX && l->readers[i] ? -1 : 0;
    for (uint32_t k = 0; k < 3; k++) {
        const fp3_ref ref = fp3_node_operand(node, k);
        uint32_t times = 0, before = 0;
        for (uint32_t j = 0; j < 3; j++) {
            const fp3_ref other = fp3_node_operand(node, j);
            const int is_same = other.at == FP3_AT_OP && other.index == ref.index;
            times += (uint32_t)is_same;
            before += (uint32_t)(is_same && j < k);
        }
        if (ref.at == FP3_AT_OP && !before && l->readers[ref.index] == times &&
            l->block->nodes[ref.index].fixed == FP3_NONE_INDEX)
            released++;
    }
    return released;
}

static uint32_t newest_operand(const list *l, uint32_t i) {
    uint32_t newest = 0;
    for (uint32_t k = 0; k < 3; k++) {
        const fp3_ref ref = fp3_node_operand(&l->block->nodes[i], k);
        if (ref.at == FP3_AT_OP && l->issued[ref.index] > newest)
            newest = l->issued[ref.index];
    }
    return newest;
}

/* Larger is better, main before minor. */
typedef struct {
    int64_t main, minor;
} rank;

static rank rank_of(const list *l, fp3_next next, uint32_t i) {
    const uint64_t soonest = l->soonest[i] > l->now ? l->soonest[i] : l->now;
    rank r = {0, 0};
    if (next == FP3_NEXT_SOON)
        r.main = -(int64_t)soonest;
    else if (next == FP3_NEXT_TURN)
        r.main = !(units_of(l, i) & l->units);
    else if (next != FP3_NEXT_GIVEN)
        r.main = releases(l, i);
    if (next == FP3_NEXT_DEEP)
        r.minor = newest_operand(l, i);
    else if (next == FP3_NEXT_LONG || next == FP3_NEXT_SOON || next == FP3_NEXT_TURN)
        r.minor = l->height[i];
    return r;
}

/* ---- the list ---- */

static void add_ready(list *l, uint32_t i) {
    uint32_t k = l->ready_count++;
    for (; k && l->ready[k - 1] > i; k--)
        l->ready[k] = l->ready[k - 1];
    l->ready[k] = i;
}

static void issue(list *l, uint32_t i) {
    if (l->soonest[i] > l->now)
        l->now = l->soonest[i];
    l->issued[i] = ++l->count;
    l->units = units_of(l, i);
    for (uint32_t k = 0; k < 3; k++) {
        const fp3_ref ref = fp3_node_operand(&l->block->nodes[i], k);
        if (ref.at == FP3_AT_OP)
            l->readers[ref.index]--;
    }
    for (uint32_t k = l->graph->out_begin[i]; k < l->graph->out_begin[i + 1]; k++) {
        const fp3_edge *e = &l->graph->edges[l->graph->out[k]];
        if (!is_within(e, l->block))
            continue;
        if (--l->waits[e->to] == 0)
            add_ready(l, e->to);
        if (l->soonest[e->to] < l->now + e->weight)
            l->soonest[e->to] = l->now + e->weight;
    }
    l->now++;
}

static uint32_t take_best(list *l, fp3_next next) {
    rank best = {INT64_MIN, INT64_MIN};
    uint32_t at = 0;
    for (uint32_t k = 0; k < l->ready_count; k++) {
        const rank r = rank_of(l, next, l->ready[k]);
        if (r.main > best.main || (r.main == best.main && r.minor > best.minor)) {
            best = r;
            at = k;
        }
    }
    const uint32_t node = l->ready[at];
    memmove(&l->ready[at], &l->ready[at + 1], (--l->ready_count - at) * sizeof *l->ready);
    return node;
}

static int make_order(list *l, uint32_t *order) {
    for (uint32_t i = 0; i < l->block->count; i++)
        if (!l->waits[i])
            add_ready(l, i);
    for (uint32_t p = 0; p < l->block->count; p++) {
        if (!l->ready_count)
            return 0;
        order[p] = take_best(l, l->next);
        issue(l, order[p]);
    }
    return 1;
}

fp3_status fp3_order_list(const fp3_block *block, const fp3_dependences *graph, fp3_next next,
                          uint32_t *order, fp3_error *error) {
    const size_t n = graph->node_count + 1;
    list l = {.block = block, .graph = graph, .next = next};
    l.waits = calloc(5 * n, sizeof *l.waits);
    l.soonest = calloc(n, sizeof *l.soonest);
    fp3_status status = FP3_OK;
    if (l.waits && l.soonest) {
        l.readers = l.waits + n;
        l.height = l.readers + n;
        l.issued = l.height + n;
        l.ready = l.issued + n;
        prepare(&l);
        if (!make_order(&l, order))
            status = fp3_fail(error, FP3_E_ARGUMENT, "operations that wait for each other");
    } else {
        status = fp3_no_memory(error);
    }
    free(l.waits);
    free(l.soonest);
    return status;
}
