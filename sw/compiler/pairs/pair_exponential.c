/* SPDX-License-Identifier: Apache-2.0 */
/* pair_exponential.c - exponentials and logarithms of double-single. tools/polynomials.py computes
 * the coefficients; highest power first. */
#include "compiler/functions/exponential.h"
#include "compiler/functions/logarithm.h"
#include "pair_functions.h"

#include <fp3/isa.h>
#include <math.h>

/* (r/2 coth(r/2) - 1)/z of z = r^2, |r| <= ln(2)/2. */
static const double half_coth_48[] = {2.0718356944429436e-08, -8.267029017803099e-07,
                                      3.306878235167326e-05, -0.001388888888878091,
                                      0.0833333333333333};

/* ln 2 in parts: the first two have 15 bits, and k has 8. */
static const double ln2_part[] = {FP3_LN2_HIGH, 0x1.7f7cp-20, 0x1.1cf79ap-36};

static uint32_t op(dag *g, uint32_t op, uint32_t a, uint32_t b) {
    return fp3_pair_op(g, op, a, b, FP3_NONE);
}
static uint32_t num(dag *g, double number) { return fp3_dag_number(g, number); }

static fp3_pair scaled(dag *g, fp3_pair x, uint32_t power) {
    return (fp3_pair){op(g, FP3_OP_MUL, x.high, power),
                      x.low == FP3_NONE ? FP3_NONE : op(g, FP3_OP_MUL, x.low, power)};
}

/* e^r - 1 = r/(c - r/2) with c = r/2 coth(r/2): as good near 0. */
static fp3_pair grown_by(dag *g, fp3_pair r) {
    const fp3_pair z = fp3_pair_mul(g, r, r), one = fp3_pair_number(g, 1);
    const fp3_pair c = fp3_pair_step(g, one, z, fp3_pair_polynomial(g, z, half_coth_48, 5, 2));
    return fp3_pair_quotient(g, r, fp3_pair_add_smaller(g, c, scaled(g, r, num(g, -0.5))));
}

/* e^x = 2^k (1 + grown) */
typedef struct {
    uint32_t k;
    fp3_pair grown;
} parts;

static parts parts_of(dag *g, fp3_pair x) {
    const uint32_t k =
        fp3_pair_op(g, FP3_OP_RINT, op(g, FP3_OP_MUL, x.high, num(g, M_LOG2E)), FP3_NONE, FP3_NONE);
    return (parts){k, grown_by(g, fp3_pair_less_multiple(g, x, k, ln2_part, 3, 1))};
}

static uint32_t power_of_two(dag *g, uint32_t k, double more) {
    return fp3_pair_op(g, FP3_OP_EXP2, op(g, FP3_OP_ADD, k, num(g, more)), FP3_NONE, FP3_NONE);
}

/* From 89 on and from -105 down the result is that of these: overflow, and 0. */
fp3_pair fp3_pair_exp(dag *g, fp3_pair x) {
    const parts p = parts_of(g, fp3_pair_at_least(g, -105, fp3_pair_at_most(g, 89, x)));
    const fp3_pair most = fp3_pair_add_smaller(g, fp3_pair_number(g, 1), p.grown);
    return scaled(g, scaled(g, most, power_of_two(g, p.k, -1)), num(g, 2));
}

/* Of x >= 0: f = (e^x - 1)/2 and q = f/(1 + 2 f), so that sinh(x) = f + q and cosh(x) = f + 1 - q.
 * Where f is large, q is 1/2. */
typedef struct {
    fp3_pair f, q;
} hyperbolic;

static fp3_pair half_grown(dag *g, fp3_pair x) {
    const parts p = parts_of(g, x);
    const uint32_t quarter = power_of_two(g, p.k, -2);
    const fp3_pair rest = fp3_two_difference(g, quarter, num(g, 0.25));
    return scaled(g, fp3_pair_add(g, rest, scaled(g, p.grown, quarter)), num(g, 2));
}

