/* SPDX-License-Identifier: Apache-2.0 */
/* pair_circular.c - sine, cosine and tangent of double-single: as circular.c, with more of
 * everything. tools/polynomials.py computes the coefficients; highest power first. */
#include "compiler/functions/circular.h"
#include "pair_functions.h"

#include <fp3/compile.h>
#include <fp3/isa.h>

#define PI 3.14159265358979323846

/* Of z = r^2: (sin(r)/r - 1)/z and (cos(r) - 1)/z for |r| <= pi/2, (r/tan(r) - 1)/z for |r| <=
 * pi/4. */
static const double sine_48[] = {
    -7.407959567159864e-13,  1.6050965773802308e-10, -2.50519727582028e-08, 2.7557318053804133e-06,
    -0.00019841269836459347, 0.008333333333325916,   -0.1666666666666665};
static const double cosine_48[] = {
    4.6276154739932966e-14, -1.146468503171844e-11, 2.0876630715357167e-09, -2.75573177649746e-07,
    2.480158729242779e-05,  -0.0013888888888860642, 0.04166666666666633,    -0.5};
static const double cotangent_48[] = {-2.8703248023979875e-08, -2.1242637372815476e-07,
                                      -2.1680582322897015e-06, -2.1376727633421682e-05,
                                      -0.00021164038137831676, -0.002116402103241101,
                                      -0.02222222222261006,    -0.3333333333333315};

/* pi in parts: all but the last have 9 bits, so n of 15 bits times them is exact, and so is x less
 * the first two (circular.c). The parts are off from pi by 2^-64. */
#define PARTS 5
static const double pi_part[PARTS] = {0x1.93p+1, -0x1.c1p-8, 0x1.aap-18, 0x1.11p-29,
                                      -0x1.2e7b96p-39};
static const double half_pi_part[PARTS] = {0x1.93p+0, -0x1.c1p-9, 0x1.aap-19, 0x1.11p-30,
                                           -0x1.2e7b96p-40};
/* n has 15 bits where |x| < 2^16, and of pi/2 where |x| < 2^15. */
#define LIMIT 0x1p112
#define LIMIT_HALF 0x1p113

typedef struct {
    fp3_pair r;
    uint32_t sign; /* 1 or -1, or FP3_NONE: 1 */
} angle;

static uint32_t mul(dag *g, uint32_t a, uint32_t b) {
    return fp3_pair_op(g, FP3_OP_MUL, a, b, FP3_NONE);
}

static angle angle_of(dag *g, fp3_pair x) {
    if (g->passes & FP3_PASS(FP3_PASS_SMALL_ANGLES))
        return (angle){{fp3_small_angle(g, x.high), x.low}, FP3_NONE};
    const uint32_t n = fp3_nearest_multiple(g, x.high, PI, LIMIT);
    const uint32_t sign =
        fp3_pair_op(g, FP3_OP_SEL, fp3_dag_number(g, -1), fp3_dag_number(g, 1), fp3_is_odd(g, n));
    return (angle){fp3_pair_less_multiple(g, x, n, pi_part, PARTS, 2), sign};
}

static fp3_pair signed_by(dag *g, uint32_t sign, fp3_pair x) {
    return sign == FP3_NONE ? x
                            : (fp3_pair){mul(g, sign, x.high), mul(g, sign, fp3_pair_low(g, x))};
}

/* |x| < 2^16, for the tangent 2^15: beyond, the functions are NaN and raise invalid. With the pass
 * `small-angles` sine and cosine likewise beyond pi/2. */
fp3_pair fp3_pair_sin(dag *g, fp3_pair x) {
    const angle a = angle_of(g, x);
    const fp3_pair z = fp3_pair_mul(g, a.r, a.r);
    const fp3_pair curve = fp3_pair_mul(g, z, fp3_pair_polynomial(g, z, sine_48, 7, 1));
    return signed_by(g, a.sign, fp3_pair_step(g, a.r, a.r, curve));
}

fp3_pair fp3_pair_cos(dag *g, fp3_pair x) {
    const angle a = angle_of(g, x);
    const fp3_pair z = fp3_pair_mul(g, a.r, a.r);
    const fp3_pair p = fp3_pair_polynomial(g, z, cosine_48, 8, 2);
    return signed_by(g, a.sign, fp3_pair_step(g, fp3_pair_number(g, 1), z, p));
}

fp3_pair fp3_pair_cotangent_times(dag *g, fp3_pair r) {
    const fp3_pair z = fp3_pair_mul(g, r, r);
    return fp3_pair_step(g, fp3_pair_number(g, 1), z,
                         fp3_pair_polynomial(g, z, cotangent_48, 8, 2));
}

/* r/d or, of an odd multiple of pi/2, d/-r, with d = r/tan(r). */
fp3_pair fp3_pair_tan(dag *g, fp3_pair x) {
    const uint32_t n = fp3_nearest_multiple(g, x.high, PI / 2, LIMIT_HALF), odd = fp3_is_odd(g, n);
    const fp3_pair r = fp3_pair_less_multiple(g, x, n, half_pi_part, PARTS, 2);
    const fp3_pair d = fp3_pair_cotangent_times(g, r);
    const fp3_pair below = fp3_pair_select(g, odd, fp3_pair_negated(g, r), d);
    return fp3_pair_quotient(g, fp3_pair_select(g, odd, d, r), below);
}
