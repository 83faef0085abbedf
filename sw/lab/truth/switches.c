/* SPDX-License-Identifier: Apache-2.0 */
/* switches.c - see switches.h. */
#include "switches.h"

#include <math.h>
#include <stdlib.h>

#include "language/evaluate.h"
#include "language/turn.h"

#define CELLS 16384     /* of the grid on which turns of what is not linear in t are looked for */
#define STOPS_MOST 2048 /* more, and the grid may have missed as many */
#define RESOLUTION 0x1p-60  /* of the whole time */
#define EXTREMUM_ROUNDS 100 /* each leaves two thirds */

#define IS_HELD 32 /* beside the bits of turn.h */

/* ---- the side of a switch ---- */

static int side_of(const fp3_expr *e, const double *values) {
    const double a = values[e->operand[0]], b = e->op == FP3_EXPR_ABS ? 0 : values[e->operand[1]];
    return e->op == FP3_EXPR_LESS_EQUAL ? a <= b
           : e->op == FP3_EXPR_EQUAL    ? a == b
           : e->op == FP3_EXPR_MAX      ? b < a
                                        : a < b;
}

static double held(const fp3_expr *e, int side, const double *values) {
    const double a = values[e->operand[0]];
    switch (e->op) {
    case FP3_EXPR_MIN:
    case FP3_EXPR_MAX:
        return side ? a : values[e->operand[1]];
    case FP3_EXPR_ABS:
        return side ? -a : a;
    default:
        return side;
    }
}

static void evaluate_at(fp3_switches *s, double t, const double *y) {
    fp3_model_evaluate(s->model, &(fp3_point){.states = y, .params = s->params, .t = t}, s->values);
}

void fp3_switches_hold(fp3_switches *s, double t, const double *y) {
    evaluate_at(s, t, y);
    for (uint32_t i = 0; i < s->model->expr_count; i++)
        if (s->kind[i] & IS_HELD)
            s->side[i] = (char)side_of(&s->model->exprs[i], s->values);
}

int fp3_switches_have_turned(fp3_switches *s, double t, const double *y) {
    evaluate_at(s, t, y);
    for (uint32_t i = 0; i < s->model->expr_count; i++)
        if (s->kind[i] & IS_HELD && s->side[i] != side_of(&s->model->exprs[i], s->values))
            return 1;
    return 0;
}

void fp3_switches_evaluate(const fp3_switches *s, const fp3_point *point, double *values) {
    for (uint32_t i = 0; i < s->model->expr_count; i++) {
        const fp3_expr *e = &s->model->exprs[i];
        values[i] =
            s->kind[i] & IS_HELD ? held(e, s->side[i], values) : fp3_ode_compute(e, point, values);
    }
}

/* ---- turns of t alone ---- */

/* What the side of the switch is the sign of; *side: that side. */
static double look(fp3_switches *s, uint32_t expr, double t, int *side) {
    const fp3_point point = {.params = s->params, .t = t};
    const fp3_expr *e = &s->model->exprs[expr];
    for (uint32_t i = 0; i < expr; i++)
        if (!(s->kind[i] & FP3_TURN_STATE))
            s->values[i] = fp3_ode_compute(&s->model->exprs[i], &point, s->values);
    *side = side_of(e, s->values);
    return s->values[e->operand[0]] - (e->op == FP3_EXPR_ABS ? 0 : s->values[e->operand[1]]);
}

static int add_stop(fp3_switches *s, double t) {
    if (s->stop_count == s->stop_room) {
        const size_t room = s->stop_room ? 2 * s->stop_room : 16;
        double *stops = realloc(s->stops, room * sizeof *stops);
        if (!stops)
            return 0;
        s->stops = stops;
        s->stop_room = room;
    }
    s->stops[s->stop_count++] = t;
    return 1;
}

/* The switch turns between a and b: the first time at which it has. */
static int bisect(fp3_switches *s, uint32_t expr, double a, double b) {
    int side_a, side;
    look(s, expr, a, &side_a);
    for (;;) {
        const double middle = a + (b - a) / 2;
        if (middle == a || middle == b || fabs(b - a) <= RESOLUTION * fabs(s->end))
            return add_stop(s, b);
        look(s, expr, middle, &side);
        if (side == side_a)
            a = middle;
        else
            b = middle;
    }
}

