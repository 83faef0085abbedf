/* SPDX-License-Identifier: Apache-2.0 */
/* path.c - polynomials between the steps of a solution, each as long as it may be.
 *
 * One of degree 7 goes through four points and has their slopes, which begin as those of three
 * steps. Where it misses the solution in the middle of the longest step, each step gets its own,
 * with points at their thirds: one, or more if the step is so long that one misses the solution.
 * Two neighbours become one if that goes through the points that it leaves out.
 */
#include "path.h"

#include <fp3/tune.h>
#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "part.h"

#define NEAR 1e-10 /* of the solution, relative to a state's size */
#define POINTS 4   /* of a polynomial */
#define TERMS (2 * POINTS)
#define SHARES_MOST 4096 /* of a step */
#define TWICE 2          /* a neighbour more than so many times as long stays by itself */
/* An event so close behind the step before, relative to the time, is at it. */
#define NO_STEP 1e-14

/* A part without events or turns of the equations. */
typedef struct {
    size_t row;   /* its first */
    int is_event; /* it begins with one */
} piece;

/* A polynomial is a row: the times of its points, then states and slopes of one point after the
 * other; in the end, of all states, the coefficients of Newton's form. */
struct fp3_path {
    size_t states, width; /* of a row */
    double *rows;
    size_t count, room;
    piece *pieces;
    size_t piece_count, piece_room;
    int is_event; /* a piece without length began with one */
    /* Until it is finished. */
    const gsl_odeiv2_system *system;
    const double *sizes;
    gsl_odeiv2_step *step;
    double *pending, *third, *both, *there, *lost; /* three rows; states */
    unsigned points;                               /* of `pending` */
    double share;                                  /* of a step: so long may a polynomial be */
};

fp3_path *fp3_path_begin(const gsl_odeiv2_system *system, const gsl_odeiv2_step_type *how,
                         const double *sizes) {
    fp3_path *p = calloc(1, sizeof *p);
    if (!p)
        return NULL;
    p->system = system;
    p->share = INFINITY;
    p->sizes = sizes;
    p->states = system->dimension;
    p->width = POINTS + TERMS * p->states;
    p->step = gsl_odeiv2_step_alloc(how, p->states);
    p->pending = calloc(3 * p->width + 2 * p->states, sizeof *p->pending);
    if (!p->step || !p->pending) {
        fp3_path_close(&p);
        return NULL;
    }
    p->third = p->pending + p->width;
    p->both = p->third + p->width;
    p->there = p->both + p->width;
    p->lost = p->there + p->states;
    return p;
}

static void free_steps(fp3_path *p) {
    if (p->step)
        gsl_odeiv2_step_free(p->step);
    p->step = NULL;
    free(p->pending);
    p->pending = NULL;
}

void fp3_path_close(fp3_path **path) {
    fp3_path *p = *path;
    if (!p)
        return;
    free_steps(p);
    free(p->rows);
    free(p->pieces);
    free(p);
    *path = NULL;
}

/* ---- a polynomial ---- */

static double *point_of(const fp3_path *p, const double *row, unsigned point) {
    return (double *)row + POINTS + 2 * point * p->states;
}

static int put_point(const fp3_path *p, double *row, unsigned point, double t, const double *y) {
    double *to = point_of(p, row, point);
    row[point] = t;
    memcpy(to, y, p->states * sizeof *y);
    return p->system->function(t, to, to + p->states, p->system->params);
}

static void copy_point(const fp3_path *p, double *row, unsigned point, const double *from,
                       unsigned which) {
    row[point] = from[which];
    memcpy(point_of(p, row, point), point_of(p, from, which), 2 * p->states * sizeof *row);
}

