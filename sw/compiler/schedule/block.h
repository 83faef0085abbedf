/* SPDX-License-Identifier: Apache-2.0 */
/* block.h - a part of a program as nodes: the first, the step or the last part.
 *
 * A node is an operation, or a copy. Its operands name other nodes, or a variable as it was when
 * the block began. A node that writes a variable writes the variable's register, so every node that
 * reads the old value issues before it.
 */
#ifndef FP3_BLOCK_H
#define FP3_BLOCK_H

#include "code.h"

#include <assert.h>

typedef struct {
    fp3_op op; /* operands: FP3_AT_OP a node, FP3_AT_VARIABLE, FP3_AT_PARAM, FP3_AT_CONSTANT */
    uint32_t writes;         /* variable, or FP3_NONE_INDEX */
    uint32_t fixed;          /* the register that it writes, or FP3_NONE_INDEX: any */
    uint32_t from;           /* as in fp3_line */
    uint32_t latency, delay; /* operands to result, issue to the issue of a reader */
    int is_ahead;
} fp3_node;

typedef struct {
    const fp3_step_code *code;
    const fp3_config *config;
    int is_first;  /* the first part: only states have a value when it begins */
    int is_cyclic; /* the step part: a variable is read as the step before left it */
    fp3_node *nodes;
    uint32_t count, room;
    uint32_t *writer; /* of each variable: a node, or FP3_NONE_INDEX */
    uint32_t copies;  /* nodes that only move a value */
    int reads_minus_zero;
} fp3_block;

/* No nodes, and no writer of any variable. The caller frees, after a failure too. */
fp3_status fp3_block_open(const fp3_step_code *code, const fp3_config *config, fp3_block *block,
                          fp3_error *error);
void fp3_block_free(fp3_block *block);
fp3_status fp3_block_clone(const fp3_block *block, fp3_block *clone, fp3_error *error);

/* Appends a node; returns its index. FP3_NONE_INDEX: out of memory. */
uint32_t fp3_block_add(fp3_block *block, const fp3_node *node);
/* Appends a node that copies a value. */
uint32_t fp3_block_add_copy(fp3_block *block, fp3_ref what);

/* An operand of a node, 0 .. 2; its place is FP3_AT_NOWHERE where there is none. */
static inline fp3_ref fp3_node_operand(const fp3_node *node, uint32_t i) {
    assert(i < 3);
    return i == 0 ? node->op.a : i == 1 ? node->op.b : node->op.c;
}
fp3_ref *fp3_node_operand_at(fp3_node *node, uint32_t i);

/* Whether it reads the variable as it was when the block began. */
int fp3_node_reads_variable(const fp3_node *node, uint32_t variable);

#endif
