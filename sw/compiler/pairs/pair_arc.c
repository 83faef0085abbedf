/* SPDX-License-Identifier: Apache-2.0 */
/* pair_arc.c - arcs of double-single: those of floats, corrected once by the tangent. */
#include "compiler/functions/arc.h"
#include "compiler/functions/division.h"
#include "pair_functions.h"

#include <fp3/isa.h>

#define PI 3.14159265358979323846

static uint32_t op(dag *g, uint32_t op, uint32_t a, uint32_t b) {
    return fp3_pair_op(g, op, a, b, FP3_NONE);
}
static uint32_t num(dag *g, double number) { return fp3_dag_number(g, number); }

static uint32_t select(dag *g, uint32_t condition, uint32_t then, uint32_t otherwise) {
    return fp3_pair_op(g, FP3_OP_SEL, then, otherwise, condition);
}

/* For |q| <= 1: a + atan((q - tan(a))/(1 + q tan(a))), with a the arc of floats and tan(a) = a/d.
 * The correction is some 2^-24 of a, and so is its own arc. */
static fp3_pair small_arc(dag *g, fp3_pair q) {
    const uint32_t a = fp3_small_arc(g, q.high);
    const fp3_pair d = fp3_pair_cotangent_times(g, (fp3_pair){a, FP3_NONE});
    const fp3_pair p = fp3_pair_mul(g, q, d);
    const uint32_t left = op(g, FP3_OP_ADD, op(g, FP3_OP_SUB, p.high, a), fp3_pair_low(g, p));
    const uint32_t below = op(g, FP3_OP_ADD, d.high, op(g, FP3_OP_MUL, q.high, a));
    return fp3_fast_two_sum(g, a, fp3_corrected(g, fp3_term(left), fp3_reciprocal(g, below)).node);
}

/* Plus `turns` halves of a turn: 0, +-1/2 or +-1. */
static fp3_pair turned(dag *g, fp3_pair arc, uint32_t turns) {
    const fp3_pair pi = fp3_pair_number(g, PI);
    const fp3_pair turn = {op(g, FP3_OP_MUL, pi.high, turns), op(g, FP3_OP_MUL, pi.low, turns)};
    return fp3_pair_add(g, turn, arc);
}

/* atan(x), or atan(-1/x) and a quarter turn. Beyond 2^60 a quarter turn is all that is left. */
fp3_pair fp3_pair_atan(dag *g, fp3_pair x) {
    const fp3_pair near = fp3_pair_at_least(g, -0x1p60, fp3_pair_at_most(g, 0x1p60, x));
    const uint32_t above = op(g, FP3_OP_LT, num(g, 1), x.high);
    const uint32_t large = op(g, FP3_OP_SUB, above, op(g, FP3_OP_LT, x.high, num(g, -1)));
    const fp3_pair one = fp3_pair_number(g, 1);
    const fp3_pair below = fp3_pair_select(g, large, fp3_pair_negated(g, near), one);
    const fp3_pair q = fp3_pair_select(g, large, fp3_pair_quotient(g, one, below), x);
    return turned(g, small_arc(g, q), op(g, FP3_OP_MUL, large, num(g, 0.5)));
}

/* atan(y/x), or atan(-x/y) and a quarter turn, or half a turn where x < 0. Only 0/0 divides by
 * zero: it is 0/1. */
fp3_pair fp3_pair_atan2(dag *g, fp3_pair y, fp3_pair x) {
    const uint32_t zero = num(g, 0);
    const uint32_t steep = op(g, FP3_OP_LT, fp3_pair_op(g, FP3_OP_ABS, x.high, FP3_NONE, FP3_NONE),
                              fp3_pair_op(g, FP3_OP_ABS, y.high, FP3_NONE, FP3_NONE));
    const fp3_pair above = fp3_pair_select(g, steep, x, y);
    const fp3_pair below = fp3_pair_select(g, steep, fp3_pair_negated(g, y), x);
    const fp3_pair tangent =
        fp3_pair_quotient(g, above, fp3_pair_select(g, below.high, below, fp3_pair_number(g, 1)));
    const uint32_t side = select(g, op(g, FP3_OP_LT, y.high, zero), num(g, -1), num(g, 1));
    const uint32_t part = select(g, steep, num(g, 0.5), op(g, FP3_OP_LT, x.high, zero));
    return turned(g, small_arc(g, tangent), op(g, FP3_OP_MUL, side, part));
}

/* sqrt((1 - x)(1 + x)): a NaN of |x| > 1. */
static fp3_pair other_side(dag *g, fp3_pair x) {
    const fp3_pair one = fp3_pair_number(g, 1);
    return fp3_pair_root(g, fp3_pair_mul(g, fp3_pair_sub(g, one, x), fp3_pair_add(g, one, x)));
}

fp3_pair fp3_pair_asin(dag *g, fp3_pair x) { return fp3_pair_atan2(g, x, other_side(g, x)); }

fp3_pair fp3_pair_acos(dag *g, fp3_pair x) { return fp3_pair_atan2(g, other_side(g, x), x); }
