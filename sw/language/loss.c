/* SPDX-License-Identifier: Apache-2.0 */
#include "loss.h"

#include "base/fpu.h"

#include <float.h>
#include <math.h>

#if FP3_FPU_IS_SOFT
void fp3_ode_forget_underflow(void) {}
int fp3_ode_may_have_underflowed(void) { return 1; }
#else
#include <fenv.h>

void fp3_ode_forget_underflow(void) {
    if (fetestexcept(FE_UNDERFLOW))
        feclearexcept(FE_UNDERFLOW);
}
int fp3_ode_may_have_underflowed(void) { return fetestexcept(FE_UNDERFLOW) != 0; }
#endif

/* What is lost is below 1e-323: beside a number like this it does not count. */
#define LARGE 1e-290

static int is_any_lost(const fp3_expr *e, const char *is_lost) {
    for (unsigned i = 0; i < fp3_ode_operands(e->op); i++)
        if (is_lost[e->operand[i]])
            return 1;
    return 0;
}

static int is_exact_zero(const fp3_expr *e, unsigned operand, const double *values,
                         const char *is_lost) {
    return values[e->operand[operand]] == 0 && !is_lost[e->operand[operand]];
}

static int stays_lost(const fp3_expr *e, double result, const double *values, const char *is_lost) {
    switch (e->op) {
    case FP3_EXPR_ADD:
    case FP3_EXPR_SUB:
    case FP3_EXPR_MIN:
    case FP3_EXPR_MAX:
        return fabs(result) < LARGE;
    case FP3_EXPR_MUL:
        return !is_exact_zero(e, 0, values, is_lost) && !is_exact_zero(e, 1, values, is_lost);
    case FP3_EXPR_SELECT:
        return is_lost[e->operand[0]] || is_lost[e->operand[values[e->operand[0]] != 0 ? 1 : 2]];
    default:
        return 1;
    }
}

/* Whether result, below the normal numbers, is significand * 2^exponent. */
static int is_same(double result, double significand, int exponent) {
    return ldexp(result, -exponent) == significand;
}

static int is_exact_product(double a, double b, double result) {
    int of_a, of_b;
    const double x = frexp(a, &of_a), y = frexp(b, &of_b), product = x * y;
    return fma(x, y, -product) == 0 && is_same(result, product, of_a + of_b);
}

static int is_exact_quotient(double a, double b, double result) {
    int of_a, of_b;
    const double x = frexp(a, &of_a), y = frexp(b, &of_b), quotient = x / y;
    return fma(quotient, y, -x) == 0 && is_same(result, quotient, of_a - of_b);
}

static int is_any_infinite(const fp3_expr *e, const double *values) {
    for (unsigned i = 0; i < fp3_ode_operands(e->op); i++)
        if (isinf(values[e->operand[i]]))
            return 1;
    return 0;
}

/* Whether the operation made a number below the normal ones that is not exact. No flag is asked:
 * some machines have none. A sum is exact there, and so are what is chosen and what an infinity
 * makes. */
static int underflows(const fp3_expr *e, double result, const double *values) {
    if (!(fabs(result) < DBL_MIN) || is_any_infinite(e, values))
        return 0;
    const double a = e->operand[0] == FP3_NONE ? 0 : values[e->operand[0]];
    switch (e->op) {
    case FP3_EXPR_MUL:
        return !is_exact_product(a, values[e->operand[1]], result);
    case FP3_EXPR_DIV:
        return !is_exact_quotient(a, values[e->operand[1]], result);
    case FP3_EXPR_POWER:
    case FP3_EXPR_EXP:
    case FP3_EXPR_ATAN2:
        return a != 0;
    default: /* a function that is 0 is exact */
        return fp3_ode_has_constants(e->op) && result != 0;
    }
}

void fp3_ode_compute_careful(const fp3_expr *e, const fp3_point *point, uint32_t i, double *values,
                             char *is_lost) {
    const double result = fp3_ode_compute(e, point, values);
    values[i] = result;
    is_lost[i] = underflows(e, result, values) ||
                 (is_any_lost(e, is_lost) && stays_lost(e, result, values, is_lost));
}
