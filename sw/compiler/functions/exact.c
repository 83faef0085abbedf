/* SPDX-License-Identifier: Apache-2.0 */
/* exact.c - quotients and roots rounded to nearest: two digits of 12 bits, and a choice by exact
 * remainders. */
#include "exact.h"

#include "compiler/value/ops.h"
#include "division.h"

#include <fp3/compile.h>

/* The exponent of a number; -126 for subnormal numbers, so that the scale is finite. */
static uint32_t exponent(dag *g, uint32_t x) {
    return op2(g, FP3_OP_MAX, num(g, -126), op1(g, FP3_OP_LOGB, x));
}

/* The upper 12 bits of x, rounded (Dekker, A floating-point technique for extending the available
 * precision, Numerische Mathematik 18, 1971). */
static uint32_t head(dag *g, uint32_t x) {
    const uint32_t c = mul(g, num(g, 4097), x);
    return sub(g, c, sub(g, c, x));
}

static uint32_t less_product(dag *g, uint32_t x, uint32_t a, uint32_t b) {
    return sub(g, x, mul(g, a, b));
}

static uint32_t magnitude(dag *g, uint32_t x) { return op1(g, FP3_OP_ABS, x); }

/* Whichever leaves less. */
static uint32_t closer(dag *g, uint32_t x, uint32_t rest, uint32_t y, uint32_t rest_of_y) {
    const uint32_t is_y = op2(g, FP3_OP_LT, magnitude(g, rest_of_y), magnitude(g, rest));
    return sel(g, is_y, y, x);
}

static uint32_t inverse(dag *g, fp3_series s) { return fp3_corrected(g, one(g), s).node; }

/* b in two halves of 12 bits, and nearly 1/b. */
typedef struct {
    uint32_t b, high, low, inverse;
} divisor;

/* Of numbers near 1, where nothing overflows or underflows. */
static uint32_t scaled_quotient(dag *g, uint32_t a, const divisor *b) {
    const uint32_t first = head(g, mul(g, a, b->inverse));
    const uint32_t left = less_product(g, less_product(g, a, first, b->high), first, b->low);
    const uint32_t q = add(g, first, mul(g, left, b->inverse));
    const uint32_t second = sub(g, q, first);
    const uint32_t rest = less_product(g, less_product(g, left, second, b->high), second, b->low);
    /* Twice the rest leads to the neighbour, if that can be the nearest. */
    const uint32_t other = add(g, q, mul(g, num(g, 2), mul(g, rest, b->inverse)));
    const uint32_t rest_of_other = less_product(g, rest, sub(g, other, q), b->b);
    return closer(g, q, rest, other, rest_of_other);
}

/* ---- by a fused multiply-add: remainders are exact at once (Markstein 1990) ---- */

static int is_fused(const dag *g) { return (g->passes & FP3_PASS(FP3_PASS_FUSE)) != 0; }

static uint32_t fused(dag *g, uint32_t op, uint32_t x, uint32_t a, uint32_t b) {
    return fp3_fold(g, op, a, b, x);
}

/* Half a unit in the last place, and a little more, is the most that q is off. */
static uint32_t fused_quotient(dag *g, uint32_t a, uint32_t b, uint32_t over) {
    const uint32_t first = mul(g, a, over);
    const uint32_t q = fused(g, FP3_OP_FMADD, first, fused(g, FP3_OP_FMSUB, a, first, b), over);
    const uint32_t rest = fused(g, FP3_OP_FMSUB, a, q, b);
    const uint32_t other = fused(g, FP3_OP_FMADD, q, mul(g, num(g, 2), rest), over);
    return closer(g, q, rest, other, fused(g, FP3_OP_FMSUB, a, other, b));
}

static uint32_t fused_root(dag *g, uint32_t a, uint32_t over) {
    const uint32_t first = mul(g, a, over), half = mul(g, num(g, 0.5), over);
    const uint32_t s = fused(g, FP3_OP_FMADD, first, fused(g, FP3_OP_FMSUB, a, first, first), half);
    const uint32_t rest = fused(g, FP3_OP_FMSUB, a, s, s);
    const uint32_t other = fused(g, FP3_OP_FMADD, s, rest, over);
    return closer(g, s, rest, other, fused(g, FP3_OP_FMSUB, a, other, other));
}

static uint32_t near_quotient(dag *g, uint32_t a, const divisor *d) {
    return is_fused(g) ? fused_quotient(g, a, d->b, d->inverse) : scaled_quotient(g, a, d);
}

uint32_t fp3_exact_quotient(dag *g, uint32_t a, uint32_t b) {
    /* b 2^-n is in [1/2, 1), a 2^-m in [1, 2): their quotient, between 1 and 4, and 2^(m-n) are in
     * range wherever a/b is. No max here: a number without an exponent must become a NaN. */
    const uint32_t minus_n = sub(g, num(g, -1), op1(g, FP3_OP_LOGB, b));
    const uint32_t scale = power_of_two(g, minus_n), near = mul(g, b, scale);
    divisor d = {near, FP3_NONE, FP3_NONE, inverse(g, fp3_reciprocal(g, near))};
    if (!is_fused(g)) {
        d.high = head(g, near);
        d.low = sub(g, near, d.high);
    }
    if (fp3_dag_is_number(g, a, 1))
        return mul(g, near_quotient(g, a, &d), scale);
    const uint32_t minus_m = sub(g, num(g, 0), exponent(g, a));
    const uint32_t q = near_quotient(g, mul(g, a, power_of_two(g, minus_m)), &d);
    return mul(g, q, power_of_two(g, sub(g, minus_n, minus_m)));
}

/* What s + d leaves of a root, if s leaves rest. */
static uint32_t rest_beyond(dag *g, uint32_t rest, uint32_t s, uint32_t d) {
    return less_product(g, less_product(g, rest, add(g, s, s), d), d, d);
}

/* s, and what it leaves, becomes the sum of s and rest times slope. */
static void advance(dag *g, uint32_t *s, uint32_t *rest, uint32_t slope) {
    const uint32_t next = add(g, *s, mul(g, *rest, slope));
    *rest = rest_beyond(g, *rest, *s, sub(g, next, *s));
    *s = next;
}

uint32_t fp3_exact_root(dag *g, uint32_t b) {
    const uint32_t n = op1(g, FP3_OP_RINT, mul(g, exponent(g, b), num(g, 0.5)));
    const uint32_t a = mul(g, b, power_of_two(g, sub(g, num(g, 0), add(g, n, n))));
    const uint32_t over = inverse(g, fp3_finite_inverse_root(g, a));
    if (is_fused(g))
        return mul(g, fused_root(g, a, over), power_of_two(g, n));
    const uint32_t half = mul(g, num(g, 0.5), over);
    uint32_t s = head(g, mul(g, a, over)), rest = less_product(g, a, s, s);
    advance(g, &s, &rest, half);
    advance(g, &s, &rest, half);
    uint32_t other = s, rest_of_other = rest;
    advance(g, &other, &rest_of_other, over);
    return mul(g, closer(g, s, rest, other, rest_of_other), power_of_two(g, n));
}
