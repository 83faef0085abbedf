/* SPDX-License-Identifier: Apache-2.0 */
/* stability.c - up to which time step nothing grows, found by bisection with a block of objects at
 * a time.
 *
 * The equations are x' = v, v' = -k x - c v with eigenvalues at an angle from the negative real
 * axis, and a step of 1; on the axis itself x' = -a x where the method takes that. Objects differ
 * in z, the size of the eigenvalue.
 */
#include "sections.h"

#include "theory.h"

#include <gsl/gsl_math.h>
#include <gsl/gsl_pow_int.h>
#include <math.h>
#include <stdlib.h>

#define OBJECTS 512
#define COARSE_STEPS 4096
#define NEAR 8.0           /* the first look goes from NEAR/OBJECTS to here, */
#define FAR 512.0          /* and, while nothing grows, eight times as far, up to here */
#define STEPS_LEAST 8192   /* of the looks after the first ... */
#define STEPS_MOST 1048576 /* ... as many as growth by GAIN takes, where z is off by FINE */
#define FINE 1e-4
#define GAIN 1.25         /* of the energy: growth */
#define GAIN_NEUTRAL 1e16 /* where the energy of a stable run has peaks: see theory.h */
#define DECAYED 1e-20     /* of the energy: it is not waited for subnormal numbers */
#define TOLERANCE 1e-3    /* of the limit ... */
#define ROUNDINGS 64      /* ... which so many roundings of one direction must not move */
#define MARGIN 4          /* cells of the first look on both sides */

static const char decay[] = "model decay\nparam a = 1\nstate x = 1\nstep 1\nx' = -a*x\n";
static const char swing[] =
    "model swing\nparam k = 1\nstate v = 0\nstate x = 1\nstep 1\nv' = -k*x\nx' = v\n";
static const char damped[] = "model damped\nparam k = 1\nparam c = 0\nstate v = 0\nstate x = 1\n"
                             "step 1\nv' = -k*x - c*v\nx' = v\n";

typedef struct {
    const fp3_trial *trial;
    const fp3_lab_arithmetic *arithmetic;
    double angle; /* from the negative real axis */
    double gain;
    fp3_lab *lab;
    int is_decay, has_damping;
    double z[OBJECTS]; /* as the program has it, ascending */
    double energy[OBJECTS];
} search;

/* Objects from low, exclusive, to high; z is what k really is. */
static fp3_status fill(search *s, double low, double high, fp3_error *error) {
    double k[OBJECTS], c[OBJECTS];
    for (int i = 0; i < OBJECTS; i++) {
        const double z = low + (high - low) * (i + 1) / OBJECTS;
        k[i] = fp3_lab_number(s->arithmetic, s->is_decay ? z : z * z);
        s->z[i] = s->is_decay ? k[i] : sqrt(k[i]);
        c[i] = 2 * s->z[i] * cos(s->angle);
    }
    fp3_status status = fp3_lab_fill(s->lab, s->is_decay ? "a" : "k", k, error);
    if (!status && s->has_damping)
        status = fp3_lab_fill(s->lab, "c", c, error);
    return status;
}

/* Of all objects; at the start it is 1. |v + conj(lambda) x|^2 / |lambda|^2: each step of a
 * Runge-Kutta method multiplies it by |R|^2, so nothing grows for a while before it decays. */
static fp3_status look(search *s, fp3_error *error) {
    double x[OBJECTS], v[OBJECTS] = {0};
    fp3_status status = fp3_lab_read(s->lab, "x", x, error);
    if (!status && !s->is_decay)
        status = fp3_lab_read(s->lab, "v", v, error);
    for (int i = 0; !status && i < OBJECTS; i++)
        s->energy[i] = gsl_pow_2(s->is_decay ? 0 : v[i] / s->z[i] + x[i] * cos(s->angle)) +
                       gsl_pow_2(x[i] * (s->is_decay ? 1 : sin(s->angle)));
    return status;
}

