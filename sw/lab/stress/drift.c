/* SPDX-License-Identifier: Apache-2.0 */
/* drift.c - a planet over a million steps: what becomes of its energy, its momentum and its place.
 *
 * 64 objects are the same orbit, turned, so that their roundings are independent: their mean is the
 * method's drift, and whatever is the same in all roundings; their spread is the random walk.
 * Energies are means over an orbit.
 */
#include "kepler.h"
#include "sections.h"

#include <gsl/gsl_pow_int.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OBJECTS 64
#define ECCENTRICITY 0.2
#define STEPS 1000000
#define STEPS_QUICK 65536 /* and of double-single, in quick as few as ... */
#define STEPS_LEAST 4096
#define WINDOWS 12        /* each at sqrt(2) times the step of the one before */
#define LOOKS 16          /* of a window: an orbit */
#define ALL (WINDOWS + 1) /* the first is the start */

#define CUT_MOST 0.05 /* of the energy: until then the orbit is what it was */
#define SIGMAS 4
#define NEAR 0.2 /* an error of place that is not yet the size of the orbit */
#define LAST_WINDOWS 6
#define POWER_OFF 0.2

typedef struct {
    const fp3_trial *trial;
    const fp3_lab_arithmetic *arithmetic;
    double h;
    uint64_t total, steps[ALL * LOOKS];
    double t[ALL];
    double *rows;                /* of a look */
    double energy[ALL][OBJECTS]; /* mean of a window */
    double momentum[ALL][OBJECTS];
    double place[ALL][OBJECTS]; /* how far ahead of its place an object is, likewise */
    /* Of the first object in double; pure: by coefficients that are not rounded. */
    double exact_energy[ALL], exact_momentum[ALL], exact_place[ALL];
    double pure_energy[ALL], pure_momentum[ALL];
    const fp3_lab_arithmetic *exact_of; /* whose coefficients they are by */
} drift;

/* Short enough that the method alone does not ruin the orbit in a million steps. */
static double step_of(const fp3_integrator *integrator) {
    static const int exponents[] = {0, 13, 8, 7, 5, 5, 4, 4, 4};
    return ldexp(
        1, -exponents[integrator->position_order < integrator->order ? integrator->position_order
                                                                     : integrator->order]);
}

static void plan(drift *d) {
    const double orbit = 2 * M_PI / d->h;
    for (int w = 0; w < ALL; w++) {
        const double first = w ? ((double)d->total - orbit) * pow(2, (w - WINDOWS) / 2.0) : 0;
        for (int l = 0; l < LOOKS; l++)
            d->steps[w * LOOKS + l] = (uint64_t)(first + orbit * l / LOOKS);
        d->t[w] = (double)d->steps[w * LOOKS] * d->h;
    }
}

/* Two words have the numbers as they are. */
static int is_pair(const drift *d) { return d->arithmetic->update == FP3_DOUBLE_SINGLE; }

/* Along the way. */
static double ahead(const double *start, double t, const double *row) {
    double truth[FP3_KEPLER_STATES];
    fp3_kepler_truth(start, t, truth);
    return ((row[2] - truth[2]) * truth[0] + (row[3] - truth[3]) * truth[1]) /
           hypot(truth[0], truth[1]);
}

static void take(drift *d, const fp3_lab *lab, int look) {
    const int w = look / LOOKS;
    const double t = (double)d->steps[look] * d->h;
    for (size_t i = 0; i < OBJECTS; i++) {
        const double *row = d->rows + FP3_KEPLER_STATES * i;
        d->energy[w][i] += fp3_kepler_energy(row) / LOOKS;
        d->momentum[w][i] += fp3_kepler_momentum(row) / LOOKS;
        d->place[w][i] += ahead(fp3_lab_initial(lab, i), t, row) / LOOKS;
    }
}

