/* SPDX-License-Identifier: Apache-2.0 */
/* dag.h - the values of a step: every value once, operands before their users.
 *
 * A node is an instruction of the machine, or a leaf: a known value, or a variable as it was when
 * the step began. If quotients, roots and functions are made later (double_step.h), they are nodes,
 * too.
 */
#ifndef FP3_DAG_H
#define FP3_DAG_H

#include "known.h"

#define FP3_DAG_LIMIT 20000u /* nodes: no instruction memory holds so many */

/* Beside FP3_OP_... */
enum {
    NODE_KNOWN = 256,
    NODE_VARIABLE,
    NODE_QUOTIENT,     /* a / b */
    NODE_ROOT,         /* of a */
    NODE_INVERSE_ROOT, /* 1 / its root */
    NODE_FIRST,        /* the first word of a: what is made of it and of known values is a float */
    /* Words of the current neighbour of a sum. Leaves; b is the place (lowering) whose values the
     * neighbour shows, c the word of a pair: 0, or 1 of its second word. */
    NODE_OTHER_STATE, /* a: of the model's states */
    NODE_OTHER_PARAM, /* a: of its params; b: FP3_NONE */
    NODE_FIELD,       /* a: of its fields; b: FP3_NONE */
    /* Over the neighbours of a relation at a place, which c tells (fp3_dag_seen): */
    NODE_TOTAL,         /* b, and node a for each one added to it */
    NODE_LEAST,         /* the least of b and of a for each one */
    NODE_MOST,          /* the most */
    NODE_SECOND,        /* the second word of the fold that stands before it: a and b are, too */
    NODE_WORST,         /* of a over all objects, comparison c: in a later phase */
    NODE_FUNCTION = 512 /* + FP3_EXPR_...: a function of a, or of a and b; of a power b is known */
};

typedef struct {
    uint32_t op;
    uint32_t a, b, c; /* as in the instruction; FP3_NONE: it has none. Of a leaf a is the index */
    uint32_t note;    /* which equation it serves */
    uint32_t next;    /* in its chain of the hash table */
} dag_node;

#define FP3_DAG_BUCKETS 4096u
#define FP3_DAG_TERMS 2 /* for 24 bits */
typedef struct {
    known_table *known;
    dag_node *nodes;
    uint32_t count, room;
    uint32_t bucket[FP3_DAG_BUCKETS];
    unsigned passes; /* what fold.h may do */
    int is_flushed;  /* the machine's subnormal numbers are zeros ... */
    int is_finite;   /* ... and it has no infinities and no NaN */
    int terms;       /* of the series behind an estimate: division.h */
    uint32_t note;   /* of the nodes made from now on */
    int is_abstract; /* quotients, roots and functions are nodes of their own */
    int is_direct;   /* rcp and rsqrt are no estimates: nothing corrects them */
    int has_failed;  /* out of memory */
    int is_full;     /* more than FP3_DAG_LIMIT nodes were asked for */
} dag;

void fp3_dag_open(dag *g, known_table *known, unsigned passes);
void fp3_dag_close(dag *g);

/* Leaves, each once. */
uint32_t fp3_dag_known(dag *g, uint32_t known);
uint32_t fp3_dag_number(dag *g, double number);
uint32_t fp3_dag_variable(dag *g, uint32_t index);
/* A leaf of a neighbour, or a sum over neighbours, each once. */
uint32_t fp3_dag_neighbour(dag *g, uint32_t op, uint32_t a, uint32_t b, uint32_t c);

/* Where nodes stand for pairs: its first word, to compute with in floats. Else the node itself. */
uint32_t fp3_dag_first(dag *g, uint32_t node);

/* A node of its own; see fold.h for the usual way. */
uint32_t fp3_dag_make(dag *g, uint32_t op, uint32_t a, uint32_t b, uint32_t c);
/* A node of this operation with these operands, or FP3_NONE. a + b is b + a, a b is b a. */
uint32_t fp3_dag_find(const dag *g, uint32_t op, uint32_t a, uint32_t b, uint32_t c);

/* FP3_NONE, or which known value the node is. */
uint32_t fp3_dag_is_known(const dag *g, uint32_t node);
int fp3_dag_is_number(const dag *g, uint32_t node, double number);

static inline int fp3_dag_is_leaf(const dag *g, uint32_t node) {
    const uint32_t op = g->nodes[node].op;
    return op == NODE_KNOWN || op == NODE_VARIABLE;
}

/* The worst of what all objects have (machine/neighbours.h); `which`: an fp3_compared. */
uint32_t fp3_dag_worst(dag *g, uint32_t node, uint32_t which);

/* Whether a value is made of all neighbours, in a loop over them. */
static inline int fp3_dag_is_fold(uint32_t op) { return op >= NODE_TOTAL && op <= NODE_SECOND; }

/* Whether the fold is one of pairs, whose second word is the node behind it. */
static inline int fp3_dag_has_second(const dag *g, uint32_t fold) {
    return fold + 1 < g->count && g->nodes[fold + 1].op == NODE_SECOND;
}

/* Operand c of a fold: by which relation, and at which place, neighbours are seen. */
static inline uint32_t fp3_dag_seen(uint32_t relation, uint32_t place) {
    return place * FP3_RELATIONS_MAX + relation;
}
static inline uint32_t fp3_dag_relation(const dag *g, uint32_t fold) {
    return g->nodes[fold].c % FP3_RELATIONS_MAX;
}
static inline uint32_t fp3_dag_place(const dag *g, uint32_t fold) {
    return g->nodes[fold].c / FP3_RELATIONS_MAX;
}

/* Operand 0 .. 2 of a node. */
static inline uint32_t fp3_dag_operand(const dag *g, uint32_t node, int i) {
    const dag_node *n = &g->nodes[node];
    return i == 0 ? n->a : i == 1 ? n->b : n->c;
}

#endif
