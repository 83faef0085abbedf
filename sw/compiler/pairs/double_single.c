/* SPDX-License-Identifier: Apache-2.0 */
/* double_single.c - error-free transformations, and what is made of them. */
#include "double_single.h"

#include "compiler/functions/division.h"

#include <fp3/compile.h>
#include <fp3/isa.h>
#include <math.h>

#define SPLITTER 4097 /* 2^12 + 1: Veltkamp's, for 24 bits */

uint32_t fp3_pair_op(dag *g, uint32_t op, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t there =
        g->passes & FP3_PASS(FP3_PASS_COMMON) ? fp3_dag_find(g, op, a, b, c) : FP3_NONE;
    return there != FP3_NONE ? there : fp3_dag_make(g, op, a, b, c);
}

uint32_t fp3_pair_low(dag *g, fp3_pair x) {
    return x.low == FP3_NONE ? fp3_dag_number(g, 0) : x.low;
}

/* A number as FP32 has it; one that FP32 has not is refused elsewhere, as it is. */
static uint32_t rounded(known_table *table, uint32_t known) {
    const double number = table->list[known].number, single = (double)(float)number;
    return table->list[known].op != KNOWN_NUMBER || !isfinite(single) ||
                   (single == 0 && number != 0)
               ? known
               : fp3_known_number(table, single);
}

fp3_pair fp3_pair_known(dag *g, uint32_t known) {
    const uint32_t low = fp3_known_make(g->known, KNOWN_LOW, known, 0);
    return (fp3_pair){fp3_dag_known(g, rounded(g->known, known)),
                      fp3_known_is(g->known, low, 0) ? FP3_NONE : fp3_dag_known(g, low)};
}

/* ---- exact ---- */

fp3_pair fp3_two_sum(dag *g, uint32_t a, uint32_t b) {
    const uint32_t s = fp3_word_add(g, a, b), p = fp3_word_sub(g, s, b), q = fp3_word_sub(g, s, p);
    return (fp3_pair){s, fp3_word_add(g, fp3_word_sub(g, a, p), fp3_word_sub(g, b, q))};
}

fp3_pair fp3_two_difference(dag *g, uint32_t a, uint32_t b) {
    const uint32_t s = fp3_word_sub(g, a, b), p = fp3_word_add(g, s, b), q = fp3_word_sub(g, p, s);
    return (fp3_pair){s, fp3_word_sub(g, fp3_word_sub(g, a, p), fp3_word_sub(g, b, q))};
}

fp3_pair fp3_fast_two_sum(dag *g, uint32_t a, uint32_t b) {
    const uint32_t s = fp3_word_add(g, a, b);
    return (fp3_pair){s, fp3_word_sub(g, b, fp3_word_sub(g, s, a))};
}

/* Two halves of 12 bits, whose products are exact. The host splits what it knows. */
static fp3_pair split(dag *g, uint32_t a) {
    const uint32_t known = fp3_dag_is_known(g, a);
    if (known != FP3_NONE)
        return (fp3_pair){fp3_dag_known(g, fp3_known_make(g->known, KNOWN_HEAD, known, 0)),
                          fp3_dag_known(g, fp3_known_make(g->known, KNOWN_TAIL, known, 0))};
    const uint32_t c = fp3_word_mul(g, fp3_dag_number(g, SPLITTER), a),
                   head = fp3_word_add(g, fp3_word_sub(g, a, c), c);
    return (fp3_pair){head, fp3_word_sub(g, a, head)};
}

/* The rest of the product without the last pair of halves, tail by tail: the rounding error is
 * tails - rest (Dekker, 1971). */
typedef struct {
    uint32_t product, rest, tails;
} halved;

static halved product_of(dag *g, uint32_t a, uint32_t b) {
    const uint32_t product = fp3_word_mul(g, a, b);
    const fp3_pair x = split(g, a), y = split(g, b);
    uint32_t rest = fp3_word_sub(g, product, fp3_word_mul(g, x.high, y.high));
    rest = fp3_word_sub(g, rest, fp3_word_mul(g, x.low, y.high));
    rest = fp3_word_sub(g, rest, fp3_word_mul(g, x.high, y.low));
    return (halved){product, rest, fp3_word_mul(g, x.low, y.low)};
}

static int is_fused(const dag *g) { return (g->passes & FP3_PASS(FP3_PASS_FUSE)) != 0; }

fp3_pair fp3_two_product(dag *g, uint32_t a, uint32_t b) {
    if (is_fused(g)) {
        const uint32_t product = fp3_word_mul(g, a, b),
                       minus = fp3_word_sub(g, fp3_dag_number(g, -0.0), product);
        return (fp3_pair){product, fp3_pair_op(g, FP3_OP_FMADD, a, b, minus)};
    }
    const halved h = product_of(g, a, b);
    return (fp3_pair){h.product, fp3_word_sub(g, h.tails, h.rest)};
}

