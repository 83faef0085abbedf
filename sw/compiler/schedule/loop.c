/* SPDX-License-Identifier: Apache-2.0 */
/* loop.c - list scheduling of a loop, with the write port. */
#include "loop.h"

#include "room.h"

#include <stdlib.h>
#include <string.h>

/* How many times the list scheduler repeats the step. Each time it knows better which results the
 * previous step leaves in flight. */
#define ROUNDS 2

/* Cycles that a node may wait for another one's sake. */
#define POLITE 3

typedef struct {
    const fp3_block *block;
    const fp3_loop *loop;
    uint32_t *waits; /* of each node, for how many others of this execution of the step part */
    int64_t *soonest, *issued_at;
    /* Remaining readers of a node's value: of the value at the beginning, and of the value of this
     * step. */
    uint32_t *old_readers, *new_readers;
    uint32_t *ready, ready_count;
    uint32_t shortest; /* latency */
    int64_t now;
    uint64_t writes; /* bit k: a result is written in cycle now + k */
    uint32_t live;
    fp3_room *room; /* NULL: no plan */
} list;

/* An execution of the step part has steps of its own, and the next one's ahead. */
static int distance_of(const list *l, const fp3_edge *e) {
    return (int)e->distance - l->loop->is_ahead[e->to] + l->loop->is_ahead[e->from];
}

static int is_node_edge(const list *l, const fp3_edge *e) {
    return e->from < l->block->count && e->to < l->block->count;
}

static int is_temporary(const list *l, uint32_t node) {
    return l->block->nodes[node].fixed == FP3_NONE_INDEX;
}

/* Which of the two values of an operand's node this reader means. */
static uint32_t *readers_of(const list *l, uint32_t reader, uint32_t value) {
    return l->loop->is_ahead[value] && !l->loop->is_ahead[reader] ? &l->old_readers[value]
                                                                  : &l->new_readers[value];
}

static void add_ready(list *l, uint32_t node) { l->ready[l->ready_count++] = node; }

/* ---- before a round ---- */

static void count_readers(list *l) {
    memset(l->old_readers, 0, l->block->count * sizeof *l->old_readers);
    memset(l->new_readers, 0, l->block->count * sizeof *l->new_readers);
    l->live = 0;
    for (uint32_t i = 0; i < l->block->count; i++)
        for (uint32_t k = 0; k < 3; k++) {
            const fp3_ref ref = fp3_node_operand(&l->block->nodes[i], k);
            if (ref.at == FP3_AT_OP)
                ++*readers_of(l, i, ref.index);
        }
    for (uint32_t i = 0; i < l->block->count; i++)
        l->live += l->old_readers[i] && is_temporary(l, i);
}

/* What the round before has issued is so many cycles old. */
static void begin_round(list *l) {
    const fp3_dependences *graph = l->loop->graph;
    count_readers(l);
    l->ready_count = 0;
    for (uint32_t i = 0; i < l->block->count; i++) {
        l->issued_at[i] -= l->now;
        l->waits[i] = 0;
        l->soonest[i] = 0;
    }
    l->now = 0;
    for (uint32_t k = 0; k < graph->edge_count; k++) {
        const fp3_edge *e = &graph->edges[k];
        if (!is_node_edge(l, e))
            continue;
        const int64_t there = l->issued_at[e->from] + e->weight;
        if (!distance_of(l, e))
            l->waits[e->to]++;
        else if (distance_of(l, e) == 1 && there > l->soonest[e->to])
            l->soonest[e->to] = there;
    }
    for (uint32_t i = 0; i < l->block->count; i++)
        if (!l->waits[i])
            add_ready(l, i);
}

/* ---- how good a choice is ---- */

static int64_t cycle_of(const list *l, uint32_t node) {
    const uint32_t written = l->block->nodes[node].latency + 1;
    int64_t cycle = l->soonest[node] > l->now ? l->soonest[node] : l->now;
    const int is_stalled = l->block->config->writeback_stall != 0;
    for (;; cycle++) {
        const int64_t waits = cycle - l->now;
        const uint64_t writes = waits < 64 ? l->writes >> waits : 0;
        if (!(writes >> written & 1) && !(is_stalled && writes & 1))
            return cycle;
    }
}

static int releases(const list *l, uint32_t node) {
    int released = is_temporary(l, node) && (l->new_readers[node] || l->old_readers[node]) ? -1 : 0;
    for (uint32_t k = 0; k < 3; k++) {
        const fp3_ref ref = fp3_node_operand(&l->block->nodes[node], k);
        if (ref.at == FP3_AT_OP && is_temporary(l, ref.index) &&
            *readers_of(l, node, ref.index) == 1)
            released++;
    }
    return released;
}

static int64_t urgency_of(const list *l, uint32_t node, int64_t cycle) {
    const fp3_node *n = &l->block->nodes[node];
    int64_t urgency = l->loop->urgency[node];
    if (l->loop->is_ahead[node])
        urgency -= l->loop->interval;
    /* The cycle in which a shorter one would be written with this one. */
    const int64_t other = cycle - l->now + n->latency + 1;
    if (n->latency > l->shortest && other < 64 && !(l->writes >> other & 1))
        urgency -= l->loop->loss;
    return urgency;
}

