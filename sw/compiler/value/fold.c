/* SPDX-License-Identifier: Apache-2.0 */
/* fold.c - known operands, identities, and values that are there already. */
#include "fold.h"

#include <fp3/compile.h>
#include <fp3/isa.h>

static int has_pass(const dag *g, fp3_pass pass) { return (g->passes & FP3_PASS(pass)) != 0; }

/* Sums and products of known values are known. */
static uint32_t of_known(dag *g, uint32_t op, uint32_t a, uint32_t b) {
    const uint32_t x = fp3_dag_is_known(g, a), y = fp3_dag_is_known(g, b);
    if (x == FP3_NONE || y == FP3_NONE)
        return FP3_NONE;
    switch (op) {
    case FP3_OP_ADD:
        return fp3_dag_known(g, fp3_known_make(g->known, KNOWN_ADD, x, y));
    case FP3_OP_SUB:
        return fp3_dag_known(g, fp3_known_make(g->known, KNOWN_SUB, x, y));
    case FP3_OP_MUL:
        return fp3_dag_known(g, fp3_known_make(g->known, KNOWN_MUL, x, y));
    default:
        return FP3_NONE;
    }
}

/* known * (x * known) as x * known: other bits. */
static uint32_t fold_product(dag *g, uint32_t a, uint32_t b) {
    const uint32_t x = fp3_dag_is_known(g, a);
    if (x == FP3_NONE)
        return fp3_dag_is_known(g, b) != FP3_NONE ? fold_product(g, b, a) : FP3_NONE;
    if (b >= g->count || g->nodes[b].op != FP3_OP_MUL)
        return FP3_NONE;
    uint32_t inner = g->nodes[b].a, other = g->nodes[b].b;
    if (fp3_dag_is_known(g, inner) == FP3_NONE) {
        inner = g->nodes[b].b;
        other = g->nodes[b].a;
    }
    const uint32_t y = fp3_dag_is_known(g, inner);
    if (y == FP3_NONE)
        return FP3_NONE;
    return fp3_fold(g, FP3_OP_MUL, other,
                    fp3_dag_known(g, fp3_known_make(g->known, KNOWN_MUL, x, y)), FP3_NONE);
}

/* What costs nothing: x * 1, x + -0, x - 0. */
static uint32_t drop_identity(const dag *g, uint32_t op, uint32_t a, uint32_t b) {
    if (op == FP3_OP_MUL && fp3_dag_is_number(g, a, 1.0))
        return b;
    if (op == FP3_OP_MUL && fp3_dag_is_number(g, b, 1.0))
        return a;
    if (op == FP3_OP_ADD && fp3_dag_is_number(g, a, -0.0))
        return b;
    if (op == FP3_OP_ADD && fp3_dag_is_number(g, b, -0.0))
        return a;
    if (op == FP3_OP_SUB && fp3_dag_is_number(g, b, 0.0))
        return a;
    return FP3_NONE;
}

/* The one that a known condition chooses, or the only one that there is. */
static uint32_t drop_choice(const dag *g, uint32_t a, uint32_t b, uint32_t c) {
    if (a == b || fp3_dag_is_number(g, c, 1.0))
        return a;
    return fp3_dag_is_number(g, c, 0.0) ? b : FP3_NONE;
}

uint32_t fp3_fold(dag *g, uint32_t op, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t easier = of_known(g, op, a, b);
    if (easier == FP3_NONE && has_pass(g, FP3_PASS_IDENTITY))
        easier = drop_identity(g, op, a, b);
    if (easier == FP3_NONE && has_pass(g, FP3_PASS_IDENTITY) && op == FP3_OP_SEL)
        easier = drop_choice(g, a, b, c);
    if (easier == FP3_NONE && has_pass(g, FP3_PASS_FOLD_PRODUCT) && op == FP3_OP_MUL)
        easier = fold_product(g, a, b);
    if (easier == FP3_NONE && has_pass(g, FP3_PASS_COMMON))
        easier = fp3_dag_find(g, op, a, b, c);
    return easier != FP3_NONE ? easier : fp3_dag_make(g, op, a, b, c);
}