/* The number of the first object that has grown after these steps; OBJECTS: none has. Each part of
 * the run is as long as all before it, so what has not grown yet cannot overflow in it. What has,
 * and what has decayed, rests. */
static fp3_status first_grown(search *s, uint64_t steps, int *found, fp3_error *error) {
    char rests[OBJECTS] = {0}, has_grown[OBJECTS] = {0};
    fp3_status status = fp3_lab_start(s->lab, error);
    for (uint64_t made = 0, part = 2; !status && made < steps; made += part) {
        part = made > 2 ? made : 2;
        part = part < steps - made ? part : steps - made;
        status = fp3_lab_run(s->lab, part, error);
        if (!status)
            status = look(s, error);
        for (int i = 0; i < OBJECTS; i++) {
            has_grown[i] |= !(s->energy[i] <= s->gain); /* NaN has */
            rests[i] = has_grown[i] || s->energy[i] < DECAYED;
        }
        if (!status)
            status = fp3_lab_rest(s->lab, rests, error);
    }
    for (*found = 0; *found < OBJECTS && !has_grown[*found];)
        ++*found;
    return status;
}

/* How many steps it takes until growth is seen that far above the limit; infinite: it does not
 * grow. */
static double steps_for(const search *s, double limit, double above) {
    const double growth =
        log(fp3_theory_growth(s->trial->integrator, limit * (1 + above), s->angle));
    return growth > 0 ? log(s->gain) / 2 / growth : INFINITY;
}

/* Growth that is not seen within the tolerance is below the roundings of the table: it is told from
 * where it is. */
static int is_seen(const search *s, double limit) {
    return !isfinite(limit) || (limit > 0 && steps_for(s, limit, TOLERANCE / 2) <= STEPS_MOST);
}

static uint64_t steps_of(const search *s, double limit) {
    if (!is_seen(s, limit))
        return STEPS_MOST / 64;
    return isfinite(limit)
               ? (uint64_t)fmin(fmax(steps_for(s, limit, FINE), STEPS_LEAST), STEPS_MOST)
               : STEPS_LEAST;
}

static fp3_status find(search *s, uint64_t steps, double *found, fp3_error *error) {
    double low = 0, high = NEAR, cell = NEAR;
    fp3_status status = FP3_OK;
    for (int round = 0; !status && (round < 2 || cell > FINE * *found);) {
        int i = 0;
        status = fill(s, low, high, error);
        if (!status)
            status = first_grown(s, round ? steps : COARSE_STEPS, &i, error);
        *found = i == OBJECTS ? INFINITY : i ? (s->z[i - 1] + s->z[i]) / 2 : s->z[0] / 2;
        if (i == OBJECTS && !round && high < FAR) {
            low = high;
            high *= 8;
            continue;
        }
        if (i == OBJECTS)
            break;
        cell = (high - low) / OBJECTS;
        high = *found + MARGIN * cell;
        /* The second look has more steps, so it may find growth earlier. */
        low = fmax(0, *found - (round ? 1 : 8) * MARGIN * cell);
        round++;
    }
    return status;
}

static fp3_status judge(search *s, fp3_error *error) {
    const fp3_integrator *table = s->trial->integrator;
    const double limit = fp3_theory_limit(table, s->angle);
    const uint64_t steps = steps_of(s, limit);
    const double degrees = s->angle * 180 / M_PI;
    fp3_verdict v =
        fp3_trial_verdict(s->trial, "stability",
                          s->is_decay      ? "decay"
                          : s->has_damping ? "damped"
                                           : "swing",
                          s->arithmetic,
                          is_seen(s, limit) ? "limit of h|lambda| at %.0f degrees from decay"
                                            : "h|lambda| at %.0f degrees from decay from which "
                                              "the energy grows by a quarter in 2^14 steps",
                          degrees);
    v.expected =
        is_seen(s, limit) ? limit : fp3_theory_onset(table, s->angle, (double)steps, sqrt(s->gain));
    v.tolerance = isfinite(v.expected) ? TOLERANCE * v.expected : 0;
    fp3_status status = find(s, steps, &v.measured, error);
    if (!status && limit > 0 && isfinite(v.measured) &&
        s->arithmetic == &fp3_lab_arithmetics[FP3_LAB_PLAIN]) {
        const double x = -v.measured * cos(s->angle), y = v.measured * sin(s->angle);
        status =
            fp3_verdicts_draw(s->trial->verdicts, "region measured", table->name, &x, &y, 1, error);
    }
    return status ? status : fp3_verdicts_add(s->trial->verdicts, &v, error);
}

