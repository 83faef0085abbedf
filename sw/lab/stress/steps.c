/* SPDX-License-Identifier: Apache-2.0 */
/* steps.c - the error of an oscillator, free or driven by t, from long time steps to short ones:
 * the method's on the left, the roundings' on the right. */
#include "sections.h"

#include <gsl/gsl_pow_int.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define OBJECTS 64
#define RUNGS 31 /* sqrt(2) apart */
#define RUNGS_QUICK 21
#define RUNGS_LEAST 13
#define SPAN 8.0
#define LARGE 0.05 /* errors above say nothing of the order, */
#define ABOVE 40   /* nor do those below so many times the smallest */
#define ORDER_OFF 0.05
#define GROWTH_OFF 0.15
#define FLOOR 4 /* units */
#define SIGMAS 4
#define EXACT 8      /* objects in double */
#define RIGHT 7      /* rungs that say how rounding grows */
#define LEAST_WALK 4 /* or how large it is ... */
#define WALK_OFF 0.5 /* ... to its half: near the shortest steps roundings begin to cancel */

static const char free_text[] = "model swing\nstate v = 0\nstate x = 1\nstep 1\nv' = -x\nx' = v\n";
static const char driven_text[] =
    "model driven\nstate v = 0\nstate x = 1\nstep 1\nv' = -x + cos(2*t)\nx' = v\n";

typedef struct {
    const fp3_trial *trial;
    const fp3_lab_arithmetic *arithmetic;
    int is_driven;
    unsigned count, order;
    double steps[RUNGS], h[RUNGS], error[RUNGS];
    double few[RUNGS]; /* error of the first EXACT objects */
    double x[RUNGS][OBJECTS];
} curve;

/* The particular solution of the driven one is -cos(2 t)/3. */
static double truth(const curve *c, double t, double x0, double v0) {
    const double drive = c->is_driven ? 1.0 / 3 : 0;
    return (x0 + drive) * cos(t) + v0 * sin(t) - drive * cos(2 * t);
}

static fp3_status measure(curve *c, fp3_rig *rig, unsigned rung, fp3_error *error) {
    const double t = c->h[rung] * c->steps[rung];
    double *x = c->x[rung], sum = 0;
    fp3_lab_step(rig->lab, c->h[rung]);
    fp3_status status = fp3_lab_start(rig->lab, error);
    if (!status)
        status = fp3_lab_run(rig->lab, (uint64_t)c->steps[rung], error);
    if (!status)
        status = fp3_lab_read(rig->lab, "x", x, error);
    for (size_t i = 0; !status && i < OBJECTS; i++) {
        const double *start = fp3_lab_initial(rig->lab, i);
        sum += gsl_pow_2((x[i] - truth(c, t, start[1], start[0])) / hypot(start[0], start[1]));
        if (i + 1 == EXACT)
            c->few[rung] = sqrt(sum / EXACT);
    }
    c->error[rung] = sqrt(sum / OBJECTS);
    return status;
}

static fp3_status measure_all(curve *c, fp3_rig *rig, fp3_error *error) {
    double x[OBJECTS], v[OBJECTS];
    uint64_t seed = 1;
    for (int i = 0; i < OBJECTS; i++) {
        x[i] = 1 + fp3_trial_chance(&seed);
        v[i] = 2 * fp3_trial_chance(&seed) - 1;
    }
    fp3_status status = fp3_rig_open(c->trial, c->is_driven ? driven_text : free_text,
                                     c->arithmetic, 1, OBJECTS, rig, error);
    if (!status)
        c->order = fp3_lab_program(rig->lab)->order;
    if (!status)
        status = fp3_lab_fill(rig->lab, "x", x, error);
    if (!status)
        status = fp3_lab_fill(rig->lab, "v", v, error);
    for (unsigned k = 0; !status && k < c->count; k++) {
        c->steps[k] = round(SPAN * pow(2, k / 2.0));
        c->h[k] = fp3_lab_number(c->arithmetic, SPAN / c->steps[k]);
        status = measure(c, rig, k, error);
    }
    return status;
}

static unsigned best_of(const curve *c) {
    unsigned best = 0;
    for (unsigned k = 1; k < c->count; k++)
        best = c->error[k] < c->error[best] ? k : best;
    return best;
}

/* Two words have the numbers as they are. */
static fp3_trial_numbers numbers_of(const curve *c) {
    return c->arithmetic->update == FP3_DOUBLE_SINGLE ? FP3_TRIAL_UNROUNDED : FP3_TRIAL_ROUNDED;
}

