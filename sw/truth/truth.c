/* truth.c - where an object of a model really is: GSL at a tight tolerance, and a second opinion.
 *
 * The second is the model's closed form, or GSL's Cash-Karp method.
 */
#include <fp3/truth.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "crossing.h"

#define ROUGH 1e-6      /* tolerance of the run that finds out how large each state becomes */
#define TOLERANCE 1e-14 /* of a step, relative to that size */
#define AGREEMENT 1e-9  /* of two ways, relative to that size */
#define ROUNDING 1e-14  /* of two ways, relative to the largest state */
#define STEPS_MAX 500000
#define LOOKS 1024 /* for events, at least, on the way: one that ends between two is not seen */

typedef struct {
    const fp3_model *model;
    const double *params, *initial;
    double *values; /* of all expressions */
    double *guess;  /* of each state's size */
    double *peak;   /* largest size of each state so far */
    double *other;  /* states, the second way */
    double reached; /* time */
} orbit;

static int derivative(double t, const double y[], double dydt[], void *self) {
    const orbit *o = self;
    fp3_model_evaluate(
        o->model, &(fp3_point){.states = y, .params = o->params, .initial = o->initial, .t = t},
        o->values);
    int result = GSL_SUCCESS;
    for (uint32_t i = 0; i < o->model->state_count; i++) {
        dydt[i] = o->values[o->model->states[i].derivative];
        if (!isfinite(dydt[i]))
            result = GSL_EDOM; /* GSL takes a smaller step */
    }
    return result;
}

static double of_two(double a, double b) { return fmax(fabs(a), fabs(b)); }

/* Sizes before anything is known: what a state is, or becomes at its first speed. One that begins
 * as 0 and at rest gets the speed it has a moment later. */
static int guess_sizes(orbit *o, double t) {
    const uint32_t count = o->model->state_count;
    double *rate = o->peak, *moment = o->other;
    int result = derivative(0, o->initial, rate, o);
    for (uint32_t i = 0; i < count && !result; i++) {
        o->guess[i] = of_two(o->initial[i], rate[i] * t);
        moment[i] = o->initial[i] + rate[i] * t / 1024;
    }
    if (!result && derivative(0, moment, rate, o) == GSL_SUCCESS)
        for (uint32_t i = 0; i < count; i++)
            o->guess[i] = of_two(o->guess[i], rate[i] * t);
    for (uint32_t i = 0; i < count; i++)
        if (o->guess[i] == 0)
            o->guess[i] = 1;
    return result;
}

static void see_peaks(const orbit *o, const double *y) {
    for (uint32_t i = 0; i < o->model->state_count; i++)
        o->peak[i] = of_two(o->peak[i], y[i]);
}

/* One step of GSL's, up to an event if one happens. */
static int advance(gsl_odeiv2_driver *driver, fp3_crossing *events, double t, double *now,
                   double *h, double *y) {
    const uint32_t count = (uint32_t)driver->sys->dimension;
    const double from = *now;
    int is_found = 0;
    if (!events)
        return gsl_odeiv2_evolve_apply(driver->e, driver->c, driver->s, driver->sys, now, t, h, y);
    *h = fmin(*h, t / LOOKS);
    memcpy(events->from, y, count * sizeof *y);
    int result =
        gsl_odeiv2_evolve_apply(driver->e, driver->c, driver->s, driver->sys, now, t, h, y);
    if (!result)
        result = fp3_crossing_find(events, from, now, y, &is_found);
    if (is_found) {
        gsl_odeiv2_evolve_reset(driver->e);
        gsl_odeiv2_step_reset(driver->s);
    }
    return result;
}

/* y goes from time 0 to t; peak becomes the largest size of each state on the way. */
static int go(orbit *o, gsl_odeiv2_driver *driver, fp3_crossing *events, double t, double *y) {
    double h = t * 1e-6, now = 0;
    unsigned steps = 0;
    int result = events ? fp3_crossing_fire(events, 0, y) : GSL_SUCCESS;
    while (!result && now != t) {
        result = advance(driver, events, t, &now, &h, y);
        see_peaks(o, y);
        o->reached = now;
        if (!result && ++steps == STEPS_MAX)
            result = GSL_EMAXITER;
    }
    return result;
}

static int integrate(orbit *o, const gsl_odeiv2_step_type *how, double tolerance,
                     const double *sizes, double t, double *y) {
    const uint32_t count = o->model->state_count;
    gsl_odeiv2_system system = {derivative, NULL, count, o};
    gsl_odeiv2_driver *driver = gsl_odeiv2_driver_alloc_scaled_new(
        &system, how, t * 1e-6, tolerance, tolerance, 1, 0, sizes);
    fp3_crossing events = {0};
    int result = driver ? GSL_SUCCESS : GSL_ENOMEM;
    if (!result && o->model->event_count)
        result = fp3_crossing_open(&events, o->model, o->params, &system, how);
    memcpy(y, o->initial, count * sizeof *y);
    for (uint32_t i = 0; i < count; i++)
        o->peak[i] = fabs(y[i]);
    if (!result)
        result = go(o, driver, o->model->event_count ? &events : NULL, t, y);
    fp3_crossing_close(&events);
    if (driver)
        gsl_odeiv2_driver_free(driver);
    return result;
}