fp3_pair fp3_two_product_less(dag *g, uint32_t a, uint32_t b) {
    if (is_fused(g)) {
        const uint32_t product = fp3_word_mul(g, a, b);
        return (fp3_pair){product, fp3_pair_op(g, FP3_OP_FMSUB, a, b, product)};
    }
    const halved h = product_of(g, a, b);
    return (fp3_pair){h.product, fp3_word_sub(g, h.rest, h.tails)};
}

/* ---- sums ---- */

static int is_single(fp3_pair x) { return x.low == FP3_NONE; }

fp3_pair fp3_pair_negated(dag *g, fp3_pair x) {
    const uint32_t zero = fp3_dag_number(g, -0.0);
    return (fp3_pair){fp3_word_sub(g, zero, x.high),
                      is_single(x) ? FP3_NONE : fp3_word_sub(g, zero, x.low)};
}

/* Algorithm 6 of Joldes, Muller and Popescu: s the sum of the high words, t of the low ones. */
static fp3_pair joined(dag *g, fp3_pair s, fp3_pair t) {
    const fp3_pair v = fp3_fast_two_sum(g, s.high, fp3_word_add(g, s.low, t.high));
    return fp3_fast_two_sum(g, v.high, fp3_word_add(g, t.low, v.low));
}

fp3_pair fp3_pair_add(dag *g, fp3_pair x, fp3_pair y) {
    const fp3_pair s = fp3_two_sum(g, x.high, y.high);
    if (is_single(x) && is_single(y))
        return s;
    if (is_single(x) || is_single(y)) /* their Algorithm 4: 2 u^2 */
        return fp3_fast_two_sum(g, s.high, fp3_word_add(g, is_single(x) ? y.low : x.low, s.low));
    return joined(g, s, fp3_two_sum(g, x.low, y.low));
}

fp3_pair fp3_pair_sub(dag *g, fp3_pair x, fp3_pair y) {
    const fp3_pair s = fp3_two_difference(g, x.high, y.high);
    if (is_single(x) && is_single(y))
        return s;
    if (is_single(y))
        return fp3_fast_two_sum(g, s.high, fp3_word_add(g, x.low, s.low));
    if (is_single(x))
        return fp3_fast_two_sum(g, s.high, fp3_word_sub(g, s.low, y.low));
    return joined(g, s, fp3_two_difference(g, x.low, y.low));
}

/* ---- products ---- */

int fp3_pair_is_power_of_two(const dag *g, fp3_pair x) {
    const uint32_t known = fp3_dag_is_known(g, x.high);
    int exponent;
    return is_single(x) && known != FP3_NONE && g->known->list[known].op == KNOWN_NUMBER &&
           fabs(frexp(g->known->list[known].number, &exponent)) == 0.5;
}

fp3_pair fp3_pair_scaled(dag *g, fp3_pair x, uint32_t power) {
    if (fp3_dag_is_number(g, power, 1))
        return x;
    return (fp3_pair){fp3_word_mul(g, x.high, power),
                      is_single(x) ? FP3_NONE : fp3_word_mul(g, x.low, power)};
}

/* z - a b, rounded once. */
static uint32_t less_product(dag *g, uint32_t z, uint32_t a, uint32_t b) {
    return fp3_pair_op(g, FP3_OP_FMSUB, a, b, z);
}

/* a - b, where a is the larger one. */
static fp3_pair fast_two_difference(dag *g, uint32_t a, uint32_t b) {
    const uint32_t s = fp3_word_sub(g, a, b);
    return (fp3_pair){s, fp3_word_sub(g, fp3_word_sub(g, a, s), b)};
}

/* Algorithm 8: by a float. */
static fp3_pair times_single(dag *g, fp3_pair x, uint32_t y) {
    if (is_single(x))
        return fp3_two_product(g, x.high, y);
    const fp3_pair p = fp3_two_product_less(g, x.high, y);
    if (is_fused(g)) /* Algorithm 9 */
        return fast_two_difference(g, p.high, less_product(g, p.low, x.low, y));
    return fp3_fast_two_sum(g, p.high, fp3_word_sub(g, fp3_word_mul(g, x.low, y), p.low));
}