/* The error of the same steps in double, by the numbers that the program has, of the first EXACT
 * objects. */
static fp3_status exact_error(const curve *c, fp3_rig *rig, unsigned rung, double *off,
                              fp3_error *error) {
    const uint64_t steps = (uint64_t)c->steps[rung];
    const double t = c->h[rung] * c->steps[rung];
    double sum = 0, row[2];
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < EXACT; i++) {
        const double *start = fp3_lab_initial(rig->lab, i);
        status =
            fp3_trial_exact(c->trial, rig, numbers_of(c), i, c->h[rung], &steps, 1, row, error);
        if (!status)
            sum +=
                gsl_pow_2((row[1] - truth(c, t, start[1], start[0])) / hypot(start[0], start[1]));
    }
    *off = sqrt(sum / EXACT);
    return status;
}

/* The slope of the method without roundings but those of its numbers, over rungs from .. to. */
static fp3_status exact_slope(const curve *c, fp3_rig *rig, unsigned from, unsigned to,
                              double *slope, double *least, fp3_error *error) {
    double off[RUNGS] = {0};
    fp3_status status = FP3_OK;
    for (unsigned k = from; !status && k < to; k++)
        status = exact_error(c, rig, k, &off[k], error);
    *slope = status ? NAN : fp3_trial_slope(c->h + from, off + from, to - from);
    *least = off[to - 1];
    return status;
}

static int loses_nothing(const curve *c) {
    return c->arithmetic->update == FP3_DOUBLE_SINGLE || c->arithmetic->update == FP3_COMPENSATED;
}

/* What roundings make of the error at least (drift.c): see below. */
static double least_of_roundings(const curve *c, unsigned rung) {
    const double n = c->steps[rung];
    return loses_nothing(c)
               ? 0
               : hypot(fp3_lab_bias(c->arithmetic) * n, fp3_lab_rounded(c->arithmetic) * sqrt(n));
}

/* The slope where the method's error is far above the roundings', over the shortest such steps.
 * What is expected is the slope in double of the same objects: a method of high order may not be
 * near its order yet where FP32 ends, and there each object has a slope of its own. */
static fp3_status judge_order(const curve *c, fp3_rig *rig, fp3_error *error) {
    const unsigned best = best_of(c);
    /* Where errors still fall in the end, the roundings' are not seen yet. */
    const double floor = best + 1 < c->count ? c->error[best] : FLOOR * fp3_lab_unit(c->arithmetic);
    unsigned to = 0, from = 0;
    while (to < c->count && !(c->error[to] < ABOVE * fmax(floor, least_of_roundings(c, to))))
        to++;
    while (from < to && !(c->error[from] < LARGE))
        from++;
    from = to > 4 && from < to - 4 ? to - 4 : from;
    if (to < from + 2) /* at the first step already there are only roundings: no order to be seen */
        return FP3_OK;
    double least;
    char because[128];
    fp3_verdict v =
        fp3_trial_verdict(c->trial, "steps", c->is_driven ? "driven" : "swing", c->arithmetic,
                          "slope of the error from h = %.3g to %.3g: that in double, "
                          "of order %u",
                          c->h[from], c->h[to - 1], c->order);
    const fp3_status status = exact_slope(c, rig, from, to, &v.expected, &least, error);
    snprintf(because, sizeof because,
             "at the shortest of these steps the error of %d objects is %.3g, in double %.3g",
             EXACT, c->few[to - 1], least);
    v.measured = fp3_trial_slope(c->h + from, c->few + from, to - from);
    v.tolerance = ORDER_OFF;
    v.because = because;
    return status ? status : fp3_verdicts_add(c->trial->verdicts, &v, error);
}

/* Of updates that lose nothing, what is left at the smallest step is the method's, and the last
 * sums'. Stoermer's keeps h v as one float, which is rounded three times a step: a walk of N
 * roundings of v, each of which turns with the oscillation. Double-single rounds as plain updates
 * do, at the end of its second word; Stoermer's method takes that for a rounding of h v. */
