/* truth.c - where an object of a model really is: GSL at a tight tolerance, and a second opinion.
 *
 * The second is the model's closed form, or GSL's Cash-Karp method.
 */
#include <fp3/tune.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/host.h"
#include "crossing.h"
#include "path.h"

#define ROUGH 1e-6      /* tolerance of the run that finds out how large each state becomes */
#define TOLERANCE 1e-14 /* of a step, relative to that size */
#define AGREEMENT 1e-9  /* of two ways, relative to that size */
#define ROUNDING 1e-14  /* of two ways, relative to the largest state */
#define STEPS_MAX 500000
#define LOOKS 1024 /* for events, at least, on the way: one that ends between two is not seen */
#define CHECKS 64  /* of a path: two ways agree there */
#define UNEVEN                                                                                     \
    0.618033988749895 /* where between two even times: what is symmetric has events at those */

typedef struct {
    const fp3_model *model;
    fp3_switches switches;
    const double *params, *initial, *times;
    size_t count;   /* times, the last is the end */
    double *values; /* of all expressions */
    double *guess;  /* of each state's size */
    double *peak;   /* largest size of each state so far */
    double *other;  /* rows of states, one for each time, the second way */
    double *y;      /* states, on the way */
    double reached; /* time */
    fp3_path *path; /* NULL: only the states at the times are of interest */
} orbit;

static int take_rates(const orbit *o, double dydt[]) {
    int result = GSL_SUCCESS;
    for (uint32_t i = 0; i < o->model->state_count; i++) {
        dydt[i] = o->values[o->model->states[i].derivative];
        if (!isfinite(dydt[i]))
            result = GSL_EDOM; /* GSL takes a smaller step */
    }
    return result;
}

/* What a switch keeps out may have no value beyond it, as the root of max(x, 0): there nothing is held. */
static int derivative(double t, const double y[], double dydt[], void *self) {
    const orbit *o = self;
    const fp3_point point = {.states = y, .params = o->params, .initial = o->initial, .t = t};
    if (o->switches.has_any) {
        fp3_switches_evaluate(&o->switches, &point, o->values);
        if (take_rates(o, dydt) == GSL_SUCCESS)
            return GSL_SUCCESS;
    }
    fp3_model_evaluate(o->model, &point, o->values);
    return take_rates(o, dydt);
}

static double of_two(double a, double b) { return fmax(fabs(a), fabs(b)); }

/* Sizes before anything is known: what a state is, or becomes at its first speed. One that begins
 * as 0 and at rest gets the speed it has a moment later. */
