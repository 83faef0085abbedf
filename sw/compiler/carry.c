/* carry.c - values that the step before has computed already.
 *
 * What a step makes of its states at the beginning, the step before has made of the same states at its
 * end if it has the same node of them: "first same as last". Such a node becomes a variable.
 */
#include "build.h"

#include <isa.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    build *b;
    uint32_t *image;  /* of each node: the node of this step that is the same of the next states */
    char *is_reached; /* from what the step leaves behind */
    char *is_candidate;
} carrying;

static uint32_t operand(const graph_node *n, int i) { return i == 0 ? n->a : i == 1 ? n->b : n->c; }

static int is_leaf(const graph_node *n) { return n->op >= NODE_KNOWN; }

static void find_reached(carrying *c) {
    const graph *g = &c->b->g;
    for (uint32_t i = 0; i < c->b->variable_count; i++)
        c->is_reached[c->b->variables[i].next] = 1;
    for (uint32_t i = g->count; i-- > 0;)
        for (int j = 0; c->is_reached[i] && !is_leaf(&g->nodes[i]) && j < 3; j++)
            if (operand(&g->nodes[i], j) != FP3_NONE)
                c->is_reached[operand(&g->nodes[i], j)] = 1;
}

static uint32_t image_of(const carrying *c, const graph_node *n) {
    uint32_t to[3];
    for (int j = 0; j < 3; j++) {
        const uint32_t from = operand(n, j);
        to[j] = from == FP3_NONE ? FP3_NONE : c->image[from];
        if (from != FP3_NONE && to[j] == FP3_NONE)
            return FP3_NONE;
    }
    return fp3_graph_look(&c->b->g, n->op, to[0], to[1], to[2]);
}

static void find_images(carrying *c) {
    const graph *g = &c->b->g;
    for (uint32_t i = 0; i < g->count; i++) {
        const graph_node *n = &g->nodes[i];
        c->image[i] = n->op == NODE_KNOWN      ? i
                      : n->op == NODE_VARIABLE ? c->b->variables[n->a].next
                                               : image_of(c, n);
        c->is_candidate[i] = !is_leaf(n) && c->is_reached[i] && c->image[i] != FP3_NONE &&
                             c->image[i] != i && c->is_reached[c->image[i]];
    }
}

/* A candidate that only other candidates need goes away by itself. */
static void mark_frontier(const carrying *c, char *is_frontier) {
    const graph *g = &c->b->g;
    for (uint32_t i = 0; i < g->count; i++)
        for (int j = 0; c->is_reached[i] && !c->is_candidate[i] && !is_leaf(&g->nodes[i]) && j < 3;
             j++)
            if (operand(&g->nodes[i], j) != FP3_NONE && c->is_candidate[operand(&g->nodes[i], j)])
                is_frontier[operand(&g->nodes[i], j)] = 1;
    for (uint32_t i = 0; i < c->b->variable_count; i++)
        if (c->is_candidate[c->b->variables[i].next])
            is_frontier[c->b->variables[i].next] = 1;
}

static uint32_t make_variables(carrying *c, const char *is_frontier) {
    build *b = c->b;
    uint32_t wanted = 0;
    for (uint32_t i = 0; i < b->g.count; i++)
        wanted += is_frontier[i] != 0;
    variable *variables =
        wanted ? realloc(b->variables, (b->variable_count + wanted) * sizeof *variables) : NULL;
    if (!variables)
        return 0;
    b->variables = variables;
    for (uint32_t i = 0; i < b->g.count; i++)
        if (is_frontier[i])
            b->variables[b->variable_count++] = (variable){.role = ROLE_CARRIED,
                                                           .state = FP3_NONE,
                                                           .next = c->image[i],
                                                           .first = i,
                                                           .last = FP3_NONE};
    return wanted;
}

uint32_t fp3_build_carry(build *b) {
    const size_t count = b->g.count + 1u;
    carrying c = {.b = b,
                  .image = calloc(count, sizeof *c.image),
                  .is_reached = calloc(count, 1),
                  .is_candidate = calloc(count, 1)};
    char *is_frontier = calloc(count, 1);
    uint32_t made = 0;
    if (c.image && c.is_reached && c.is_candidate && is_frontier) {
        find_reached(&c);
        find_images(&c);
        mark_frontier(&c, is_frontier);
        made = make_variables(&c, is_frontier);
    } else
        b->has_failed = 1;
    free(c.image);
    free(c.is_reached);
    free(c.is_candidate);
    free(is_frontier);
    return made;
}
