/* division.c - a series makes an estimate of 9 bits a quotient or root of 24; with fewer bits its first term is enough. */
#include "division.h"

#include "compiler/value/ops.h"

/* With e = 1 - b y, x/b is x y / (1 - e), and 1/(1 - e) = 1 + e + e^2 + O(e^3), where e^3 is below
 * half a unit in the last place. y is never too large, so b y is in [1/2, 1]: rounding changes it by
 * at most 2^-25, and 1 - b y is exact. */
fp3_series fp3_reciprocal(dag *g, uint32_t b) {
    const uint32_t y = op1(g, FP3_OP_RCP, b);
    const uint32_t e = sub(g, num(g, 1), mul(g, b, y));
    return (fp3_series){y, g->terms == 1 ? e : add(g, e, mul(g, e, e))};
}

/* Likewise x/sqrt(b): with e = 1 - b y^2, (1 - e)^-1/2 = 1 + e/2 + 3/8 e^2 + O(e^3). */
static fp3_series root_series(dag *g, uint32_t b, uint32_t y) {
    const uint32_t e = sub(g, num(g, 1), mul(g, b, mul(g, y, y)));
    const uint32_t half = num(g, 0.5);
    return (fp3_series){y,
                        mul(g, e, g->terms == 1 ? half : add(g, half, mul(g, num(g, 0.375), e)))};
}

fp3_series fp3_inverse_root(dag *g, uint32_t b) {
    return root_series(g, b, op1(g, FP3_OP_RSQRT, b));
}

term fp3_corrected(dag *g, term x, fp3_series s) {
    const uint32_t q = fp3_dag_is_number(g, x.node, 1) ? s.estimate : mul(g, x.node, s.estimate);
    return (term){add(g, q, mul(g, q, s.correction)), x.is_negative};
}

/* The estimate of 2^-126, and what no correction of a normal number exceeds. Estimates of smaller numbers are
 * infinite. */
#define MOST 0x1p63
#define MOST_CORRECTION(g) ((g)->terms == 1 ? 0x1p-5 : 0x1p-8)

static uint32_t finite(dag *g, uint32_t y) { return op2(g, FP3_OP_MIN, num(g, MOST), y); }

fp3_series fp3_finite_inverse_root(dag *g, uint32_t b) {
    return root_series(g, b, finite(g, op1(g, FP3_OP_RSQRT, b)));
}

uint32_t fp3_root(dag *g, uint32_t b) {
    return fp3_corrected(g, fp3_term(b), fp3_finite_inverse_root(g, b)).node;
}

/* Of 0 the correction is a NaN: then min is its second operand. */
uint32_t fp3_root_beside_inverse(dag *g, uint32_t b) {
    const fp3_series s = fp3_inverse_root(g, b);
    const uint32_t t = op2(g, FP3_OP_MIN, s.correction, num(g, MOST_CORRECTION(g)));
    return fp3_corrected(g, fp3_term(b), (fp3_series){finite(g, s.estimate), t}).node;
}
