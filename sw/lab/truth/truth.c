/* SPDX-License-Identifier: Apache-2.0 */
/* truth.c - where an object of a model really is: GSL at a tight tolerance, and a second opinion.
 *
 * The second is the model's closed form, or another method of GSL's.
 */
#include <fp3/truth.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/host.h"
#include "bsimp.h"
#include "crossing.h"
#include "orbit.h"
#include "path.h"

#define ROUGH 1e-6     /* tolerance of the run that finds out how large each state becomes */
#define AGREEMENT 1e-9 /* of two ways, relative to that size */
#define ROUNDING 1e-14 /* of two ways, relative to the largest state */
#define CHECKS 64      /* of a path: two ways agree there */
#define UNEVEN                                                                                     \
    0.618033988749895 /* where between two even times: what is symmetric has events at those */

typedef struct {
    fp3_slopes eq;
    fp3_orbit way;
    fp3_method how, again; /* the way to go, and the other one */
    double *guess, *other; /* of each state's size; rows of states, the other way */
} orbit;

/* Explicit: Prince and Dormand's order 8, and Cash and Karp's. Implicit: Bader and Deuflhard's
 * extrapolation, and backward differences. On stiff models small errors of a state may become large
 * ones of another, or of itself once it has grown. So the implicit ones have nearly a relative
 * tolerance; h |y'| allows for a state that goes through 0. */
static void choose(orbit *o, int is_stiff) {
    if (is_stiff) {
        o->how = (fp3_method){&fp3_step_bsimp, &fp3_step_bsimp, 1e-13, 1, 1e-6, 50000, 0};
        o->again = (fp3_method){gsl_odeiv2_step_msbdf, &fp3_step_bsimp, 1e-14, 1, 1e-6, 500000, 0};
    } else {
        o->how =
            (fp3_method){gsl_odeiv2_step_rk8pd, gsl_odeiv2_step_rk8pd, 1e-14, 0, 1, 500000, 5.17};
        o->again = (fp3_method){gsl_odeiv2_step_rkck, gsl_odeiv2_step_rkck, 1e-14, 0, 1, 500000, 0};
    }
}

static double of_two(double a, double b) { return fmax(fabs(a), fabs(b)); }

/* Sizes before anything is known: what a state is, or becomes at its first speed. One that begins
 * as 0 and at rest gets the speed it has a moment later. */
static int guess_sizes(orbit *o, double t) {
    const uint32_t count = o->eq.model->state_count;
    double *rate = o->way.peak, *moment = o->other;
    fp3_switches_hold(&o->eq.switches, 0, o->eq.initial);
    int result = fp3_slopes_of(0, o->eq.initial, rate, &o->eq);
    for (uint32_t i = 0; i < count && !result; i++) {
        o->guess[i] = of_two(o->eq.initial[i], rate[i] * t);
        moment[i] = o->eq.initial[i] + rate[i] * t / 1024;
    }
    if (!result && fp3_slopes_of(0, moment, rate, &o->eq) == GSL_SUCCESS)
        for (uint32_t i = 0; i < count; i++)
            o->guess[i] = of_two(o->guess[i], rate[i] * t);
    for (uint32_t i = 0; i < count; i++)
        if (o->guess[i] == 0)
            o->guess[i] = 1;
    return result;
}

/* A loop of several events has none that changes the states alone. */
static fp3_status stays(const orbit *o, fp3_error *error) {
    const fp3_event *event =
        fp3_crossing_of(o->eq.model, o->eq.params, o->way.reached, o->way.y, o->eq.values);
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "no truth from time %.9g on: the event of line %u happens again and again, "
                    "because its condition stays true and it changes the states each time (write a "
                    "projection as `project q = q/norm(q)`)",
                    o->way.reached, event ? event->line : o->eq.model->events[0].line);
}

/* result is of fp3_orbit_go: a state that leaves all bounds, too many steps, or memory. */
static fp3_status stopped(const orbit *o, const fp3_method *how, int result, fp3_error *error) {
    const double t = o->way.times[o->way.count - 1];
    if (result == GSL_ENOMEM)
        return fp3_no_memory(error);
    if (result == FP3_CROSSING_STAYS)
        return stays(o, error);
    if (result == FP3_CROSSING_MOST)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "no truth from time %.9g on: more than %d events happened until then",
                        o->way.reached, FP3_EVENTS_MOST);
    if (result == FP3_CROSSING_SLIDES)
        return fp3_fail(
            error, FP3_E_ARGUMENT,
            "no truth from time %.9g on: the solution does not leave a point at which a "
            "condition of the equations changes",
            o->way.reached);
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "GSL's %s does not reach time %.9g: it made %u steps and came to time %.9g, %s",
                    how->step->name, t, o->way.steps, o->way.reached,
                    result == GSL_EMAXITER ? "and may make no more"
                                           : "where no step is short enough");
}

/* a and b are of state i. What has just begun to move is small beside what it is computed from: a
 * closed form then has the rounding errors of that. */
