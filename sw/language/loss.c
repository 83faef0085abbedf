#include "loss.h"

#include <fenv.h>
#include <math.h>

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

void fp3_ode_compute_careful(const fp3_expr *e, const fp3_point *point, uint32_t i, double *values,
                             char *is_lost) {
    feclearexcept(FE_UNDERFLOW);
    volatile double result = fp3_ode_compute(e, point, values);
    const int is_new = fetestexcept(FE_UNDERFLOW) != 0;
    values[i] = result;
    is_lost[i] = is_new || (is_any_lost(e, is_lost) && stays_lost(e, result, values, is_lost));
}