/* result is of integrate: a state that leaves all bounds, or memory. */
static fp3_status stopped(const orbit *o, const char *how, double t, int result, fp3_error *error) {
    if (result == FP3_CROSSING_STAYS)
        return fp3_fail(
            error, FP3_E_ARGUMENT,
            "no truth from time %.9g on: what an event does there makes it happen again",
            o->reached);
    if (result == FP3_CROSSING_MOST)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "no truth from time %.9g on: more than %d events happened until then",
                        o->reached, FP3_EVENTS_MOST);
    return fp3_fail(error, result == GSL_ENOMEM ? FP3_E_SYSTEM : FP3_E_ARGUMENT,
                    "GSL's %s does not reach time %.9g: %s (an explicit method: no stiff model)",
                    how, t, gsl_strerror(result));
}

/* a and b are of state i. What has just begun to move is small beside what it is computed from: a
 * closed form then has the rounding errors of that. */
static int apart(const orbit *o, double a, double b, uint32_t i) {
    double largest = 0;
    for (uint32_t j = 0; j < o->model->state_count; j++)
        largest = of_two(largest, o->peak[j]);
    return !(fabs(a - b) <= AGREEMENT * o->peak[i] + ROUNDING * largest);
}

static fp3_status disagree(const fp3_quantity *state, double t, const char *which, double theirs,
                           double ours, fp3_error *error) {
    return fp3_fail(error, FP3_E_MISMATCH,
                    "two truths of '%s' at time %.9g: GSL's rk8pd says %.17g, %s says %.17g",
                    state->name, t, ours, which, theirs);
}

static fp3_status check_exact(orbit *o, double t, const double *states, fp3_error *error) {
    fp3_model_evaluate(
        o->model,
        &(fp3_point){.states = states, .params = o->params, .initial = o->initial, .t = t},
        o->values);
    for (uint32_t i = 0; i < o->model->state_count; i++) {
        const fp3_quantity *state = &o->model->states[i];
        if (state->exact != FP3_NONE && apart(o, states[i], o->values[state->exact], i))
            return disagree(state, t, "the closed form", o->values[state->exact], states[i], error);
    }
    return FP3_OK;
}

/* Where a state has no closed form. */
static fp3_status check_again(orbit *o, double t, const double *states, fp3_error *error) {
    uint32_t unknown = 0;
    for (uint32_t i = 0; i < o->model->state_count; i++)
        unknown += o->model->states[i].exact == FP3_NONE;
    if (!unknown)
        return FP3_OK;
    const int result = integrate(o, gsl_odeiv2_step_rkck, TOLERANCE, o->guess, t, o->other);
    if (result)
        return stopped(o, "rkck", t, result, error);
    for (uint32_t i = 0; i < o->model->state_count; i++)
        if (apart(o, states[i], o->other[i], i))
            return disagree(&o->model->states[i], t, "rkck", o->other[i], states[i], error);
    return FP3_OK;
}

/* Sizes of a rough run. A state that stays far below its guess may be lost in the tolerance, and a stiff
 * model then explodes: with a tighter one it does not. */
static int find_sizes(orbit *o, double t, double *y) {
    const int first = integrate(o, gsl_odeiv2_step_rk8pd, ROUGH, o->guess, t, y);
    int result = first;
    for (double rough = ROUGH / 1000; result && first != GSL_ENOMEM && rough > TOLERANCE;
         rough /= 1000)
        result = integrate(o, gsl_odeiv2_step_rk8pd, rough, o->guess, t, y);
    return result ? first : GSL_SUCCESS;
}

static fp3_status follow(orbit *o, double t, double *states, fp3_error *error) {
    int result = guess_sizes(o, t);
    if (!result)
        result = find_sizes(o, t, states);
    for (uint32_t i = 0; i < o->model->state_count; i++)
        if (o->peak[i] > 0)
            o->guess[i] = o->peak[i];
    if (!result)
        result = integrate(o, gsl_odeiv2_step_rk8pd, TOLERANCE, o->guess, t, states);
    if (result)
        return stopped(o, "rk8pd", t, result, error);
    const fp3_status status = check_exact(o, t, states, error);
    return status ? status : check_again(o, t, states, error);
}

static fp3_status check_arguments(const fp3_model *model, const double *params,
                                  const double *initial, double t, fp3_error *error) {
    if (!isfinite(t))
        return fp3_fail(error, FP3_E_ARGUMENT, "the time is %g", t);
    if (t < 0 && model->event_count)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "no truth at time %.9g: events cannot be followed back", t);
    for (uint32_t i = 0; i < model->param_count; i++)
        if (!isfinite(params[i]))
            return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is %g", model->params[i].name, params[i]);
    for (uint32_t i = 0; i < model->state_count; i++)
        if (!isfinite(initial[i]))
            return fp3_fail(error, FP3_E_ARGUMENT, "'%s' starts at %g", model->states[i].name,
                            initial[i]);
    return FP3_OK;
}

fp3_status fp3_model_truth(const fp3_model *model, const double *params, const double *initial,
                           double t, double *states, fp3_error *error) {
    const uint32_t count = model->state_count;
    fp3_status status = check_arguments(model, params, initial, t, error);
    if (status)
        return status;
    double *room = calloc(model->expr_count + 4 * (size_t)count, sizeof *room);
    if (!room)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    double *of_states = room + model->expr_count, *reached = of_states + 3 * (size_t)count;
    orbit o = {.model = model,
               .params = params,
               .initial = initial,
               .values = room,
               .guess = of_states,
               .peak = of_states + count,
               .other = of_states + 2 * (size_t)count};
    memcpy(reached, initial, count * sizeof *reached);
    gsl_error_handler_t *handler = gsl_set_error_handler_off(); /* GSL's own ends the program */
    if (t != 0)
        status = follow(&o, t, reached, error);
    gsl_set_error_handler(handler);
    if (!status)
        memcpy(states, reached, count * sizeof *states);
    free(room);
    return status;
}