/* Windows may overlap at the start, so their looks are taken in the order of steps. */
static int by_step(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

static fp3_status measure(drift *d, fp3_lab *lab, fp3_error *error) {
    uint64_t order[ALL * LOOKS][2], at = 0;
    fp3_status status = fp3_lab_start(lab, error);
    for (int look = 0; look < ALL * LOOKS; look++)
        order[look][0] = d->steps[look], order[look][1] = (uint64_t)look;
    qsort(order, ALL * LOOKS, sizeof *order, by_step);
    for (int k = 0; !status && k < ALL * LOOKS; at = order[k][0], k++) {
        status = fp3_lab_run(lab, order[k][0] - at, error);
        if (!status)
            status = fp3_lab_read_all(lab, d->rows, error);
        if (!status)
            take(d, lab, (int)order[k][1]);
    }
    return status;
}

/* The same steps in double: the method without roundings, but those of its numbers where they are
 * asked for. */
static fp3_status follow(drift *d, fp3_rig *rig, fp3_trial_numbers numbers, double *energy,
                         double *momentum, double *place, fp3_error *error) {
    const double *start = fp3_lab_initial(rig->lab, 0);
    uint64_t order[ALL * LOOKS][2], steps[ALL * LOOKS];
    double *rows = calloc(ALL * LOOKS * FP3_KEPLER_STATES, sizeof *rows);
    for (int look = 0; look < ALL * LOOKS; look++)
        order[look][0] = d->steps[look], order[look][1] = (uint64_t)look;
    qsort(order, ALL * LOOKS, sizeof *order, by_step);
    for (int k = 0; k < ALL * LOOKS; k++)
        steps[k] = order[k][0];
    const fp3_status status =
        rows ? fp3_trial_exact(d->trial, rig, numbers, 0, d->h, steps, ALL * LOOKS, rows, error)
             : fp3_no_memory(error);
    for (int k = 0; !status && k < ALL * LOOKS; k++) {
        const double *row = rows + FP3_KEPLER_STATES * k;
        const int w = (int)order[k][1] / LOOKS;
        energy[w] += fp3_kepler_energy(row) / LOOKS;
        momentum[w] += fp3_kepler_momentum(row) / LOOKS;
        place[w] += ahead(start, (double)steps[k] * d->h, row) / LOOKS;
    }
    for (int w = ALL - 1; w >= 0; w--)
        place[w] = fabs(place[w] - place[0]);
    free(rows);
    return status;
}

static fp3_status measure_exact(drift *d, fp3_rig *rig, fp3_error *error) {
    double ignored[ALL] = {0};
    fp3_status status = follow(d, rig, FP3_TRIAL_UNROUNDED, d->pure_energy, d->pure_momentum,
                               is_pair(d) ? d->exact_place : ignored, error);
    if (!status && !is_pair(d))
        return follow(d, rig, FP3_TRIAL_ROUNDED, d->exact_energy, d->exact_momentum, d->exact_place,
                      error);
    memcpy(d->exact_energy, d->pure_energy, sizeof d->pure_energy);
    memcpy(d->exact_momentum, d->pure_momentum, sizeof d->pure_momentum);
    return status;
}

/* ---- verdicts ---- */

/* Mean and spread over the objects of what has become of a value since the start, relative to it.
 */
static void change(double values[ALL][OBJECTS], int w, double *mean, double *spread) {
    double sum = 0, squares = 0;
    for (int i = 0; i < OBJECTS; i++) {
        const double x = values[w][i] / values[0][i] - 1;
        sum += x;
        squares += x * x;
    }
    *mean = sum / OBJECTS;
    *spread = sqrt(fmax(0, squares / OBJECTS - *mean * *mean));
}

/* Stoermer's two-term recursion takes a rounding of x for a change of the velocity, by 1/h as large
 * (Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, chapter III.10). The
 * random walk of updates rounded to nearest: v dv + r dr/r^3 of two components of v and of r in
 * each substep, relative to the energy 1/2. */
static double walk(const drift *d) {
    const unsigned updates = d->trial->run->kind == FP3_SPLITTING ? d->trial->run->stages : 2;
    const double rounded = fp3_lab_rounded(d->arithmetic);
    const double all = 2 * rounded * sqrt(0.75 * updates * (double)d->total);
    /* The k of a linearly implicit method solve n linear equations: a backward error of 3 n
     * roundings (Higham, theorem 9.4). */
    const double of_k = d->trial->run->kind == FP3_ROSENBROCK ? 3 * FP3_KEPLER_STATES : 1;
    const double each = d->arithmetic->update == FP3_COMPENSATED
                            ? all * of_k * d->h + 4 * fp3_lab_unit(d->arithmetic)
                            : all;
    return d->trial->run->kind == FP3_STOERMER ? each / d->h : each;
}

/* A program adds the products c k to a state from the left, and k and the sum are multiples of
 * units far above the error of c, less than half a unit of c k. So c's error may be rounded away or
 * doubled, alike in all orbits that have the same units: what rounded coefficients do in double
 * (exact beside pure) is seen up to once more or less. With coefficients that FP32 has, it is
 * nothing. Measured on Kepler's problem by rk6 in FP32 but for its coefficients: 3e-7 instead
 * of 1.2e-5 in 65536 steps. */
static double doubt(const double *exact, const double *pure) {
    return fabs(exact[WINDOWS] / exact[0] - pure[WINDOWS] / pure[0]);
}

static fp3_status judge_value(const drift *d, const char *what, double values[ALL][OBJECTS],
                              const double *exact, const double *pure, fp3_error *error) {
    double mean, spread;
    change(values, WINDOWS, &mean, &spread);
    const int is_kept = fp3_trial_is_symplectic(d->trial->integrator) && !is_pair(d);
    const double in_double = exact[WINDOWS] / exact[0] - 1;
    fp3_verdict v =
        fp3_trial_verdict(d->trial, "drift", "kepler", d->arithmetic,
                          "%s: relative change%s in %" PRIu64 " steps of h = %g (%s)", what,
                          is_pair(d) ? " of the first object" : "", d->total, d->h,
                          is_kept ? "bounded, random walk" : "that of the method in double");
    v.expected = is_kept ? 0 : in_double;
    v.measured = is_pair(d) ? values[WINDOWS][0] / values[0][0] - 1 : mean;
    v.tolerance = SIGMAS * walk(d) + (is_pair(d) ? 0 : 0.01 * fabs(v.expected)) +
                  (is_kept ? 0 : doubt(exact, pure));
    double half, ignored;
    char because[160];
    change(values, WINDOWS - 2, &half, &ignored);
    snprintf(because, sizeof because,
             "after half the steps off by %.2g, in the end by %.2g; objects part by %.2g; in "
             "double %.3g, with coefficients that are not rounded %.3g",
             half - (is_kept ? 0 : exact[WINDOWS - 2] / exact[0] - 1), mean - v.expected, spread,
             in_double, pure[WINDOWS] / pure[0] - 1);
    v.because = because;
    return fp3_verdicts_add(d->trial->verdicts, &v, error);
}

/* Each update is cut towards 0, or of logarithms is too large, by fp3_lab_bias of itself: of v this
 * takes v^2 from the energy, of r 1/r, and the mean of each over an orbit is 1. Relative to the
 * energy, -1/2, that is twice as much for each update of v, and of r. */
static fp3_status judge_bias(drift *d, fp3_error *error) {
    const unsigned updates = d->trial->run->kind == FP3_SPLITTING ? d->trial->run->stages : 2;
    double mean[ALL], spread;
    int last = 1;
    for (int w = 1; w < ALL; w++) {
        change(d->energy, w, &mean[w], &spread);
        last = fabs(mean[w]) < CUT_MOST ? w : last;
    }
    const double steps = d->t[last] / d->h;
    fp3_verdict v = fp3_trial_verdict(
        d->trial, "drift", "kepler", d->arithmetic,
        "energy: relative change in each step, up to t = %.3g (linear: all roundings one way)",
        d->t[last]);
    v.expected = -2 * fp3_lab_bias(d->arithmetic) * updates +
                 (d->exact_energy[last] / d->exact_energy[0] - 1) / steps;
    v.measured = mean[last] / steps;
    v.tolerance = 0.25 * fabs(v.expected);
    return fp3_verdicts_add(d->trial->verdicts, &v, error);
}

static fp3_status judge_spread(drift *d, fp3_error *error) {
    double mean, spread[ALL];
    for (int w = 1; w < ALL; w++)
        change(d->energy, w, &mean, &spread[w]);
    fp3_verdict v = fp3_trial_verdict(d->trial, "drift", "kepler", d->arithmetic,
                                      "energy: power of t with which objects part (random walk)");
    v.expected = 0.5;
    v.measured = fp3_trial_slope(d->t + 1, spread + 1, WINDOWS);
    v.tolerance = 0.15;
    return fp3_verdicts_add(d->trial->verdicts, &v, error);
}

/* Whether the roundings of successive steps are: see steps.c. */
static int is_independent(const drift *d) {
    return !is_pair(d) && d->arithmetic->update != FP3_COMPENSATED &&
           d->h * d->h > 2 * fp3_lab_unit(d->arithmetic);
}

/* How far ahead since the first orbit, within which a method errs to and fro: mean and spread over
 * the objects. */
static void lead(const drift *d, int w, double *mean, double *spread) {
    double sum = 0, squares = 0;
    for (int i = 0; i < OBJECTS; i++) {
        const double since = d->place[w][i] - d->place[0][i];
        sum += since;
        squares += gsl_pow_2(since);
    }
    *mean = fabs(sum / OBJECTS);
    *spread = sqrt(fmax(0, squares / OBJECTS - gsl_pow_2(sum / OBJECTS)));
}

static fp3_status judge_power(const drift *d, const char *what, const double *values, int from,
                              int to, double expected, fp3_error *error) {
    /* Where an error of higher power is still the smaller one, double has another slope, too. */
    const double slope =
        fp3_trial_slope(d->t + from, d->exact_place + from, (size_t)(to - from + 1));
    const int is_other = expected != 1.5 && fabs(slope - expected) > POWER_OFF;
    fp3_verdict v = fp3_trial_verdict(d->trial, "drift", "kepler", d->arithmetic,
                                      "place: power of t with which %s: %g%s", what, expected,
                                      is_other ? " (another in double, too)" : "");
    v.expected = is_other ? slope : expected;
    v.measured = fp3_trial_slope(d->t + from, values + from, (size_t)(to - from + 1));
    v.tolerance = POWER_OFF;
    return fp3_verdicts_add(d->trial->verdicts, &v, error);
}

/* The mean of a symplectic method's objects errs with t, that of another with t^2; the random walk
 * of the energy makes objects part with t^(3/2) (Hairer, Lubich and Wanner, Geometric Numerical
 * Integration, X.3; Brouwer, Astron. J. 46, 149 (1937)). */
static fp3_status judge_place(drift *d, fp3_error *error) {
    const int is_symplectic = fp3_trial_is_symplectic(d->trial->integrator);
    double mean[ALL], spread[ALL];
    int last = 0;
    for (int w = 1; w < ALL; w++) {
        lead(d, w, &mean[w], &spread[w]);
        last +=
            last == w - 1 && mean[w] < NEAR && spread[w] < NEAR; /* later, it comes round again */
    }
    const int from = last - LAST_WINDOWS + 1;
    fp3_status status = FP3_OK;
    if (from < 1)
        return FP3_OK;
    if (mean[from] > SIGMAS * spread[from] / sqrt(OBJECTS) && mean[last] > spread[last])
        status =
            judge_power(d, "objects err together", mean, from, last, is_symplectic ? 1 : 2, error);
    if (!status && is_independent(d))
        status = judge_power(d, "objects part", spread, 1, last, 1.5, error);
    return status;
}

static fp3_status draw(drift *d, fp3_error *error) {
    double mean[ALL], place[ALL], spread;
    char series[96];
    for (int w = 1; w < ALL; w++) {
        lead(d, w, &place[w], &spread);
        place[w] = hypot(place[w], spread);
        change(d->energy, w, &mean[w], &spread);
        mean[w] = hypot(mean[w], spread);
    }
    snprintf(series, sizeof series, "%s, %s", d->trial->integrator->name,
             fp3_lab_name(d->arithmetic));
    fp3_status status =
        fp3_verdicts_draw(d->trial->verdicts, "energy", series, d->t + 1, mean + 1, WINDOWS, error);
    if (!status)
        status = fp3_verdicts_draw(d->trial->verdicts, "place", series, d->t + 1, place + 1,
                                   WINDOWS, error);
    return status;
}

static fp3_status judge(drift *d, fp3_error *error) {
    fp3_status status = draw(d, error);
    /* Stoermer's recursion takes what x is too large for a velocity, by 1/h as large: no theory
     * here. */
    if (fp3_lab_is_logarithmic(d->arithmetic) && d->trial->run->kind == FP3_STOERMER)
        return status;
    if (!status && fp3_lab_bias(d->arithmetic) != 0)
        return judge_bias(d, error);
    if (!status)
        status = judge_value(d, "energy", d->energy, d->exact_energy, d->pure_energy, error);
    if (!status)
        status =
            judge_value(d, "momentum", d->momentum, d->exact_momentum, d->pure_momentum, error);
    if (!status && is_independent(d))
        status = judge_spread(d, error);
    return status ? status : judge_place(d, error);
}

static void forget_exact(drift *d) {
    memset(d->exact_energy, 0, sizeof d->exact_energy);
    memset(d->exact_momentum, 0, sizeof d->exact_momentum);
    memset(d->exact_place, 0, sizeof d->exact_place);
    memset(d->pure_energy, 0, sizeof d->pure_energy);
    memset(d->pure_momentum, 0, sizeof d->pure_momentum);
}

static void forget(drift *d) {
    memset(d->energy, 0, sizeof d->energy);
    memset(d->momentum, 0, sizeof d->momentum);
    memset(d->place, 0, sizeof d->place);
}

/* The processor has no arithmetic without infinities, with fewer bits or by logarithms: it takes 30
 * times as long. */
static uint64_t steps_of(const drift *d) {
    if (d->trial->options->is_quick)
        return is_pair(d) ? STEPS_LEAST : STEPS_QUICK;
    return is_pair(d) || fp3_lab_is_slow(d->arithmetic) ? STEPS_QUICK : STEPS;
}

static fp3_status run(drift *d, const fp3_lab_arithmetic *arithmetic, fp3_error *error) {
    fp3_rig rig;
    d->arithmetic = arithmetic;
    d->total = steps_of(d);
    if (!fp3_lab_bias(arithmetic) && SIGMAS * walk(d) > CUT_MOST)
        return FP3_OK; /* with so few bits the walk takes the orbit apart, and steps are too short
                          to move it */
    plan(d);
    forget(d);
    if (d->exact_of && !fp3_lab_is_as_exact(d->exact_of, arithmetic))
        forget_exact(d);
    d->exact_of = arithmetic;
    fp3_status status =
        fp3_rig_open(d->trial, fp3_kepler_text, arithmetic, d->h, OBJECTS, &rig, error);
    if (fp3_trial_has_no_room(arithmetic, status)) {
        fp3_rig_close(&rig);
        return FP3_OK;
    }
    if (!status)
        status = fp3_kepler_fill(rig.lab, OBJECTS, ECCENTRICITY, error);
    if (!status)
        status = measure(d, rig.lab, error);
    if (!status && !d->exact_energy[0]) /* the same however the machine rounds */
        status = measure_exact(d, &rig, error);
    if (!status)
        status = judge(d, error);
    fp3_rig_close(&rig);
    return status;
}

fp3_status fp3_section_drift(const fp3_trial *trial, fp3_error *error) {
    drift *d = calloc(1, sizeof *d);
    if (!d)
        return fp3_no_memory(error);
    *d = (drift){.trial = trial,
                 .h = step_of(trial->integrator), /* a power of two: a number of every format */
                 .rows = calloc(OBJECTS * FP3_KEPLER_STATES, sizeof *d->rows)};
    fp3_status status = d->rows ? FP3_OK : fp3_no_memory(error);
    for (unsigned i = 0; !status && i < fp3_lab_arithmetic_count; i++)
        if (fp3_trial_tries(trial, &fp3_lab_arithmetics[i],
                            fp3_lab_is_nearly_plain(&fp3_lab_arithmetics[i])))
            status = run(d, &fp3_lab_arithmetics[i], error);
    free(d->rows);
    free(d);
    return status;
}
