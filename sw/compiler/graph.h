/* graph.h - a step as a graph: every value once, operands before what is made of them.
 *
 * A node is an instruction of the machine, or a leaf: a known value, or a variable as it was when the
 * step began. A term is a node with a sign that nobody has paid for yet: additions take it in.
 */
#ifndef FP3_GRAPH_H
#define FP3_GRAPH_H

#include "known.h"

#define GRAPH_LIMIT 20000u /* nodes: no instruction memory holds so many */

enum { NODE_KNOWN = 256, NODE_VARIABLE = 257 }; /* beside FP3_OP_... */

typedef struct {
    uint32_t op;
    uint32_t a, b, c; /* as in the instruction; FP3_NONE: it has none. Of a leaf a is the index */
    uint32_t note;    /* which equation it serves */
    uint32_t next;    /* in its chain of the hash table */
} graph_node;

typedef struct {
    uint32_t node;
    int is_negative;
} term;

#define GRAPH_BUCKETS 4096u
typedef struct {
    known_table *known;
    graph_node *nodes;
    uint32_t count, room;
    uint32_t bucket[GRAPH_BUCKETS];
    int is_shared;   /* a value that is there already is not made again */
    int drops_units; /* x * 1 is x, x + -0 is x */
    int folds_products;
    uint32_t note;  /* of the nodes made from now on */
    int has_failed; /* out of memory */
    int is_full;    /* more than GRAPH_LIMIT nodes were asked for */
} graph;

void fp3_graph_open(graph *g, known_table *known);
void fp3_graph_close(graph *g);

uint32_t fp3_graph_known(graph *g, uint32_t known);
uint32_t fp3_graph_number(graph *g, double number);
uint32_t fp3_graph_variable(graph *g, uint32_t index);
/* The node of op a, b, c, after what the flags above allow. Sums and products of known values are known. */
uint32_t fp3_graph_op(graph *g, uint32_t op, uint32_t a, uint32_t b, uint32_t c);
/* The same if it is there, else FP3_NONE; nothing is made. */
uint32_t fp3_graph_look(const graph *g, uint32_t op, uint32_t a, uint32_t b, uint32_t c);

/* FP3_NONE, or which known value the node is. */
uint32_t fp3_graph_is_known(const graph *g, uint32_t node);
int fp3_graph_is_number(const graph *g, uint32_t node, double number);

term fp3_term(uint32_t node);
term fp3_term_negated(term t);
term fp3_term_add(graph *g, term a, term b);
term fp3_term_sub(graph *g, term a, term b);
term fp3_term_mul(graph *g, term a, term b);
/* The value itself, its sign paid for. */
uint32_t fp3_term_value(graph *g, term t);

#endif
