/* SPDX-License-Identifier: Apache-2.0 */
/* circular.c - sine, cosine, tangent: the argument less a multiple of pi or pi/2, and a polynomial.
 */
#include "circular.h"

#include "compiler/value/ops.h"
#include "division.h"
#include "functions.h"

#include <fp3/compile.h>

#define PI 3.14159265358979323846

/* Minimax, of z = r^2, highest power first. |r| is at most half of the multiple of pi, and a little
 * more because n is computed from rounded numbers. sin(r) = r + r z s(z), relative error 6e-9;
 * cos(r) = 1 + z c(z), absolute error 5e-8; r/tan(r) = 1 - z t(z), relative error 6e-9. The rest of
 * what the tests find is rounding. */
static const double sine[] = {2.6049796955608703e-06, -1.9809259638245343e-04,
                              8.333061854128796e-03, -0.16666659392646654};
static const double cosine[] = {2.318603927151998e-05, -1.3855580403143559e-03,
                                0.041663946880750535, -0.49999930849444146};
static const double cotangent[] = {2.480716381451633e-04, 2.0964135709987406e-03,
                                   0.022226493584336364, 0.3333330490981909};

/* x = n pi + r, and sin(x) = sign sin(r), cos(x) = sign cos(r). */
typedef struct {
    uint32_t r, z, sign; /* z = r^2; sign is 1 or -1, or FP3_NONE: 1 */
} angle;

/* pi and pi/2 in parts. Where |x| < 2^16, n pi has n of at most 15 bits, n pi/2 of 16, and all
 * parts but the last have 9 and 8 bits, so n times them is exact. So are all differences but the
 * last: each is a multiple of the last place of x or of the part, and fits 24 bits (Cody and Waite,
 * Software Manual for the Elementary Functions, 1980, chapter 8). The first part is too large, so
 * that the second is negative: an infinite n gives infinity minus infinity. A tangent grows without
 * limit as r falls, so it takes four. */
static const double pi_part[] = {0x1.93p+1, -0x1.c1p-8, 0x1.aa22168c234c5p-18};
static const double half_pi_part[] = {0x1.94p+0, -0x1.ep-8, -0x1.2cp-18, 0x1.110b4611a6263p-26};

/* x 2^112 overflows from |x| = 2^16 on. Then n, the multiple nearest to x, is infinite, the result
 * is a NaN, and invalid is raised: beyond the range there is a flag and no number. */
#define LIMIT 0x1p112

uint32_t fp3_nearest_multiple(dag *g, uint32_t x, double unit, double limit) {
    const uint32_t multiple = mul(g, mul(g, x, num(g, limit)), num(g, 1 / (limit * unit)));
    return op1(g, FP3_OP_RINT, multiple);
}

/* x - n (part[0] + part[1] + ...) */
static uint32_t less(dag *g, uint32_t x, uint32_t n, const double *part, int count) {
    for (int i = 0; i < count; i++)
        x = sub(g, x, mul(g, n, num(g, part[i])));
    return x;
}

/* n/2 is not integral then. */
uint32_t fp3_is_odd(dag *g, uint32_t n) {
    const uint32_t half = mul(g, n, num(g, 0.5));
    return sub(g, half, op1(g, FP3_OP_RINT, half));
}

static angle reduced(dag *g, uint32_t x) {
    const uint32_t n = fp3_nearest_multiple(g, x, PI, LIMIT), r = less(g, x, n, pi_part, 3);
    return (angle){r, mul(g, r, r), sel(g, fp3_is_odd(g, n), num(g, -1), num(g, 1))};
}

/* x (2/pi) 2^127, rounded, overflows from the second number above pi/2 on; infinity times 0 is a
 * NaN. */
uint32_t fp3_small_angle(dag *g, uint32_t x) {
    const uint32_t beyond = mul(g, x, num(g, 0x1.45f304p+127));
    return add(g, x, mul(g, beyond, num(g, 0)));
}

static angle small(dag *g, uint32_t x) {
    const uint32_t r = fp3_small_angle(g, x);
    return (angle){r, mul(g, r, r), FP3_NONE};
}

static angle angle_of(dag *g, uint32_t x) {
    return g->passes & FP3_PASS(FP3_PASS_SMALL_ANGLES) ? small(g, x) : reduced(g, x);
}

static uint32_t signed_by(dag *g, const angle *a, uint32_t x) {
    return a->sign == FP3_NONE ? x : mul(g, a->sign, x);
}

/* Of x in radians, |x| < 2^16; sine and cosine with the pass `small-angles`, |x| <= pi/2. Beyond
 * that the value is a NaN and raises invalid. */
term fp3_sin(dag *g, term x) {
    const angle a = angle_of(g, x.node);
    const uint32_t r = signed_by(g, &a, a.r);
    const uint32_t p = polynomial(g, a.z, sine, 4);
    return (term){add(g, r, mul(g, mul(g, r, a.z), p)), x.is_negative};
}

term fp3_cos(dag *g, term x) {
    const angle a = angle_of(g, x.node);
    const uint32_t one = a.sign == FP3_NONE ? num(g, 1) : a.sign;
    const uint32_t p = polynomial(g, a.z, cosine, 4);
    return fp3_term(add(g, one, mul(g, signed_by(g, &a, a.z), p)));
}

/* r/d or, of an odd multiple of pi/2, d/-r, with d = r/tan(r). */
term fp3_tan(dag *g, term x) {
    const uint32_t n = fp3_nearest_multiple(g, x.node, PI / 2, LIMIT), odd = fp3_is_odd(g, n);
    const uint32_t r = less(g, x.node, n, half_pi_part, 4), z = mul(g, r, r);
    const uint32_t d = sub(g, num(g, 1), mul(g, z, polynomial(g, z, cotangent, 4)));
    const uint32_t minus_r = fp3_term_value(g, fp3_term_negated(fp3_term(r)));
    const uint32_t below = sel(g, odd, minus_r, d), above = sel(g, odd, d, r);
    return (term){fp3_corrected(g, fp3_term(above), fp3_reciprocal(g, below)).node, x.is_negative};
}