/* Points and slopes become divided differences, each point being there twice. */
static void solve(const fp3_path *p, double *row) {
    for (size_t i = 0; i < p->states; i++) {
        double *cell = row + POINTS + i, d[TERMS];
        for (unsigned k = 0; k < TERMS; k++)
            d[k] = cell[(k & ~1u) * p->states];
        for (unsigned order = 1; order < TERMS; order++)
            for (unsigned k = TERMS - 1; k >= order; k--)
                d[k] = order == 1 && k % 2
                           ? cell[k * p->states]
                           : (d[k] - d[k - 1]) / (row[k / 2] - row[(k - order) / 2]);
        for (unsigned k = 0; k < TERMS; k++)
            cell[k * p->states] = d[k];
    }
}

static double value(const fp3_path *p, const double *row, double t, size_t state) {
    const double *cell = row + POINTS + state;
    double sum = cell[(TERMS - 1) * p->states];
    for (unsigned k = TERMS - 1; k-- > 0;)
        sum = sum * (t - row[k / 2]) + cell[k * p->states];
    return sum;
}

static double product(const double *row, double t) {
    double product = 1;
    for (unsigned i = 0; i < POINTS; i++)
        product *= t - row[i];
    return product * product;
}

/* How far it is from y at a time, as a multiple of NEAR; so its error is told where it is largest:
 * near the middle between two points. */
static double miss(const fp3_path *p, const double *row, double t, const double *y) {
    double most = 0, worst = 0;
    for (unsigned i = 0; i + 1 < POINTS; i++)
        most = fmax(most, product(row, (row[i] + row[i + 1]) / 2));
    const double near = NEAR * fmin(1, product(row, t) / most);
    for (size_t i = 0; i < p->states; i++) {
        const double e = fabs(value(p, row, t, i) - y[i]) / (near * p->sizes[i]);
        if (!(e <= worst)) /* a NaN, too */
            worst = isfinite(e) ? e : INFINITY;
    }
    return worst;
}

static int meets(const fp3_path *p, const double *row, double t, const double *y) {
    return miss(p, row, t, y) <= 1;
}

/* ---- rows ---- */

static double length(const double *row) { return row[POINTS - 1] - row[0]; }

/* The last two rows become one. */
static int merge(fp3_path *p) {
    static const struct {
        unsigned row, point;
    } kept[POINTS] = {{0, 0}, {0, 2}, {1, 1}, {1, 3}}, left[] = {{0, 1}, {0, 3}, {1, 2}};
    if (p->count < p->pieces[p->piece_count - 1].row + 2)
        return 0;
    double *at = p->rows + (p->count - 2) * p->width;
    const double *const rows[] = {at, at + p->width};
    if (length(rows[0]) > TWICE * length(rows[1]))
        return 0;
    for (unsigned i = 0; i < POINTS; i++)
        copy_point(p, p->both, i, rows[kept[i].row], kept[i].point);
    solve(p, p->both);
    for (unsigned i = 0; i < sizeof left / sizeof *left; i++) {
        const double *row = rows[left[i].row];
        if (!meets(p, p->both, row[left[i].point], point_of(p, row, left[i].point)))
            return 0;
    }
    copy_point(p, at, 1, at, 2);
    copy_point(p, at, 2, rows[1], 1);
    copy_point(p, at, 3, rows[1], 3);
    p->count--;
    return 1;
}

static int push(fp3_path *p, const double *row) {
    if (p->count == p->room) {
        const size_t room = 2 * p->room + 16;
        double *more = realloc(p->rows, room * p->width * sizeof *more);
        if (!more)
            return GSL_ENOMEM;
        p->rows = more;
        p->room = room;
    }
    memcpy(p->rows + p->count++ * p->width, row, p->width * sizeof *row);
    while (merge(p)) {
    }
    return GSL_SUCCESS;
}

/* ---- steps ---- */

/* p->there: the states at a time behind a point of a row. */
static int go(fp3_path *p, const double *row, unsigned point, double t) {
    memcpy(p->there, point_of(p, row, point), p->states * sizeof *p->there);
    return fp3_part_go(p->step, p->system, row[point], t - row[point], p->there, p->lost);
}

