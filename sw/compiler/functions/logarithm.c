/* SPDX-License-Identifier: Apache-2.0 */
/* logarithm.c - x as m 2^-e with m near 1. tools/polynomials.py computes the coefficients; highest
 * power first. */
#include "logarithm.h"

#include "compiler/value/ops.h"
#include "division.h"
#include "exponential.h"
#include "functions.h"

#include <math.h>

#define ROOT_HALF 0.70710678118654752
#define TINY                                                                                       \
    0x1p-100 /* below this x is multiplied by 2^32, else by 1/4: all that follows is normal */

/* (log(1 + r) - r + r^2/2)/r^3 for 1 + r from sqrt(1/2) to sqrt(2). */
static const double log_rest[] = {0.0869942605, -0.142687127, 0.149155915, -0.165774733,
                                  0.199629858,  -0.250013381, 0.333339125};

/* The scale for x: neither the product nor its power of two is subnormal or overflows. 0 for a
 * negative x: with one infinite exponent from 0 and another from x, e is inf - inf. */
static uint32_t scale_of(dag *g, uint32_t x) {
    const uint32_t is_tiny = op2(g, FP3_OP_LT, x, num(g, TINY));
    return sel(g, is_tiny, num(g, 0x1p32), num(g, 0.25));
}

static uint32_t is_negative(dag *g, uint32_t x) { return op2(g, FP3_OP_LT, x, num(g, 0)); }

uint32_t fp3_log_scale(dag *g, uint32_t x) {
    return sel(g, is_negative(g, x), num(g, 0), scale_of(g, x));
}

fp3_log_parts fp3_log_parts_of(dag *g, uint32_t scaled, uint32_t scale) {
    const uint32_t lower = op1(g, FP3_OP_LOGB, mul(g, scaled, num(g, ROOT_HALF)));
    const uint32_t k = sub(g, num(g, -1), lower);
    const uint32_t finite = fp3_at_least(g, -126, fp3_at_most(g, 127, k));
    const uint32_t power = op1(g, FP3_OP_EXP2, finite);
    return (fp3_log_parts){
        .m = mul(g, scaled, power), .power = power, .e = add(g, k, op1(g, FP3_OP_LOGB, scale))};
}

/* log(1 + r) - r. The leading coefficient is positive: so that of infinity is. */
static uint32_t curve_of(dag *g, uint32_t r) {
    const uint32_t curve = add(g, num(g, -0.5), mul(g, r, polynomial(g, r, log_rest, 7)));
    return mul(g, mul(g, r, r), curve);
}

uint32_t fp3_log_near_1(dag *g, uint32_t m) {
    const uint32_t r = add(g, m, num(g, -1));
    return add(g, r, curve_of(g, r));
}

static fp3_log_parts parts_of(dag *g, uint32_t x) {
    const uint32_t scale = fp3_log_scale(g, x);
    return fp3_log_parts_of(g, mul(g, x, scale), scale);
}

/* -e ln 2 + log(1 + r) */
static term log_of(dag *g, uint32_t e, uint32_t r) {
    const uint32_t low = sub(g, curve_of(g, r), mul(g, e, num(g, FP3_LN2_LOW)));
    return fp3_term(sub(g, add(g, r, low), mul(g, e, num(g, FP3_LN2_HIGH))));
}

term fp3_log(dag *g, term x) {
    const fp3_log_parts p = parts_of(g, fp3_term_value(g, x));
    return log_of(g, p.e, add(g, p.m, num(g, -1)));
}

/* The logarithm of u = 1 + x, with the rounding error of u added to r: if e is 0, r is x. u is
 * never subnormal. The rest of infinity is infinite. */
term fp3_log1p(dag *g, term at) {
    const uint32_t x = fp3_term_value(g, at), u = add(g, x, num(g, 1));
    const uint32_t rest = sub(g, x, sub(g, fp3_at_most(g, 0x1.fffffep127, u), num(g, 1)));
    const uint32_t scale = sel(g, is_negative(g, u), num(g, 0), num(g, 0.25));
    const fp3_log_parts p = fp3_log_parts_of(g, mul(g, u, scale), scale);
    const uint32_t power = mul(g, p.power, num(g, 0.25));
    return log_of(g, p.e, add(g, add(g, p.m, num(g, -1)), mul(g, rest, power)));
}

/* -e + log2 m, where log2 m = r + (r (1/ln 2 - 1) + (log m - r)/ln 2): r is exact. For a power of
 * two the result is the exponent itself. */
term fp3_log2(dag *g, term x) {
    const fp3_log_parts p = parts_of(g, fp3_term_value(g, x));
    const uint32_t r = add(g, p.m, num(g, -1));
    const uint32_t curve = mul(g, curve_of(g, r), num(g, M_LOG2E));
    const uint32_t rest = add(g, mul(g, r, num(g, M_LOG2E - 1)), curve);
    return fp3_term(sub(g, add(g, r, rest), p.e));
}

/* ---- powers ---- */

