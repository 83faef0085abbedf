/* schedule_graph.c - operations to nodes: who writes a variable, which old values need a copy. */
#include "schedule_graph.h"

#include "machine/cycles.h"

#include <inttypes.h>
#include <isa.h>
#include <stdlib.h>
#include <string.h>

static fp3_status no_memory(fp3_error *error) {
    return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
}

static fp3_ref *operand_of(fp3_op *op, uint32_t i) {
    return i == 0 ? &op->a : i == 1 ? &op->b : &op->c;
}

fp3_ref fp3_node_operand(const fp3_node *node, uint32_t i) {
    return i == 0 ? node->op.a : i == 1 ? node->op.b : node->op.c;
}

/* ---- nodes ---- */

uint32_t fp3_block_add(fp3_block *block, const fp3_node *node) {
    if (block->count == block->room) {
        const uint32_t room = block->room ? 2 * block->room : 64;
        fp3_node *nodes = realloc(block->nodes, room * sizeof *nodes);
        if (!nodes)
            return FP3_NONE_INDEX;
        block->nodes = nodes;
        block->room = room;
    }
    fp3_node *added = &block->nodes[block->count];
    *added = *node;
    added->latency = fp3_cycles_latency(block->config, node->op.op);
    added->delay = fp3_cycles_delay(block->config, node->op.op);
    return block->count++;
}

/* x + -0.0 is x, for every x that an operation or the host can make, -0.0 included. */
static uint32_t add_copy(fp3_block *block, fp3_ref what) {
    const fp3_step *step = block->step;
    const uint32_t minus_zero =
        step->minus_zero == FP3_NONE_INDEX ? step->constant_count : step->minus_zero;
    block->reads_minus_zero = 1;
    block->copies++;
    return fp3_block_add(block, &(fp3_node){.op = {.op = FP3_OP_ADD,
                                                   .a = what,
                                                   .b = {FP3_AT_CONSTANT, minus_zero},
                                                   .note = FP3_NONE_INDEX},
                                            .writes = FP3_NONE_INDEX,
                                            .fixed = FP3_NONE_INDEX,
                                            .from = FP3_NONE_INDEX});
}

/* Where a reference of the caller is found in a block of its kind. */
static fp3_ref found_at(fp3_ref ref) {
    if (ref.at == FP3_AT_FIRST || ref.at == FP3_AT_LAST)
        ref.at = FP3_AT_OP;
    else if (ref.at == FP3_AT_NEXT)
        ref.at = FP3_AT_VARIABLE;
    return ref;
}

/* op_at: what an operation of this part is called, variable_at: a variable at its beginning. */
static fp3_status check(const fp3_step *step, fp3_ref ref, fp3_place op_at, fp3_place variable_at,
                        uint32_t op_count, fp3_error *error) {
    uint32_t count = 0;
    if (ref.at == FP3_AT_NOWHERE)
        return FP3_OK;
    if (ref.at == op_at)
        count = op_count;
    else if (ref.at == variable_at)
        count = step->variable_count;
    else if (ref.at == FP3_AT_PARAM)
        count = step->param_count;
    else if (ref.at == FP3_AT_CONSTANT)
        count = step->constant_count;
    return ref.index < count
               ? FP3_OK
               : fp3_fail(error, FP3_E_ARGUMENT, "a step refers to place %d, index %" PRIu32,
                          (int)ref.at, ref.index);
}

static fp3_status add_ops(fp3_block *block, const fp3_op *ops, uint32_t count, fp3_place op_at,
                          fp3_place variable_at, fp3_error *error) {
    for (uint32_t i = 0; i < count; i++) {
        fp3_node node = {
            .op = ops[i], .writes = FP3_NONE_INDEX, .fixed = FP3_NONE_INDEX, .from = i};
        for (uint32_t k = 0; k < 3; k++) {
            fp3_ref *ref = operand_of(&node.op, k);
            fp3_status status = check(block->step, *ref, op_at, variable_at, i, error);
            if (status)
                return status;
            *ref = found_at(*ref);
        }
        if (fp3_block_add(block, &node) == FP3_NONE_INDEX)
            return no_memory(error);
    }
    return FP3_OK;
}

/* The variable gets this value: by the node that makes it, if nobody else wants that one's
 * register. */
