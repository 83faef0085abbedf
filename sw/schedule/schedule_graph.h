/* schedule_graph.h - a part of a program as operations, and what has to come before what.
 *
 * A block is the first, the step or the last part. Its nodes name values: of other nodes, or of a
 * variable as it was when the block began. A node that writes a variable writes its register, so
 * that all who read the variable as it was have to issue before; where that cannot be, a node that
 * copies the old value first is put in between, and the late readers read the copy.
 */
#ifndef FP3_SCHEDULE_GRAPH_H
#define FP3_SCHEDULE_GRAPH_H

#include "code.h"

typedef struct {
    fp3_op op; /* operands: FP3_AT_OP a node, FP3_AT_VARIABLE, FP3_AT_PARAM, FP3_AT_CONSTANT */
    uint32_t writes;         /* variable, or FP3_NONE_INDEX */
    uint32_t fixed;          /* the register that it writes, or FP3_NONE_INDEX: any */
    uint32_t from;           /* as in fp3_line */
    uint32_t latency, delay; /* operands to result, issue to the issue of a reader */
    int is_ahead;
} fp3_node;

/* Node `to` of a step issues weight cycles or more after node `from` of the step so many before
 * it. */
typedef struct {
    uint32_t from, to;
    uint32_t weight, distance;
    int is_anti; /* from reads the variable that to overwrites */
} fp3_edge;

typedef struct {
    fp3_edge *edges;
    uint32_t edge_count, node_count;
    /* Edges by node: out[out_begin[i] .. out_begin[i+1]) leave node i; likewise those that come
     * in. */
    uint32_t *out_begin, *out, *in_begin, *in;
} fp3_graph;

typedef struct {
    const fp3_step *step;
    const fp3_config *config;
    int is_first;  /* the first part: only states have a value at its beginning */
    int is_cyclic; /* the step part: a variable is read as the step before has left it */
    fp3_node *nodes;
    uint32_t count, room;
    uint32_t *writer; /* of each variable: a node, or FP3_NONE_INDEX */
    uint32_t copies;  /* nodes that only move a value */
    int reads_minus_zero;
} fp3_block;

fp3_status fp3_block_first(const fp3_step *step, const fp3_config *config, fp3_block *block,
                           fp3_error *error);
fp3_status fp3_block_step(const fp3_step *step, const fp3_config *config, fp3_block *block,
                          fp3_error *error);
fp3_status fp3_block_last(const fp3_step *step, const fp3_config *config, fp3_block *block,
                          fp3_error *error);
void fp3_block_free(fp3_block *block);
fp3_status fp3_block_clone(const fp3_block *block, fp3_block *clone, fp3_error *error);

/* Whoever reads the variable late, after others of its readers have done their work, reads a copy:
 * so the variable can be written sooner. *is_changed: there are such readers. */
fp3_status fp3_block_split(fp3_block *block, uint32_t variable, int *is_changed, fp3_error *error);

/* A node more, behind all; FP3_NONE_INDEX: no room. */
uint32_t fp3_block_add(fp3_block *block, const fp3_node *node);

/* An operand of a node, 0 .. 2; its place is FP3_AT_NOWHERE where there is none. */
fp3_ref fp3_node_operand(const fp3_node *node, uint32_t i);

/* What must hold whatever the registers are. A distance is 0, but where is_cyclic and a value goes
 * to the next step. extra: edges more, and nodes behind the block's that they may name. */
fp3_status fp3_graph_make(const fp3_block *block, const fp3_edge *extra, uint32_t extra_count,
                          uint32_t extra_nodes, fp3_graph *graph, fp3_error *error);
void fp3_graph_free(fp3_graph *graph);

/* Data alone: cycles per step of the longest dependence from step to step (solo machine). */
fp3_status fp3_step_path(const fp3_step *step, const fp3_config *config, double *cycles,
                         fp3_error *error);

#endif