static int apart(const orbit *o, double a, double b, uint32_t i) {
    double largest = 0;
    for (uint32_t j = 0; j < o->eq.model->state_count; j++)
        largest = of_two(largest, o->way.peak[j]);
    return !(fabs(a - b) <= AGREEMENT * o->way.peak[i] + ROUNDING * largest);
}

static fp3_status disagree(const orbit *o, const fp3_quantity *state, double t, const char *which,
                           double theirs, double ours, fp3_error *error) {
    return fp3_fail(error, FP3_E_MISMATCH,
                    "two solutions of '%s' at time %.9g: GSL's %s says %.17g, %s says %.17g",
                    state->name, t, o->how.step->name, ours, which, theirs);
}

/* At the time with this number. */
static fp3_status check_exact(orbit *o, size_t look, const double *states, fp3_error *error) {
    const double t = fmin(o->way.times[look], o->way.stopped);
    fp3_model_evaluate(
        o->eq.model,
        &(fp3_point){.states = states, .params = o->eq.params, .initial = o->eq.initial, .t = t},
        o->eq.values);
    for (uint32_t i = 0; i < o->eq.model->state_count; i++) {
        const fp3_quantity *state = &o->eq.model->states[i];
        if (state->exact != FP3_NONE && apart(o, states[i], o->eq.values[state->exact], i))
            return disagree(o, state, t, "the closed form", o->eq.values[state->exact], states[i],
                            error);
    }
    return FP3_OK;
}

/* The first state that is apart; FP3_NONE: none is. */
static uint32_t find_apart(const orbit *o, const double *states, const double *other) {
    const uint32_t count = o->eq.model->state_count;
    uint32_t i = 0;
    while (i < count && !apart(o, states[i], other[i], i))
        i++;
    return i < count ? i : FP3_NONE;
}

/* Right at an event, rounding puts two ways on its two sides. */
static int is_beside(const orbit *o, const fp3_path *path, double t, const double *other) {
    const double near = AGREEMENT * o->way.times[o->way.count - 1];
    double when;
    return (fp3_path_before(path, t, &when, o->way.y) && t - when <= near &&
            find_apart(o, o->way.y, other) == FP3_NONE) ||
           (fp3_path_after(path, t, &when, o->way.y) && when - t <= near &&
            find_apart(o, o->way.y, other) == FP3_NONE);
}

static fp3_status check_look(const orbit *o, const fp3_path *path, size_t look,
                             const double *states, const double *other, fp3_error *error) {
    const uint32_t i = find_apart(o, states, other);
    const double t = o->way.times[look];
    return i == FP3_NONE || (path && is_beside(o, path, t, other))
               ? FP3_OK
               : disagree(o, &o->eq.model->states[i], t, o->again.step->name, other[i], states[i],
                          error);
}

/* What GSL says of a way that did not come to its end, so that another may. */
static int is_stuck(int result) {
    return result && result != GSL_ENOMEM && result < FP3_CROSSING_STAYS;
}

/* Rounding may keep steps from a tolerance that is tight where a state is near 0: then its size
 * counts for more. */
static int go(orbit *o, const fp3_method *how, double *rows, fp3_path **path) {
    fp3_method with = *how;
    int result = fp3_orbit_go(&o->way, &with, how->tolerance, o->guess, rows, path);
    while (is_stuck(result) && with.floor < 1) {
        with.floor = fmin(1, 1000 * with.floor);
        if (path)
            fp3_path_close(path);
        result = fp3_orbit_go(&o->way, &with, how->tolerance, o->guess, rows, path);
    }
    return result;
}

/* Where a state has no closed form; on a stiff model always, as a step of bsimp may be so long that
 * it passes over a peak. */
static fp3_status check_again(orbit *o, const double *rows, const fp3_path *path,
                              fp3_error *error) {
    const uint32_t count = o->eq.model->state_count;
    uint32_t unknown = 0;
    for (uint32_t i = 0; i < count; i++)
        unknown += o->eq.model->states[i].exact == FP3_NONE;
    if (!unknown && o->how.stable > 0)
        return FP3_OK;
    const int result = go(o, &o->again, o->other, NULL);
    fp3_status status = result ? stopped(o, &o->again, result, error) : FP3_OK;
    for (size_t i = 0; !status && i < o->way.count; i++)
        status = check_look(o, path, i, rows + i * count, o->other + i * count, error);
    return status;
}

/* What a tighter tolerance does not mend. */
static int is_final(int result) {
    return !result || result == FP3_ORBIT_STIFF || result == GSL_ENOMEM || result == GSL_EMAXITER;
}

/* Sizes of a rough run. A state that stays far below its guess may be lost in the tolerance, and a
 * stiff model then explodes: with a tighter one it does not. */
