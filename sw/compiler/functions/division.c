/* SPDX-License-Identifier: Apache-2.0 */
/* division.c - a series makes an estimate of 9 bits a quotient or root of 24; with fewer bits its
 * first term is enough. */
#include "division.h"

#include "compiler/value/ops.h"

#include <math.h>

/* With e = 1 - b y, x/b is x y / (1 - e), and 1/(1 - e) = 1 + e + e^2 + O(e^3), where e^3 is below
 * half a unit in the last place. y is never too large, so b y is in [1/2, 1]: rounding changes it
 * by at most 2^-25, and 1 - b y is exact. */
fp3_series fp3_reciprocal(dag *g, uint32_t b) {
    const uint32_t y = op1(g, FP3_OP_RCP, b);
    if (g->is_direct)
        return (fp3_series){y, FP3_NONE};
    const uint32_t e = sub(g, num(g, 1), mul(g, b, y));
    return (fp3_series){y, g->terms == 1 ? e : add(g, e, mul(g, e, e))};
}

/* Likewise x/sqrt(b): with e = 1 - b y^2, (1 - e)^-1/2 = 1 + e/2 + 3/8 e^2 + O(e^3). Flushed, y^2
 * may be 0, so that b y is made first, which costs half a unit in the last place. */
static fp3_series root_series(dag *g, uint32_t b, uint32_t y) {
    if (g->is_direct)
        return (fp3_series){y, FP3_NONE};
    const uint32_t product = g->is_flushed ? mul(g, mul(g, b, y), y) : mul(g, b, mul(g, y, y));
    const uint32_t e = sub(g, num(g, 1), product), half = num(g, 0.5);
    return (fp3_series){y,
                        mul(g, e, g->terms == 1 ? half : add(g, half, mul(g, num(g, 0.375), e)))};
}

fp3_series fp3_inverse_root(dag *g, uint32_t b) {
    return root_series(g, b, op1(g, FP3_OP_RSQRT, b));
}

static uint32_t corrected(dag *g, uint32_t estimate, uint32_t correction) {
    return correction == FP3_NONE ? estimate : add(g, estimate, mul(g, estimate, correction));
}

term fp3_corrected(dag *g, term x, fp3_series s) {
    const int is_one = fp3_dag_is_number(g, x.node, 1);
    const uint32_t q = is_one ? s.estimate : mul(g, x.node, s.estimate);
    return (term){corrected(g, q, s.correction), x.is_negative};
}

/* Without infinities 1/sqrt(0) overflows, but its product with a small x does not, so 1/sqrt(b) is
 * computed first. */
term fp3_over_root(dag *g, term x, fp3_series s) {
    return g->is_finite ? fp3_term_mul(g, x, fp3_corrected(g, one(g), s)) : fp3_corrected(g, x, s);
}

/* ---- where subnormal numbers are flushed ---- */

/* A numerator up to 1 needs no scaling: the quotient is flushed wherever the reciprocal is. Without
 * infinities the numerator has to be large enough that x/0 overflows. */
static int needs_no_scale(const dag *g, uint32_t node) {
    const uint32_t id = fp3_dag_is_known(g, node);
    const int is_number = id != FP3_NONE && g->known->list[id].op == KNOWN_NUMBER;
    const double size = is_number ? fabs(g->known->list[id].number) : INFINITY;
    return size <= 1 && size >= (g->is_finite ? 0.5 : 0);
}

/* Without infinities 1/0 has to overflow, whatever the numerator: twice the estimate of 1/0 does.
 */
static uint32_t without_zero(dag *g, uint32_t y) { return g->is_finite ? add(g, y, y) : y; }

/* The estimate of 1/b from 2^126 on is 0. So b is scaled to be less: numbers end at 2^128, or at
 * 2^129 if exponent 255 is a number's. */
term fp3_quotient(dag *g, term x, uint32_t b) {
    if (!g->is_flushed || needs_no_scale(g, x.node))
        return fp3_corrected(g, x, fp3_reciprocal(g, b));
    fp3_series s = fp3_reciprocal(g, mul(g, b, num(g, g->is_finite ? 0.125 : 0.25)));
    s.estimate = without_zero(g, s.estimate);
    const term larger = fp3_corrected(g, x, s);
    return fp3_term_mul(g, larger, fp3_term(num(g, g->is_finite ? 0.0625 : 0.25)));
}

/* Where subnormal numbers are flushed, r^n may be 0 though x r^n is not: x is multiplied by r^(n/2)
 * twice, so that nothing on the way is less than both the result and x. */
term fp3_times_power(dag *g, term x, term r, unsigned n) {
    const int is_one = fp3_dag_is_number(g, x.node, 1) && !x.is_negative;
    if (!g->is_flushed || n == 1 || is_one) {
        const term power = fp3_term_power(g, r, n);
        return is_one ? power : fp3_term_mul(g, x, power);
    }
    const term half = fp3_term_power(g, r, n / 2);
    const term product = fp3_term_mul(g, fp3_term_mul(g, x, half), half);
    return n % 2 ? fp3_term_mul(g, product, r) : product;
}

/* x y^n is multiplied by (1 + t)^n, as y t may be 0. */
term fp3_over_power(dag *g, term x, uint32_t b, unsigned n) {
    const fp3_series s = fp3_reciprocal(g, b);
    if (!g->is_flushed || fp3_dag_is_number(g, x.node, 1))
        return fp3_times_power(g, x, fp3_corrected(g, one(g), s), n);
    const term y = fp3_term(without_zero(g, s.estimate));
    if (s.correction == FP3_NONE)
        return fp3_times_power(g, x, y, n);
    const double unit = g->is_finite ? 0.5 : 1;
    const uint32_t factor = add(g, num(g, unit), mul(g, num(g, unit), s.correction));
    return fp3_term_mul(g, fp3_times_power(g, x, y, n), fp3_term_power(g, fp3_term(factor), n));
}

/* The estimate of 2^-126, and the limit of corrections of normal numbers. Estimates of smaller
 * numbers are infinite. An exact reciprocal root is above 2^74.5 for 0 alone. Without infinities b
 * y is 0 for b = 0, and overflows for a negative b. */
#define MOST 0x1p63
#define MOST_DIRECT 0x1p75
#define MOST_CORRECTION(g) ((g)->terms == 1 ? 0x1p-5 : 0x1p-8)

static uint32_t bounded(dag *g, uint32_t y) {
    return op2(g, FP3_OP_MIN, num(g, g->is_direct ? MOST_DIRECT : MOST), y);
}

fp3_series fp3_finite_inverse_root(dag *g, uint32_t b) {
    const uint32_t y = op1(g, FP3_OP_RSQRT, b);
    return root_series(g, b, g->is_finite ? y : bounded(g, y));
}

static uint32_t root_of_series(dag *g, uint32_t b, fp3_series s) {
    return corrected(g, mul(g, b, s.estimate), s.correction);
}

uint32_t fp3_root(dag *g, uint32_t b) {
    return root_of_series(g, b, fp3_finite_inverse_root(g, b));
}

/* Of 0 the correction is a NaN: then min is its second operand. */
uint32_t fp3_root_beside_inverse(dag *g, uint32_t b) {
    if (g->is_direct)
        return fp3_root(g, b);
    const fp3_series s = fp3_inverse_root(g, b);
    if (g->is_finite)
        return root_of_series(g, b, s);
    const uint32_t t = op2(g, FP3_OP_MIN, s.correction, num(g, MOST_CORRECTION(g)));
    return root_of_series(g, b, (fp3_series){bounded(g, s.estimate), t});
}
