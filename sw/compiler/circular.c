/* circular.c - sine and cosine as polynomials. */
#include "circular.h"

#include "ops.h"

/* (sin(x)/x - 1)/z and (cos(x) - 1)/z for z = x^2 in [0, pi^2], interpolated at the nodes of Chebyshev:
 * highest power first. Absolute errors in FP32 over [-pi, pi]: 6.1e-7 and 3.9e-7 (tests/ode measures
 * them). There is no range reduction. */
static const double sine[] = {1.3942344679303983e-10, -2.4822272894578905e-08,
                              2.7545680159356923e-06, -0.0001984100208558025,
                              0.008333331074231525,   -0.16666666635715308};
static const double cosine[] = {1.77299531221692e-09,   -2.7216673353840383e-07,
                                2.4784361623782387e-05, -0.0013888492914356971,
                                0.04166663326988213,    -0.4999999954247248};

term fp3_sine(dag *g, term x) {
    const uint32_t z = mul(g, x.node, x.node);
    const uint32_t p = polynomial(g, z, sine, 6);
    return (term){add(g, x.node, mul(g, mul(g, x.node, z), p)), x.is_negative};
}

term fp3_cosine(dag *g, term x) {
    const uint32_t z = mul(g, x.node, x.node);
    return fp3_term(add(g, num(g, 1), mul(g, z, polynomial(g, z, cosine, 6))));
}