/* Algorithm 10. */
fp3_pair fp3_pair_mul(dag *g, fp3_pair x, fp3_pair y) {
    if (fp3_pair_is_power_of_two(g, x))
        return fp3_pair_scaled(g, y, x.high);
    if (fp3_pair_is_power_of_two(g, y))
        return fp3_pair_scaled(g, x, y.high);
    if (is_single(x) || is_single(y))
        return is_single(y) ? times_single(g, x, y.high) : times_single(g, y, x.high);
    const fp3_pair p = fp3_two_product_less(g, x.high, y.high);
    if (is_fused(g))
        return fast_two_difference(
            g, p.high, less_product(g, less_product(g, p.low, x.low, y.high), x.high, y.low));
    const uint32_t crossed =
        fp3_word_add(g, fp3_word_mul(g, x.high, y.low), fp3_word_mul(g, x.low, y.high));
    return fp3_fast_two_sum(g, p.high, fp3_word_sub(g, crossed, p.low));
}

fp3_pair fp3_pair_add_smaller(dag *g, fp3_pair x, fp3_pair y) {
    const fp3_pair s = fp3_fast_two_sum(g, x.high, y.high);
    uint32_t left = is_single(y) ? s.low : fp3_word_add(g, s.low, y.low);
    if (!is_single(x))
        left = fp3_word_add(g, x.low, left);
    return fp3_fast_two_sum(g, s.high, left);
}

/* The product stays as rounded and left: the sum makes a pair of it. */
fp3_pair fp3_pair_step(dag *g, fp3_pair c, fp3_pair z, fp3_pair p) {
    const fp3_pair most = fp3_two_product_less(g, z.high, p.high);
    uint32_t left = FP3_NONE;
    if (!is_single(p))
        left = fp3_word_mul(g, z.high, p.low);
    if (!is_single(z))
        left = left == FP3_NONE ? fp3_word_mul(g, z.low, p.high)
                                : fp3_word_add(g, left, fp3_word_mul(g, z.low, p.high));
    left = left == FP3_NONE ? fp3_word_sub(g, fp3_dag_number(g, 0), most.low)
                            : fp3_word_sub(g, left, most.low);
    return fp3_pair_add_smaller(g, c, (fp3_pair){most.high, left});
}

fp3_pair fp3_pair_number(dag *g, double number) {
    return fp3_pair_known(g, fp3_known_number(g->known, number));
}

fp3_pair fp3_pair_polynomial(dag *g, fp3_pair z, const double *coefficient, int count,
                             int singles) {
    uint32_t few = fp3_dag_number(g, (double)(float)coefficient[0]);
    for (int i = 1; i <= singles; i++)
        few = fp3_word_add(g, fp3_dag_number(g, (double)(float)coefficient[i]),
                           fp3_word_mul(g, few, z.high));
    fp3_pair p = {few, FP3_NONE};
    for (int i = singles + 1; i < count; i++)
        p = fp3_pair_step(g, fp3_pair_number(g, coefficient[i]), z, p);
    return p;
}

/* The first parts leave a float, each of the others a float and an error. */
fp3_pair fp3_pair_less_multiple(dag *g, fp3_pair x, uint32_t n, const double *part, int count,
                                int exact) {
    uint32_t most = x.high, left = x.low == FP3_NONE ? fp3_dag_number(g, 0) : FP3_NONE;
    for (int i = 0; i < exact; i++)
        most = fp3_word_sub(g, most, fp3_word_mul(g, n, fp3_dag_number(g, part[i])));
    for (int i = exact; i < count - 1; i++) {
        const fp3_pair s =
            fp3_two_difference(g, most, fp3_word_mul(g, n, fp3_dag_number(g, part[i])));
        most = s.high;
        left = left == FP3_NONE ? s.low : fp3_word_add(g, left, s.low);
        if (i == exact && !is_single(x)) {
            const fp3_pair with = fp3_two_sum(g, most, x.low);
            most = with.high;
            left = fp3_word_add(g, left, with.low);
        }
    }
    left = fp3_word_sub(g, left, fp3_word_mul(g, n, fp3_dag_number(g, part[count - 1])));
    return fp3_fast_two_sum(g, most, left);
}

/* ---- quotients and roots: those of floats, corrected once ---- */

static uint32_t one_over(dag *g, fp3_series s) {
    return fp3_corrected(g, fp3_term(fp3_dag_number(g, 1)), s).node;
}

/* q is off by 5 u at most, so x - q y is known within a few u^2 of x: all terms but the last are
 * exact (Sterbenz), and a reciprocal of 24 bits is enough. */
fp3_pair fp3_pair_quotient(dag *g, fp3_pair x, fp3_pair y) {
    const uint32_t over = one_over(g, fp3_reciprocal(g, y.high)), q = fp3_word_mul(g, x.high, over);
    const fp3_pair p = times_single(g, y, q);
    const uint32_t most = fp3_word_sub(g, x.high, p.high);
    const uint32_t left = is_single(x) ? fp3_word_sub(g, most, p.low)
                                       : fp3_word_add(g, most, fp3_word_sub(g, x.low, p.low));
    return fp3_fast_two_sum(g, q, fp3_word_mul(g, left, over));
}

