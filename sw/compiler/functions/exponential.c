/* SPDX-License-Identifier: Apache-2.0 */
/* exponential.c - e^x as 2^k e^r, with k an integer and |r| half of ln 2, or less than ln 2 where
 * that is all that keeps 2^k finite or where the configuration truncates. tools/polynomials.py
 * computes the coefficients; highest power first. */
#include "exponential.h"

#include "compiler/value/ops.h"
#include "division.h"
#include "functions.h"

#define LOG2_E 1.4426950408889634

/* (e^r - 1 - r)/r^2 for |r| <= 0.70. */
static const double rest[] = {0.000196067995, 0.00141083682, 0.00833621155,
                              0.0416610762,   0.166666105,   0.500000358};
/* (sinh(r)/r - 1)/z and (cosh(r) - 1)/z for z = r^2 <= 0.49. */
static const double odd[] = {0.000201020244, 0.00833259244, 0.166666731};
static const double even[] = {0.00141238933, 0.0416599847, 0.500000536};

/* A comparison with a NaN is false, and then min and max give their second operand. */
uint32_t fp3_at_most(dag *g, double limit, uint32_t n) {
    return op2(g, FP3_OP_MIN, num(g, limit), n);
}

uint32_t fp3_at_least(dag *g, double limit, uint32_t n) {
    return op2(g, FP3_OP_MAX, num(g, limit), n);
}

static uint32_t rint_of(dag *g, uint32_t x) { return op1(g, FP3_OP_RINT, x); }

static uint32_t multiple_of_ln2(dag *g, uint32_t x) {
    return rint_of(g, mul(g, x, num(g, LOG2_E)));
}

/* x - k ln 2: the first product is exact, and so is the difference unless |x| is much smaller than
 * the product. */
static uint32_t remainder_of(dag *g, uint32_t x, uint32_t k) {
    const uint32_t r = sub(g, x, mul(g, k, num(g, FP3_LN2_HIGH)));
    return sub(g, r, mul(g, k, num(g, FP3_LN2_LOW)));
}

uint32_t fp3_exp_scaled(dag *g, uint32_t r, uint32_t k) {
    const uint32_t slope = add(g, num(g, 1), mul(g, r, polynomial(g, r, rest, 6)));
    return mul(g, add(g, num(g, 1), mul(g, r, slope)), power_of_two(g, k));
}

/* -104 gives 0 as -infinity does. With k = 127 at most, 2^k is finite: the product overflows, or
 * the polynomial, whose coefficients are all positive. */
term fp3_exp(dag *g, term x) {
    const uint32_t y = fp3_at_least(g, -104, fp3_term_value(g, x));
    const uint32_t k = fp3_at_most(g, 127, multiple_of_ln2(g, y));
    return fp3_term(fp3_exp_scaled(g, remainder_of(g, y, k), k));
}

/* With P, D = (2^k +/- 2^-k)/2, sinh(r + k ln 2) = D + (sinh(r) P + (cosh(r) - 1) D) and
 * cosh(r + k ln 2) = P + (sinh(r) D + (cosh(r) - 1) P). Near 0, D is 0 and P is 1. */
typedef struct {
    uint32_t sinh, cosh_less_1, p, d;
} hyperbolic;

static hyperbolic parts_of(dag *g, uint32_t x) {
    const uint32_t k = fp3_at_least(g, -128, fp3_at_most(g, 128, multiple_of_ln2(g, x)));
    const uint32_t r = remainder_of(g, x, k), z = mul(g, r, r);
    const uint32_t up = power_of_two(g, add(g, k, num(g, -1)));
    const uint32_t down = power_of_two(g, sub(g, num(g, -1), k));
    const uint32_t curve = mul(g, z, polynomial(g, z, odd, 3));
    return (hyperbolic){.sinh = add(g, r, mul(g, r, curve)),
                        .cosh_less_1 = mul(g, z, polynomial(g, z, even, 3)),
                        .p = add(g, up, down),
                        .d = sub(g, up, down)};
}

term fp3_sinh(dag *g, term x) {
    const hyperbolic h = parts_of(g, fp3_term_value(g, x));
    return fp3_term(add(g, h.d, add(g, mul(g, h.sinh, h.p), mul(g, h.cosh_less_1, h.d))));
}

term fp3_cosh(dag *g, term x) {
    const hyperbolic h = parts_of(g, fp3_term_value(g, x));
    return fp3_term(add(g, h.p, add(g, mul(g, h.sinh, h.d), mul(g, h.cosh_less_1, h.p))));
}

/* e^x - 1 = (2^k - 1) + 2^k (e^r - 1), which is accurate near 0. */
static uint32_t less_1(dag *g, uint32_t x, uint32_t k) {
    const uint32_t r = remainder_of(g, x, k), scale = power_of_two(g, k);
    const uint32_t grown = add(g, r, mul(g, mul(g, r, r), polynomial(g, r, rest, 6)));
    return add(g, add(g, scale, num(g, -1)), mul(g, scale, grown));
}

/* Below -20 it is -1. What is too large overflows as exp does. */
term fp3_expm1(dag *g, term x) {
    const uint32_t y = fp3_at_least(g, -20, fp3_term_value(g, x));
    return fp3_term(less_1(g, y, fp3_at_most(g, 127, multiple_of_ln2(g, y))));
}

/* e^x/(1 + e^x). Beyond 20 the quotient is 1. */
term fp3_logistic(dag *g, term x) {
    const uint32_t y = fp3_at_least(g, -104, fp3_at_most(g, 20, fp3_term_value(g, x)));
    const uint32_t k = multiple_of_ln2(g, y), e = fp3_exp_scaled(g, remainder_of(g, y, k), k);
    return fp3_corrected(g, fp3_term(e), fp3_reciprocal(g, add(g, e, num(g, 1))));
}

/* E/(E + 2) with E = e^(2x) - 1. Beyond 20 the quotient is 1. */
term fp3_tanh(dag *g, term x) {
    const uint32_t near = fp3_at_least(g, -20, fp3_at_most(g, 20, fp3_term_value(g, x)));
    const uint32_t y = add(g, near, near), e = less_1(g, y, multiple_of_ln2(g, y));
    return fp3_corrected(g, fp3_term(e), fp3_reciprocal(g, add(g, e, num(g, 2))));
}