static fp3_status write_variable(fp3_block *block, uint32_t variable, fp3_ref value,
                                 fp3_error *error) {
    uint32_t writer = value.index;
    if (value.at != FP3_AT_OP || block->nodes[writer].writes != FP3_NONE_INDEX)
        writer = add_copy(block, value);
    if (writer == FP3_NONE_INDEX)
        return no_memory(error);
    block->nodes[writer].writes = block->nodes[writer].fixed = variable;
    block->writer[variable] = writer;
    return FP3_OK;
}

static fp3_status open_block(const fp3_step *step, const fp3_config *config, fp3_block *block,
                             fp3_error *error) {
    *block = (fp3_block){.step = step, .config = config};
    block->writer = malloc((step->variable_count + 1) * sizeof *block->writer);
    if (!block->writer)
        return no_memory(error);
    for (uint32_t x = 0; x < step->variable_count; x++)
        block->writer[x] = FP3_NONE_INDEX;
    return FP3_OK;
}

void fp3_block_free(fp3_block *block) {
    free(block->nodes);
    free(block->writer);
    *block = (fp3_block){0};
}

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

static int reads_old(const fp3_node *node, uint32_t variable) {
    for (uint32_t k = 0; k < 3; k++) {
        const fp3_ref ref = fp3_node_operand(node, k);
        if (ref.at == FP3_AT_VARIABLE && ref.index == variable)
            return 1;
    }
    return 0;
}

static void read_copy(fp3_node *node, uint32_t variable, uint32_t copy) {
    for (uint32_t k = 0; k < 3; k++) {
        fp3_ref *ref = operand_of(&node->op, k);
        if (ref->at == FP3_AT_VARIABLE && ref->index == variable)
            *ref = (fp3_ref){FP3_AT_OP, copy};
    }
}

/* Node `reader` reads a copy of the old variable; copies[variable] is that, once there is one. */
static fp3_status make_late(fp3_block *block, uint32_t reader, uint32_t variable, uint32_t *copies,
                            fp3_error *error) {
    if (copies[variable] == FP3_NONE_INDEX)
        copies[variable] = add_copy(block, (fp3_ref){FP3_AT_VARIABLE, variable});
    if (copies[variable] == FP3_NONE_INDEX)
        return no_memory(error);
    read_copy(&block->nodes[reader], variable, copies[variable]);
    return FP3_OK;
}

/* Who reads the old value of what it depends on must read a copy. */
static fp3_status copy_for_users(fp3_block *block, uint32_t *copies, fp3_error *error) {
    fp3_status status = FP3_OK;
    char *marked = malloc(block->count + block->step->variable_count + 1);
    if (!marked)
        return no_memory(error);
    for (uint32_t x = 0; !status && x < block->step->variable_count; x++) {
        const uint32_t writer = block->writer[x], count = block->count;
        if (writer == FP3_NONE_INDEX)
            continue;
        mark_users(block, writer, marked);
        for (uint32_t i = 0; !status && i < count; i++)
            if (i != writer && marked[i] && reads_old(&block->nodes[i], x))
                status = make_late(block, i, x, copies, error);
    }
    free(marked);
    return status;
}

/* ---- edges ---- */

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

fp3_status fp3_graph_make(const fp3_block *block, const fp3_edge *extra, uint32_t extra_count,
                          uint32_t extra_nodes, fp3_graph *graph, fp3_error *error) {
    edge_list list = {0};
    int is_done = 1;
    *graph = (fp3_graph){.node_count = block->count + extra_nodes};
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
    fp3_graph_free(graph);
    return no_memory(error);
}

void fp3_graph_free(fp3_graph *graph) {
    free(graph->edges);
    free(graph->out_begin);
    free(graph->out);
    free(graph->in_begin);
    free(graph->in);
    *graph = (fp3_graph){0};
}

/* ---- circles ---- */

/* waits[i]: of how many nodes of this step node i has to come behind that cannot be ordered
 * themselves. */
static void count_waits(const fp3_graph *graph, uint32_t *waits, uint32_t *queue) {
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
static const fp3_edge *held_by(const fp3_graph *graph, const uint32_t *waits, uint32_t node) {
    for (uint32_t k = graph->in_begin[node]; k < graph->in_begin[node + 1]; k++) {
        const fp3_edge *e = &graph->edges[graph->in[k]];
        if (!e->distance && waits[e->from])
            return e;
    }
    return NULL;
}

/* An edge of a circle that a copy can cut, best one whose variable has a copy already; NULL: no
 * circle. */
static const fp3_edge *find_cut(const fp3_block *block, const fp3_graph *graph,
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
        fp3_graph graph;
        fp3_status status = fp3_graph_make(block, NULL, 0, 0, &graph, error);
        if (status)
            return status;
        uint32_t *waits = malloc((2 * (size_t)block->count + 1) * sizeof *waits);
        const fp3_edge *cut = NULL;
        if (waits) {
            count_waits(&graph, waits, waits + block->count);
            cut = find_cut(block, &graph, waits, copies);
        }
        if (!waits)
            status = no_memory(error);
        else if (cut)
            status = make_late(block, cut->from, block->nodes[cut->to].writes, copies, error);
        const int is_over = status || !cut;
        free(waits);
        fp3_graph_free(&graph);
        if (is_over)
            return status;
    }
}