/* wanted[k]: how urgent whoever is that wants to write in cycle now + k. */
static void find_wanted(const list *l, int64_t *wanted) {
    for (int k = 0; k < 64; k++)
        wanted[k] = INT64_MIN / 2;
    for (uint32_t k = 0; k < l->ready_count; k++) {
        const uint32_t node = l->ready[k];
        const int64_t cycle = cycle_of(l, node), urgency = urgency_of(l, node, cycle);
        const int64_t written = cycle - l->now + l->block->nodes[node].latency + 1;
        if (written < 64 && wanted[written] < urgency)
            wanted[written] = urgency;
    }
}

/* A cycle that a node had better leave to another one is as if it were some cycles later. */
static int64_t polite(const list *l, uint32_t node, int64_t cycle, int64_t urgency,
                      const int64_t *wanted) {
    const int64_t written = cycle - l->now + l->block->nodes[node].latency + 1;
    return written < 64 && wanted[written] >= urgency + l->loop->guard ? cycle + POLITE : cycle;
}

static uint32_t take_at(list *l, uint32_t at) {
    const uint32_t node = l->ready[at];
    l->ready[at] = l->ready[--l->ready_count];
    return node;
}

/* The first of all that can issue without keeping the rest of the plan from its registers. */
static uint32_t take_planned(list *l) {
    int64_t best = INT64_MAX;
    uint32_t at = 0;
    for (uint32_t k = 0; k < l->ready_count; k++) {
        const uint32_t node = l->ready[k];
        const int64_t cycle = cycle_of(l, node);
        const int is_sooner =
            cycle < best ||
            (cycle == best && fp3_room_turn(l->room, node) < fp3_room_turn(l->room, l->ready[at]));
        if (is_sooner && fp3_room_allows(l->room, node)) {
            best = cycle;
            at = k;
        }
    }
    fp3_room_issue(l->room, l->ready[at]);
    return take_at(l, at);
}

static uint32_t take_best(list *l) {
    const int is_full = l->live >= l->loop->limit, is_guarded = l->loop->guard != FP3_NO_GUARD;
    int64_t wanted[64], best_first = INT64_MIN, best_second = INT64_MIN;
    uint32_t at = 0;
    if (is_guarded)
        find_wanted(l, wanted);
    for (uint32_t k = 0; k < l->ready_count; k++) {
        const uint32_t node = l->ready[k];
        const int64_t cycle = cycle_of(l, node), second = urgency_of(l, node, cycle);
        const int64_t first = is_full      ? releases(l, node)
                              : is_guarded ? -polite(l, node, cycle, second, wanted)
                                           : -cycle;
        if (first > best_first ||
            (first == best_first &&
             (second > best_second || (second == best_second && node < l->ready[at])))) {
            best_first = first;
            best_second = second;
            at = k;
        }
    }
    return take_at(l, at);
}

/* ---- a round ---- */

static void issue(list *l, uint32_t node) {
    const fp3_dependences *graph = l->loop->graph;
    const int64_t cycle = cycle_of(l, node), waits = cycle - l->now;
    l->live = (uint32_t)((int)l->live - releases(l, node));
    l->writes = waits < 64 ? l->writes >> waits : 0;
    l->writes = (l->writes | UINT64_C(1) << (l->block->nodes[node].latency + 1)) >> 1;
    l->issued_at[node] = cycle;
    l->now = cycle + 1;
    for (uint32_t k = 0; k < 3; k++) {
        const fp3_ref ref = fp3_node_operand(&l->block->nodes[node], k);
        if (ref.at == FP3_AT_OP)
            --*readers_of(l, node, ref.index);
    }
    for (uint32_t k = graph->out_begin[node]; k < graph->out_begin[node + 1]; k++) {
        const fp3_edge *e = &graph->edges[graph->out[k]];
        if (!is_node_edge(l, e) || distance_of(l, e))
            continue;
        if (cycle + e->weight > l->soonest[e->to])
            l->soonest[e->to] = cycle + e->weight;
        if (--l->waits[e->to] == 0)
            add_ready(l, e->to);
    }
}

static int make_round(list *l, uint32_t *order) {
    begin_round(l);
    if (l->room)
        fp3_room_begin(l->room, l->loop->plan);
    for (uint32_t p = 0; p < l->block->count; p++) {
        if (!l->ready_count)
            return 0;
        order[p] = l->room ? take_planned(l) : take_best(l);
        issue(l, order[p]);
    }
    return 1;
}

fp3_status fp3_loop_order(const fp3_block *block, const fp3_loop *loop, uint32_t *order,
                          fp3_error *error) {
    const size_t n = block->count + 1;
    list l = {.block = block, .loop = loop, .shortest = UINT32_MAX};
    fp3_status status = FP3_OK;
    l.waits = calloc(4 * n, sizeof *l.waits);
    l.soonest = calloc(2 * n, sizeof *l.soonest);
    if (loop->plan)
        l.room = fp3_room_make(block, loop->is_ahead, loop->limit);
    if (l.waits && l.soonest && (l.room || !loop->plan)) {
        l.old_readers = l.waits + n;
        l.new_readers = l.old_readers + n;
        l.ready = l.new_readers + n;
        l.issued_at = l.soonest + n;
        for (uint32_t i = 0; i < block->count; i++) {
            if (block->nodes[i].latency < l.shortest)
                l.shortest = block->nodes[i].latency;
            l.issued_at[i] = INT32_MIN;
        }
        for (int round = 0; !status && round < ROUNDS; round++)
            if (!make_round(&l, order))
                status = fp3_fail(error, FP3_E_ARGUMENT, "operations that wait for each other");
    } else {
        status = fp3_no_memory(error);
    }
    fp3_room_free(&l.room);
    free(l.waits);
    free(l.soonest);
    return status;
}
