/* SPDX-License-Identifier: Apache-2.0 */
/* double_single.h - arithmetic with unevaluated sums of two floats, as instructions.
 *
 * A pair stands for high + low, where high is that sum rounded to FP32. u = 2^-24. All bounds are
 * relative to the result and hold with rounding to nearest, where nothing overflows and no product
 * falls below 2^-102: below that a product's error is no float any more, and is off by a few
 * 2^-149. A factor from 2^115 on, or a product from 1.99 2^127 on, may overflow in its halves: then
 * a word is no number, and overflow is raised.
 *
 * Sources: Dekker, A floating-point technique for extending the available precision, Numer. Math.
 * 18 (1971); Knuth, TAOCP 2, 4.2.2; Joldes, Muller and Popescu, Tight and rigorous error bounds for
 * basic building blocks of double-word arithmetic, ACM TOMS 44 (2017); Muller and Rideau,
 * Formalization of double-word arithmetic, ACM TOMS 48 (2022).
 */
#ifndef FP3_DOUBLE_SINGLE_H
#define FP3_DOUBLE_SINGLE_H

#include "compiler/value/dag.h"
#include <fp3/isa.h>

typedef struct {
    uint32_t high, low; /* low FP3_NONE: it is 0 */
} fp3_pair;

/* Nodes as they are: only the pass `common` may change these nodes, which depend on how each
 * operation is rounded. */
uint32_t fp3_pair_op(dag *g, uint32_t op, uint32_t a, uint32_t b, uint32_t c);
static inline uint32_t fp3_word_add(dag *g, uint32_t a, uint32_t b) {
    return fp3_pair_op(g, FP3_OP_ADD, a, b, FP3_NONE);
}
static inline uint32_t fp3_word_sub(dag *g, uint32_t a, uint32_t b) {
    return fp3_pair_op(g, FP3_OP_SUB, a, b, FP3_NONE);
}
static inline uint32_t fp3_word_mul(dag *g, uint32_t a, uint32_t b) {
    return fp3_pair_op(g, FP3_OP_MUL, a, b, FP3_NONE);
}
/* The second word, 0 where there is none. */
uint32_t fp3_pair_low(dag *g, fp3_pair x);

/* A known value: its low word is known, too. */
fp3_pair fp3_pair_known(dag *g, uint32_t known);

/* Exact: the rounded sum, difference or product of two floats, and the error of the rounding. */
fp3_pair fp3_two_sum(dag *g, uint32_t a, uint32_t b);
fp3_pair fp3_two_difference(dag *g, uint32_t a, uint32_t b);
fp3_pair fp3_two_product(dag *g, uint32_t a, uint32_t b);
/* The error with the other sign, which chains. */
fp3_pair fp3_two_product_less(dag *g, uint32_t a, uint32_t b);
/* The first where the exponent of a is not below that of b, or a is 0. */
fp3_pair fp3_fast_two_sum(dag *g, uint32_t a, uint32_t b);

/* A number 2^n, or -2^n, that is known; and x times one. */
int fp3_pair_is_power_of_two(const dag *g, fp3_pair x);
fp3_pair fp3_pair_scaled(dag *g, fp3_pair x, uint32_t power);

fp3_pair fp3_pair_negated(dag *g, fp3_pair x);
fp3_pair fp3_pair_add(dag *g, fp3_pair x, fp3_pair y); /* 3 u^2 */
fp3_pair fp3_pair_sub(dag *g, fp3_pair x, fp3_pair y); /* 3 u^2 */
fp3_pair fp3_pair_mul(dag *g, fp3_pair x, fp3_pair y); /* 5 u^2; by a float 3 u^2; by 2^n exact */
fp3_pair fp3_pair_quotient(dag *g, fp3_pair x, fp3_pair y); /* 32 u^2 */
fp3_pair fp3_pair_root(dag *g, fp3_pair x);                 /* 16 u^2 */
fp3_pair fp3_pair_inverse_root(dag *g, fp3_pair x);         /* 16 u^2 */

/* |y| not larger than |x|, or x 0: 4 u^2 of x. The words of y may overlap. */
fp3_pair fp3_pair_add_smaller(dag *g, fp3_pair x, fp3_pair y);
/* c + z p, where |z p| is not larger than |c|: an error of 4 u^2 of c, because the product is not
 * normalised first. */
fp3_pair fp3_pair_step(dag *g, fp3_pair c, fp3_pair z, fp3_pair p);
/* By Horner's rule, highest power first, where each term is larger than all later terms. The first
 * `singles` + 1 coefficients and their results are floats. */
fp3_pair fp3_pair_polynomial(dag *g, fp3_pair z, const double *coefficient, int count, int singles);
fp3_pair fp3_pair_number(dag *g, double number);

/* x - n (part[0] + part[1] + ...), where n times each part but the last is exact, and so is x less
 * the first `exact` of these products. The error is that of n times the last part, and of a sum of
 * small terms. */
fp3_pair fp3_pair_less_multiple(dag *g, fp3_pair x, uint32_t n, const double *part, int count,
                                int exact);
/* limit, if the first word is beyond it; x, if it is a NaN. */
fp3_pair fp3_pair_at_most(dag *g, double limit, fp3_pair x);
fp3_pair fp3_pair_at_least(dag *g, double limit, fp3_pair x);

/* 1 or 0, without a low word. */
fp3_pair fp3_pair_less(dag *g, fp3_pair x, fp3_pair y);
fp3_pair fp3_pair_less_equal(dag *g, fp3_pair x, fp3_pair y);
fp3_pair fp3_pair_select(dag *g, uint32_t condition, fp3_pair then, fp3_pair otherwise);
fp3_pair fp3_pair_abs(dag *g, fp3_pair x);

#endif
