/* SPDX-License-Identifier: Apache-2.0 */
/* embedded.h - pairs of Runge-Kutta methods on the same stages. */
#ifndef FP3_EMBEDDED_H
#define FP3_EMBEDDED_H

#include <fp3/model.h>

/* Finds embedded_order and is_first_same_as_last of a table that has its weights. */
void fp3_embedded_find(fp3_integrator *table);

/* Whether the two methods differ on y' = a y, and on y' = f(t). Where they do not, the estimate of
 * the error is 0 whatever the step. */
int fp3_embedded_sees_rates(const fp3_integrator *table);
int fp3_embedded_sees_time(const fp3_integrator *table);

#endif