/* From 89 on it overflows, below -40 it is -1. */
fp3_pair fp3_pair_expm1(dag *g, fp3_pair x) {
    return scaled(g, half_grown(g, fp3_pair_at_least(g, -40, fp3_pair_at_most(g, 89, x))),
                  num(g, 2));
}

/* e^x/(1 + e^x): beyond 40 it is 1. */
fp3_pair fp3_pair_logistic(dag *g, fp3_pair x) {
    const fp3_pair e = fp3_pair_exp(g, fp3_pair_at_most(g, 40, x));
    return fp3_pair_quotient(g, e, fp3_pair_add(g, fp3_pair_number(g, 1), e));
}

static hyperbolic hyperbolic_of(dag *g, fp3_pair x) {
    const fp3_pair f = half_grown(g, fp3_pair_at_most(g, 89.5, fp3_pair_abs(g, x)));
    const fp3_pair least = fp3_pair_at_most(g, 0x1p60, f);
    const fp3_pair below = fp3_pair_add(g, fp3_pair_number(g, 1), scaled(g, least, num(g, 2)));
    return (hyperbolic){f, fp3_pair_quotient(g, least, below)};
}

static fp3_pair with_sign_of(dag *g, fp3_pair x, fp3_pair size) {
    const uint32_t is_negative = op(g, FP3_OP_LT, x.high, num(g, 0));
    return scaled(g, size, fp3_pair_op(g, FP3_OP_SEL, num(g, -1), num(g, 1), is_negative));
}

fp3_pair fp3_pair_sinh(dag *g, fp3_pair x) {
    const hyperbolic h = hyperbolic_of(g, x);
    return with_sign_of(g, x, fp3_pair_add(g, h.f, h.q));
}

fp3_pair fp3_pair_cosh(dag *g, fp3_pair x) {
    const hyperbolic h = hyperbolic_of(g, x);
    return fp3_pair_add(g, h.f, fp3_pair_sub(g, fp3_pair_number(g, 1), h.q));
}

/* f/(f + 1) of twice x: beyond 20 it is 1. */
fp3_pair fp3_pair_tanh(dag *g, fp3_pair x) {
    const fp3_pair near = fp3_pair_at_most(g, 20, fp3_pair_abs(g, x));
    const fp3_pair f = half_grown(g, scaled(g, near, num(g, 2)));
    const fp3_pair below = fp3_pair_add(g, fp3_pair_number(g, 1), f);
    return with_sign_of(g, x, fp3_pair_quotient(g, f, below));
}

/* ---- logarithms ---- */

/* log(m) for m from sqrt(1/2) to sqrt(2), and less = m - 1: y, that of floats, and log(m e^-y) =
 * log(1 + d) = d - d^2/2, as d is some 2^-24 of y, or 2^-25 from the second word of m. With g =
 * e^-y - 1, d = less + m g: the cancellation is exact, so the result is as accurate near 1. */
static fp3_pair log_near_1(dag *g, fp3_pair m, fp3_pair less) {
    const uint32_t y = fp3_log_near_1(g, m.high);
    const fp3_pair minus_y = {op(g, FP3_OP_SUB, num(g, -0.0), y), FP3_NONE};
    const fp3_pair d = fp3_pair_add(g, less, fp3_pair_mul(g, m, grown_by(g, minus_y)));
    const uint32_t square = op(g, FP3_OP_MUL, op(g, FP3_OP_MUL, d.high, num(g, 0.5)), d.high);
    return fp3_pair_add_smaller(g, (fp3_pair){y, FP3_NONE},
                                (fp3_pair){d.high, op(g, FP3_OP_SUB, d.low, square)});
}

/* x = m 2^-e */
typedef struct {
    fp3_pair m;
    uint32_t e;
} normal;

/* Of (x scale) and scale. */
static normal normal_of(dag *g, fp3_pair x, uint32_t scale) {
    const fp3_pair small = scaled(g, x, scale);
    const fp3_log_parts p = fp3_log_parts_of(g, small.high, scale);
    return (normal){{p.m, x.low == FP3_NONE ? FP3_NONE : op(g, FP3_OP_MUL, small.low, p.power)},
                    p.e};
}

