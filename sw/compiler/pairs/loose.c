/* loose.c - see loose.h. */
#include "loose.h"

#include <fp3/isa.h>

static uint32_t add(dag *g, uint32_t a, uint32_t b) {
    return fp3_pair_op(g, FP3_OP_ADD, a, b, FP3_NONE);
}
static uint32_t sub(dag *g, uint32_t a, uint32_t b) {
    return fp3_pair_op(g, FP3_OP_SUB, a, b, FP3_NONE);
}
static uint32_t mul(dag *g, uint32_t a, uint32_t b) {
    return fp3_pair_op(g, FP3_OP_MUL, a, b, FP3_NONE);
}

static int is_single(fp3_loose x) { return x.words.low == FP3_NONE; }

static unsigned larger(unsigned a, unsigned b) { return a > b ? a : b; }

fp3_loose fp3_loose_of(fp3_pair x) { return (fp3_loose){x, 0, 0, x.low == FP3_NONE ? 0 : 1}; }

fp3_loose fp3_loose_negated(dag *g, fp3_loose x) {
    x.words.high = sub(g, fp3_dag_number(g, -0.0), x.words.high);
    x.is_less = !is_single(x) && !x.is_less;
    return x;
}

/* base + word, or base - word. */
static uint32_t with(dag *g, uint32_t base, uint32_t word, int is_less) {
    return (is_less ? sub : add)(g, base, word);
}

/* As fp3_fast_two_sum. */
static fp3_pair settled(dag *g, fp3_loose x) {
    if (!x.is_less)
        return fp3_fast_two_sum(g, x.words.high, x.words.low);
    const uint32_t s = sub(g, x.words.high, x.words.low);
    return (fp3_pair){s, sub(g, sub(g, x.words.high, s), x.words.low)};
}

/* Where a sum has cancelled, the first word may be the smaller one: then what is rounded is u of the second. */
static fp3_loose bounded(dag *g, fp3_loose x) {
    return x.spread > FP3_SPREAD_MOST ? (fp3_loose){settled(g, x), 0, 1, 1} : x;
}

static fp3_loose sum(dag *g, fp3_loose x, fp3_loose y, int is_difference) {
    fp3_pair s = (is_difference ? fp3_two_difference : fp3_two_sum)(g, x.words.high, y.words.high);
    if (!is_single(x))
        s.low = with(g, s.low, x.words.low, x.is_less);
    if (!is_single(y))
        s.low = with(g, s.low, y.words.low, y.is_less != is_difference);
    return bounded(
        g, (fp3_loose){s, 0, !is_single(x) || !is_single(y), 1 + larger(x.spread, y.spread)});
}

fp3_loose fp3_loose_add(dag *g, fp3_loose x, fp3_loose y) { return sum(g, x, y, 0); }

fp3_loose fp3_loose_sub(dag *g, fp3_loose x, fp3_loose y) { return sum(g, x, y, 1); }

static fp3_loose scaled(dag *g, fp3_loose x, uint32_t power) {
    x.words = fp3_pair_scaled(g, x.words, power);
    return x;
}

/* The error of the product of the first words is known with the other sign, and so is all that is added to it. */
fp3_loose fp3_loose_mul(dag *g, fp3_loose x, fp3_loose y) {
    if (fp3_pair_is_power_of_two(g, x.words))
        return scaled(g, y, x.words.high);
    if (fp3_pair_is_power_of_two(g, y.words))
        return scaled(g, x, y.words.high);
    fp3_pair p = fp3_two_product_less(g, x.words.high, y.words.high);
    if (!is_single(x))
        p.low = with(g, p.low, mul(g, x.words.low, y.words.high), !x.is_less);
    if (!is_single(y))
        p.low = with(g, p.low, mul(g, x.words.high, y.words.low), !y.is_less);
    return bounded(g, (fp3_loose){p, 1, !is_single(x) || !is_single(y), 1 + x.spread + y.spread});
}

fp3_pair fp3_loose_pair(dag *g, fp3_loose x) {
    if (x.is_rough)
        return (x.is_less ? fp3_two_difference : fp3_two_sum)(g, x.words.high, x.words.low);
    if (x.is_less)
        x.words.low = sub(g, fp3_dag_number(g, 0), x.words.low);
    return x.words;
}

uint32_t fp3_loose_first(dag *g, fp3_loose x) {
    return x.is_rough ? with(g, x.words.high, x.words.low, x.is_less) : x.words.high;
}
