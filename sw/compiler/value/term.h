/* SPDX-License-Identifier: Apache-2.0 */
/* term.h - a node with a sign that no instruction has paid for yet: an addition takes it in. */
#ifndef FP3_TERM_H
#define FP3_TERM_H

#include "dag.h"

typedef struct {
    uint32_t node;
    int is_negative;
} term;

term fp3_term(uint32_t node);
term fp3_term_negated(term t);
term fp3_term_add(dag *g, term a, term b);
term fp3_term_sub(dag *g, term a, term b);
term fp3_term_mul(dag *g, term a, term b);
/* x^n by squares: x^3 is (x x) x. */
term fp3_term_power(dag *g, term x, unsigned n);
/* The value itself, its sign paid for. */
uint32_t fp3_term_value(dag *g, term t);

#endif