/* (atanh(s)/s - 1)/z for z = s^2 <= 0.0295. */
static const double atanh_rest[] = {0.117898636, 0.142687306, 0.200001657, 0.333333313};

/* A number as one with 12 significant bits and what is left. */
typedef struct {
    uint32_t high, low;
} halves;

static uint32_t known2(dag *g, known_op op, uint32_t a, uint32_t b) {
    return fp3_known_make(g->known, op, a, b);
}

/* Of a known value, by Dekker's product, in double. */
static halves known_halves(dag *g, uint32_t n) {
    const uint32_t c = known2(g, KNOWN_MUL, n, fp3_known_number(g->known, 0x1p41 + 1));
    const uint32_t high = known2(g, KNOWN_SUB, c, known2(g, KNOWN_SUB, c, n));
    return (halves){fp3_dag_known(g, high), fp3_dag_known(g, known2(g, KNOWN_SUB, n, high))};
}

/* log(m)/2 = atanh(a/b) with a = m - 1 and b = m + 1, as a first part s of 11 bits, which is about
 * a/b, and the rest: together about 31 bits, which leaves a power its 24 behind a product with its
 * exponent. atanh(a/b) - atanh(s) is atanh((a - s b)/(b - s a)), which equals its small argument. s
 * b is s m + s: all sums of a - s b but the last are exact. */
static halves half_log(dag *g, uint32_t m) {
    const uint32_t a = add(g, m, num(g, -1)), b = add(g, m, num(g, 1));
    const uint32_t near = mul(g, a, op1(g, FP3_OP_RCP, b)), c = mul(g, near, num(g, 0x1p13 + 1));
    const uint32_t s = sub(g, c, sub(g, c, near)), z = mul(g, s, s);
    const uint32_t m1 = mul(g, op1(g, FP3_OP_RINT, mul(g, m, num(g, 0x1p12))), num(g, 0x1p-12));
    const uint32_t left = sub(g, sub(g, sub(g, a, s), mul(g, s, m1)), mul(g, s, sub(g, m, m1)));
    const fp3_series over = fp3_reciprocal(g, sub(g, b, mul(g, s, a)));
    const uint32_t curve = mul(g, z, polynomial(g, z, atanh_rest, 4));
    return (halves){s, add(g, fp3_corrected(g, fp3_term(left), over).node, mul(g, s, curve))};
}

/* 2^t where t = n log2(x) is a sum: exact products, one of them with a power of x's exponent, and
 * the rest. */
static uint32_t power_of_parts(dag *g, fp3_log_parts p, uint32_t n) {
    const uint32_t over_ln2 = known2(g, KNOWN_MUL, n, fp3_known_number(g->known, 2 / M_LN2));
    const halves y = known_halves(g, n), w = known_halves(g, over_ln2), l = half_log(g, p.m);
    const uint32_t from_e = mul(g, y.high, p.e), from_m = mul(g, w.high, l.high);
    const uint32_t small =
        sub(g, add(g, mul(g, fp3_dag_known(g, over_ln2), l.low), mul(g, w.low, l.high)),
            mul(g, y.low, p.e));
    const uint32_t t = add(g, sub(g, from_m, from_e), small);
    const uint32_t k = fp3_at_least(g, -150, fp3_at_most(g, 127, op1(g, FP3_OP_RINT, t)));
    const uint32_t f = add(g, sub(g, from_m, add(g, from_e, k)), small);
    return fp3_exp_scaled(g, mul(g, fp3_at_least(g, -1, f), num(g, M_LN2)), k);
}

/* 0 and infinity have a large exponent in place of an infinite one, so that its product with n = 0
 * is 0. */
static fp3_log_parts finite_parts(dag *g, uint32_t scaled, uint32_t scale) {
    fp3_log_parts p = fp3_log_parts_of(g, scaled, scale);
    p.m = fp3_at_most(g, 2, p.m);
    p.e = fp3_at_least(g, -0x1p60, fp3_at_most(g, 0x1p60, p.e));
    return p;
}

uint32_t fp3_power(dag *g, uint32_t x, uint32_t n) {
    const uint32_t sign = fp3_known_make(g->known, KNOWN_SIGN, n, 0);
    const uint32_t exponent = fp3_known_make(g->known, KNOWN_EXPONENT, n, 0);
    if (fp3_known_is(g->known, sign, 0)) {
        const uint32_t scale = fp3_log_scale(g, x);
        return power_of_parts(g, finite_parts(g, mul(g, x, scale), scale), exponent);
    }
    const uint32_t size = op1(g, FP3_OP_ABS, x);
    const uint32_t turn = sel(g, is_negative(g, x), fp3_dag_known(g, sign), num(g, 1));
    const uint32_t scale = mul(g, scale_of(g, size), turn);
    const uint32_t scaled = op1(g, FP3_OP_ABS, mul(g, size, scale));
    return mul(g, power_of_parts(g, finite_parts(g, scaled, scale), exponent), turn);
}
