/* SPDX-License-Identifier: Apache-2.0 */
#include "constant.h"

#include <math.h>

#include "dimension_check.h"
#include "expression.h"
#include "loss.h"
#include "vector.h"

/* Values of the expressions from .. expr_count-1 */
static void compute(ode_parser *p, uint32_t from) {
    double params[ODE_QUANTITIES];
    for (uint32_t i = 0; i < p->param_count; i++)
        params[i] = p->params[i].quantity.value;
    const fp3_point point = {.params = params};
    for (uint32_t i = from; i < p->expr_count; i++)
        fp3_ode_compute_careful(&p->exprs[i], &point, i, p->values, p->is_lost);
}

const char *fp3_ode_constant_expected(double value, int is_lost) {
    return is_lost        ? "a value computed without numbers below 2.2e-308, the end of double"
           : isnan(value) ? "a finite value (this is not a number)"
           : isinf(value) ? "a finite value (this is infinite)"
                          : NULL;
}

/* The value of the expression as a constant. 0 after an error. */
static int take(ode_parser *p, fp3_token at, ode_value value, unsigned size,
                ode_constant *constant) {
    char is[ODE_DIMENSION_TEXT_SIZE], wanted[ODE_DIMENSION_TEXT_SIZE];
    if (value.size != size) {
        fp3_ode_wrong(&p->in, at, "%s (this is %s)",
                      size == 2   ? "a vector such as (1, 0)"
                      : size == 3 ? "a vector such as (1, 0, 0)"
                                  : fp3_ode_shape(size),
                      fp3_ode_shape(value.size));
        return 0;
    }
    for (unsigned i = 0; i < size; i++) {
        const ode_dimension *dimension = &p->dimensions[value.expr[i]];
        constant->value[i] = p->values[value.expr[i]];
        if (!fp3_ode_dimension_fits(dimension, &constant->dimension)) {
            fp3_ode_wrong(&p->in, at, "a value in %s (this is in %s)",
                          fp3_ode_dimension_text(&p->dimension_names, &constant->dimension, wanted),
                          fp3_ode_dimension_text(&p->dimension_names, dimension, is));
            return 0;
        }
        const char *expected =
            fp3_ode_constant_expected(constant->value[i], p->is_lost[value.expr[i]]);
        if (expected) {
            fp3_ode_wrong(&p->in, at, "%s", expected);
            return 0;
        }
    }
    return 1;
}

static int has_param(const ode_parser *p, uint32_t from) {
    int has = 0;
    for (uint32_t i = from; i < p->expr_count; i++)
        has |= p->exprs[i].op == FP3_EXPR_PARAM;
    return has;
}

/* The expressions of a constant are forgotten once it is computed; but a start follows params that
 * a run gives. */
int fp3_ode_measured(ode_parser *p, ode_context context, unsigned size, ode_constant *constant) {
    fp3_token at = p->in.next;
    const uint32_t from = p->expr_count;
    *constant = (ode_constant){.dimension = {.kind = ODE_DIMENSION_ANY}};
    const ode_value value = fp3_ode_expression(p, context);
    fp3_ode_dimension_read(p, &constant->dimension, constant->dimension_text);
    int is_good = 0;
    if (value.size && !p->in.is_lost) {
        compute(p, from);
        fp3_ode_check_dimensions(p, from);
        is_good = take(p, at, value, size, constant);
    }
    const int is_kept = is_good && context == ODE_IN_START && has_param(p, from);
    for (unsigned i = 0; i < ODE_VECTOR; i++)
        constant->expr[i] = is_kept && i < size ? value.expr[i] : FP3_NONE;
    if (!is_kept)
        fp3_ode_forget(p, from);
    return is_good;
}