static fp3_status search_ray(const fp3_trial *trial, const fp3_lab_arithmetic *arithmetic,
                             double degrees, fp3_error *error) {
    const fp3_integrator *run = trial->run;
    search *s = calloc(1, sizeof *s);
    fp3_model *model = NULL;
    if (!s)
        return fp3_no_memory(error);
    *s = (search){.trial = trial,
                  .arithmetic = arithmetic,
                  .angle = degrees * M_PI / 180,
                  .is_decay = degrees == 0,
                  .has_damping = degrees > 0 && degrees < 90,
                  .gain = fp3_trial_is_symplectic(run) ? GAIN_NEUTRAL : GAIN};
    fp3_status status = fp3_lab_model(s->is_decay      ? decay
                                      : s->has_damping ? damped
                                                       : swing,
                                      &model, error);
    const fp3_lab_def def = {model, run, arithmetic, 1, OBJECTS, !trial->options->is_quick};
    if (!status)
        status = fp3_lab_open(&def, &s->lab, error);
    if (!status)
        status = judge(s, error);
    fp3_lab_close(&s->lab);
    fp3_model_free(&model);
    free(s);
    return status;
}

/* Splittings are not for decay, and Stoermer's method is for forces without damping. */
static int applies(const fp3_integrator *integrator, double degrees) {
    return degrees == 90 || integrator->kind == FP3_RUNGE_KUTTA ||
           integrator->kind == FP3_CHEBYSHEV || integrator->kind == FP3_ROSENBROCK ||
           (integrator->kind == FP3_SPLITTING && degrees > 0);
}

/* By theory. */
static fp3_status draw_region(const fp3_trial *trial, fp3_error *error) {
    double x[91], y[91];
    size_t count = 0;
    for (int degrees = 0; degrees <= 90; degrees++)
        if (applies(trial->integrator, degrees)) {
            const double angle = degrees * M_PI / 180,
                         limit = fp3_theory_limit(trial->integrator, angle);
            if (isfinite(limit)) {
                x[count] = -limit * cos(angle);
                y[count++] = limit * sin(angle);
            }
        }
    return fp3_verdicts_draw(trial->verdicts, "region", trial->integrator->name, x, y, count,
                             error);
}

fp3_status fp3_section_stability(const fp3_trial *trial, fp3_error *error) {
    const int apart = trial->options->is_quick ? 45 : 15;
    fp3_status status = draw_region(trial, error);
    for (int degrees = 0; !status && degrees <= 90; degrees += apart)
        if (applies(trial->run, degrees) &&
            fp3_trial_tries(trial, &fp3_lab_arithmetics[FP3_LAB_PLAIN], 0))
            status = search_ray(trial, &fp3_lab_arithmetics[FP3_LAB_PLAIN], degrees, error);
    for (unsigned i = FP3_LAB_COMPENSATED; !status && i < fp3_lab_arithmetic_count; i++)
        if (fp3_lab_arithmetics[i].update != FP3_DOUBLE_SINGLE &&
            ROUNDINGS * fp3_lab_unit(&fp3_lab_arithmetics[i]) <= TOLERANCE &&
            fp3_trial_tries(trial, &fp3_lab_arithmetics[i], trial->options->is_quick))
            status =
                search_ray(trial, &fp3_lab_arithmetics[i], applies(trial->run, 0) ? 0 : 90, error);
    return status;
}
