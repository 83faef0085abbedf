/* SPDX-License-Identifier: Apache-2.0 */
/* copies.c - which old values need a copy. */
#include "copies.h"

#include "dependences.h"

#include <stdlib.h>
#include <string.h>

/* ---- old values ---- */

/* Marks what depends on node `from` within the block. Operands need not come first. */
static void mark_users(const fp3_block *block, uint32_t from, char *marked) {
    memset(marked, 0, block->count);
    marked[from] = 1;
    for (int is_news = 1; is_news;) {
        is_news = 0;
        for (uint32_t i = 0; i < block->count; i++)
            for (uint32_t k = 0; k < 3 && !marked[i]; k++) {
                const fp3_ref ref = fp3_node_operand(&block->nodes[i], k);
                if (ref.at == FP3_AT_OP && marked[ref.index])
                    marked[i] = (char)(is_news = 1);
            }
    }
}

static void read_copy(fp3_node *node, uint32_t variable, uint32_t copy) {
    for (uint32_t k = 0; k < 3; k++) {
        fp3_ref *ref = fp3_node_operand_at(node, k);
        if (ref->at == FP3_AT_VARIABLE && ref->index == variable)
            *ref = (fp3_ref){FP3_AT_OP, copy};
    }
}

/* Node `reader` reads a copy of the old variable; copies[variable] is that, once there is one. */
static fp3_status make_late(fp3_block *block, uint32_t reader, uint32_t variable, uint32_t *copies,
                            fp3_error *error) {
    if (copies[variable] == FP3_NONE_INDEX)
        copies[variable] = fp3_block_add_copy(block, (fp3_ref){FP3_AT_VARIABLE, variable});
    if (copies[variable] == FP3_NONE_INDEX)
        return fp3_no_memory(error);
    read_copy(&block->nodes[reader], variable, copies[variable]);
    return FP3_OK;
}

/* Who reads the old value of what it depends on must read a copy. */
static fp3_status copy_for_users(fp3_block *block, uint32_t *copies, fp3_error *error) {
    fp3_status status = FP3_OK;
    char *marked = malloc(block->count + block->code->variable_count + 1);
    if (!marked)
        return fp3_no_memory(error);
    for (uint32_t x = 0; !status && x < block->code->variable_count; x++) {
        const uint32_t writer = block->writer[x], count = block->count;
        if (writer == FP3_NONE_INDEX)
            continue;
        mark_users(block, writer, marked);
        for (uint32_t i = 0; !status && i < count; i++)
            if (i != writer && marked[i] && fp3_node_reads_variable(&block->nodes[i], x))
                status = make_late(block, i, x, copies, error);
    }
    free(marked);
    return status;
}

/* ---- circles ---- */

/* waits[i]: of how many nodes of this step node i has to come behind that cannot be ordered
 * themselves. */
static void count_waits(const fp3_dependences *graph, uint32_t *waits, uint32_t *queue) {
    uint32_t head = 0, tail = 0;
    memset(waits, 0, graph->node_count * sizeof *waits);
    for (uint32_t e = 0; e < graph->edge_count; e++)
        if (!graph->edges[e].distance)
            waits[graph->edges[e].to]++;
    for (uint32_t i = 0; i < graph->node_count; i++)
        if (!waits[i])
            queue[tail++] = i;
    while (head < tail) {
        const uint32_t i = queue[head++];
        for (uint32_t k = graph->out_begin[i]; k < graph->out_begin[i + 1]; k++) {
            const fp3_edge *e = &graph->edges[graph->out[k]];
            if (!e->distance && --waits[e->to] == 0)
                queue[tail++] = e->to;
        }
    }
}

/* The edge by which a node that waits waits for another one that does. */
static const fp3_edge *held_by(const fp3_dependences *graph, const uint32_t *waits, uint32_t node) {
    for (uint32_t k = graph->in_begin[node]; k < graph->in_begin[node + 1]; k++) {
        const fp3_edge *e = &graph->edges[graph->in[k]];
        if (!e->distance && waits[e->from])
            return e;
    }
    return NULL;
}

