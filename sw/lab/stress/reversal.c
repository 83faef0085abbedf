/* SPDX-License-Identifier: Apache-2.0 */
/* reversal.c - a planet goes forward, its velocity is turned, and it goes as far again: a symmetric
 * method comes back to where it began but for roundings (Hairer, Lubich and Wanner, Geometric
 * Numerical Integration, chapter V). */
#include "kepler.h"
#include "sections.h"

#include <fp3/truth.h>
#include <gsl/gsl_pow_int.h>
#include <math.h>

#define OBJECTS 64
#define ECCENTRICITY 0.2
#define SPAN 12.0
#define RUNGS 26  /* sqrt(2) apart */
#define FEWEST 24 /* steps */
#define LARGE 0.2
#define ORDER_OFF 0.3
#define NOISE 40 /* an error of so many times what roundings can make is the method's */

/* Turning v and going on by h is going back by -h, for whatever has a(r) alone: so a splitting that
 * reads the same from both ends is symmetric, and no explicit Runge-Kutta method is. */
static int is_symmetric(const fp3_integrator *integrator) {
    if (integrator->kind != FP3_SPLITTING)
        return 0;
    for (unsigned i = 0, j = integrator->stages - 1; i < j; i++, j--)
        if (integrator->substeps[i].is_kick != integrator->substeps[j].is_kick ||
            fabs(integrator->substeps[i].coefficient - integrator->substeps[j].coefficient) > 1e-15)
            return 0;
    return 1;
}

/* A random walk of roundings, of which one shifts the orbit's period and so grows with the time. */
static double rounding(double h) {
    return fp3_lab_unit(&fp3_lab_arithmetics[FP3_LAB_PLAIN]) * sqrt(2 * SPAN / h) * SPAN;
}

static fp3_status there_and_back(fp3_rig *rig, double h, double *off, fp3_error *error) {
    static const char *const turned[] = {"v_x", "v_y"};
    const uint64_t steps = (uint64_t)round(SPAN / h);
    double v[OBJECTS], rows[OBJECTS * FP3_KEPLER_STATES], sum = 0;
    fp3_lab_step(rig->lab, h);
    fp3_status status = fp3_lab_start(rig->lab, error);
    if (!status)
        status = fp3_lab_run(rig->lab, steps, error);
    for (int j = 0; !status && j < 2; j++) {
        status = fp3_lab_read(rig->lab, turned[j], v, error);
        for (int i = 0; i < OBJECTS; i++)
            v[i] = -v[i];
        if (!status)
            status = fp3_lab_write(rig->lab, turned[j], v, error);
    }
    if (!status)
        status = fp3_lab_run(rig->lab, steps, error);
    if (!status)
        status = fp3_lab_read_all(rig->lab, rows, error);
    for (size_t i = 0; !status && i < OBJECTS; i++) {
        const double *start = fp3_lab_initial(rig->lab, i), *row = rows + FP3_KEPLER_STATES * i;
        sum += gsl_pow_2(row[2] - start[2]) + gsl_pow_2(row[3] - start[3]);
    }
    *off = sqrt(sum / OBJECTS);
    return status;
}

/* The same in double, of the first object. */
static fp3_status exact(const fp3_compiled *compiled, const fp3_lab *lab, double h, double *off,
                        fp3_error *error) {
    const uint64_t steps = (uint64_t)round(SPAN / h);
    const double *params = fp3_lab_params(lab, 0), *start = fp3_lab_initial(lab, 0);
    double there[FP3_KEPLER_STATES], back[FP3_KEPLER_STATES] = {0};
    fp3_status status = fp3_compiled_exact(compiled, params, start, h, &steps, 1, there, error);
    there[0] = -there[0], there[1] = -there[1];
    if (!status)
        status = fp3_compiled_exact(compiled, params, there, h, &steps, 1, back, error);
    *off = hypot(back[2] - start[2], back[3] - start[3]);
    return status;
}

