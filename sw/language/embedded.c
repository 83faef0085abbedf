/* SPDX-License-Identifier: Apache-2.0 */
/* embedded.c - the order of the second method, whether stages are shared between steps, and what
 * the estimate does not see.
 *
 * On y' = a y, with z = h a, a step of either method is 1 + sum_k b.L^k.1 w^(k+1), w = z/(1 - gamma
 * z), gamma being the diagonal and L what A + Gamma has below it (k_i = w (1 + sum_j L_ij k_j)). On
 * y' = f(t) it is the sum over k of h^(k+1) f^(k)/k! b.c^k; a linearly implicit one has b.(c +
 * Gamma.1) for k = 1.
 */
#include "embedded.h"

#include "conditions.h"

#include <math.h>
#include <string.h>

/* A pair up to order 8 differs by more. Weights of 10 digits, fewer do not add up to 1, leave less
 * of one that differs by nothing. */
#define DISTANCE_LEAST 1e-7

static int is_last_row(const fp3_integrator *t) {
    const unsigned last = t->stages - 1;
    for (unsigned j = 0; j < last; j++)
        if (fabs(t->a[last][j] - t->b[j]) > FP3_CONDITION_TOLERANCE)
            return 0;
    return t->stages > 1 && t->b[last] == 0;
}

void fp3_embedded_find(fp3_integrator *table) {
    fp3_integrator other = *table;
    double worst = 0, next = 0;
    memcpy(other.b, table->embedded, sizeof other.b);
    table->embedded_order = fp3_integrator_order(&other, &worst, &next);
    table->is_first_same_as_last = table->kind != FP3_ROSENBROCK && is_last_row(table);
}

/* What the two methods make of these stages is the same. A NaN is no distance. */
static int is_same(const fp3_integrator *t, const double *at) {
    double distance = 0;
    for (unsigned i = 0; i < t->stages; i++)
        distance += (t->b[i] - t->embedded[i]) * at[i];
    return !(fabs(distance) > DISTANCE_LEAST);
}

int fp3_embedded_sees_rates(const fp3_integrator *t) {
    double power[FP3_STAGES_MAX];
    for (unsigned i = 0; i < t->stages; i++)
        power[i] = 1;
    for (unsigned k = 0; k < t->stages; k++) {
        if (!is_same(t, power))
            return 1;
        for (unsigned i = t->stages; i-- > 0;) { /* a row needs those before it as they were */
            double sum = 0;
            for (unsigned j = 0; j < i; j++)
                sum += (t->a[i][j] + t->gamma[i][j]) * power[j];
            power[i] = sum;
        }
    }
    return 0;
}

int fp3_embedded_sees_time(const fp3_integrator *t) {
    for (unsigned k = 0; k <= t->stages; k++) {
        double power[FP3_STAGES_MAX];
        for (unsigned i = 0; i < t->stages; i++) {
            power[i] = pow(t->c[i], k);
            for (unsigned j = 0; j <= i && k == 1; j++)
                power[i] += t->gamma[i][j];
        }
        if (!is_same(t, power))
            return 1;
    }
    return 0;
}
