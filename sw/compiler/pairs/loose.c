/* SPDX-License-Identifier: Apache-2.0 */
/* loose.c - see loose.h. */
#include "loose.h"

#include <fp3/isa.h>

static int is_single(fp3_loose x) { return x.words.low == FP3_NONE; }

static unsigned larger(unsigned a, unsigned b) { return a > b ? a : b; }

fp3_loose fp3_loose_of(fp3_pair x) { return (fp3_loose){x, 0, 0, x.low == FP3_NONE ? 0 : 1}; }

fp3_loose fp3_loose_negated(dag *g, fp3_loose x) {
    x.words.high = fp3_word_sub(g, fp3_dag_number(g, -0.0), x.words.high);
    x.is_less = !is_single(x) && !x.is_less;
    return x;
}

/* base + word, or base - word. */
static uint32_t with(dag *g, uint32_t base, uint32_t word, int is_less) {
    return (is_less ? fp3_word_sub : fp3_word_add)(g, base, word);
}

/* As fp3_fast_two_sum. */
static fp3_pair settled(dag *g, fp3_loose x) {
    if (!x.is_less)
        return fp3_fast_two_sum(g, x.words.high, x.words.low);
    const uint32_t s = fp3_word_sub(g, x.words.high, x.words.low);
    return (fp3_pair){s, fp3_word_sub(g, fp3_word_sub(g, x.words.high, s), x.words.low)};
}

/* If a sum has cancelled, the first word may be the smaller one; the rounding error is then u of
 * the second word. */
static fp3_loose bounded(dag *g, fp3_loose x) {
    return x.spread > FP3_SPREAD_MOST ? (fp3_loose){settled(g, x), 0, 1, 1} : x;
}

/* base +- a +- b, the same for b and a. A word that is FP3_NONE is none. */
static uint32_t with_both(dag *g, uint32_t base, uint32_t a, int is_a_less, uint32_t b,
                          int is_b_less) {
    if (a == FP3_NONE || b == FP3_NONE)
        return a != FP3_NONE   ? with(g, base, a, is_a_less)
               : b != FP3_NONE ? with(g, base, b, is_b_less)
                               : base;
    if (is_a_less == is_b_less)
        return with(g, base, fp3_word_add(g, a, b), is_a_less);
    return fp3_word_add(g, base, is_a_less ? fp3_word_sub(g, b, a) : fp3_word_sub(g, a, b));
}

static int is_zero(const dag *g, fp3_loose x) {
    return is_single(x) &&
           (fp3_dag_is_number(g, x.words.high, 0) || fp3_dag_is_number(g, x.words.high, -0.0));
}

/* A zero changes nothing, so that words do not depend on whether a pass has dropped it. */
static fp3_loose sum(dag *g, fp3_loose x, fp3_loose y, int is_difference) {
    if (is_zero(g, y))
        return x;
    if (is_zero(g, x))
        return is_difference ? fp3_loose_negated(g, y) : y;
    fp3_pair s = (is_difference ? fp3_two_difference : fp3_two_sum)(g, x.words.high, y.words.high);
    s.low = with_both(g, s.low, x.words.low, x.is_less, y.words.low, y.is_less != is_difference);
    return bounded(
        g, (fp3_loose){s, 0, !is_single(x) || !is_single(y), 1 + larger(x.spread, y.spread)});
}

fp3_loose fp3_loose_add(dag *g, fp3_loose x, fp3_loose y) { return sum(g, x, y, 0); }

fp3_loose fp3_loose_sub(dag *g, fp3_loose x, fp3_loose y) { return sum(g, x, y, 1); }

static fp3_loose scaled(dag *g, fp3_loose x, uint32_t power) {
    x.words = fp3_pair_scaled(g, x.words, power);
    return x;
}

static int is_known(const dag *g, fp3_loose x) {
    return fp3_dag_is_known(g, x.words.high) != FP3_NONE;
}

static uint32_t cross(dag *g, fp3_loose low_of, fp3_loose high_of) {
    return is_single(low_of) ? FP3_NONE : fp3_word_mul(g, low_of.words.low, high_of.words.high);
}

/* The error of the product of the first words is computed with the other sign, and so are all terms
 * added to it. A known value is always the same operand, so both cross products chain. */
fp3_loose fp3_loose_mul(dag *g, fp3_loose x, fp3_loose y) {
    if (is_zero(g, x) || is_zero(g, y))
        return is_zero(g, x) ? x : y;
    if (fp3_pair_is_power_of_two(g, x.words))
        return scaled(g, y, x.words.high);
    if (fp3_pair_is_power_of_two(g, y.words))
        return scaled(g, x, y.words.high);
    if (is_known(g, x) && !is_known(g, y))
        return fp3_loose_mul(g, y, x);
    fp3_pair p = fp3_two_product_less(g, x.words.high, y.words.high);
    const uint32_t of_x = cross(g, x, y), of_y = cross(g, y, x);
    if (is_known(g, y) && !is_known(g, x) && of_x != FP3_NONE && of_y != FP3_NONE)
        p.low = with(g, with(g, p.low, of_x, !x.is_less), of_y, !y.is_less);
    else
        p.low = with_both(g, p.low, of_x, !x.is_less, of_y, !y.is_less);
    return bounded(g, (fp3_loose){p, 1, !is_single(x) || !is_single(y), 1 + x.spread + y.spread});
}

fp3_pair fp3_loose_pair(dag *g, fp3_loose x) {
    if (x.is_rough)
        return (x.is_less ? fp3_two_difference : fp3_two_sum)(g, x.words.high, x.words.low);
    if (x.is_less)
        x.words.low = fp3_word_sub(g, fp3_dag_number(g, 0), x.words.low);
    return x.words;
}

uint32_t fp3_loose_first(dag *g, fp3_loose x) {
    return x.is_rough ? with(g, x.words.high, x.words.low, x.is_less) : x.words.high;
}