/* `third` goes from its first point, where it is left, to a time, with points at its thirds. */
static int fill(fp3_path *p, double end) {
    const double from = p->third[0];
    int result = GSL_SUCCESS;
    for (unsigned i = 1; !result && i < POINTS; i++) {
        const double t = i == POINTS - 1 ? end : from + (end - from) * i / (POINTS - 1);
        result = go(p, p->third, 0, t);
        if (!result)
            result = put_point(p, p->third, i, t, p->there);
    }
    return result;
}

/* By how much `third` misses the solution in the middle of its first part and of its last. */
static int measure(fp3_path *p, double *worst) {
    int result = GSL_SUCCESS;
    *worst = 0;
    memcpy(p->both, p->third, p->width * sizeof *p->both);
    solve(p, p->both);
    for (unsigned i = 0; !result && i < POINTS - 1; i += POINTS - 2) {
        const double t = (p->third[i] + p->third[i + 1]) / 2;
        result = go(p, p->third, 0, t);
        if (!result)
            *worst = fmax(*worst, miss(p, p->both, t, p->there));
    }
    return result;
}

/* Polynomials of its own for a step from a point of `pending`: one, or as many as it takes. */
static int push_step(fp3_path *p, unsigned point, double end) {
    int result = GSL_SUCCESS;
    double worst = 0;
    const double least = (end - p->pending[point]) / SHARES_MOST;
    copy_point(p, p->third, 0, p->pending, point);
    while (!result && p->third[0] != end) {
        const double from = p->third[0], width = fmin(p->share, end - from);
        const double to = width < end - from && from + width > from ? from + width : end;
        result = fill(p, to);
        if (!result)
            result = measure(p, &worst);
        const double most = worst > 1 ? 0.5 : 4;
        p->share = fmax(least, width * fmin(most, 0.9 * pow(worst, -1. / TERMS)));
        if (result || (worst > 1 && width > least))
            continue;
        result = push(p, p->third);
        copy_point(p, p->third, 0, p->third, POINTS - 1);
    }
    return result;
}

static int push_steps(fp3_path *p) {
    int result = GSL_SUCCESS;
    for (unsigned i = 0; !result && i + 1 < p->points; i++)
        result = push_step(p, i, p->pending[i + 1]);
    return result;
}

static int push_all(fp3_path *p) {
    unsigned longest = 0;
    for (unsigned i = 1; i + 1 < POINTS; i++)
        if (p->pending[i + 1] - p->pending[i] > p->pending[longest + 1] - p->pending[longest])
            longest = i;
    const double t = (p->pending[longest] + p->pending[longest + 1]) / 2;
    const int result = go(p, p->pending, longest, t);
    if (result)
        return result;
    memcpy(p->both, p->pending, p->width * sizeof *p->both);
    solve(p, p->both);
    return meets(p, p->both, t, p->there) ? push(p, p->pending) : push_steps(p);
}

int fp3_path_start(fp3_path *p, double t, const double *states, int is_event) {
    if (p->piece_count == p->piece_room) {
        const size_t room = 2 * p->piece_room + 16;
        piece *more = realloc(p->pieces, room * sizeof *more);
        if (!more)
            return GSL_ENOMEM;
        p->pieces = more;
        p->piece_room = room;
    }
    p->pieces[p->piece_count++] = (piece){p->count, is_event || p->is_event};
    p->is_event = 0;
    p->points = 1;
    return put_point(p, p->pending, 0, t, states);
}

int fp3_path_step(fp3_path *p, double t, const double *states) {
    int result = put_point(p, p->pending, p->points++, t, states);
    if (result || p->points < POINTS)
        return result;
    result = push_all(p);
    copy_point(p, p->pending, 0, p->pending, POINTS - 1);
    p->points = 1;
    return result;
}

/* What has no length is no piece; the next one begins with its event. */
static void drop_empty(fp3_path *p) {
    if (p->count == p->pieces[p->piece_count - 1].row)
        p->is_event = p->pieces[--p->piece_count].is_event;
}

