/* SPDX-License-Identifier: Apache-2.0 */
/* standstill.c - states that plain steps are too small to change. */
#include <fp3/model.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static int stays(double x, double increment) {
    return increment != 0 && isfinite(x) && (double)(float)(x + (double)(float)increment) == x;
}

/* Whether the derivative of a state still has its sign where the state would be. */
static int keeps_sign(const fp3_model *model, const fp3_point *point, uint32_t state, double way,
                      double slope, double *room) {
    double *const moved = room + model->expr_count;
    memcpy(moved, point->states, model->state_count * sizeof *moved);
    moved[state] += way;
    fp3_point there = *point;
    there.states = moved;
    fp3_model_evaluate(model, &there, room);
    return room[model->states[state].derivative] * slope > 0;
}

int fp3_model_standstill(const fp3_model *model, const fp3_point *point, double h, double span,
                         double share, double *room, char text[FP3_STANDSTILL_TEXT_SIZE]) {
    text[0] = 0;
    fp3_model_evaluate(model, point, room);
    for (uint32_t s = 0; s < model->state_count; s++) {
        const uint32_t of = model->states[s].derivative;
        const double x = point->states[s], slope = of == FP3_NONE ? 0 : room[of];
        const double increment = slope * (double)(float)h;
        if (!stays(x, increment) || !(fabs(slope * span) > share * fabs(x)) ||
            !keeps_sign(model, point, s, slope * span, slope, room + model->expr_count))
            continue;
        const float single = fabsf((float)x);
        snprintf(text, FP3_STANDSTILL_TEXT_SIZE,
                 "%s stands still: a step adds %.2g, and FP32 rounds %s = %.6g by up to %.2g",
                 model->states[s].name, increment, model->states[s].name, x,
                 ((double)nextafterf(single, INFINITY) - (double)single) / 2);
        return 1;
    }
    return 0;
}