static int guess_sizes(orbit *o, double t) {
    const uint32_t count = o->model->state_count;
    double *rate = o->peak, *moment = o->other;
    fp3_switches_hold(&o->switches, 0, o->initial);
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

/* One step of GSL's, up to an event if one happens, or to where a switch turns. */
static int advance(gsl_odeiv2_driver *driver, fp3_crossing *events, double t, double *now,
                   double *h, double *y, int *is_found) {
    const uint32_t count = (uint32_t)driver->sys->dimension;
    const double from = *now;
    *is_found = 0;
    if (!events)
        return gsl_odeiv2_evolve_apply(driver->e, driver->c, driver->s, driver->sys, now, t, h, y);
    if (events->model->event_count || events->switches->has_states)
        *h = copysign(fmin(fabs(*h), fabs(t) / LOOKS), t);
    t = fp3_switches_until(events->switches, from, t);
    memcpy(events->from, y, count * sizeof *y);
    int result =
        gsl_odeiv2_evolve_apply(driver->e, driver->c, driver->s, driver->sys, now, t, h, y);
    if (!result)
        result = fp3_crossing_find(events, from, now, y, is_found);
    if (*is_found) {
        gsl_odeiv2_evolve_reset(driver->e);
        gsl_odeiv2_step_reset(driver->s);
    }
    return result;
}

static double end_of(const orbit *o) { return o->times[o->count - 1]; }

/* A step has come to y, or to where the solution stopped (crossing.h) and goes on from y. */
static int keep(fp3_path *path, double t, const double *y, int is_stop, int is_event) {
    if (!path)
        return GSL_SUCCESS;
    return is_stop ? fp3_path_start(path, t, y, is_event) : fp3_path_step(path, t, y);
}

/* y goes on to a time. */
static int go_to(orbit *o, gsl_odeiv2_driver *driver, fp3_crossing *events, double t, double *now,
                 double *h, unsigned *steps) {
    int result = GSL_SUCCESS, is_stop;
    while (!result && *now != t) {
        result = advance(driver, events, t, now, h, o->y, &is_stop);
        if (!result)
            result = keep(o->path, *now, o->y, is_stop, is_stop && events->is_event);
        see_peaks(o, o->y);
        o->reached = *now;
        if (!result && ++*steps == STEPS_MAX)
            result = GSL_EMAXITER;
    }
    return result;
}

/* y goes from time 0 to the end, and is kept at each time; peak becomes the largest size of each state
 * on the way. A path has no stop on the way. */
static int go(orbit *o, gsl_odeiv2_driver *driver, fp3_crossing *events, double *rows) {
    const uint32_t states = o->model->state_count;
    double h = end_of(o) * 1e-6, now = 0;
    unsigned steps = 0;
    int result = events ? fp3_crossing_start(events, o->y) : GSL_SUCCESS;
    if (!result && o->path)
        result = fp3_path_start(o->path, 0, o->y, 0);
    for (size_t i = o->path ? o->count - 1 : 0; !result && i < o->count; i++) {
        result = go_to(o, driver, events, o->times[i], &now, &h, &steps);
        memcpy(rows + i * states, o->y, states * sizeof *o->y);
    }
    if (result || !o->path)
        return result;
    result = fp3_path_stop(o->path, now);
    fp3_path_finish(o->path);
    for (size_t i = 0; !result && i + 1 < o->count; i++)
        fp3_path_at(o->path, o->times[i], rows + i * states);
    return result;
}

/* rows: of states, one for each time. path: NULL, or where to keep how it goes. */
static int integrate(orbit *o, const gsl_odeiv2_step_type *how, double tolerance,
                     const double *sizes, double *rows, fp3_path **path) {
    const uint32_t count = o->model->state_count;
    gsl_odeiv2_system system = {derivative, NULL, count, o};
    gsl_odeiv2_driver *driver = gsl_odeiv2_driver_alloc_scaled_new(
        &system, how, end_of(o) * 1e-6, tolerance, tolerance, 1, 0, sizes);
    fp3_crossing events = {0};
    int result = driver ? GSL_SUCCESS : GSL_ENOMEM;
    const int has_crossings = o->model->event_count || o->switches.has_any;
    if (!result && has_crossings)
        result = fp3_crossing_open(&events, &o->switches, &system, how);
    o->path = path ? *path = fp3_path_begin(&system, how, sizes) : NULL;
    events.path = o->path;
    if (path && !o->path)
        result = GSL_ENOMEM;
    memcpy(o->y, o->initial, count * sizeof *o->y);
    for (uint32_t i = 0; i < count; i++)
        o->peak[i] = fabs(o->y[i]);
    if (!result)
        result = go(o, driver, has_crossings ? &events : NULL, rows);
    fp3_crossing_close(&events);
    if (driver)
        gsl_odeiv2_driver_free(driver);
    return result;
}

/* A loop of several events has none that changes the states alone. */
static fp3_status stays(const orbit *o, fp3_error *error) {
    const fp3_event *event = fp3_crossing_of(o->model, o->params, o->reached, o->y, o->values);
    return fp3_fail(
        error, FP3_E_ARGUMENT,
        "no truth from time %.9g on: the event of line %u happens again and again, as its "
        "condition is still true after it and it changes the states each time (a "
        "projection is written `project q = q/norm(q)`)",
        o->reached, event ? event->line : o->model->events[0].line);
}

/* result is of integrate: a state that leaves all bounds, or memory. */
static fp3_status stopped(const orbit *o, const char *how, double t, int result, fp3_error *error) {
    if (result == FP3_CROSSING_STAYS)
        return stays(o, error);
    if (result == FP3_CROSSING_MOST)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "no truth from time %.9g on: more than %d events happened until then",
                        o->reached, FP3_EVENTS_MOST);
    if (result == FP3_CROSSING_SLIDES)
        return fp3_fail(
            error, FP3_E_ARGUMENT,
            "no truth from time %.9g on: the solution does not leave a point at which a "
            "condition of the equations changes",
            o->reached);
    return fp3_fail(
        error, result == GSL_ENOMEM ? FP3_E_SYSTEM : FP3_E_ARGUMENT,
        "GSL's %s does not reach time %.9g: %s (an explicit method, which stiff models defeat)",
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
                    "two solutions of '%s' at time %.9g: GSL's rk8pd says %.17g, %s says %.17g",
                    state->name, t, ours, which, theirs);
}

