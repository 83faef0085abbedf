/* SPDX-License-Identifier: Apache-2.0 */
/* loss.h - values in double, and which of them lost digits at the lower end of double. */
#ifndef FP3_ODE_LOSS_H
#define FP3_ODE_LOSS_H

#include "evaluate.h"

/* values[i] of an expression as of fp3_ode_compute. is_lost[i]: it underflowed, or was made of a
 * value that did, and may differ from what the formula means in more than the rounding to FP32. */
void fp3_ode_compute_careful(const fp3_expr *expr, const fp3_point *point, uint32_t i,
                             double *values, char *is_lost);

/* Whether anything in double may have underflowed since it was last forgotten: 0: nothing has. */
void fp3_ode_forget_underflow(void);
int fp3_ode_may_have_underflowed(void);

#endif