/* An edge of a circle that a copy can cut, preferably of a variable that has a copy already; NULL:
 * no circle. */
static const fp3_edge *find_cut(const fp3_block *block, const fp3_dependences *graph,
                                const uint32_t *waits, const uint32_t *copies) {
    uint32_t node = 0;
    while (node < graph->node_count && !waits[node])
        node++;
    if (node == graph->node_count)
        return NULL;
    /* Backwards so often that it must be in a circle, and then once around. */
    for (uint32_t i = 0; i < graph->node_count; i++)
        node = held_by(graph, waits, node)->from;
    const fp3_edge *found = NULL;
    const uint32_t begin = node;
    do {
        const fp3_edge *e = held_by(graph, waits, node);
        if (e->is_anti && (!found || copies[block->nodes[e->to].writes] != FP3_NONE_INDEX))
            found = e;
        node = e->from;
    } while (node != begin);
    return found;
}

static fp3_status cut_circles(fp3_block *block, uint32_t *copies, fp3_error *error) {
    for (;;) {
        fp3_dependences graph;
        fp3_status status = fp3_dependences_make(block, NULL, 0, 0, &graph, error);
        if (status)
            return status;
        uint32_t *waits = malloc((2 * (size_t)block->count + 1) * sizeof *waits);
        const fp3_edge *cut = NULL;
        if (waits) {
            count_waits(&graph, waits, waits + block->count);
            cut = find_cut(block, &graph, waits, copies);
        }
        if (!waits)
            status = fp3_no_memory(error);
        else if (cut)
            status = make_late(block, cut->from, block->nodes[cut->to].writes, copies, error);
        const int is_over = status || !cut;
        free(waits);
        fp3_dependences_free(&graph);
        if (is_over)
            return status;
    }
}

fp3_status fp3_copies_add(fp3_block *block, fp3_error *error) {
    const uint32_t count = block->code->variable_count;
    uint32_t *copies = malloc((count + 1) * sizeof *copies);
    if (!copies)
        return fp3_no_memory(error);
    for (uint32_t x = 0; x < count; x++)
        copies[x] = FP3_NONE_INDEX;
    fp3_status status = copy_for_users(block, copies, error);
    if (!status)
        status = cut_circles(block, copies, error);
    free(copies);
    return status;
}

/* ---- copies by which steps overlap more ---- */

static int is_copy_of(const fp3_node *node, uint32_t variable) {
    return node->from == FP3_NONE_INDEX && node->writes == FP3_NONE_INDEX &&
           fp3_node_reads_variable(node, variable);
}

/* late[i]: node i reads the variable, and depends on another reader of it. */
static void mark_late(const fp3_block *block, uint32_t variable, char *late, char *marked) {
    memset(late, 0, block->count);
    for (uint32_t r = 0; r < block->count; r++) {
        if (!fp3_node_reads_variable(&block->nodes[r], variable) ||
            is_copy_of(&block->nodes[r], variable))
            continue;
        mark_users(block, r, marked);
        for (uint32_t i = 0; i < block->count; i++)
            if (i != r && marked[i] && fp3_node_reads_variable(&block->nodes[i], variable))
                late[i] = 1;
    }
}

fp3_status fp3_copies_split(fp3_block *block, uint32_t variable, int *is_changed,
                            fp3_error *error) {
    const uint32_t count = block->count, variables = block->code->variable_count;
    uint32_t *copies = malloc((variables + 1) * sizeof *copies);
    char *late = malloc(2 * (size_t)count + 1);
    fp3_status status = copies && late ? FP3_OK : fp3_no_memory(error);
    *is_changed = 0;
    if (!status) {
        mark_late(block, variable, late, late + count);
        copies[variable] = FP3_NONE_INDEX;
        for (uint32_t i = 0; i < count; i++)
            if (is_copy_of(&block->nodes[i], variable))
                copies[variable] = i;
    }
    for (uint32_t i = 0; !status && i < count; i++)
        if (late[i] && i != block->writer[variable]) {
            status = make_late(block, i, variable, copies, error);
            *is_changed = 1;
        }
    free(copies);
    free(late);
    return status;
}