static fp3_status exact_slope(const fp3_trial *trial, const fp3_rig *rig, const double *h,
                              unsigned count, double *slope, fp3_error *error) {
    const fp3_compile_def def = fp3_compile_default();
    fp3_compiled *compiled = NULL;
    double off[RUNGS];
    fp3_status status = fp3_compile(rig->model, trial->integrator, &def, &compiled, error);
    for (unsigned k = 0; !status && k < count; k++)
        status = exact(compiled, rig->lab, h[k], &off[k], error);
    *slope = status ? NAN : fp3_trial_slope(h, off, count);
    fp3_compiled_free(&compiled);
    return status;
}

/* h^(p+1) d of the way forward and (-h)^(p+1) d of the way back cancel for an even p. */
static fp3_status judge_order(const fp3_trial *trial, const fp3_rig *rig, const double *h,
                              const double *off, fp3_error *error) {
    const unsigned table = trial->integrator->position_order, order = table + (table % 2 ? 0 : 1);
    unsigned from = 0, to = RUNGS;
    while (from < RUNGS && !(off[from] < LARGE))
        from++;
    while (to > from && !(off[to - 1] > NOISE * rounding(h[to - 1])))
        to--;
    from = to > from + 4 ? to - 4 : from;
    if (to < from + 2) /* at the first step already there are only roundings: no order to be seen */
        return FP3_OK;
    double slope;
    const fp3_status status = exact_slope(trial, rig, h + from, to - from, &slope, error);
    const int is_near = fabs(slope - order) < ORDER_OFF;
    fp3_verdict v =
        fp3_trial_verdict(trial, "reversal", "kepler", &fp3_lab_arithmetics[FP3_LAB_PLAIN],
                          "slope of the distance from the start, from h = %.3g to %.3g: order %u%s",
                          h[from], h[to - 1], order, is_near ? "" : " (another in double, too)");
    v.expected = is_near ? order : slope;
    v.measured = fp3_trial_slope(h + from, off + from, to - from);
    v.tolerance = ORDER_OFF;
    return status ? status : fp3_verdicts_add(trial->verdicts, &v, error);
}

static fp3_status judge_return(const fp3_trial *trial, const double *h, const double *off,
                               fp3_error *error) {
    unsigned worst = 0;
    for (unsigned k = 1; k < RUNGS; k++)
        worst = off[k] / rounding(h[k]) > off[worst] / rounding(h[worst]) ? k : worst;
    fp3_verdict v =
        fp3_trial_verdict(trial, "reversal", "kepler", &fp3_lab_arithmetics[FP3_LAB_PLAIN],
                          "distance from the start, by what roundings make, at h = %.3g", h[worst]);
    v.relation = FP3_AT_MOST;
    v.expected = 4; /* standard deviations */
    v.measured = off[worst] / rounding(h[worst]);
    return fp3_verdicts_add(trial->verdicts, &v, error);
}

fp3_status fp3_section_reversal(const fp3_trial *trial, fp3_error *error) {
    double h[RUNGS], off[RUNGS];
    fp3_rig rig;
    if (trial->run->kind == FP3_STOERMER || /* has no velocity to turn */
        !fp3_trial_tries(trial, &fp3_lab_arithmetics[FP3_LAB_PLAIN], 0))
        return FP3_OK;
    fp3_status status = fp3_rig_open(trial, fp3_kepler_text, &fp3_lab_arithmetics[FP3_LAB_PLAIN], 1,
                                     OBJECTS, &rig, error);
    if (!status)
        status = fp3_kepler_fill(rig.lab, OBJECTS, ECCENTRICITY, error);
    for (int k = 0; !status && k < RUNGS; k++)
        status = there_and_back(&rig, h[k] = (float)(SPAN / round(FEWEST * pow(2, k / 2.0))),
                                &off[k], error);
    if (!status)
        status = is_symmetric(trial->integrator) ? judge_return(trial, h, off, error)
                                                 : judge_order(trial, &rig, h, off, error);
    fp3_rig_close(&rig);
    return status;
}