/* It comes near a turn between a and b: if it goes over and back, both turns. */
static int search_extremum(fp3_switches *s, uint32_t expr, double a, double b) {
    const double from = a, to = b;
    int side, side_1, side_2;
    look(s, expr, a, &side);
    for (int i = 0; i < EXTREMUM_ROUNDS; i++) {
        const double t1 = a + (b - a) / 3, t2 = b - (b - a) / 3;
        const double d1 = fabs(look(s, expr, t1, &side_1)), d2 = fabs(look(s, expr, t2, &side_2));
        if (side_1 != side || side_2 != side) {
            const double over = side_1 != side ? t1 : t2;
            return bisect(s, expr, from, over) && bisect(s, expr, over, to);
        }
        if (d1 < d2)
            b = t2;
        else
            a = t1;
    }
    return 1;
}

static int find_turns(fp3_switches *s, uint32_t expr) {
    const int cells = fp3_turn_is_linear(s->model, s->kind, expr) ? 1 : CELLS;
    double d[3] = {0};
    int side[3], is_good = 1;
    for (int k = 0; is_good && s->stop_count <= STOPS_MOST && k <= cells; k++) {
        const double t = s->end * k / cells, width = s->end / cells;
        d[2] = fabs(look(s, expr, t, &side[2]));
        if (k > 0 && side[1] != side[2])
            is_good = bisect(s, expr, t - width, t);
        else if (k > 1 && side[0] == side[1] && d[1] < d[0] && d[1] <= d[2])
            is_good = search_extremum(s, expr, t - 2 * width, t);
        d[0] = d[1], d[1] = d[2];
        side[0] = side[1], side[1] = side[2];
    }
    return is_good;
}

static int by_size(const void *a, const void *b) {
    const double x = fabs(*(const double *)a), y = fabs(*(const double *)b);
    return (x > y) - (x < y);
}

/* An `==` of t holds for no time. */
static fp3_status find_stops(fp3_switches *s, fp3_error *error) {
    const fp3_model *model = s->model;
    for (uint32_t i = 0; i < model->expr_count; i++) {
        const int is_of_time = fp3_turn_is_of_time(model, s->kind, i);
        if (!fp3_turn_can(model->exprs[i].op))
            continue;
        if (s->kind[i] & FP3_TURN_RATE && s->kind[i] & (FP3_TURN_TIME | FP3_TURN_STATE)) {
            s->kind[i] |= IS_HELD;
            s->has_any = 1;
            s->has_states |= !is_of_time;
        }
        if (!is_of_time || !(s->kind[i] & (FP3_TURN_RATE | FP3_TURN_CONDITION)) ||
            model->exprs[i].op == FP3_EXPR_EQUAL)
            continue;
        s->has_any = 1;
        if (!find_turns(s, i))
            return fp3_no_memory(error);
        if (s->stop_count > STOPS_MOST)
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "no truth: conditions in t change more than %d times up to time %.9g "
                            "(line %u)",
                            STOPS_MOST, s->end, model->exprs[i].line);
    }
    if (s->stop_count)
        qsort(s->stops, s->stop_count, sizeof *s->stops, by_size);
    return FP3_OK;
}

fp3_status fp3_switches_open(fp3_switches *s, const fp3_model *model, const double *params,
                             double end, fp3_error *error) {
    *s = (fp3_switches){.model = model,
                        .params = params,
                        .kind = calloc(model->expr_count + 1u, 1),
                        .side = calloc(model->expr_count + 1u, 1),
                        .values = calloc(model->expr_count + 1u, sizeof(double)),
                        .end = end};
    if (!s->kind || !s->side || !s->values)
        return fp3_no_memory(error);
    fp3_turn_kinds(model, s->kind);
    return find_stops(s, error);
}

void fp3_switches_close(fp3_switches *s) {
    free(s->kind);
    free(s->side);
    free(s->values);
    free(s->stops);
    *s = (fp3_switches){0};
}

double fp3_switches_until(const fp3_switches *s, double now, double t) {
    size_t low = 0, high = s->stop_count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (fabs(s->stops[middle]) > fabs(now))
            high = middle;
        else
            low = middle + 1;
    }
    return low < s->stop_count && fabs(s->stops[low]) < fabs(t) ? s->stops[low] : t;
}
