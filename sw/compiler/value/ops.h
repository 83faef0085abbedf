/* SPDX-License-Identifier: Apache-2.0 */
/* ops.h - the operations that functions are made of, by short names.
 *
 *     const uint32_t z = mul(g, x, x);
 *     return add(g, num(g, 1), mul(g, z, polynomial(g, z, cosine, 6)));
 *
 * Each is the node of fold.h. Inline, as only lower.c and the files of functions include this.
 */
#ifndef FP3_OPS_H
#define FP3_OPS_H

#include "fold.h"
#include "term.h"

#include <fp3/isa.h>

static inline uint32_t op2(dag *g, uint32_t op, uint32_t a, uint32_t b) {
    return fp3_fold(g, op, a, b, FP3_NONE);
}
static inline uint32_t op1(dag *g, uint32_t op, uint32_t a) { return op2(g, op, a, FP3_NONE); }
/* 2^n of an integral n. */
static inline uint32_t power_of_two(dag *g, uint32_t n) { return op1(g, FP3_OP_EXP2, n); }
static inline uint32_t add(dag *g, uint32_t a, uint32_t b) { return op2(g, FP3_OP_ADD, a, b); }
static inline uint32_t sub(dag *g, uint32_t a, uint32_t b) { return op2(g, FP3_OP_SUB, a, b); }
static inline uint32_t mul(dag *g, uint32_t a, uint32_t b) { return op2(g, FP3_OP_MUL, a, b); }
static inline uint32_t num(dag *g, double number) { return fp3_dag_number(g, number); }
static inline term one(dag *g) { return fp3_term(num(g, 1)); }

/* condition, unless it is 0, gives then. */
static inline uint32_t sel(dag *g, uint32_t condition, uint32_t then, uint32_t otherwise) {
    return fp3_fold(g, FP3_OP_SEL, then, otherwise, condition);
}

/* By Horner's rule, highest power first. */
static inline uint32_t polynomial(dag *g, uint32_t z, const double *coefficient, int count) {
    uint32_t p = num(g, coefficient[0]);
    for (int i = 1; i < count; i++)
        p = add(g, num(g, coefficient[i]), mul(g, p, z));
    return p;
}

#endif