static int find_sizes(orbit *o, double *rows) {
    const int first = fp3_orbit_go(&o->way, &o->how, ROUGH, o->guess, rows, NULL);
    int result = first;
    for (double rough = ROUGH / 1000; !is_final(result) && rough > o->how.tolerance; rough /= 1000)
        result = fp3_orbit_go(&o->way, &o->how, rough, o->guess, rows, NULL);
    for (uint32_t i = 0; i < o->eq.model->state_count; i++)
        if (o->way.peak[i] > 0)
            o->guess[i] = o->way.peak[i];
    return is_final(result) ? result : first;
}

static int solve(orbit *o, double *rows, fp3_path **path) {
    const int result = find_sizes(o, rows);
    return result ? result : go(o, &o->how, rows, path);
}

/* Far from what a stiff model does, its speeds say nothing. */
static void start_sizes(orbit *o) {
    const uint32_t count = o->eq.model->state_count;
    double most = 0;
    for (uint32_t i = 0; i < count; i++)
        most = of_two(most, o->eq.initial[i]);
    for (uint32_t i = 0; i < count; i++)
        o->guess[i] = o->eq.initial[i] != 0 ? fabs(o->eq.initial[i]) : most > 0 ? most : 1;
}

static fp3_status follow(orbit *o, double *rows, fp3_path **path, fp3_error *error) {
    const uint32_t count = o->eq.model->state_count;
    choose(o, 0);
    int result = guess_sizes(o, o->way.times[o->way.count - 1]);
    if (!result)
        result = solve(o, rows, path);
    /* An explicit method may explode before the model is seen to be stiff. */
    if (result == FP3_ORBIT_STIFF || is_stuck(result)) {
        if (path)
            fp3_path_close(path);
        start_sizes(o);
        choose(o, 1);
        result = solve(o, rows, path);
    }
    fp3_status status = result ? stopped(o, &o->how, result, error) : FP3_OK;
    for (size_t i = 0; !status && i < o->way.count; i++)
        status = check_exact(o, i, rows + i * count, error);
    return status ? status : check_again(o, rows, path ? *path : NULL, error);
}

/* A projection that reads the length of the step, or what was before it, is part of the motion. */
static fp3_status check_projections(const fp3_model *model, fp3_error *error) {
    if (fp3_model_is_map(model))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "'%s' has no truth: its projections alone move the states, and the truth "
                        "makes none",
                        model->name);
    for (uint32_t i = 0; i < model->expr_count; i++)
        if (model->exprs[i].op == FP3_EXPR_STEP || model->exprs[i].op == FP3_EXPR_BEFORE)
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "'%s' has no truth: its projection in line %" PRIu32
                            " moves the states by what happened within a step, and the truth has "
                            "no steps",
                            model->name, model->exprs[i].line);
    return FP3_OK;
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
    return check_projections(model, error);
}

/* The sizes of what the room of an orbit is for, one after the other. */
static double *make_room(orbit *o, size_t times) {
    const size_t count = o->eq.model->state_count;
    double *room = calloc((3 + times) * count + 1, sizeof *room);
    if (!room)
        return NULL;
    o->guess = room;
    o->way.peak = o->guess + count;
    o->way.y = o->way.peak + count;
    o->other = o->way.y + count;
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
    orbit o = {.way = {.slopes = &o.eq, .times = times, .count = count}};
    const size_t cells = count * model->state_count;
    fp3_status status = check_arguments(model, params, initial, times[count - 1], error);
    if (status)
        return status;
    status = fp3_slopes_open(&o.eq, model, params, initial, times[count - 1], error);
    double *room = make_room(&o, count), *rows = calloc(cells + 1, sizeof *rows);
    if (!status && (!room || !rows))
        status = fp3_no_memory(error);
    gsl_error_handler_t *handler = gsl_set_error_handler_off(); /* GSL's own ends the program */
    if (!status)
        status = follow(&o, rows, path, error);
    gsl_set_error_handler(handler);
    if (!status && states)
        memcpy(states, rows, cells * sizeof *states);
    for (uint32_t i = 0; !status && sizes && i < model->state_count; i++)
        sizes[i] = o.way.peak[i];
    fp3_slopes_close(&o.eq);
    free(rows);
    free(room);
    return status;
}

fp3_status fp3_model_truths(const fp3_model *model, const double *params, const double *initial,
                            const double *times, size_t count, double *states, double *sizes,
                            fp3_error *error) {
    FP3_HOST;
    fp3_status status = fp3_model_check_alone(model, error);
    if (!status)
        status = check_times(times, count, error);
    return status ? status : look(model, params, initial, times, count, states, sizes, NULL, error);
}

fp3_status fp3_model_truth(const fp3_model *model, const double *params, const double *initial,
                           double t, double *states, fp3_error *error) {
    FP3_HOST;
    const fp3_status alone = fp3_model_check_alone(model, error);
    if (alone)
        return alone;
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
    fp3_status status = fp3_model_check_alone(model, error);
    if (!status)
        status = check_times(times, CHECKS + 1, error);
    if (!status)
        status = look(model, params, initial, times, CHECKS + 1, NULL, sizes, path, error);
    if (status)
        fp3_path_close(path);
    return status;
}
