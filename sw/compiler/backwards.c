/* SPDX-License-Identifier: Apache-2.0 */
/* backwards.c - see backwards.h: midpoint steps, extrapolated to length 0 (Gragg, Bulirsch, Stoer).
 *
 * A part of the way is accepted if two orders agree. Where the equations jump, parts get shorter
 * until the jump lies in a part that is too short to matter.
 */
#include "backwards.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ORDERS 12
#define PARTS 4000 /* most of them, refused ones included */
/* Two orders agree to this share of a state's size; if rounding in the equations prevents that, to
 * SHARPER times as much, up to the last. */
#define AGREEMENT 0x1p-50
#define SHARPER 16
#define AGREEMENT_LAST 0x1p-30

struct fp3_backwards {
    const fp3_model *model;
    const double *params, *initial;
    double *values; /* of all expressions */
    double *y, *size, *slope, *before, *now;
    double *table; /* ORDERS rows: the extrapolations of the last number of steps */
};

fp3_status fp3_backwards_open(const fp3_model *model, fp3_backwards **backwards, fp3_error *error) {
    const size_t states = model->state_count;
    fp3_backwards *b = *backwards = calloc(1, sizeof *b);
    double *room = b ? calloc(model->expr_count + (5 + ORDERS) * states + 1, sizeof *room) : NULL;
    if (!room) {
        fp3_backwards_close(backwards);
        return fp3_no_memory(error);
    }
    b->model = model;
    b->values = room;
    b->y = b->values + model->expr_count;
    b->size = b->y + states;
    b->slope = b->size + states;
    b->before = b->slope + states;
    b->now = b->before + states;
    b->table = b->now + states;
    return FP3_OK;
}

void fp3_backwards_close(fp3_backwards **backwards) {
    if (*backwards)
        free((*backwards)->values);
    free(*backwards);
    *backwards = NULL;
}

/* The slopes at a point, and how large states are on the way over a part of length h. */
static void look(fp3_backwards *b, double t, double h, const double *y) {
    const fp3_point point = {.states = y, .params = b->params, .initial = b->initial, .t = t};
    fp3_model_evaluate(b->model, &point, b->values);
    for (uint32_t i = 0; i < b->model->state_count; i++) {
        b->slope[i] = b->values[b->model->states[i].derivative];
        b->size[i] = fmax(b->size[i], fmax(fabs(y[i]), fabs(h * b->slope[i])));
    }
}

/* From b->y at time t in n steps, an even number; the end replaces b->before. */
static void midpoint(fp3_backwards *b, double t, double h, unsigned n) {
    const uint32_t states = b->model->state_count;
    const double step = h / n;
    look(b, t, h, b->y);
    for (uint32_t i = 0; i < states; i++) {
        b->before[i] = b->y[i];
        b->now[i] = b->y[i] + step * b->slope[i];
    }
    for (unsigned m = 1; m < n; m++) {
        look(b, t + m * step, h, b->now);
        for (uint32_t i = 0; i < states; i++) {
            const double next = b->before[i] + 2 * step * b->slope[i];
            b->before[i] = b->now[i];
            b->now[i] = next;
        }
    }
    look(b, t + h, h, b->now);
    for (uint32_t i = 0; i < states; i++)
        b->before[i] = 0.5 * (b->before[i] + b->now[i] + step * b->slope[i]);
}

/* Row j of the table becomes the extrapolation of the last j + 1 numbers of steps. Returns whether
 * the last two rows agree in all states. */
static int extrapolate(fp3_backwards *b, unsigned order, double agreement) {
    const uint32_t states = b->model->state_count;
    int agree = order > 0;
    for (uint32_t i = 0; i < states; i++) {
        double better = b->before[i], row = 0;
        for (unsigned j = 0; j <= order; j++) {
            const double old = b->table[j * states + i];
            b->table[j * states + i] = row = better;
            if (j < order) {
                const double ratio = (order + 1.0) / (order - j);
                better += (better - old) / (ratio * ratio - 1);
                agree &= j + 1 < order || fabs(better - row) <= agreement * b->size[i];
            }
        }
        agree &= isfinite(row);
    }
    return agree;
}

/* The order at which a part is accepted; ORDERS: none. */
static unsigned part(fp3_backwards *b, double t, double h, double agreement) {
    memset(b->size, 0, b->model->state_count * sizeof *b->size);
    for (unsigned order = 0; order < ORDERS; order++) {
        midpoint(b, t, h, 2 * (order + 1));
        if (extrapolate(b, order, agreement))
            return order;
    }
    return ORDERS;
}

static int go(fp3_backwards *b, double end, double agreement) {
    const size_t states = b->model->state_count;
    double t = 0, h = end;
    memcpy(b->y, b->initial, states * sizeof *b->y);
    for (unsigned parts = 0; parts < PARTS && t != end; parts++) {
        const double length = fabs(h) < fabs(end - t) ? h : end - t;
        const unsigned order = part(b, t, length, agreement);
        h = order < ORDERS ? 2 * length : length / 2;
        if (order == ORDERS)
            continue;
        memcpy(b->y, b->table + order * states, states * sizeof *b->y);
        t = length == end - t ? end : t + length;
    }
    return t == end;
}

fp3_status fp3_backwards_go(fp3_backwards *b, const double *params, const double *initial, double h,
                            double *states, fp3_error *error) {
    b->params = params;
    b->initial = initial;
    for (double agreement = AGREEMENT; agreement <= AGREEMENT_LAST; agreement *= SHARPER)
        if (go(b, -h, agreement)) {
            memcpy(states, b->y, b->model->state_count * sizeof *states);
            return FP3_OK;
        }
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "no states at time %.9g, one step before the start: the equations have no "
                    "solution that far back",
                    -h);
}