static fp3_pair less_1(dag *g, fp3_pair m) { return fp3_pair_sub(g, m, fp3_pair_number(g, 1)); }

/* -e ln 2 + log(m) */
static fp3_pair log_of_normal(dag *g, normal n, fp3_pair less) {
    const fp3_pair whole = fp3_fast_two_sum(g, op(g, FP3_OP_MUL, n.e, num(g, -ln2_part[0])),
                                            op(g, FP3_OP_MUL, n.e, num(g, -ln2_part[1])));
    const uint32_t low = op(g, FP3_OP_SUB, whole.low, op(g, FP3_OP_MUL, n.e, num(g, ln2_part[2])));
    return fp3_pair_add_smaller(g, (fp3_pair){whole.high, low}, log_near_1(g, n.m, less));
}

static fp3_pair log_of(dag *g, fp3_pair x, uint32_t scale) {
    const normal n = normal_of(g, x, scale);
    return log_of_normal(g, n, less_1(g, n.m));
}

fp3_pair fp3_pair_log(dag *g, fp3_pair x) { return log_of(g, x, fp3_log_scale(g, x.high)); }

/* Where e is 0, m - 1 is x. */
fp3_pair fp3_pair_log1p(dag *g, fp3_pair x) {
    const fp3_pair u = fp3_pair_add(g, fp3_pair_number(g, 1), x);
    const normal n = normal_of(g, u, fp3_log_scale(g, u.high));
    return log_of_normal(g, n, fp3_pair_select(g, n.e, less_1(g, n.m), x));
}

/* -e + log(m)/ln 2 */
fp3_pair fp3_pair_log2(dag *g, fp3_pair x) {
    const normal n = normal_of(g, x, fp3_log_scale(g, x.high));
    const fp3_pair part =
        fp3_pair_mul(g, log_near_1(g, n.m, less_1(g, n.m)), fp3_pair_number(g, M_LOG2E));
    const fp3_pair whole = {op(g, FP3_OP_SUB, num(g, -0.0), n.e), FP3_NONE};
    return fp3_pair_add_smaller(g, whole, part);
}

/* e^(n log |x|), with the sign of x where n is odd. 0^n is 2^(-n inf). */
fp3_pair fp3_pair_power(dag *g, fp3_pair x, uint32_t n) {
    const uint32_t exponent = fp3_known_make(g->known, KNOWN_EXPONENT, n, 0);
    const uint32_t sign = fp3_known_make(g->known, KNOWN_SIGN, n, 0);
    const fp3_pair one = fp3_pair_number(g, 1), there = fp3_pair_select(g, x.high, x, one);
    const uint32_t is_negative = op(g, FP3_OP_LT, x.high, num(g, 0));
    const uint32_t turn =
        fp3_pair_op(g, FP3_OP_SEL, fp3_dag_known(g, sign), num(g, 1), is_negative);
    const fp3_pair size = fp3_pair_abs(g, there);
    const uint32_t known = fp3_pair_op(g, FP3_OP_ABS, turn, FP3_NONE, FP3_NONE);
    const uint32_t scale = op(g, FP3_OP_MUL, fp3_log_scale(g, size.high), known);
    const fp3_pair all =
        fp3_pair_exp(g, fp3_pair_mul(g, fp3_pair_known(g, exponent), log_of(g, size, scale)));
    const uint32_t large = fp3_known_number(g->known, -0x1p60);
    const uint32_t end = fp3_dag_known(g, fp3_known_make(g->known, KNOWN_MUL, large, exponent));
    const fp3_pair of_zero = {fp3_pair_op(g, FP3_OP_EXP2, end, FP3_NONE, FP3_NONE), FP3_NONE};
    return fp3_pair_select(g, x.high, scaled(g, all, turn), of_zero);
}
