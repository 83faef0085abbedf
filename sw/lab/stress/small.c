/* SPDX-License-Identifier: Apache-2.0 */
/* small.c - where a step moves nothing any more: beside a state of ordinary size, near an
 * equilibrium, and at the lower end of the numbers. What should be is exact, from the rules of IEEE
 * 754. */
#include "sections.h"

#include <math.h>
#include <stdio.h>

#define OBJECTS 512
#define MIDDLE (OBJECTS / 2)

/* ---- an update below half a unit ---- */

#define MOVE_STEPS 4096

static const char move_text[] = "model move\nparam a = 1\nstate x = 1\nstep 1\nx' = a\n";

/* The next number on the way to `to`. Where a sum is rounded is not known to a last place of
 * logarithms, so that they are taken further apart. */
static float beside(const fp3_lab_arithmetic *how, float at, float to) {
    const double way = to < at ? -1 : 1;
    int exponent;
    const int is_power =
        frexpf(at, &exponent) == 0.5f; /* below it, numbers are half as far apart */
    return (float)(fp3_lab_is_logarithmic(how)
                       ? (double)at * (1 + way * 0x1p-9)
                       : at + way * ldexp(fp3_lab_unit(how), exponent - (is_power && to < at)));
}

/* Objects whose a are the numbers around `centre`; *largest: the largest a that does not move 1.
 * *off: by how many units of 2^-23 the others are off at most. */
static fp3_status move(const fp3_trial *trial, const fp3_lab_arithmetic *how, double centre,
                       double *largest, double *off, fp3_error *error) {
    double a[OBJECTS], x[OBJECTS];
    float at = (float)centre;
    fp3_rig rig;
    for (int i = MIDDLE; i < OBJECTS; i++, at = beside(how, at, INFINITY))
        a[i] = (double)at;
    at = (float)centre;
    for (int i = MIDDLE; i >= 0; i--, at = beside(how, at, 0))
        a[i] = (double)at;
    fp3_status status = fp3_rig_open(trial, move_text, how, 1, OBJECTS, &rig, error);
    if (!status)
        status = fp3_lab_fill(rig.lab, "a", a, error);
    if (!status)
        status = fp3_lab_start(rig.lab, error);
    if (!status)
        status = fp3_lab_run(rig.lab, MOVE_STEPS, error);
    if (!status)
        status = fp3_lab_read(rig.lab, "x", x, error);
    fp3_rig_close(&rig);
    *largest = *off = 0;
    for (int i = 0; !status && i < OBJECTS; i++) {
        *largest = x[i] == 1 ? a[i] : *largest;
        *off = fmax(*off, fabs(x[i] - 1 - MOVE_STEPS * a[i]) * 0x1p23);
    }
    return status;
}

/* 1 + a is 1 for a up to half a unit, of logarithms about there: the tie goes to the even 1 (IEEE
 * 754, 4.3.1); of a truncated sum below a unit. What is kept of updates is added exactly but for
 * the last sum. In double-single a and all sums are multiples of 2^-48 below 2, which has room for
 * them. */
static fp3_status judge_move(const fp3_trial *trial, const fp3_lab_arithmetic *how,
                             fp3_error *error) {
    const int bits = -ilogb(fp3_lab_unit(how)); /* of half a unit beside 1 */
    const int is_log = fp3_lab_is_logarithmic(how);
    const double half = is_log ? fp3_lab_unit(how) : ldexp(1, -bits), unit = 2 * half;
    const int is_pair = how->update == FP3_DOUBLE_SINGLE;
    double largest, off;
    fp3_status status =
        move(trial, how, fp3_lab_truncates(how) ? unit : half, &largest, &off, error);
    fp3_verdict v =
        is_pair || how->update == FP3_COMPENSATED
            ? fp3_trial_verdict(trial, "stagnation", "move", how,
                                "x' = a below half a unit, off after 4096 steps, in units%s",
                                is_pair ? " of 2^-48" : "")
            : fp3_trial_verdict(trial, "stagnation", "move", how,
                                "largest h f that leaves x = 1 where it is, in units of %s2^-%d",
                                is_log ? "ln 2 " : "", is_log ? 24 : bits);
    if (is_pair || how->update == FP3_COMPENSATED) {
        v.relation = FP3_AT_MOST;
        v.expected = is_pair ? 0 : 0.5; /* the sum, rounded once */
        v.measured = is_pair ? off * 0x1p25 : off;
    } else {
        v.expected = (fp3_lab_truncates(how) ? (double)beside(how, (float)unit, 0) : half) / half;
        v.tolerance = is_log ? 0.3 : 0; /* a sum is within 0.65 of the last place, not 0.5 */
        v.measured = largest / half;
    }
    return status ? status : fp3_verdicts_add(trial->verdicts, &v, error);
}

/* ---- near an equilibrium ---- */

#define CALM_STEPS 65536
#define CALM_STEP 0.00390625 /* at least, and ... */
#define CALM_UNITS 64        /* ... so many units of roundoff, so that the bound is far from x */

static const char calm_text[] =
    "model calm\nparam p = 1\nparam q = 1\nstate x = 0\nstep 1\nx' = p - q*x\n";

/* x stops where h f is half a unit of x, 2^-24 x to 2^-23 x; f = p - q x itself is off by 2^-24 p
 * and a unit. So |x - p/q| stays below (2^-24/(h q) + 2^-23) p/q times 2 at most; compensated,
 * below what f is off by. In double-single products are off by 5 2^-48 at most, sums by less, in
 * place of 2^-24, and of logarithms sums by 1.3 times that. */
