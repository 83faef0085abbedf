/* SPDX-License-Identifier: Apache-2.0 */
/* theory.c - see theory.h. */
#include "theory.h"

#include <complex.h>
#include <gsl/gsl_math.h>
#include <math.h>
#include <string.h>

#define SCAN 1e-3 /* no interval of stability or of growth is shorter */
#define FAR 512   /* nothing explicit is stable up to here with 23 stages */
#define FAR_RATIONAL 1e6
#define NEUTRAL                                                                                    \
    1e-9 /* eigenvalues of matrices are on the unit circle to within the root of a rounding */

/* R(w) = sum of coefficients[j] w^j, what a step of a Runge-Kutta method multiplies x' = w x with
 * (Hairer and Wanner, Solving Ordinary Differential Equations II, chapter IV.2). Returns the
 * degree. */
static unsigned polynomial(const fp3_integrator *rk, double coefficients[FP3_STAGES_MAX + 1]) {
    double power[FP3_STAGES_MAX]; /* A^(j-1) times the vector of ones */
    unsigned degree = 0;
    coefficients[0] = 1;
    for (unsigned i = 0; i < rk->stages; i++)
        power[i] = 1;
    for (unsigned j = 1; j <= rk->stages; j++) {
        double next[FP3_STAGES_MAX] = {0};
        coefficients[j] = 0;
        for (unsigned i = 0; i < rk->stages; i++) {
            coefficients[j] += rk->b[i] * power[i];
            for (unsigned m = 0; m < i; m++)
                next[i] += rk->a[i][m] * power[m];
        }
        memcpy(power, next, sizeof next);
        degree = coefficients[j] != 0 ? j : degree;
    }
    return degree;
}

/* R(w), stage by stage: where w is large the terms of the polynomial cancel. */
static double complex evaluate(const fp3_integrator *rk, double complex w) {
    double complex slope[FP3_STAGES_MAX], sum = 1;
    for (unsigned i = 0; i < rk->stages; i++) {
        double complex stage = 1;
        for (unsigned m = 0; m < i; m++)
            stage += rk->a[i][m] * slope[m];
        slope[i] = w * stage;
        sum += rk->b[i] * slope[i];
    }
    return sum;
}

static double radius(double m[2][2]) {
    const double half = (m[0][0] + m[1][1]) / 2;
    const double complex root = csqrt(half * half - (m[0][0] * m[1][1] - m[0][1] * m[1][0]));
    return fmax(cabs(half + root), cabs(half - root));
}

/* Rows x and v of a step; v is kicked by a(x, v) = -k x - c v. */
static double growth_of_splitting(const fp3_integrator *integrator, double k, double c) {
    double m[2][2] = {{1, 0}, {0, 1}};
    for (unsigned i = 0; i < integrator->stages; i++)
        for (int j = 0; j < 2; j++) {
            const fp3_substep *s = &integrator->substeps[i];
            if (s->is_kick)
                m[1][j] += s->coefficient * (-k * m[0][j] - c * m[1][j]);
            else
                m[0][j] += s->coefficient * m[1][j];
        }
    return radius(m);
}

/* v by the method while x stays: v1 = R v - phi k x with phi = (R(-c) - 1)/(-c); then x1 = x + v1.
 */
static double growth_of_late(const double *coefficients, unsigned degree, double k, double c) {
    double phi = 0;
    for (unsigned j = degree; j >= 1; j--)
        phi = phi * -c + coefficients[j];
    const double r = 1 - c * phi;
    double m[2][2] = {{1 - phi * k, r}, {-phi * k, r}};
    return radius(m);
}

/* k_i = (1 + sum of (a_ij + gamma_ij) k_j) w/(1 - gamma w): J is w itself. */
static double complex evaluate_rosenbrock(const fp3_integrator *table, double complex w) {
    double complex k[FP3_STAGES_MAX], sum = 1;
    for (unsigned i = 0; i < table->stages; i++) {
        k[i] = 1;
        for (unsigned j = 0; j < i; j++)
            k[i] += (table->a[i][j] + table->gamma[i][j]) * k[j];
        k[i] *= w / (1 - table->gamma[i][i] * w);
        sum += table->b[i] * k[i];
    }
    return sum;
}

double fp3_theory_growth(const fp3_integrator *integrator, double z, double angle) {
    const double k = z * z, c = angle < M_PI_2 ? 2 * z * cos(angle) : 0;
    double coefficients[FP3_STAGES_MAX + 1];
    if (integrator->kind == FP3_SPLITTING)
        return growth_of_splitting(integrator, k, c);
    if (integrator->kind == FP3_STOERMER) {
        double m[2][2] = {{2 - k, -1}, {1, 0}};
        return radius(m);
    }
    if (integrator->is_position_late && angle > 0) {
        const unsigned degree = polynomial(integrator, coefficients);
        return growth_of_late(coefficients, degree, k, c);
    }
    const double complex w = angle < M_PI_2 ? -z * cexp(I * angle) : -I * z;
    return cabs(integrator->kind == FP3_ROSENBROCK ? evaluate_rosenbrock(integrator, w)
                                                   : evaluate(integrator, w));
}

/* x' = v, v' = -c v: x stays neutral. */
static double growth_of_damped(const fp3_integrator *integrator, double c, double angle) {
    double coefficients[FP3_STAGES_MAX + 1];
    (void)angle;
    if (integrator->kind == FP3_SPLITTING)
        return growth_of_splitting(integrator, 0, c);
    if (integrator->is_position_late)
        return growth_of_late(coefficients, polynomial(integrator, coefficients), 0, c);
    return fp3_theory_growth(integrator, c, 0);
}

static int is_matrix(const fp3_integrator *integrator) {
    return integrator->kind == FP3_SPLITTING || integrator->kind == FP3_STOERMER ||
           integrator->is_position_late;
}

/* Where growth first exceeds most. A rational R tends to a limit, which FAR_RATIONAL is as good as.
 */
typedef double growth_fn(const fp3_integrator *integrator, double z, double angle);
static double first(growth_fn *growth, const fp3_integrator *integrator, double angle, double most,
                    double at) {
    const int is_rational = integrator->kind == FP3_ROSENBROCK;
    double apart = SCAN;
    while (at < (is_rational ? FAR_RATIONAL : FAR) && growth(integrator, at, angle) <= most)
        at += apart = is_rational ? at * SCAN : SCAN;
    if (is_rational && at >= FAR_RATIONAL)
        return INFINITY;
    double low = at - apart, high = at;
    for (int i = 0; i < 60; i++) {
        const double middle = (low + high) / 2;
        if (growth(integrator, middle, angle) <= most)
            low = middle;
        else
            high = middle;
    }
    return low;
}

double fp3_theory_limit(const fp3_integrator *integrator, double angle) {
    const double most = 1 + (is_matrix(integrator) ? NEUTRAL : 1e-12), least = 0.2;
    return fp3_theory_growth(integrator, least, angle) > most
               ? 0
               : first(fp3_theory_growth, integrator, angle, most, least);
}

double fp3_theory_onset(const fp3_integrator *integrator, double angle, double steps, double gain) {
    return first(fp3_theory_growth, integrator, angle, pow(gain, 1 / steps), SCAN);
}

double fp3_theory_damped(const fp3_integrator *integrator) {
    return first(growth_of_damped, integrator, 0, 1 + NEUTRAL, SCAN);
}
