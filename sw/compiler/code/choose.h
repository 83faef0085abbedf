/* SPDX-License-Identifier: Apache-2.0 */
/* choose.h - what each node of a part is executed as: scaled sums, chained products. */
#ifndef FP3_CHOOSE_H
#define FP3_CHOOSE_H

#include "compiler/step/options.h"
#include "compiler/value/dag.h"

/* Which additions take a product in before it is rounded to a register. The addend of a chained
 * product must be ready when the product begins; if latency counts, this can delay the addition. */
typedef enum {
    CHAIN_NONE,
    CHAIN_EARLY, /* where it makes nothing later */
    CHAIN_ALL,
    /* All, and other sums and products go the chain's way as well: a + b as a + 1 b, a b as -0 + a
     * b. Results that are equally late never meet at the write port. */
    CHAIN_SLACK, /* ... those far from the longest path */
    CHAIN_LONG   /* ... each of them */
} chain_policy;

typedef struct {
    const dag *g;
    const fp3_options *options;
    chain_policy policy;
    const char *is_leaf; /* of each node: something else provides its value */
    uint32_t *uses;      /* of each node: how often it is read; the caller counts the roots */
    /* For sums and products that go the chain's way: nodes, or FP3_NONE. */
    uint32_t one, minus_zero;
} fp3_part;

/* A node as an instruction. */
typedef struct {
    uint32_t op;         /* FP3_OP_... */
    uint32_t operand[3]; /* nodes, or FP3_NONE */
    uint32_t operations; /* that it stands for; 0: the node is not executed by itself */
} fp3_choice_of_node;

/* choices: of each node of the part. */
fp3_status fp3_choices_make(const fp3_part *part, fp3_choice_of_node *choices, fp3_error *error);

#endif
