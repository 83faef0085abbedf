/* SPDX-License-Identifier: Apache-2.0 */
/* arc.c - arcs: a quotient or a root where the argument is large, and a polynomial. */
#include "arc.h"

#include "compiler/value/ops.h"
#include "division.h"
#include "functions.h"

#define PI 3.14159265358979323846

/* Minimax, of z = q^2, highest power first: atan(q) = q (1 + z t(z)) for |q| <= 1,
 * relative error 2e-8; asin(q) = q + q z s(z) for |q| <= 1/2, relative error 5e-9. */
static const double arctangent[] = {
    0.0029207066111503134, -0.016367986630123354, 0.04321195812739277, -0.0755222271769758,
    0.10666008697271201,   -0.14211056366574187,  0.19993772969540183, -0.33333152742134753};
static const double arcsine[] = {0.04217812416693978, 0.024173017185572306, 0.045471592865058384,
                                 0.07495288798498058, 0.16666752677574134};

static uint32_t negated(dag *g, uint32_t x) {
    return fp3_term_value(g, fp3_term_negated(fp3_term(x)));
}

/* -1 where x > limit, 1 where x < -limit, else 0. */
static uint32_t side(dag *g, uint32_t x, double limit) {
    const uint32_t above = op2(g, FP3_OP_LT, num(g, limit), x);
    return sub(g, op2(g, FP3_OP_LT, x, num(g, -limit)), above);
}

static uint32_t quotient(dag *g, uint32_t a, uint32_t b) {
    return fp3_corrected(g, fp3_term(a), fp3_reciprocal(g, b)).node;
}

/* The product comes last, so that -0 stays -0. */
uint32_t fp3_small_arc(dag *g, uint32_t q) {
    const uint32_t z = mul(g, q, q);
    return mul(g, q, add(g, num(g, 1), mul(g, z, polynomial(g, z, arctangent, 8))));
}

/* atan(x), or atan(-1/x) and a quarter turn. Of a small x no reciprocal is made, which might raise
 * something. */
term fp3_atan(dag *g, term at) {
    const uint32_t x = fp3_term_value(g, at);
    const uint32_t large = side(g, x, 1);
    const uint32_t over = quotient(g, num(g, 1), sel(g, large, negated(g, x), num(g, 1)));
    const uint32_t arc = fp3_small_arc(g, sel(g, large, over, x));
    return fp3_term(sub(g, arc, mul(g, large, num(g, PI / 2))));
}

/* atan(y/x), or atan(-x/y) and a quarter turn, or half a turn where x < 0. Only 0/0 divides by
 * zero: it is 0/1. A quarter of a divisor always has an estimate, unless subnormal numbers are
 * flushed. */
static uint32_t tangent_of(dag *g, uint32_t above, uint32_t below) {
    if (g->is_flushed)
        return fp3_quotient(g, fp3_term(above), sel(g, below, below, num(g, 1))).node;
    const uint32_t quarter = mul(g, below, num(g, 0.25));
    return quotient(g, mul(g, above, num(g, 0.25)), sel(g, below, quarter, num(g, 1)));
}

term fp3_atan2(dag *g, term up, term along) {
    const uint32_t x = fp3_term_value(g, along), y = fp3_term_value(g, up);
    const uint32_t steep = op2(g, FP3_OP_LT, op1(g, FP3_OP_ABS, x), op1(g, FP3_OP_ABS, y));
    const uint32_t above = sel(g, steep, x, y), below = sel(g, steep, negated(g, y), x);
    const uint32_t tangent = tangent_of(g, above, below);
    const uint32_t turn = sel(g, op2(g, FP3_OP_LT, y, num(g, 0)), num(g, -PI), num(g, PI));
    const uint32_t part = sel(g, steep, num(g, 0.5), op2(g, FP3_OP_LT, x, num(g, 0)));
    return fp3_term(add(g, fp3_small_arc(g, tangent), mul(g, turn, part)));
}

/* Of |x| > 1 a NaN, which raises invalid. asin(x) = arc - large pi/2, with arc = asin(x), or minus
 * the sign of x times 2 asin(sqrt((1 - |x|)/2)). */
typedef struct {
    uint32_t arc, large;
} part_arc;

/* FLT_MAX x overflows where |x| > 1; then it times 0 is a NaN. */
static part_arc arc_of(dag *g, term at) {
    uint32_t x = fp3_term_value(g, at);
    x = add(g, x, mul(g, mul(g, x, num(g, 0x1.fffffep+127)), num(g, 0)));
    const uint32_t large = side(g, x, 0.5);
    const uint32_t rest = sub(g, num(g, 0.5), mul(g, num(g, 0.5), op1(g, FP3_OP_ABS, x)));
    const uint32_t root = mul(g, add(g, large, large), fp3_root(g, rest));
    const uint32_t q = sel(g, large, root, x), z = sel(g, large, rest, mul(g, x, x));
    return (part_arc){add(g, q, mul(g, mul(g, q, z), polynomial(g, z, arcsine, 5))), large};
}

term fp3_asin(dag *g, term x) {
    const part_arc p = arc_of(g, x);
    return fp3_term(sub(g, p.arc, mul(g, p.large, num(g, PI / 2))));
}

/* pi/2 - asin(x); what arc is taken from is 0, pi/2 or pi. */
term fp3_acos(dag *g, term x) {
    const part_arc p = arc_of(g, x);
    return fp3_term(sub(g, add(g, num(g, PI / 2), mul(g, p.large, num(g, PI / 2))), p.arc));
}