int fp3_path_stop(fp3_path *p, double t) {
    const double last = p->pending[p->points - 1];
    int result = push_steps(p);
    if (!result && t - last > NO_STEP * t)
        result = push_step(p, p->points - 1, t);
    drop_empty(p);
    return result;
}

/* An event from which there is no way on: a line is what follows. */
static int push_line(fp3_path *p) {
    const double from = p->pending[0], length = FP3_PATH_BEYOND * from;
    const double *y = point_of(p, p->pending, 0), *rate = y + p->states;
    p->pieces[p->piece_count++] = (piece){p->count, 1};
    for (unsigned i = 0; i < POINTS; i++) {
        double *to = point_of(p, p->third, i);
        p->third[i] = from + length * i / (POINTS - 1);
        for (size_t s = 0; s < p->states; s++) {
            to[s] = y[s] + rate[s] * (p->third[i] - from);
            to[p->states + s] = rate[s];
        }
    }
    return push(p, p->third);
}

int fp3_path_finish(fp3_path *p) {
    drop_empty(p);
    const int result = p->is_event ? push_line(p) : GSL_SUCCESS;
    free_steps(p);
    for (size_t i = 0; i < p->count; i++)
        solve(p, p->rows + i * p->width);
    return result;
}

/* ---- looks ---- */

static void look(const fp3_path *p, size_t row, double t, double *states) {
    for (size_t i = 0; i < p->states; i++)
        states[i] = value(p, p->rows + row * p->width, t, i);
}

void fp3_path_at(const fp3_path *p, double t, double *states) {
    size_t low = 0, high = p->count;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (p->rows[middle * p->width] <= t)
            low = middle;
        else
            high = middle;
    }
    look(p, low, t, states);
}

/* The first piece that begins after t. */
static size_t next_piece(const fp3_path *p, double t) {
    size_t low = 0, high = p->piece_count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (p->rows[p->pieces[middle].row * p->width] <= t)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

int fp3_path_before(const fp3_path *p, double t, double *when, double *states) {
    size_t next = next_piece(p, t);
    while (next >= 2 && !p->pieces[next - 1].is_event)
        next--;
    if (next < 2)
        return 0;
    const size_t row = p->pieces[next - 1].row;
    *when = p->rows[row * p->width];
    look(p, row - 1, *when, states);
    return 1;
}

int fp3_path_after(const fp3_path *p, double t, double *when, double *states) {
    size_t next = next_piece(p, t);
    while (next < p->piece_count && !p->pieces[next].is_event)
        next++;
    if (next == p->piece_count)
        return 0;
    const size_t row = p->pieces[next].row;
    *when = p->rows[row * p->width];
    look(p, row, *when, states);
    return 1;
}

/* ---- errors ---- */

uint64_t fp3_path_every(uint64_t steps) {
    return steps < FP3_TUNE_LOOKS ? 1 : steps / FP3_TUNE_LOOKS;
}

/* A state that is 0 all the time must stay it. */
static double distance(const fp3_path *p, const fp3_path_scale *scale, const double *states) {
    double worst = 0;
    for (size_t i = 0; i < p->states; i++) {
        const double away = fabs(states[i] - scale->room[i]);
        const double e = away == 0 ? 0 : away / scale->sizes[i];
        if (!(e <= worst)) /* a NaN, too */
            worst = isfinite(e) ? e : INFINITY;
    }
    return worst;
}

double fp3_path_error(const fp3_path *p, const fp3_path_scale *scale, double t,
                      const double *states) {
    double when;
    fp3_path_at(p, t, scale->room);
    double e = distance(p, scale, states);
    if (e > 0 && fp3_path_before(p, t, &when, scale->room))
        e = fmin(e, fmax((t - when) / scale->span, distance(p, scale, states)));
    if (e > 0 && fp3_path_after(p, t, &when, scale->room))
        e = fmin(e, fmax((when - t) / scale->span, distance(p, scale, states)));
    return e;
}
