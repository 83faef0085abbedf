/* SPDX-License-Identifier: Apache-2.0 */
/* weights.c - roundings that cancel each other.
 *
 * Rounded to nearest, five weights add up to 1 + 1e-8, and after a time T a solution is T 1e-8 too
 * far, whatever h. That is far more than compensated updates lose.
 */
#include "weights.h"

#include <math.h>
#include <string.h>

#define TRIALS 9        /* of the largest weight: 4 units of its last place to either side */
#define NOTHING 0x1p-44 /* of the sum */

/* x as a float, and n units of its last place. */
static double rounded(double x, int n) {
    const double nearest = (double)(float)x;
    int exponent;
    frexp(nearest, &exponent);
    return nearest + n * ldexp(1, exponent - 24);
}

static double share_of(const double *share, unsigned i) { return share ? share[i] : 1; }

/* The weight that adds most, of those that are not fixed; count: none is left. */
static unsigned largest(const double *w, const double *share, unsigned count,
                        const char *is_fixed) {
    unsigned found = count;
    for (unsigned i = 0; i < count; i++)
        if (!is_fixed[i] && (found == count || fabs(w[i] * share_of(share, i)) >
                                                   fabs(w[found] * share_of(share, found))))
            found = i;
    return found;
}

/* Each weight takes in the errors of the weights before, from the largest to the smallest. Returns
 * the remaining error of the sum. */
static double round_all(double *w, const double *share, unsigned count, double sum, int ulps) {
    char is_fixed[FP3_STAGES_MAX];
    for (unsigned i = 0; i < count; i++) {
        is_fixed[i] = fabs(w[i]) == 1 || w[i] * share_of(share, i) == 0;
        sum -= w[i] * share_of(share, i);
    }
    for (unsigned top; (top = largest(w, share, count, is_fixed)) < count; ulps = 0) {
        const double value = w[top];
        double equal = 0;
        for (unsigned i = 0; i < count; i++)
            equal += !is_fixed[i] && w[i] == value ? share_of(share, i) : 0;
        const double now = rounded(equal != 0 ? value + sum / equal : value, ulps);
        sum += equal * (value - now);
        for (unsigned i = 0; i < count; i++)
            if (!is_fixed[i] && w[i] == value) {
                w[i] = now;
                is_fixed[i] = 1;
            }
    }
    return sum;
}

void fp3_weights(const fp3_advance *a, double *weights, const double *share, unsigned count,
                 double sum) {
    double given[FP3_STAGES_MAX], trial[FP3_STAGES_MAX], least = INFINITY;
    if (a->options->arithmetic != FP3_COMPENSATED)
        return;
    memcpy(given, weights, count * sizeof *given);
    for (int n = 0; n < TRIALS && least > NOTHING * fabs(sum); n++) {
        memcpy(trial, given, count * sizeof *trial);
        const double left = fabs(round_all(trial, share, count, sum, n % 2 ? (n + 1) / 2 : -n / 2));
        if (left < least) {
            least = left;
            memcpy(weights, trial, count * sizeof *trial);
        }
    }
    for (unsigned i = 0; i < count; i++)
        if (weights[i] != given[i])
            fp3_known_stands_for(&a->step->known, fabs(weights[i]), fabs(given[i]));
}
