/* SPDX-License-Identifier: Apache-2.0 */
/* evaluate.h - the operations of expressions, and their values in double. */
#ifndef FP3_ODE_EVALUATE_H
#define FP3_ODE_EVALUATE_H

#include <fp3/model.h>

/* The value of an expression, from those of its operands. */
double fp3_ode_compute(const fp3_expr *expr, const fp3_point *point, const double *values);
/* The values of an expression that is_known, for count objects. Params and values are columns of
 * count numbers: that of param 0, of param 1 ... */
void fp3_ode_compute_column(const fp3_expr *expr, const double *params, const double *values,
                            size_t count, double *column);
unsigned fp3_ode_operands(fp3_expr_op op);
/* Whether it is made of sums and products with constants of its own: powers may be. */
int fp3_ode_has_constants(fp3_expr_op op);

#endif
