/* SPDX-License-Identifier: Apache-2.0 */
/* dependences.h - which node of a block waits for which other one, and how long. */
#ifndef FP3_DEPENDENCES_H
#define FP3_DEPENDENCES_H

#include "block.h"

/* Node `to` issues at least `weight` cycles after node `from` of the step `distance` steps before.
 */
typedef struct {
    uint32_t from, to;
    uint32_t weight, distance;
    int is_anti; /* from reads the variable that to overwrites */
} fp3_edge;

typedef struct {
    fp3_edge *edges;
    uint32_t edge_count, node_count;
    /* Edges by node: out[out_begin[i] .. out_begin[i+1]) leave node i; in likewise enter it. */
    uint32_t *out_begin, *out, *in_begin, *in;
} fp3_dependences;

/* Conditions that must hold with any registers. A distance is 0, except where is_cyclic and a value
 * goes to the next step. extra: more edges, which may name extra_nodes nodes after the block's. */
fp3_status fp3_dependences_make(const fp3_block *block, const fp3_edge *extra, uint32_t extra_count,
                                uint32_t extra_nodes, fp3_dependences *made, fp3_error *error);
void fp3_dependences_free(fp3_dependences *made);

#endif