static fp3_status judge_end(const curve *c, fp3_rig *rig, fp3_error *error) {
    const int is_pair = c->arithmetic->update == FP3_DOUBLE_SINGLE, last = (int)c->count - 1;
    const int is_stoermer = c->trial->run->kind == FP3_STOERMER, is_walk = is_pair || is_stoermer;
    const double half = fp3_lab_unit(c->arithmetic), unit = is_pair ? half * half : half;
    const double rounded = fp3_lab_rounded(c->arithmetic);
    const double pairs = rounded * sqrt(c->steps[last]) / (is_stoermer ? c->h[last] : 1);
    const double walk = is_pair ? SIGMAS * pairs
                        : is_stoermer
                            ? FLOOR * half + SIGMAS * rounded * sqrt(3 * c->steps[last]) / 2
                            : FLOOR * half;
    double exact;
    const fp3_status status = exact_error(c, rig, (unsigned)last, &exact, error);
    fp3_verdict v =
        fp3_trial_verdict(c->trial, "steps", c->is_driven ? "driven" : "swing", c->arithmetic,
                          "error at h = %.3g, in units of 2^-%d: that in double, and %s",
                          c->h[last], is_pair ? 48 : 24, is_walk ? "a walk of roundings" : "4");
    v.relation = FP3_AT_MOST;
    v.expected = exact / unit;
    v.measured = c->few[last] / unit;
    v.tolerance = walk / unit;
    return status ? status : fp3_verdicts_add(c->trial->verdicts, &v, error);
}

/* How the roundings' error grows as a power of h, u being the unit of x: 2^-23 in binary32.
 *
 * Roundings of N = T/h steps: independent, they add up as sqrt(N), all in one direction, as N
 * (Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed. 2002, section 2.8; Henrici
 * 1962). x is a multiple of its unit, so what is rounded is h f alone: independent from step to
 * step only while it changes by a unit or more, h^2 |x''| > u.
 *
 * Stoermer's recursion takes a rounding r of x for one of the velocity, r/h, and rounds h^2 x'',
 * which changes by h^3 x''' a step. Below h = u^(1/3) it passes all fractions of a unit evenly, so
 * roundings cancel, but where x''' = 0: there, over sqrt(2 u)/h^2 steps, all are alike. (u/h)
 * sqrt(u)/h^2 goes with h^-3. Cut off, each is -u/2 in the mean, as an acceleration of u/(2 h^2).
 * Of logarithms both are as large, and there is no power. */
static double power_of_roundings(const curve *c, unsigned from) {
    double both[RIGHT];
    if (c->trial->run->kind == FP3_STOERMER)
        return fp3_lab_truncates(c->arithmetic) ? -2 : -3;
    for (unsigned k = 0; k < RIGHT; k++)
        both[k] = least_of_roundings(c, from + k);
    return fp3_trial_slope(c->h + from, both, RIGHT);
}

/* With few bits there are few steps between the method's error and those that are too short, and
 * the slope over so few is chance. So it is the size that is judged. An update that is off by e of
 * x leaves e x cos(t) of it in the end, or of v e v sin(t): squares of all of these are 1/4 in the
 * mean. The errors of h and of coefficients, which are as large, are taken away: */
static fp3_status error_of_roundings(const curve *c, fp3_rig *rig, unsigned rung, double *off,
                                     fp3_error *error) {
    const uint64_t steps = (uint64_t)c->steps[rung];
    double sum = 0, row[2];
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < OBJECTS; i++) {
        const double *start = fp3_lab_initial(rig->lab, i);
        status =
            fp3_trial_exact(c->trial, rig, FP3_TRIAL_ROUNDED, i, c->h[rung], &steps, 1, row, error);
        sum += gsl_pow_2((c->x[rung][i] - row[1]) / hypot(start[0], start[1]));
    }
    *off = sqrt(sum / OBJECTS);
    return status;
}

/* The last rung that is what is said above: of Stoermer's method cut off, while the error is small.
 */
static unsigned last_of_roundings(const curve *c) {
    const int is_stoermer = c->trial->run->kind == FP3_STOERMER;
    unsigned last = c->count - 1;
    if (fp3_lab_truncates(c->arithmetic))
        while (is_stoermer && last && c->error[last] > LARGE)
            last--;
    else
        while (last && c->h[last] * c->h[last] < 2 * fp3_lab_unit(c->arithmetic))
            last--;
    return last;
}

