/* SPDX-License-Identifier: Apache-2.0 */
/* points.c - ways to solve a problem: each is run for its error, then all in turn for their times.
 */
#include "points.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define SOLVED 0.1
#define WORSE_MOST 2
#define ERROR_MOST 0.5   /* of the scale: beyond it nothing is solved */
#define SECONDS_MOST 0.5 /* of a run: the next tolerance would take longer */
#define NEAR 1.5         /* times the shortest time to an error: still near the front */

void fp3_measure_points_say(const fp3_measure_points *points, const char *format, ...) {
    char text[256];
    va_list values;
    va_start(values, format);
    vsnprintf(text, sizeof text, format, values);
    va_end(values);
    if (points->say)
        points->say(points->user, text);
}

static double seconds_of(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double fp3_measure_now(void) { return seconds_of(CLOCK_MONOTONIC); }

double fp3_measure_spent(void) { return seconds_of(CLOCK_THREAD_CPUTIME_ID); }

fp3_measure_point *fp3_measure_points_add(fp3_measure_points *points,
                                          const fp3_measure_point *point) {
    if (points->count == points->room) {
        const size_t room = 2 * points->room + 64;
        fp3_measure_point *more = realloc(points->point, room * sizeof *more);
        if (!more)
            return NULL;
        points->point = more;
        points->room = room;
    }
    fp3_measure_point *added = &points->point[points->count];
    *added = *point;
    added->ends = calloc((size_t)point->problem->variants * point->problem->model->state_count + 1,
                         sizeof *added->ends);
    if (!added->ends)
        return NULL;
    points->count++;
    return added;
}

static void close_point(fp3_measure_point *point) {
    if (point->close)
        point->close(point);
    free(point->ends);
}

void fp3_measure_points_close(fp3_measure_points *points) {
    for (size_t i = 0; i < points->count; i++)
        close_point(&points->point[i]);
    free(points->point);
    json_decref(points->left_out);
    *points = (fp3_measure_points){0};
}

static void put_text(json_t *object, const char *key, const char *text) {
    json_object_set_new(object, key, text ? json_string(text) : json_null());
}

static void put_number(json_t *object, const char *key, double number) {
    json_object_set_new(object, key,
                        number > 0 && isfinite(number) ? json_real(number) : json_null());
}

static json_t *about(const fp3_measure_point *p) {
    json_t *o = json_object();
    put_text(o, "model", p->problem->model->name);
    put_text(o, "engine", p->engine);
    put_text(o, "method", p->method);
    put_text(o, "integrator", p->integrator);
    put_text(o, "arithmetic", p->arithmetic);
    put_text(o, "config", p->config);
    put_number(o, "h", p->h);
    put_number(o, "tolerance", p->tolerance);
    return o;
}

void fp3_measure_points_leave_out(fp3_measure_points *points, const fp3_measure_point *point,
                                  const char *why) {
    json_t *o = about(point);
    put_text(o, "why", why);
    json_array_append_new(points->left_out, o);
}

json_t *fp3_measure_points_json(const fp3_measure_points *points) {
    json_t *all = json_array();
    for (size_t i = 0; i < points->count; i++) {
        const fp3_measure_point *p = &points->point[i];
        json_t *o = about(p);
        const double seconds = fp3_measure_median(p->seconds, p->repeats);
        json_object_set_new(o, "threads", json_integer((json_int_t)p->threads));
        json_object_set_new(o, "objects", json_integer((json_int_t)p->objects));
        json_object_set_new(o, "steps",
                            p->steps ? json_integer((json_int_t)p->steps) : json_null());
        json_object_set_new(o, "error_median", json_real(p->error_median));
        json_object_set_new(o, "error_worst",
                            isfinite(p->error_worst) ? json_real(p->error_worst) : json_null());
        put_number(o, "ns_per_object", seconds * 1e9 / (double)p->objects);
        put_number(o, "cycles", p->cycles);
        json_object_set_new(o, "repeats", json_integer((json_int_t)p->repeats));
        json_array_append_new(all, o);
    }
    return all;
}

/* Runs once for the error; whether the point stays; seconds of this thread's processor. */
static fp3_status first_run(fp3_measure_points *points, fp3_measure_point *p, int *stays,
                            double *spent, fp3_error *error) {
    double seconds = 0;
    fp3_error why = {.text = ""};
    *stays = 1;
    const double begin = fp3_measure_spent();
    const fp3_status status = p->run ? p->run(p, &seconds, &why) : FP3_OK;
    *spent = fp3_measure_spent() - begin;
    p->seconds[0] = seconds; /* kept if there is no time for another */
    p->repeats = p->run != NULL;
    if (status == FP3_E_LIMIT) {
        fp3_measure_points_leave_out(points, p, why.text);
        *stays = 0;
        return FP3_OK;
    }
    if (status)
        return fp3_fail(error, status, "%s %s: %s", p->engine,
                        p->method ? p->method : p->integrator, why.text);
    fp3_measure_problem_errors(p->problem, p->ends, &p->error_median, &p->error_worst);
    *stays = p->error_median < ERROR_MOST;
    return FP3_OK;
}

/* ---- sweeps ---- */

/* Points of one solver with smaller and smaller time steps or tolerances. The rest is not worth a
 * run when two in a row are no better than the best, or one took too long. */
typedef struct {
    const char *engine, *method;
    double best;
    unsigned worse;
} sweep;

static int is_swept(const fp3_measure_point *p) { return p->run && p->method; }

static int is_worth_it(sweep *s, const fp3_measure_point *p) {
    if (!is_swept(p))
        return 1;
    if (p->engine != s->engine || p->method != s->method)
        *s = (sweep){.engine = p->engine, .method = p->method, .best = INFINITY};
    return s->worse < WORSE_MOST;
}

/* A point that was left out has no error. */
static void note(sweep *s, const fp3_measure_points *points, const fp3_measure_point *p, int stays,
                 double spent) {
    if (!is_swept(p))
        return;
    if (stays)
        s->worse = p->error_median < s->best || s->best > SOLVED ? 0 : s->worse + 1;
    s->best = stays ? fmin(s->best, p->error_median) : s->best;
    if (spent > (p->steps ? points->patience : SECONDS_MOST))
        s->worse = WORSE_MOST;
}

/* ---- which points are near the front ---- */

static int is_alike(const fp3_measure_point *a, const fp3_measure_point *b) {
    return a->run && b->run && !strcmp(a->engine, b->engine) && a->threads == b->threads;
}

static double per_object(const fp3_measure_point *p) { return p->seconds[0] / (double)p->objects; }

/* No other of its engine that is as accurate takes by far less time. */
static int is_near(const fp3_measure_points *points, const fp3_measure_point *p) {
    double best = INFINITY;
    for (size_t i = 0; i < points->count; i++) {
        const fp3_measure_point *q = &points->point[i];
        if (q->repeats && is_alike(p, q) && q->error_median <= p->error_median)
            best = fmin(best, per_object(q));
    }
    return per_object(p) <= NEAR * best;
}

double fp3_measure_points_behind(const fp3_measure_points *points, const fp3_measure_point *p,
                                 int is_same_arithmetic) {
    double best = INFINITY;
    for (size_t i = 0; i < points->count; i++) {
        const fp3_measure_point *q = &points->point[i];
        if (q->work > 0 && q->threads == p->threads && q->error_median <= p->error_median &&
            !strcmp(q->engine, p->engine) &&
            (!is_same_arithmetic || !strcmp(q->arithmetic, p->arithmetic)))
            best = fmin(best, q->work);
    }
    return p->work / best;
}

/* The same with one thread. */
static const fp3_measure_point *alone(const fp3_measure_points *points,
                                      const fp3_measure_point *p) {
    for (size_t i = 0; i < points->count; i++) {
        const fp3_measure_point *q = &points->point[i];
        if (q->engine == p->engine && q->threads == 1 && q->integrator == p->integrator &&
            q->arithmetic == p->arithmetic && q->steps == p->steps && q->tolerance == p->tolerance)
            return q;
    }
    return NULL;
}

/* ---- all of it ---- */

static unsigned repeats_of(const fp3_measure_points *points, const fp3_measure_point *p) {
    const double fits = p->seconds[0] > 0 ? points->patience / p->seconds[0] : points->repeats;
    return !is_near(points, p) || fits < 1 ? 1
           : fits < points->repeats        ? (unsigned)fits
                                           : points->repeats;
}

/* In turn: the second run of all, the third of all, ... */
static fp3_status repeat_all(fp3_measure_points *points, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (unsigned r = 1; !status && r < points->repeats; r++) {
        fp3_measure_points_say(points, "%zu points, time %u of %u", points->count, r + 1,
                               points->repeats);
        for (size_t i = 0; !status && i < points->count; i++) {
            fp3_measure_point *p = &points->point[i];
            if (r < p->repeats)
                status = p->run(p, &p->seconds[r], error);
        }
    }
    return status;
}

static void drop(fp3_measure_points *points, const unsigned char *stays) {
    size_t kept = 0;
    for (size_t i = 0; i < points->count; i++)
        if (stays[i])
            points->point[kept++] = points->point[i];
        else
            close_point(&points->point[i]);
    points->count = kept;
}

/* Those with one thread; with several only what is near the front with one. */
static fp3_status first_runs(fp3_measure_points *points, int has_threads, fp3_error *error) {
    fp3_status status = FP3_OK;
    sweep of = {0};
    unsigned char *stays = calloc(points->count + 1, 1);
    if (!stays)
        return fp3_no_memory(error);
    for (size_t i = 0; !status && i < points->count; i++) {
        fp3_measure_point *p = &points->point[i];
        int stay = 1;
        double spent = 0;
        if ((p->threads > 1) == has_threads) {
            const fp3_measure_point *one = has_threads ? alone(points, p) : NULL;
            stay = has_threads ? one && is_near(points, one)
                               : is_worth_it(&of, p) && fp3_measure_points_behind(points, p, 0) <=
                                                            FP3_MEASURE_HOPELESS;
            if (stay) {
                status = first_run(points, p, &stay, &spent, error);
                note(&of, points, p, stay, spent);
            }
        }
        stays[i] = (unsigned char)stay;
    }
    if (!status)
        drop(points, stays);
    free(stays);
    return status;
}

fp3_status fp3_measure_points_time(fp3_measure_points *points, fp3_error *error) {
    fp3_status status = first_runs(points, 0, error);
    if (!status)
        status = first_runs(points, 1, error);
    for (size_t i = 0; !status && i < points->count; i++)
        if (points->point[i].run)
            points->point[i].repeats = repeats_of(points, &points->point[i]);
    return status ? status : repeat_all(points, error);
}
