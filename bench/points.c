/* points.c - ways to solve a problem: each is run for its error, then all in turn for their times. */
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define SOLVED 0.1
#define WORSE_MOST 2
#define ERROR_MOST 0.5 /* of the scale: beyond it nothing is solved */

double bench_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

bench_point *bench_points_add(bench_points *points, const bench_point *point) {
    if (points->count == points->room) {
        const size_t room = 2 * points->room + 64;
        bench_point *more = realloc(points->point, room * sizeof *more);
        if (!more)
            return NULL;
        points->point = more;
        points->room = room;
    }
    bench_point *added = &points->point[points->count];
    *added = *point;
    added->ends = calloc((size_t)point->problem->variants * point->problem->model->state_count + 1,
                         sizeof *added->ends);
    if (!added->ends)
        return NULL;
    points->count++;
    return added;
}

static void close_point(bench_point *point) {
    if (point->close)
        point->close(point);
    free(point->ends);
}

void bench_points_close(bench_points *points) {
    for (size_t i = 0; i < points->count; i++)
        close_point(&points->point[i]);
    free(points->point);
    json_decref(points->left_out);
    *points = (bench_points){0};
}

static void put_text(json_t *object, const char *key, const char *text) {
    json_object_set_new(object, key, text ? json_string(text) : json_null());
}

static void put_number(json_t *object, const char *key, double number) {
    json_object_set_new(object, key,
                        number > 0 && isfinite(number) ? json_real(number) : json_null());
}

static json_t *about(const bench_point *p) {
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

void bench_points_leave_out(bench_points *points, const bench_point *point, const char *why) {
    json_t *o = about(point);
    put_text(o, "why", why);
    json_array_append_new(points->left_out, o);
}

json_t *bench_points_json(const bench_points *points) {
    json_t *all = json_array();
    for (size_t i = 0; i < points->count; i++) {
        const bench_point *p = &points->point[i];
        json_t *o = about(p);
        const double seconds = bench_median(p->seconds, p->repeats);
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

/* Runs once for the error; whether the point stays. */
static fp3_status first_run(bench_points *points, bench_point *p, int *stays, fp3_error *error) {
    double seconds = 0;
    fp3_error why = {""};
    *stays = 1;
    const fp3_status status = p->run ? p->run(p, &seconds, &why) : FP3_OK;
    if (status == FP3_E_LIMIT) {
        bench_points_leave_out(points, p, why.text);
        *stays = 0;
        return FP3_OK;
    }
    if (status)
        return fp3_fail(error, status, "%s %s: %s", p->engine,
                        p->method ? p->method : p->integrator, why.text);
    bench_problem_errors(p->problem, p->ends, &p->error_median, &p->error_worst);
    *stays = p->error_median < ERROR_MOST;
    const double fits = seconds > 0 ? points->patience / seconds : points->repeats;
    p->repeats = !p->run                  ? 0
                 : fits < 1               ? 1
                 : fits < points->repeats ? (unsigned)fits
                                          : points->repeats;
    p->seconds[0] = seconds; /* kept if there is no time for another */
    return FP3_OK;
}

/* In turn: the first repeat of all, the second of all, ... */
static fp3_status repeat_all(bench_points *points, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (unsigned r = 0; !status && r < points->repeats; r++) {
        fprintf(stderr, "  %zu points, time %u of %u\n", points->count, r + 1, points->repeats);
        for (size_t i = 0; !status && i < points->count; i++) {
            bench_point *p = &points->point[i];
            if (r < p->repeats && p->repeats > 1)
                status = p->run(p, &p->seconds[r], error);
        }
    }
    return status;
}

/* Points with smaller and smaller time steps, of one solver: when two in a row are no better than the
 * best, or the next would take too long, the rest is not worth a run. */
typedef struct {
    const char *engine, *method;
    double best;
    unsigned worse;
} series;

static int is_worth_it(series *s, const bench_point *p) {
    if (!p->run || !p->steps || !p->method)
        return 1;
    if (p->engine != s->engine || p->method != s->method)
        *s = (series){.engine = p->engine, .method = p->method, .best = INFINITY};
    return s->worse < WORSE_MOST;
}

static void note(series *s, const bench_points *points, const bench_point *p) {
    if (!p->run || !p->steps || !p->method)
        return;
    s->worse = p->error_median < s->best || s->best > SOLVED ? 0 : s->worse + 1;
    s->best = fmin(s->best, p->error_median);
    if (2 * p->seconds[0] > points->patience)
        s->worse = WORSE_MOST;
}

fp3_status bench_points_time(bench_points *points, fp3_error *error) {
    fp3_status status = FP3_OK;
    size_t kept = 0, i = 0;
    series of = {0};
    for (; !status && i < points->count; i++) {
        bench_point *p = &points->point[i];
        int stays = is_worth_it(&of, p);
        if (stays) {
            status = first_run(points, p, &stays, error);
            note(&of, points, p);
        }
        if (stays && !status)
            points->point[kept++] = *p;
        else
            close_point(p);
    }
    for (; i < points->count; i++) /* after a failure */
        close_point(&points->point[i]);
    points->count = kept;
    return status ? status : repeat_all(points, error);
}
