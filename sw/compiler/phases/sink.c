/* SPDX-License-Identifier: Apache-2.0 */
/* sink.c - see sink.h. Nodes from the last to the first: what reads a node has its place before. */
#include "sink.h"

#include <stdlib.h>

#define DEPTH 6 /* that far a value is looked at for what it is made of */

typedef struct {
    fp3_cut_plan *c;
    uint32_t *first, *last; /* of each node: when it is read first (FP3_NONE: never), and last */
    char *is_pinned;        /* it is read by more than straight code */
} sinker;

static int is_straight(const fp3_cut_plan *c, uint32_t node) {
    const uint32_t op = fp3_cut_node(c, node)->op;
    return !fp3_dag_is_leaf(c->g, node) && !fp3_dag_is_fold(op) && op != NODE_WORST &&
           !c->is_body[node];
}

static void pin(const sinker *s, uint32_t node) {
    if (node != FP3_NONE)
        s->is_pinned[node] = 1;
}

/* The operands of a node are read when it is computed. */
static void read(const sinker *s, uint32_t node) {
    uint32_t list[FP3_CUT_OPERANDS];
    const unsigned count = fp3_cut_operands(s->c, node, list);
    const uint32_t when = s->c->when[node];
    for (unsigned k = 0; k < count; k++) {
        uint32_t *first = &s->first[list[k]], *last = &s->last[list[k]];
        *first = when < *first ? when : *first;
        *last = when > *last ? when : *last;
        if (!is_straight(s->c, node))
            pin(s, list[k]);
    }
}

static void pin_all(const sinker *s) {
    const fp3_step *step = s->c->step;
    for (uint32_t i = 0; i < s->c->own; i++)
        pin(s, step->variables[i].next);
    for (uint32_t k = 0; k < step->kept_count; k++)
        pin(s, step->kept[k].node);
    for (uint32_t k = 0; k < step->sight.count; k++)
        pin(s, step->sight.list[k].node);
}

static uint32_t phase_of(uint32_t when) { return when / FP3_CUT_SLOTS; }

/* How many values have to be kept longer, if the node is computed then; what it is made of may be
 * computed then, too. */
static unsigned longer(const sinker *s, uint32_t node, uint32_t then, int depth) {
    uint32_t list[FP3_CUT_OPERANDS];
    const unsigned count = fp3_cut_operands(s->c, node, list);
    unsigned found = 0;
    for (unsigned k = 0; k < count; k++) {
        const uint32_t of = list[k];
        const int is_there =
            fp3_cut_node(s->c, of)->op == NODE_KNOWN || phase_of(s->last[of]) >= phase_of(then);
        const int may_sink = depth && is_straight(s->c, of) && !s->is_pinned[of];
        if (!is_there)
            found += !may_sink || longer(s, of, then, depth - 1);
    }
    return found;
}

fp3_status fp3_cut_sink(fp3_cut_plan *c, fp3_error *error) {
    const sinker s = {.c = c,
                      .first = fp3_cut_filled(c->g->count),
                      .last = calloc(c->g->count + 1u, sizeof *s.last),
                      .is_pinned = calloc(c->g->count + 1u, 1)};
    const int is_good = s.first && s.last && s.is_pinned;
    for (uint32_t i = 0; is_good && i < c->g->count; i++)
        if (c->is_needed[i])
            read(&s, i);
    for (uint32_t i = 0; is_good && i < c->g->count; i++)
        s.first[i] = FP3_NONE;
    if (is_good)
        pin_all(&s);
    for (uint32_t i = c->g->count; is_good && i-- > 0;) {
        if (!c->is_needed[i])
            continue;
        if (is_straight(c, i) && !s.is_pinned[i] && s.first[i] != FP3_NONE &&
            phase_of(s.first[i]) > phase_of(c->when[i]) && longer(&s, i, s.first[i], DEPTH) <= 1)
            c->when[i] = s.first[i];
        read(&s, i);
    }
    free(s.first);
    free(s.last);
    free(s.is_pinned);
    return is_good ? FP3_OK : fp3_no_memory(error);
}