static fp3_status judge_walk(const curve *c, fp3_rig *rig, fp3_error *error) {
    const fp3_integrator *run = c->trial->run;
    const unsigned updates = run->kind == FP3_SPLITTING ? run->stages : 2;
    const unsigned last = last_of_roundings(c), from = best_of(c) + 1;
    double sum = 0, off;
    fp3_status status = FP3_OK;
    /* Of other kinds roundings of the stages count, too. */
    if (from + LEAST_WALK > last + 1 ||
        (run->kind != FP3_SPLITTING && run->kind != FP3_RUNGE_KUTTA))
        return FP3_OK;
    for (unsigned k = from; !status && k <= last; k++) {
        status = error_of_roundings(c, rig, k, &off, error);
        sum += gsl_pow_2(off / least_of_roundings(c, k)) / (last - from + 1);
    }
    fp3_verdict v = fp3_trial_verdict(
        c->trial, "steps", c->is_driven ? "driven" : "swing", c->arithmetic,
        "what roundings do from h = %.3g to %.3g, by the random walk of one state", c->h[from],
        c->h[last]);
    v.expected = sqrt(updates) / 2;
    v.measured = sqrt(sum);
    v.tolerance = WALK_OFF * v.expected;
    return status ? status : fp3_verdicts_add(c->trial->verdicts, &v, error);
}

static fp3_status judge_right(const curve *c, fp3_error *error) {
    const unsigned best = best_of(c), last = last_of_roundings(c);
    if (best + RIGHT > last)
        return FP3_OK;
    const unsigned from = last - RIGHT + 1;
    const int is_stoermer = c->trial->run->kind == FP3_STOERMER;
    if (is_stoermer && fp3_lab_is_logarithmic(c->arithmetic))
        return FP3_OK;
    if (is_stoermer && !fp3_lab_truncates(c->arithmetic) &&
        gsl_pow_3(c->h[from]) > 2 * fp3_lab_unit(c->arithmetic)) /* too long for it */
        return FP3_OK;
    fp3_verdict v = fp3_trial_verdict(
        c->trial, "steps", c->is_driven ? "driven" : "swing", c->arithmetic,
        "slope of the roundings' error from h = %.3g to %.3g", c->h[from], c->h[last]);
    v.measured = fp3_trial_slope(c->h + from, c->error + from, RIGHT);
    v.expected = power_of_roundings(c, from);
    v.tolerance = GROWTH_OFF;
    return fp3_verdicts_add(c->trial->verdicts, &v, error);
}

/* Short time steps show nothing new of what rounds as plain does; others take long. */
static unsigned rungs_of(const fp3_trial *trial, const fp3_lab_arithmetic *arithmetic,
                         int is_driven) {
    const int is_pair = arithmetic->update == FP3_DOUBLE_SINGLE;
    if (trial->options->is_quick)
        return is_pair ? RUNGS_LEAST : RUNGS_QUICK;
    return is_driven || is_pair || fp3_lab_is_nearly_plain(arithmetic) ||
                   fp3_lab_is_slow(arithmetic)
               ? RUNGS_QUICK
               : RUNGS;
}

static fp3_status run(const fp3_trial *trial, const fp3_lab_arithmetic *arithmetic, int is_driven,
                      fp3_error *error) {
    curve c = {.trial = trial,
               .arithmetic = arithmetic,
               .is_driven = is_driven,
               .count = rungs_of(trial, arithmetic, is_driven)};
    char series[96];
    snprintf(series, sizeof series, "%s, %s", trial->integrator->name, fp3_lab_name(arithmetic));
    fp3_rig rig;
    fp3_status status = measure_all(&c, &rig, error);
    if (fp3_trial_has_no_room(arithmetic, status)) {
        fp3_rig_close(&rig);
        return FP3_OK;
    }
    if (!status)
        status = judge_order(&c, &rig, error);
    if (!status && !is_driven)
        status = loses_nothing(&c)              ? judge_end(&c, &rig, error)
                 : fp3_lab_is_small(arithmetic) ? judge_walk(&c, &rig, error)
                                                : judge_right(&c, error);
    fp3_rig_close(&rig);
    if (!status && !is_driven)
        status = fp3_verdicts_draw(trial->verdicts, "steps", series, c.h, c.error, c.count, error);
    return status;
}

fp3_status fp3_section_steps(const fp3_trial *trial, fp3_error *error) {
    const fp3_lab_arithmetic *plain = &fp3_lab_arithmetics[FP3_LAB_PLAIN];
    fp3_status status = fp3_trial_tries(trial, plain, 0) ? run(trial, plain, 1, error) : FP3_OK;
    for (unsigned i = 0; !status && i < fp3_lab_arithmetic_count; i++)
        if (fp3_trial_tries(trial, &fp3_lab_arithmetics[i],
                            trial->options->is_quick &&
                                fp3_lab_is_nearly_plain(&fp3_lab_arithmetics[i])))
            status = run(trial, &fp3_lab_arithmetics[i], 0, error);
    return status;
}
