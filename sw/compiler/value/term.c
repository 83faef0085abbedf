/* SPDX-License-Identifier: Apache-2.0 */
/* term.c - signs go to the addition that comes next. */
#include "term.h"

#include "fold.h"

#include <fp3/isa.h>

term fp3_term(uint32_t node) { return (term){.node = node}; }

term fp3_term_negated(term t) {
    t.is_negative = !t.is_negative;
    return t;
}

uint32_t fp3_term_value(dag *g, term t) {
    if (!t.is_negative)
        return t.node;
    const uint32_t known = fp3_dag_is_known(g, t.node);
    if (known != FP3_NONE)
        return fp3_dag_known(g, fp3_known_make(g->known, KNOWN_NEGATE, known, 0));
    /* -(k x) is (-k) x. */
    const dag_node n = t.node < g->count ? g->nodes[t.node] : (dag_node){0};
    for (int i = 0; n.op == FP3_OP_MUL && i < 2; i++) {
        const uint32_t factor = fp3_dag_is_known(g, i ? n.b : n.a);
        if (factor != FP3_NONE)
            return fp3_fold(g, FP3_OP_MUL,
                            fp3_dag_known(g, fp3_known_make(g->known, KNOWN_NEGATE, factor, 0)),
                            i ? n.a : n.b, FP3_NONE);
    }
    /* -0 - x is -x for every x. */
    return fp3_fold(g, FP3_OP_SUB, fp3_dag_number(g, -0.0), t.node, FP3_NONE);
}

term fp3_term_add(dag *g, term a, term b) {
    if (b.is_negative)
        return fp3_term_sub(g, a, fp3_term_negated(b));
    if (a.is_negative)
        return fp3_term_sub(g, b, fp3_term_negated(a));
    return fp3_term(fp3_fold(g, FP3_OP_ADD, a.node, b.node, FP3_NONE));
}

term fp3_term_sub(dag *g, term a, term b) {
    /* -(a + b) would have another zero: its sign is paid for at a. */
    const uint32_t x = fp3_term_value(g, a);
    return fp3_term(fp3_fold(g, b.is_negative ? FP3_OP_ADD : FP3_OP_SUB, x, b.node, FP3_NONE));
}

term fp3_term_mul(dag *g, term a, term b) {
    const uint32_t product = fp3_fold(g, FP3_OP_MUL, a.node, b.node, FP3_NONE);
    return (term){product, a.is_negative != b.is_negative};
}

term fp3_term_power(dag *g, term x, unsigned n) {
    term result = fp3_term(fp3_dag_number(g, 1));
    int is_one = 1;
    for (; n; n >>= 1) {
        if (n & 1) {
            result = is_one ? x : fp3_term_mul(g, x, result);
            is_one = 0;
        }
        if (n > 1)
            x = fp3_term_mul(g, x, x);
    }
    return result;
}
