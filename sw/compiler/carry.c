/* SPDX-License-Identifier: Apache-2.0 */
/* carry.c - nodes and their images under the step. */
#include "carry.h"

#include <assert.h>
#include <stdlib.h>

typedef struct {
    fp3_step *step;
    uint32_t *image;  /* of each node: the node that is the same of the new states, or FP3_NONE */
    char *is_reached; /* the new values depend on it */
    char *is_candidate;
    char *is_frontier; /* a candidate that something other than a candidate reads */
} carrying;

static void find_reached(const carrying *c) {
    const dag *g = &c->step->values;
    for (uint32_t i = 0; i < c->step->variable_count; i++)
        c->is_reached[c->step->variables[i].next] = 1;
    for (uint32_t i = g->count; i-- > 0;)
        for (int j = 0; c->is_reached[i] && !fp3_dag_is_leaf(g, i) && j < 3; j++)
            if (fp3_dag_operand(g, i, j) != FP3_NONE)
                c->is_reached[fp3_dag_operand(g, i, j)] = 1;
}

static uint32_t image_of(const carrying *c, uint32_t node) {
    const dag *g = &c->step->values;
    uint32_t to[3];
    for (int j = 0; j < 3; j++) {
        const uint32_t from = fp3_dag_operand(g, node, j);
        to[j] = from == FP3_NONE ? FP3_NONE : c->image[from];
        if (from != FP3_NONE && to[j] == FP3_NONE)
            return FP3_NONE;
    }
    return fp3_dag_find(g, g->nodes[node].op, to[0], to[1], to[2]);
}

static void find_images(const carrying *c) {
    const dag *g = &c->step->values;
    for (uint32_t i = 0; i < g->count; i++) {
        const dag_node *n = &g->nodes[i];
        c->image[i] = n->op == NODE_KNOWN      ? i
                      : n->op == NODE_VARIABLE ? c->step->variables[n->a].next
                                               : image_of(c, i);
        c->is_candidate[i] = !fp3_dag_is_leaf(g, i) && c->is_reached[i] &&
                             c->image[i] != FP3_NONE && c->image[i] != i &&
                             c->is_reached[c->image[i]];
    }
}

/* A candidate that only other candidates need goes away by itself. */
static void mark_frontier(const carrying *c) {
    const dag *g = &c->step->values;
    for (uint32_t i = 0; i < g->count; i++) {
        if (!c->is_reached[i] || c->is_candidate[i] || fp3_dag_is_leaf(g, i))
            continue;
        for (int j = 0; j < 3; j++) {
            const uint32_t operand = fp3_dag_operand(g, i, j);
            if (operand != FP3_NONE && c->is_candidate[operand])
                c->is_frontier[operand] = 1;
        }
    }
    for (uint32_t i = 0; i < c->step->variable_count; i++)
        if (c->is_candidate[c->step->variables[i].next])
            c->is_frontier[c->step->variables[i].next] = 1;
}

static int is_kept(const fp3_step *step, uint32_t node) {
    for (uint32_t i = 0; i < step->variable_count; i++)
        if (step->variables[i].first == node)
            return 1;
    return 0;
}

static int add_variables(const carrying *c) {
    for (uint32_t i = 0; i < c->step->values.count; i++) {
        if (!c->is_frontier[i] || is_kept(c->step, i))
            continue;
        if (!fp3_step_add(c->step, ROLE_CARRIED, FP3_NONE))
            return 0;
        variable *added = &c->step->variables[c->step->variable_count - 1];
        assert(c->image[i] != FP3_NONE);
        added->next = c->image[i];
        added->first = i;
    }
    return 1;
}

fp3_status fp3_carry(fp3_step *step, fp3_error *error) {
    const size_t count = step->values.count + 1u;
    carrying c = {.step = step,
                  .image = calloc(count, sizeof *c.image),
                  .is_reached = calloc(count, 1),
                  .is_candidate = calloc(count, 1),
                  .is_frontier = calloc(count, 1)};
    int is_done = c.image && c.is_reached && c.is_candidate && c.is_frontier;
    if (is_done) {
        find_reached(&c);
        find_images(&c);
        mark_frontier(&c);
        is_done = add_variables(&c);
    }
    free(c.image);
    free(c.is_reached);
    free(c.is_candidate);
    free(c.is_frontier);
    return is_done ? FP3_OK : fp3_no_memory(error);
}
