/* SPDX-License-Identifier: Apache-2.0 */
/* polish.c - see polish.h. */
#include "polish.h"

#include "allocate.h"
#include "timing.h"

#include <stdlib.h>
#include <string.h>

/* How far an instruction moves at most. */
#define FAR 24u

typedef struct {
    const fp3_block *block;
    const fp3_dependences *graph;
    uint32_t *order, *position;
    uint64_t state; /* of the random numbers */
} work;

/* An LCG, Knuth's constants; its upper half. */
static uint32_t below(work *w, uint32_t bound) {
    w->state = w->state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)((w->state >> 32) * bound >> 32);
}

static int is_of_one_step(const work *w, const fp3_edge *e) {
    const fp3_node *nodes = w->block->nodes;
    return e->from < w->block->count && e->to < w->block->count &&
           (int)e->distance - nodes[e->to].is_ahead + nodes[e->from].is_ahead == 0;
}

/* Where a node may stand, the others in their order. */
static void find_range(const work *w, uint32_t node, uint32_t *low, uint32_t *high) {
    const fp3_dependences *g = w->graph;
    const uint32_t now = w->position[node];
    *low = now > FAR ? now - FAR : 0;
    *high = now + FAR < w->block->count ? now + FAR : w->block->count - 1;
    for (uint32_t k = g->in_begin[node]; k < g->in_begin[node + 1]; k++) {
        const fp3_edge *e = &g->edges[g->in[k]];
        if (is_of_one_step(w, e) && w->position[e->from] + 1 > *low)
            *low = w->position[e->from] + 1;
    }
    for (uint32_t k = g->out_begin[node]; k < g->out_begin[node + 1]; k++) {
        const fp3_edge *e = &g->edges[g->out[k]];
        if (is_of_one_step(w, e) && w->position[e->to] < *high + 1)
            *high = w->position[e->to] - 1;
    }
}

static void move(work *w, uint32_t from, uint32_t to) {
    const uint32_t node = w->order[from];
    for (; from < to; from++)
        w->order[from] = w->order[from + 1];
    for (; from > to; from--)
        w->order[from] = w->order[from - 1];
    w->order[to] = node;
    for (uint32_t p = 0; p < w->block->count; p++)
        w->position[w->order[p]] = p;
}

static fp3_status try_moves(work *w, double enough, uint32_t moves, fp3_error *error) {
    double cycles = 0, now;
    fp3_status status = fp3_time_order(w->block, w->order, &now, error);
    for (uint32_t i = 0; !status && i < moves && now > enough; i++) {
        const uint32_t from = below(w, w->block->count);
        uint32_t low, high;
        find_range(w, w->order[from], &low, &high);
        const uint32_t to = low + below(w, high - low + 1);
        if (to == from)
            continue;
        move(w, from, to);
        uint32_t least = 0;
        status = fp3_time_order(w->block, w->order, &cycles, error);
        if (!status && cycles <= now)
            status = fp3_allocate_least(w->block, w->order, &least, error);
        if (cycles > now || least > w->block->config->registers)
            move(w, to, from);
        else
            now = cycles;
    }
    return status;
}

fp3_status fp3_polish(const fp3_block *block, const fp3_dependences *graph, double enough,
                      uint32_t moves, uint32_t *order, fp3_error *error) {
    work w = {.block = block, .graph = graph, .order = order, .state = 1};
    w.position = malloc((block->count + 1) * sizeof *w.position);
    if (!w.position)
        return fp3_no_memory(error);
    for (uint32_t p = 0; p < block->count; p++)
        w.position[order[p]] = p;
    const fp3_status status = block->count ? try_moves(&w, enough, moves, error) : FP3_OK;
    free(w.position);
    return status;
}
