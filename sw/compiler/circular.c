/* circular.c - sine and cosine: the argument less a multiple of pi, and a polynomial. */
#include "circular.h"

#include "ops.h"

#include <fp3/passes.h>

#define PI 3.14159265358979323846

/* Minimax over |r| <= 1.575, a little more than pi/2 since n is found with rounded numbers: highest power
 * first, of z = r^2. sin(r) = r + r z s(z), relative error 6e-9; cos(r) = 1 + z c(z), absolute error
 * 5e-8. The rest of what tests/ode/accuracy.c finds is rounding. */
static const double sine[] = {2.6049796955608703e-06, -1.9809259638245343e-04,
                              8.333061854128796e-03, -0.16666659392646654};
static const double cosine[] = {2.318603927151998e-05, -1.3855580403143559e-03,
                                0.041663946880750535, -0.49999930849444146};

/* x = n pi + r, and sin(x) = sign sin(r), cos(x) = sign cos(r). */
typedef struct {
    uint32_t r, z, sign; /* z = r^2; sign is 1 or -1, or FP3_NONE: 1 */
} angle;

/* pi in three parts. n has at most 15 bits where |x| < 2^16, and the first two parts have 9 each, so n
 * times them is exact. So are the first two differences: each is a multiple of the last place of x or
 * of the part, and is no larger than 2 (Cody and Waite, Software Manual for the Elementary Functions,
 * 1980, chapter 8). The first part is above pi, so that the second is negative: an infinite n gives
 * infinity minus infinity. */
static const double pi_part[] = {0x1.93p+1, -0x1.c1p-8, 0x1.aa22168c234c5p-18};

/* x 2^112 overflows from |x| = 2^16 on. Then n is infinite, the result is a NaN, and invalid is raised:
 * beyond the range there is a flag and no number. */
#define LIMIT 0x1p112

static angle reduced(dag *g, uint32_t x) {
    const uint32_t turns = mul(g, mul(g, x, num(g, LIMIT)), num(g, 1 / (LIMIT * PI)));
    const uint32_t n = op1(g, FP3_OP_RINT, turns);
    uint32_t r = x;
    for (int i = 0; i < 3; i++)
        r = sub(g, r, mul(g, n, num(g, pi_part[i])));
    /* n is odd where n/2 is not integral. */
    const uint32_t half = mul(g, n, num(g, 0.5));
    const uint32_t odd = sub(g, half, op1(g, FP3_OP_RINT, half));
    return (angle){r, mul(g, r, r), sel(g, odd, num(g, -1), num(g, 1))};
}

/* x (2/pi) 2^127, rounded, overflows from the second number above pi/2 on: then it times 0 is a NaN. */
static angle small(dag *g, uint32_t x) {
    const uint32_t beyond = mul(g, x, num(g, 0x1.45f304p+127));
    const uint32_t r = add(g, x, mul(g, beyond, num(g, 0)));
    return (angle){r, mul(g, r, r), FP3_NONE};
}

static angle angle_of(dag *g, uint32_t x) {
    return g->passes & FP3_PASS(FP3_PASS_SMALL_ANGLES) ? small(g, x) : reduced(g, x);
}

static uint32_t signed_by(dag *g, const angle *a, uint32_t x) {
    return a->sign == FP3_NONE ? x : mul(g, a->sign, x);
}

term fp3_sine(dag *g, term x) {
    const angle a = angle_of(g, x.node);
    const uint32_t r = signed_by(g, &a, a.r);
    const uint32_t p = polynomial(g, a.z, sine, 4);
    return (term){add(g, r, mul(g, mul(g, r, a.z), p)), x.is_negative};
}

term fp3_cosine(dag *g, term x) {
    const angle a = angle_of(g, x.node);
    const uint32_t one = a.sign == FP3_NONE ? num(g, 1) : a.sign;
    const uint32_t p = polynomial(g, a.z, cosine, 4);
    return fp3_term(add(g, one, mul(g, signed_by(g, &a, a.z), p)));
}