static fp3_status judge_calm(const fp3_trial *trial, const fp3_lab_arithmetic *how,
                             fp3_error *error) {
    const double unit = fp3_lab_unit(how), h = fmax(CALM_STEP, CALM_UNITS * unit);
    double p[OBJECTS], q[OBJECTS], x[OBJECTS];
    uint64_t seed = 5;
    fp3_rig rig;
    for (int i = 0; i < OBJECTS; i++) {
        p[i] = 1 + 4 * fp3_trial_chance(&seed);
        q[i] = 1 + 4 * fp3_trial_chance(&seed);
    }
    fp3_status status = fp3_rig_open(trial, calm_text, how, h, OBJECTS, &rig, error);
    if (!status)
        status = fp3_lab_fill(rig.lab, "p", p, error);
    if (!status)
        status = fp3_lab_fill(rig.lab, "q", q, error);
    if (!status)
        status = fp3_lab_start(rig.lab, error);
    if (!status)
        status = fp3_lab_run(rig.lab, CALM_STEPS, error);
    if (!status)
        status = fp3_lab_read(rig.lab, "x", x, error);
    fp3_verdict v = fp3_trial_verdict(trial, "stagnation", "calm", how,
                                      "distance from the equilibrium at most, by its bound");
    v.relation = FP3_AT_MOST;
    v.expected = 1;
    for (size_t i = 0; !status && i < OBJECTS; i++) {
        const double *at = fp3_lab_params(rig.lab, i);
        const double rounding = how->update == FP3_DOUBLE_SINGLE ? 5 * 0x1p-48
                                : fp3_lab_truncates(how)         ? 2 * unit
                                : fp3_lab_is_logarithmic(how)    ? 1.3 * unit
                                                                 : unit;
        const double stops = how->update == FP3_COMPENSATED ? 0 : rounding / (h * at[1]);
        const double bound = 2 * (stops + 2 * rounding) * at[0] / at[1];
        v.measured = fmax(v.measured, fabs(x[i] - at[0] / at[1]) / bound);
    }
    fp3_rig_close(&rig);
    return status ? status : fp3_verdicts_add(trial->verdicts, &v, error);
}

fp3_status fp3_section_stagnation(const fp3_trial *trial, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (unsigned i = 0; !status && i < fp3_lab_arithmetic_count; i++) {
        if (!fp3_trial_tries(trial, &fp3_lab_arithmetics[i], 0))
            continue;
        status = judge_move(trial, &fp3_lab_arithmetics[i], error);
        if (!status)
            status = judge_calm(trial, &fp3_lab_arithmetics[i], error);
    }
    return status;
}

/* ---- the lower end ---- */

#define DECAY_STEPS 20000

static const char decay_text[] = "model decay\nparam a = 1\nstate x = 1e-30\nstep 1\nx' = -a*x\n";

/* Where a decay by a stops, by Euler's method with h = 1. Gradual: a x rounds to 0 up to half of
 * the smallest number, truncated below all of it. Flushed, and of logarithms: a x is 0 below the
 * smallest number; the last x is less than one step below that. */
static int is_right(const fp3_lab_arithmetic *how, double a, double x) {
    const double least = fp3_lab_least(how);
    if (fp3_lab_flushes(how))
        return a * x < least * (1 + 0x1p-23) && x >= (1 - a) * least / a * (1 - 0x1p-22) &&
               x >= least;
    const double units = fp3_lab_truncates(how) ? ceil(1 / a) - 1 : floor(0.5 / a);
    return x == units * least;
}

static fp3_status judge_decay(const fp3_trial *trial, const fp3_lab_arithmetic *how,
                              fp3_error *error) {
    double a[OBJECTS], x[OBJECTS];
    fp3_rig rig;
    for (int i = 0; i < OBJECTS; i++)
        a[i] = fp3_lab_number(how, i ? 0.01 + 0.48 * i / OBJECTS : 0.5);
    fp3_status status = fp3_rig_open(trial, decay_text, how, 1, OBJECTS, &rig, error);
    if (!status)
        status = fp3_lab_fill(rig.lab, "a", a, error);
    if (!status)
        status = fp3_lab_start(rig.lab, error);
    if (!status)
        status = fp3_lab_run(rig.lab, DECAY_STEPS, error);
    if (!status)
        status = fp3_lab_read(rig.lab, "x", x, error);
    fp3_rig_close(&rig);
    int wrong = 0, first = -1;
    for (int i = 0; !status && i < OBJECTS; i++)
        if (!is_right(how, a[i], x[i])) {
            first = first < 0 ? i : first;
            wrong++;
        }
    char because[128] = "";
    if (first >= 0)
        snprintf(because, sizeof because, "a = %.9g stops at %.9g = %.9g of the smallest", a[first],
                 x[first], x[first] / fp3_lab_least(how));
    fp3_verdict v =
        fp3_trial_verdict(trial, "subnormal", "decay", how,
                          "of %d decays, those that stop elsewhere than they should", OBJECTS);
    v.measured = wrong;
    v.because = because;
    return status ? status : fp3_verdicts_add(trial->verdicts, &v, error);
}

/* Multiplies by 1 - a once a step, and loses nothing else: by Euler's method. */
fp3_status fp3_section_subnormal(const fp3_trial *trial, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (unsigned i = 0; !status && i < fp3_lab_arithmetic_count; i++)
        if (fp3_lab_arithmetics[i].update != FP3_COMPENSATED &&
            fp3_trial_tries(trial, &fp3_lab_arithmetics[i], 0))
            status = judge_decay(trial, &fp3_lab_arithmetics[i], error);
    return status;
}
