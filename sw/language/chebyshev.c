/* SPDX-License-Identifier: Apache-2.0 */
/* chebyshev.c - coefficients of the method from its two numbers, stages and damping.
 *
 * On y' = w y with a step of 1 stage j is the polynomial a_j + b_j T_j(w0 + w1 w): T_j is
 * Chebyshev's, w0 = 1 + damping / stages^2, w1 = T_s'(w0) / T_s''(w0), b_j = T_j''(w0) / T_j'(w0)^2
 * and a_j = 1 - b_j T_j(w0).
 *
 * The recurrence of the paper is that of T_j, 2 w0 T_j - T_j-1. In FP32 it would lose digits of
 * what changes slowly, by the square of the stages. Here the difference of two stages is carried
 * on, as Reinsch did for sums of Chebyshev polynomials near 1 (Stoer and Bulirsch, Introduction to
 * Numerical Analysis, section 2.3.2): 2 w0 - 2, not 2 w0, is rounded.
 */
#include "chebyshev.h"

#include "embedded.h"

#include <math.h>
#include <string.h>

typedef struct {
    double value[FP3_STAGES_MAX], slope[FP3_STAGES_MAX], bend[FP3_STAGES_MAX];
} polynomials;

/* T_j, T_j' and T_j'' at w, j = 0 .. stages. */
static void evaluate(polynomials *t, unsigned stages, double w) {
    *t = (polynomials){.value = {1, w}, .slope = {0, 1}};
    for (unsigned j = 2; j <= stages; j++) {
        t->value[j] = 2 * w * t->value[j - 1] - t->value[j - 2];
        t->slope[j] = 2 * t->value[j - 1] + 2 * w * t->slope[j - 1] - t->slope[j - 2];
        t->bend[j] = 4 * t->slope[j - 1] + 2 * w * t->bend[j - 1] - t->bend[j - 2];
    }
}

static void find_recurrence(fp3_recurrence *r, unsigned stages, double damping) {
    const double beyond = damping / stages / stages;
    polynomials t;
    evaluate(&t, stages, 1 + beyond);
    const double w1 = t.slope[stages] / t.bend[stages];
    *r = (fp3_recurrence){.stages = stages, .first = w1, .bend = 2 * beyond};
    for (unsigned j = 1; j <= stages; j++) {
        const unsigned like = j < 2 ? 2 : j;
        r->at[j] = t.bend[like] / t.slope[like] / t.slope[like];
        r->share[j] = 1 - r->at[j] * t.value[j];
        r->slope[j] = 2 * w1 / r->at[j];
    }
}

/* The recurrence of weights of slopes. */
static void expand(fp3_integrator *table) {
    const fp3_recurrence *r = &table->recurrence;
    double change[FP3_STAGES_MAX] = {r->first}, sum[FP3_STAGES_MAX] = {r->first};
    for (unsigned j = 1; j <= r->stages; j++) {
        for (unsigned i = 0; i < j; i++) {
            table->a[j][i] = r->at[j] * sum[i];
            table->c[j] += table->a[j][i];
            change[i] += r->bend * sum[i];
        }
        change[j] += r->slope[j];
        change[0] -= r->slope[j] * r->share[j];
        for (unsigned i = 0; i <= j; i++)
            sum[i] += change[i];
    }
    memcpy(table->b, table->a[r->stages], sizeof table->b);
}

void fp3_chebyshev_make(fp3_integrator *table, unsigned stages, double damping) {
    find_recurrence(&table->recurrence, stages, damping);
    table->stages = stages + 1;
    expand(table);
    for (unsigned i = 0; i <= stages; i++)
        table->embedded[i] = (1 + FP3_CHEBYSHEV_WAY) * table->b[i] -
                             (i == 0 || i == stages ? FP3_CHEBYSHEV_WAY / 2 : 0);
    fp3_embedded_find(table);
}
