/* SPDX-License-Identifier: Apache-2.0 */
/* bsimp.c - states that a step moves far are shifted away from 0.
 *
 * GSL's bsimp takes a step for unstable if a state becomes many times what it was. So it would
 * hardly leave a point at which one is 1e-18, as right after an event at 0. What a step adds to
 * such a state is what its sum with the shift is rounded to.
 */
#include "bsimp.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    gsl_odeiv2_step *step;
    const gsl_odeiv2_system *system; /* of states that are not shifted */
    double *shift, *states, *shifted;
} shifting;

static void close(void *state) {
    shifting *s = state;
    if (s->step)
        gsl_odeiv2_step_free(s->step);
    free(s->shift);
    free(s);
}

static void *open(size_t count) {
    shifting *s = calloc(1, sizeof *s);
    if (!s)
        return NULL;
    s->step = gsl_odeiv2_step_alloc(gsl_odeiv2_step_bsimp, count);
    s->shift = calloc(3 * count + 1, sizeof *s->shift);
    if (!s->step || !s->shift) {
        close(s);
        return NULL;
    }
    s->states = s->shift + count;
    s->shifted = s->states + count;
    return s;
}

static const double *shift_back(const shifting *s, const double y[]) {
    for (size_t i = 0; i < s->system->dimension; i++)
        s->states[i] = y[i] - s->shift[i];
    return s->states;
}

static int slopes_of(double t, const double y[], double dydt[], void *self) {
    const shifting *s = self;
    return s->system->function(t, shift_back(s, y), dydt, s->system->params);
}

static int jacobian_of(double t, const double y[], double *dfdy, double dfdt[], void *self) {
    const shifting *s = self;
    return s->system->jacobian(t, shift_back(s, y), dfdy, dfdt, s->system->params);
}

static int find_shift(shifting *s, double t, double h, const double y[]) {
    const int result = s->system->function(t, y, s->shift, s->system->params);
    for (size_t i = 0; !result && i < s->system->dimension; i++) {
        const double move = fabs(h * s->shift[i]);
        s->shift[i] = fabs(y[i]) < move ? copysign(move, y[i]) : 0;
    }
    return result;
}

static int apply(void *state, size_t count, double t, double h, double y[], double lost[],
                 const double dydt_in[], double dydt_out[], const gsl_odeiv2_system *system) {
    shifting *s = state;
    const gsl_odeiv2_system shifted = {slopes_of, jacobian_of, count, s};
    (void)dydt_in;
    s->system = system;
    int result = find_shift(s, t, h, y);
    if (result)
        return result;
    for (size_t i = 0; i < count; i++)
        s->shifted[i] = y[i] + s->shift[i];
    result = gsl_odeiv2_step_apply(s->step, t, h, s->shifted, lost, NULL, dydt_out, &shifted);
    if (!result)
        memcpy(y, shift_back(s, s->shifted), count * sizeof *y);
    return result;
}

static int set_driver(void *state, const gsl_odeiv2_driver *driver) {
    (void)state;
    (void)driver;
    return GSL_SUCCESS;
}

static int reset(void *state, size_t count) {
    const shifting *s = state;
    (void)count;
    return gsl_odeiv2_step_reset(s->step);
}

static unsigned order(void *state) {
    const shifting *s = state;
    return gsl_odeiv2_step_order(s->step);
}

const gsl_odeiv2_step_type fp3_step_bsimp = {"bsimp",    0,     0,     open, apply,
                                             set_driver, reset, order, close};
