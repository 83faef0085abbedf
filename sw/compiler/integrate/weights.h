/* SPDX-License-Identifier: Apache-2.0 */
/* weights.h - coefficients in FP32 whose sum is exact. */
#ifndef FP3_WEIGHTS_H
#define FP3_WEIGHTS_H

#include "compiler/step/advance.h"

/* Of compensated programs alone: rounds weights to FP32, each to within a few units of its last
 * place, so that the sum of weights[i] share[i] is `sum`, as far as FP32 has such numbers. Weights
 * of 0, 1 or -1 stay, and equal weights stay equal. Steps that are computed exactly use the given
 * weights. share: NULL if each is 1. */
void fp3_weights(const fp3_advance *a, double *weights, const double *share, unsigned count,
                 double sum);

#endif