/* q + (x - q^2)/(2 sqrt(x)) */
fp3_pair fp3_pair_root(dag *g, fp3_pair x) {
    const fp3_series s = fp3_finite_inverse_root(g, x.high);
    const uint32_t q = fp3_corrected(g, fp3_term(x.high), s).node;
    const uint32_t half = fp3_word_mul(g, fp3_dag_number(g, 0.5), one_over(g, s));
    const fp3_pair p = fp3_two_product_less(g, q, q);
    uint32_t left = fp3_word_add(g, fp3_word_sub(g, x.high, p.high), p.low);
    if (!is_single(x))
        left = fp3_word_add(g, left, x.low);
    return fp3_fast_two_sum(g, q, fp3_word_mul(g, left, half));
}

/* y + y/2 (1 - x y^2). The next term, 3/8 (1 - x y^2)^2 y, is 6 u^2 at most. */
fp3_pair fp3_pair_inverse_root(dag *g, fp3_pair x) {
    const uint32_t y = one_over(g, fp3_inverse_root(g, x.high));
    const fp3_pair p = times_single(g, times_single(g, x, y), y);
    const uint32_t left = fp3_word_sub(g, fp3_word_sub(g, fp3_dag_number(g, 1), p.high), p.low);
    return fp3_fast_two_sum(g, y,
                            fp3_word_mul(g, fp3_word_mul(g, fp3_dag_number(g, 0.5), y), left));
}

/* ---- choices ---- */

/* The high words decide, unless they are equal. */
static fp3_pair compared(dag *g, uint32_t op, fp3_pair x, fp3_pair y) {
    if (is_single(x) && is_single(y))
        return (fp3_pair){fp3_pair_op(g, op, x.high, y.high, FP3_NONE), FP3_NONE};
    const uint32_t less = fp3_pair_op(g, FP3_OP_LT, x.high, y.high, FP3_NONE);
    const uint32_t at_most = fp3_pair_op(g, FP3_OP_LE, x.high, y.high, FP3_NONE);
    const uint32_t low = fp3_pair_op(g, op, fp3_pair_low(g, x), fp3_pair_low(g, y), FP3_NONE);
    return (fp3_pair){fp3_pair_op(g, FP3_OP_SEL, less, fp3_word_mul(g, at_most, low), less),
                      FP3_NONE};
}

fp3_pair fp3_pair_less(dag *g, fp3_pair x, fp3_pair y) { return compared(g, FP3_OP_LT, x, y); }

fp3_pair fp3_pair_less_equal(dag *g, fp3_pair x, fp3_pair y) {
    return compared(g, FP3_OP_LE, x, y);
}

fp3_pair fp3_pair_select(dag *g, uint32_t condition, fp3_pair then, fp3_pair otherwise) {
    fp3_pair made = {fp3_pair_op(g, FP3_OP_SEL, then.high, otherwise.high, condition), FP3_NONE};
    if (!is_single(then) || !is_single(otherwise))
        made.low = fp3_pair_op(g, FP3_OP_SEL, fp3_pair_low(g, then), fp3_pair_low(g, otherwise),
                               condition);
    return made;
}

static fp3_pair clamped(dag *g, uint32_t is_beyond, double limit, fp3_pair x) {
    return fp3_pair_select(g, is_beyond, (fp3_pair){fp3_dag_number(g, limit), FP3_NONE}, x);
}

fp3_pair fp3_pair_at_most(dag *g, double limit, fp3_pair x) {
    return clamped(g, fp3_pair_op(g, FP3_OP_LT, fp3_dag_number(g, limit), x.high, FP3_NONE), limit,
                   x);
}

fp3_pair fp3_pair_at_least(dag *g, double limit, fp3_pair x) {
    return clamped(g, fp3_pair_op(g, FP3_OP_LT, x.high, fp3_dag_number(g, limit), FP3_NONE), limit,
                   x);
}

fp3_pair fp3_pair_abs(dag *g, fp3_pair x) {
    const uint32_t high = fp3_pair_op(g, FP3_OP_ABS, x.high, FP3_NONE, FP3_NONE);
    if (is_single(x))
        return (fp3_pair){high, FP3_NONE};
    const uint32_t is_negative = fp3_pair_op(g, FP3_OP_LT, x.high, fp3_dag_number(g, 0), FP3_NONE);
    return (fp3_pair){high,
                      fp3_pair_op(g, FP3_OP_SEL, fp3_word_sub(g, fp3_dag_number(g, -0.0), x.low),
                                  x.low, is_negative)};
}
