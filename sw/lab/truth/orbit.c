/* SPDX-License-Identifier: Apache-2.0 */
/* orbit.c - see orbit.h. */
#include "orbit.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <string.h>

#include "crossing.h"
#include "stiff.h"

#define LOOKS 1024 /* for events, at least, on the way: one that ends between two is not seen */
#define LOST_STEPS 10000
#define STIFF_EVERY 128 /* steps there is a look at the Jacobian */
#define STIFF_LOOKS 32  /* that find the step limited by stability */
#define STIFF_PART 0.5  /* of what is stable: steps that accuracy limits are far below it */

typedef struct {
    fp3_orbit *o;
    const fp3_method *how;
    gsl_odeiv2_driver *driver;
    fp3_crossing *events; /* NULL: nothing stops it */
    double now, h;
    int is_beyond; /* the end: what happens there is of no size */
} traveller;

static void see_peaks(const fp3_orbit *o, const double *y) {
    for (uint32_t i = 0; i < o->slopes->model->state_count; i++)
        o->peak[i] = fmax(o->peak[i], fabs(y[i]));
}

static double end_of(const fp3_orbit *o) { return o->times[o->count - 1]; }

static int step(traveller *w, double t) {
    gsl_odeiv2_driver *d = w->driver;
    return gsl_odeiv2_evolve_apply(d->e, d->c, d->s, d->sys, &w->now, t, &w->h, w->o->y);
}

/* An event may have stopped the object. */
static void see_stop(const traveller *w) {
    if (!w->events || !w->events->has_stopped)
        return;
    w->o->slopes->has_stopped = 1;
    w->o->stopped = w->now;
}

/* One step of GSL's, up to an event if one happens, or to where a switch turns. */
static int advance(traveller *w, double t, int *is_found) {
    fp3_crossing *events = w->events;
    const double from = w->now;
    *is_found = 0;
    if (!events || events->has_stopped)
        return step(w, t);
    if (events->model->event_count || events->switches->has_states)
        w->h = copysign(fmin(fabs(w->h), fabs(t) / LOOKS), t);
    t = fp3_switches_until(events->switches, from, t);
    memcpy(events->from, w->o->y, w->driver->sys->dimension * sizeof(double));
    int result = step(w, t);
    if (!result)
        result = fp3_crossing_find(events, from, &w->now, w->o->y, is_found);
    if (*is_found) {
        gsl_odeiv2_evolve_reset(w->driver->e);
        gsl_odeiv2_step_reset(w->driver->s);
        see_stop(w);
    }
    return result;
}

/* A step has come to y, or to where the solution stopped (crossing.h) and goes on from y. */
static int keep(const traveller *w, int is_stop) {
    const fp3_orbit *o = w->o;
    if (!o->path)
        return GSL_SUCCESS;
    return is_stop ? fp3_path_start(o->path, w->now, o->y, w->events->is_event)
                   : fp3_path_step(o->path, w->now, o->y);
}

/* Whether a step from a time on was one of too many that are limited by stability. */
static int judge(const traveller *w, double from) {
    fp3_orbit *o = w->o;
    const double least = STIFF_PART * w->how->stable;
    double reach = 0;
    if (least == 0 || o->steps % STIFF_EVERY)
        return GSL_SUCCESS;
    const int result = fp3_stiff_reach(w->driver->sys, w->now, w->now - from, o->y, least, &reach);
    o->limited += reach >= least;
    return !result && o->limited == STIFF_LOOKS ? FP3_ORBIT_STIFF : result;
}

/* So many steps are tried in vain that rounding must be what the tolerance measures. */
static int is_lost(const traveller *w) {
    const unsigned steps = w->o->steps;
    return w->how->floor < 1 && steps >= LOST_STEPS && w->driver->e->failed_steps > steps / 4;
}

static int count(const traveller *w, double from) {
    if (++w->o->steps == w->how->most)
        return GSL_EMAXITER;
    return is_lost(w) ? GSL_ETOL : judge(w, from);
}

/* y goes on to a time. */
static int go_to(traveller *w, double t) {
    int result = GSL_SUCCESS, is_stop;
    while (!result && w->now != t) {
        const double from = w->now;
        result = advance(w, t, &is_stop);
        if (!result)
            result = keep(w, is_stop);
        if (!w->is_beyond)
            see_peaks(w->o, w->o->y);
        w->o->reached = w->now;
        if (!result)
            result = count(w, from);
    }
    return result;
}

/* A path goes on where the solution does. */
static int go_beyond(traveller *w) {
    fp3_orbit *o = w->o;
    int result = fp3_path_stop(o->path, w->now);
    if (!result)
        result = fp3_path_start(o->path, w->now, o->y, 0);
    if (result)
        return result;
    w->is_beyond = 1;
    result = go_to(w, w->now * (1 + FP3_PATH_BEYOND));
    if (result != GSL_ENOMEM)
        result = result ? GSL_SUCCESS : fp3_path_stop(o->path, w->now);
    return result ? result : fp3_path_finish(o->path);
}

/* y goes from time 0 to the end, and is kept at each time. A path has no stop on the way. */
static int go(traveller *w, double *rows) {
    fp3_orbit *o = w->o;
    const uint32_t states = o->slopes->model->state_count;
    int result = w->events ? fp3_crossing_start(w->events, o->y) : GSL_SUCCESS;
    see_stop(w);
    if (!result && o->path)
        result = fp3_path_start(o->path, 0, o->y, 0);
    for (size_t i = o->path ? o->count - 1 : 0; !result && i < o->count; i++) {
        result = go_to(w, o->times[i]);
        memcpy(rows + i * states, o->y, states * sizeof *o->y);
    }
    if (result || !o->path)
        return result;
    result = go_beyond(w);
    for (size_t i = 0; !result && i + 1 < o->count; i++)
        fp3_path_at(o->path, o->times[i], rows + i * states);
    return result;
}

int fp3_orbit_go(fp3_orbit *o, const fp3_method *how, double tolerance, const double *sizes,
                 double *rows, fp3_path **path) {
    const fp3_model *model = o->slopes->model;
    const uint32_t states = model->state_count;
    gsl_odeiv2_system system = {fp3_slopes_of, fp3_slopes_jacobian, states, o->slopes};
    fp3_crossing events = {0};
    traveller w = {.o = o, .how = how, .h = end_of(o) * 1e-6};
    w.driver = gsl_odeiv2_driver_alloc_scaled_new(&system, how->step, w.h, tolerance * how->floor,
                                                  tolerance, 1, how->slope, sizes);
    int result = w.driver ? GSL_SUCCESS : GSL_ENOMEM;
    if (model->event_count || o->slopes->switches.has_any)
        w.events = &events;
    if (!result && w.events)
        result = fp3_crossing_open(&events, &o->slopes->switches, &system, how->within);
    o->path = path ? *path = fp3_path_begin(&system, how->within, sizes) : NULL;
    events.path = o->path;
    if (path && !o->path)
        result = GSL_ENOMEM;
    memcpy(o->y, o->slopes->initial, states * sizeof *o->y);
    for (uint32_t i = 0; i < states; i++)
        o->peak[i] = fabs(o->y[i]);
    o->reached = 0;
    o->stopped = INFINITY;
    o->slopes->has_stopped = 0;
    o->steps = o->limited = 0;
    if (!result)
        result = go(&w, rows);
    fp3_crossing_close(&events);
    if (w.driver)
        gsl_odeiv2_driver_free(w.driver);
    return result;
}