static fp3_status copy_old_values(fp3_block *block, fp3_error *error) {
    const uint32_t count = block->step->variable_count;
    uint32_t *copies = malloc((count + 1) * sizeof *copies);
    if (!copies)
        return no_memory(error);
    for (uint32_t x = 0; x < count; x++)
        copies[x] = FP3_NONE_INDEX;
    fp3_status status = copy_for_users(block, copies, error);
    if (!status)
        status = cut_circles(block, copies, error);
    free(copies);
    return status;
}

fp3_status fp3_block_clone(const fp3_block *block, fp3_block *clone, fp3_error *error) {
    fp3_status status = open_block(block->step, block->config, clone, error);
    for (uint32_t i = 0; !status && i < block->count; i++)
        if (fp3_block_add(clone, &block->nodes[i]) == FP3_NONE_INDEX)
            status = no_memory(error);
    for (uint32_t x = 0; !status && x < block->step->variable_count; x++)
        clone->writer[x] = block->writer[x];
    clone->is_first = block->is_first;
    clone->is_cyclic = block->is_cyclic;
    clone->copies = block->copies;
    clone->reads_minus_zero = block->reads_minus_zero;
    return status;
}

static int is_copy_of(const fp3_node *node, uint32_t variable) {
    return node->from == FP3_NONE_INDEX && node->writes == FP3_NONE_INDEX &&
           reads_old(node, variable);
}

/* late[i]: node i reads the variable, and depends on another reader of it. */
static void mark_late(const fp3_block *block, uint32_t variable, char *late, char *marked) {
    memset(late, 0, block->count);
    for (uint32_t r = 0; r < block->count; r++) {
        if (!reads_old(&block->nodes[r], variable) || is_copy_of(&block->nodes[r], variable))
            continue;
        mark_users(block, r, marked);
        for (uint32_t i = 0; i < block->count; i++)
            if (i != r && marked[i] && reads_old(&block->nodes[i], variable))
                late[i] = 1;
    }
}