/* At the time with this number. */
static fp3_status check_exact(orbit *o, size_t look, const double *states, fp3_error *error) {
    const double t = o->times[look];
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

static fp3_status check_look(const orbit *o, size_t look, const double *states, const double *other,
                             fp3_error *error) {
    for (uint32_t i = 0; i < o->model->state_count; i++)
        if (apart(o, states[i], other[i], i))
            return disagree(&o->model->states[i], o->times[look], "rkck", other[i], states[i],
                            error);
    return FP3_OK;
}

/* Where a state has no closed form. */
static fp3_status check_again(orbit *o, const double *rows, fp3_error *error) {
    const uint32_t count = o->model->state_count;
    uint32_t unknown = 0;
    for (uint32_t i = 0; i < count; i++)
        unknown += o->model->states[i].exact == FP3_NONE;
    if (!unknown)
        return FP3_OK;
    const int result = integrate(o, gsl_odeiv2_step_rkck, TOLERANCE, o->guess, o->other, NULL);
    fp3_status status = result ? stopped(o, "rkck", end_of(o), result, error) : FP3_OK;
    for (size_t i = 0; !status && i < o->count; i++)
        status = check_look(o, i, rows + i * count, o->other + i * count, error);
    return status;
}

/* Sizes of a rough run. A state that stays far below its guess may be lost in the tolerance, and a stiff
 * model then explodes: with a tighter one it does not. */
static int find_sizes(orbit *o, double *rows) {
    const int first = integrate(o, gsl_odeiv2_step_rk8pd, ROUGH, o->guess, rows, NULL);
    int result = first;
    for (double rough = ROUGH / 1000; result && first != GSL_ENOMEM && rough > TOLERANCE;
         rough /= 1000)
        result = integrate(o, gsl_odeiv2_step_rk8pd, rough, o->guess, rows, NULL);
    return result ? first : GSL_SUCCESS;
}

static fp3_status follow(orbit *o, double *rows, fp3_path **path, fp3_error *error) {
    const uint32_t count = o->model->state_count;
    int result = guess_sizes(o, end_of(o));
    if (!result)
        result = find_sizes(o, rows);
    for (uint32_t i = 0; i < count; i++)
        if (o->peak[i] > 0)
            o->guess[i] = o->peak[i];
    if (!result)
        result = integrate(o, gsl_odeiv2_step_rk8pd, TOLERANCE, o->guess, rows, path);
    fp3_status status = result ? stopped(o, "rk8pd", end_of(o), result, error) : FP3_OK;
    for (size_t i = 0; !status && i < o->count; i++)
        status = check_exact(o, i, rows + i * count, error);
    return status ? status : check_again(o, rows, error);
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

/* The sizes of what the room of an orbit is for, one after the other. */
static double *make_room(orbit *o, size_t times) {
    const size_t count = o->model->state_count;
    double *room = calloc(o->model->expr_count + (3 + times) * count, sizeof *room);
    if (!room)
        return NULL;
    o->values = room;
    o->guess = room + o->model->expr_count;
    o->peak = o->guess + count;
    o->y = o->peak + count;
    o->other = o->y + count;
    return room;
}

static fp3_status check_times(const double *times, size_t count, fp3_error *error) {
    for (size_t i = 0; i < count; i++)
        if (!(times[i] > (i ? times[i - 1] : 0)))
            return fp3_fail(error, FP3_E_ARGUMENT, "time %.9g: expected times above 0, upwards",
                            times[i]);
    return count ? FP3_OK : fp3_fail(error, FP3_E_ARGUMENT, "expected a time");
}

/* states, sizes and path may be NULL. */
static fp3_status look(const fp3_model *model, const double *params, const double *initial,
                       const double *times, size_t count, double *states, double *sizes,
                       fp3_path **path, fp3_error *error) {
    orbit o = {
        .model = model, .params = params, .initial = initial, .times = times, .count = count};
    const size_t cells = count * model->state_count;
    fp3_status status = check_arguments(model, params, initial, times[count - 1], error);
    if (status)
        return status;
    double *room = make_room(&o, count), *rows = calloc(cells + 1, sizeof *rows);
    if (!room || !rows)
        status = fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    if (!status)
        status = fp3_switches_open(&o.switches, model, params, times[count - 1], error);
    gsl_error_handler_t *handler = gsl_set_error_handler_off(); /* GSL's own ends the program */
    if (!status)
        status = follow(&o, rows, path, error);
    gsl_set_error_handler(handler);
    if (!status && states)
        memcpy(states, rows, cells * sizeof *states);
    for (uint32_t i = 0; !status && sizes && i < model->state_count; i++)
        sizes[i] = o.peak[i];
    fp3_switches_close(&o.switches);
    free(rows);
    free(room);
    return status;
}

fp3_status fp3_model_truths(const fp3_model *model, const double *params, const double *initial,
                            const double *times, size_t count, double *states, double *sizes,
                            fp3_error *error) {
    FP3_HOST;
    const fp3_status status = check_times(times, count, error);
    return status ? status : look(model, params, initial, times, count, states, sizes, NULL, error);
}

fp3_status fp3_model_truth(const fp3_model *model, const double *params, const double *initial,
                           double t, double *states, fp3_error *error) {
    FP3_HOST;
    if (t != 0)
        return look(model, params, initial, &t, 1, states, NULL, NULL, error);
    const fp3_status status = check_arguments(model, params, initial, t, error);
    if (!status)
        memcpy(states, initial, model->state_count * sizeof *states);
    return status;
}

fp3_status fp3_path_open(const fp3_model *model, const double *params, const double *initial,
                         double end, double *sizes, fp3_path **path, fp3_error *error) {
    double times[CHECKS + 1];
    *path = NULL;
    for (int i = 0; i < CHECKS; i++)
        times[i] = end * (i + UNEVEN) / CHECKS;
    times[CHECKS] = end;
    fp3_status status = check_times(times, CHECKS + 1, error);
    if (!status)
        status = look(model, params, initial, times, CHECKS + 1, NULL, sizes, path, error);
    if (status)
        fp3_path_close(path);
    return status;
}
