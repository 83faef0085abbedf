/* SPDX-License-Identifier: Apache-2.0 */
/* interval.c - dependences around the loop, and the longest way through them. */
#include "interval.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

struct fp3_interval {
    const fp3_block *block;
    fp3_dependences graph; /* node block->count is the beginning of the step part */
    uint32_t nodes;
    int32_t
        *height;    /* cycles to the end of all that depends on a node, whole intervals taken off */
    uint32_t *next; /* the node after it on its longest way so far, or FP3_NONE_INDEX */
    uint32_t *visited; /* by which walk along `next` */
};

/* ---- what has to hold beside the dependences of a step ---- */

/* A reader issues before its operand is computed again, and all nodes of a step issue within an
 * interval on either side of the beginning. */
static uint32_t list_extra(const fp3_block *block, fp3_edge *extra) {
    const uint32_t begin = block->count;
    uint32_t count = 0;
    for (uint32_t i = 0; i < block->count; i++) {
        const fp3_node *node = &block->nodes[i];
        for (uint32_t k = 0; k < 3; k++) {
            const fp3_ref ref = fp3_node_operand(node, k);
            if (ref.at == FP3_AT_OP)
                extra[count++] = (fp3_edge){i, ref.index, 1, 1, 1};
        }
        extra[count++] = (fp3_edge){i, begin, 1, 1, 1};
        extra[count++] = (fp3_edge){begin, i, 0, 1, 1};
        if (node->writes != FP3_NONE_INDEX || !block->code->allow_ahead)
            extra[count++] = (fp3_edge){begin, i, 0, 0, 1};
    }
    return count;
}

fp3_status fp3_interval_make(const fp3_block *block, fp3_interval **found, fp3_error *error) {
    fp3_interval *m = *found = calloc(1, sizeof *m);
    fp3_edge *extra = calloc(6 * (size_t)block->count + 1, sizeof *extra);
    fp3_status status = FP3_E_SYSTEM;
    if (m && extra) {
        m->block = block;
        m->nodes = block->count + 1;
        m->height = calloc(m->nodes, sizeof *m->height);
        m->next = calloc(m->nodes, sizeof *m->next);
        m->visited = calloc(m->nodes, sizeof *m->visited);
        if (m->height && m->next && m->visited)
            status =
                fp3_dependences_make(block, extra, list_extra(block, extra), 1, &m->graph, error);
    }
    free(extra);
    if (!status)
        return FP3_OK;
    fp3_interval_free(found);
    return fp3_no_memory(error);
}

void fp3_interval_free(fp3_interval **found) {
    if (!*found)
        return;
    fp3_dependences_free(&(*found)->graph);
    free((*found)->height);
    free((*found)->next);
    free((*found)->visited);
    free(*found);
    *found = NULL;
}

/* ---- urgency ---- */

static int32_t span_of(const fp3_edge *e, uint32_t interval) {
    return (int32_t)e->weight - (int32_t)(e->distance * interval);
}

/* A way that comes back to a node has become longer on the way around, and will without end. */
static int comes_back(const fp3_interval *m) {
    memset(m->visited, 0, m->nodes * sizeof *m->visited);
    for (uint32_t i = 0; i < m->nodes; i++) {
        uint32_t at = i;
        for (; at != FP3_NONE_INDEX && !m->visited[at]; at = m->next[at])
            m->visited[at] = i + 1;
        if (at != FP3_NONE_INDEX && m->visited[at] == i + 1)
            return 1;
    }
    return 0;
}

/* 0: the dependences need a longer interval. */
static int find_heights(const fp3_interval *m, uint32_t interval) {
    memset(m->height, 0, m->nodes * sizeof *m->height);
    memset(m->next, 0xff, m->nodes * sizeof *m->next);
    for (int is_news = 1; is_news;) {
        is_news = 0;
        for (uint32_t e = m->graph.edge_count; e-- > 0;) {
            const fp3_edge *edge = &m->graph.edges[e];
            const int32_t height = m->height[edge->to] + span_of(edge, interval);
            if (height > m->height[edge->from]) {
                m->height[edge->from] = height;
                m->next[edge->from] = edge->to;
                is_news = 1;
            }
        }
        if (is_news && comes_back(m))
            return 0;
    }
    return 1;
}

uint32_t fp3_interval_least_from(const fp3_interval *found, uint32_t least, uint32_t most) {
    uint32_t low = least, high = least;
    assert(least > 0);
    while (!find_heights(found, high)) {
        low = high + 1;
        high += high / 2 + 1;
        if (high > most)
            return 0;
    }
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (find_heights(found, middle))
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

fp3_status fp3_interval_least(const fp3_block *block, uint32_t *interval, fp3_error *error) {
    const uint32_t least = block->config->writeback_stall ? 2 * block->count : block->count;
    fp3_interval *found;
    fp3_status status = fp3_interval_make(block, &found, error);
    if (status)
        return status;
    *interval = fp3_interval_least_from(found, least + !least, 64 * (least + 64));
    fp3_interval_free(&found);
    return FP3_OK;
}

const fp3_dependences *fp3_interval_dependences(const fp3_interval *found) { return &found->graph; }

const int32_t *fp3_interval_heights(const fp3_interval *found, uint32_t interval) {
    find_heights(found, interval);
    return found->height;
}
