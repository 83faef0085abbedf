/* SPDX-License-Identifier: Apache-2.0 */
/* dependences.c - the edges between the nodes of a block, found from both ends. */
#include "dependences.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    fp3_edge *edges;
    uint32_t count, room;
} edge_list;

static int add_edge(edge_list *list, fp3_edge edge) {
    if (list->count == list->room) {
        const uint32_t room = list->room ? 2 * list->room : 256;
        fp3_edge *edges = realloc(list->edges, room * sizeof *edges);
        if (!edges)
            return 0;
        list->edges = edges;
        list->room = room;
    }
    list->edges[list->count++] = edge;
    return 1;
}

/* What node i waits for because of one operand, and who waits for node i to have read it. */
static int add_edges_of(const fp3_block *block, uint32_t i, fp3_ref operand, edge_list *list) {
    if (operand.at == FP3_AT_OP)
        return add_edge(list,
                        (fp3_edge){operand.index, i, block->nodes[operand.index].delay, 0, 0});
    const uint32_t writer =
        operand.at == FP3_AT_VARIABLE ? block->writer[operand.index] : FP3_NONE_INDEX;
    if (writer == FP3_NONE_INDEX)
        return 1;
    if (writer != i && !add_edge(list, (fp3_edge){i, writer, 1, 0, 1}))
        return 0;
    return !block->is_cyclic ||
           add_edge(list, (fp3_edge){writer, i, block->nodes[writer].delay, 1, 0});
}

static uint32_t *by_node(const fp3_edge *edges, uint32_t edge_count, uint32_t node_count,
                         int is_out, uint32_t *begin) {
    uint32_t *list = malloc((edge_count + 1) * sizeof *list);
    if (!list)
        return NULL;
    memset(begin, 0, (node_count + 2) * sizeof *begin);
    for (uint32_t e = 0; e < edge_count; e++)
        begin[(is_out ? edges[e].from : edges[e].to) + 2]++;
    for (uint32_t i = 0; i < node_count; i++)
        begin[i + 2] += begin[i + 1];
    for (uint32_t e = 0; e < edge_count; e++)
        list[begin[(is_out ? edges[e].from : edges[e].to) + 1]++] = e;
    return list;
}

fp3_status fp3_dependences_make(const fp3_block *block, const fp3_edge *extra, uint32_t extra_count,
                                uint32_t extra_nodes, fp3_dependences *graph, fp3_error *error) {
    edge_list list = {0};
    int is_done = 1;
    *graph = (fp3_dependences){.node_count = block->count + extra_nodes};
    for (uint32_t i = 0; is_done && i < block->count; i++)
        for (uint32_t k = 0; is_done && k < 3; k++)
            is_done = add_edges_of(block, i, fp3_node_operand(&block->nodes[i], k), &list);
    for (uint32_t e = 0; is_done && e < extra_count; e++)
        is_done = add_edge(&list, extra[e]);
    graph->edges = list.edges;
    graph->edge_count = list.count;
    graph->out_begin = malloc((graph->node_count + 2) * sizeof *graph->out_begin);
    graph->in_begin = malloc((graph->node_count + 2) * sizeof *graph->in_begin);
    if (is_done && graph->out_begin && graph->in_begin) {
        graph->out = by_node(list.edges, list.count, graph->node_count, 1, graph->out_begin);
        graph->in = by_node(list.edges, list.count, graph->node_count, 0, graph->in_begin);
    }
    if (graph->out && graph->in)
        return FP3_OK;
    fp3_dependences_free(graph);
    return fp3_no_memory(error);
}

void fp3_dependences_free(fp3_dependences *graph) {
    free(graph->edges);
    free(graph->out_begin);
    free(graph->out);
    free(graph->in_begin);
    free(graph->in);
    *graph = (fp3_dependences){0};
}