fp3_status fp3_block_split(fp3_block *block, uint32_t variable, int *is_changed, fp3_error *error) {
    const uint32_t count = block->count, variables = block->step->variable_count;
    uint32_t *copies = malloc((variables + 1) * sizeof *copies);
    char *late = malloc(2 * (size_t)count + 1);
    fp3_status status = copies && late ? FP3_OK : no_memory(error);
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

/* ---- the three parts ---- */

static fp3_status check_states(const fp3_block *block, fp3_error *error) {
    for (uint32_t x = 0; x < block->step->variable_count; x++)
        for (uint32_t i = 0; block->writer[x] != FP3_NONE_INDEX && i < block->count; i++)
            if (reads_old(&block->nodes[i], x))
                return fp3_fail(error, FP3_E_ARGUMENT,
                                "the first part reads variable %" PRIu32 ", which it makes", x);
    return FP3_OK;
}

fp3_status fp3_block_first(const fp3_step *step, const fp3_config *config, fp3_block *block,
                           fp3_error *error) {
    fp3_status status = open_block(step, config, block, error);
    block->is_first = 1;
    if (!status)
        status =
            add_ops(block, step->first, step->first_count, FP3_AT_FIRST, FP3_AT_VARIABLE, error);
    for (uint32_t x = 0; !status && x < step->variable_count; x++) {
        const fp3_ref value = step->variables[x].first;
        status = check(step, value, FP3_AT_FIRST, FP3_AT_VARIABLE, step->first_count, error);
        if (!status && value.at != FP3_AT_NOWHERE)
            status = write_variable(block, x, found_at(value), error);
    }
    return status ? status : check_states(block, error);
}

fp3_status fp3_block_step(const fp3_step *step, const fp3_config *config, fp3_block *block,
                          fp3_error *error) {
    fp3_status status = open_block(step, config, block, error);
    block->is_cyclic = 1;
    if (!status)
        status = add_ops(block, step->step, step->step_count, FP3_AT_OP, FP3_AT_VARIABLE, error);
    for (uint32_t x = 0; !status && x < step->variable_count; x++) {
        const fp3_ref value = step->variables[x].next;
        status = check(step, value, FP3_AT_OP, FP3_AT_VARIABLE, step->step_count, error);
        const int is_kept =
            value.at == FP3_AT_NOWHERE || (value.at == FP3_AT_VARIABLE && value.index == x);
        if (!status && !is_kept)
            status = write_variable(block, x, value, error);
    }
    return status ? status : copy_old_values(block, error);
}

fp3_status fp3_block_last(const fp3_step *step, const fp3_config *config, fp3_block *block,
                          fp3_error *error) {
    fp3_status status = open_block(step, config, block, error);
    if (!status)
        status = add_ops(block, step->last, step->last_count, FP3_AT_LAST, FP3_AT_NEXT, error);
    for (uint32_t x = 0; !status && x < step->variable_count; x++) {
        const fp3_ref value = step->variables[x].last;
        status = check(step, value, FP3_AT_LAST, FP3_AT_NEXT, step->last_count, error);
        if (!status && value.at != FP3_AT_NOWHERE)
            status = write_variable(block, x, found_at(value), error);
    }
    return status ? status : copy_old_values(block, error);
}

/* ---- how long a step must take ---- */

/* The largest mean weight of a circle (Karp). weight[x * n + y]: from x to y in one step; below 0:
 * none. */
static double largest_mean(const double *weight, uint32_t n, double *longest) {
    /* longest[k * n + y]: of walks of k edges from anywhere to y; each n of them. */
    for (uint32_t y = 0; y < n; y++)
        longest[y] = 0;
    for (uint32_t k = 1; k <= n; k++)
        for (uint32_t y = 0; y < n; y++) {
            double most = -1;
            for (uint32_t x = 0; x < n; x++) {
                const double before = longest[(k - 1) * n + x], edge = weight[x * n + y];
                if (before >= 0 && edge >= 0 && before + edge > most)
                    most = before + edge;
            }
            longest[k * n + y] = most;
        }
    double best = 0;
    for (uint32_t y = 0; y < n; y++) {
        double least = -1;
        for (uint32_t k = 0; k < n && longest[n * n + y] >= 0; k++)
            if (longest[k * n + y] >= 0) {
                const double mean = (longest[n * n + y] - longest[k * n + y]) / (double)(n - k);
                if (least < 0 || mean < least)
                    least = mean;
            }
        if (least > best)
            best = least;
    }
    return best;
}

/* Of each operation, the cycles from reading variable x to its result; -1: it does not depend on
 * x. */
static void path_from(const fp3_step *step, const fp3_config *config, uint32_t x, double *to) {
    for (uint32_t i = 0; i < step->step_count; i++) {
        const fp3_op *op = &step->step[i];
        const fp3_ref refs[3] = {op->a, op->b, op->c};
        double begin = -1;
        for (int k = 0; k < 3; k++) {
            const double here = refs[k].at == FP3_AT_OP ? to[refs[k].index]
                                : refs[k].at == FP3_AT_VARIABLE && refs[k].index == x ? 0
                                                                                      : -1;
            if (here > begin)
                begin = here;
        }
        to[i] = begin < 0 ? -1 : begin + fp3_cycles_delay(config, op->op);
    }
}

fp3_status fp3_step_path(const fp3_step *step, const fp3_config *config, double *cycles,
                         fp3_error *error) {
    const uint32_t n = step->variable_count;
    *cycles = 0;
    double *weight = malloc(((size_t)n * (2 * n + 1) + step->step_count + 1) * sizeof *weight);
    if (!weight)
        return no_memory(error);
    double *longest = weight + (size_t)n * n, *to = longest + (size_t)n * (n + 1);
    for (uint32_t x = 0; x < n; x++) {
        path_from(step, config, x, to);
        for (uint32_t y = 0; y < n; y++) {
            const fp3_ref next = step->variables[y].next;
            weight[x * n + y] = next.at == FP3_AT_OP                            ? to[next.index]
                                : next.at == FP3_AT_VARIABLE && next.index == x ? 0
                                                                                : -1;
        }
    }
    *cycles = n ? largest_mean(weight, n, longest) : 0;
    free(weight);
    return FP3_OK;
}
