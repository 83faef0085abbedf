/* crossing.c - the time of an event by bisection, as far as double can tell two times apart. */
#include "crossing.h"

#include <gsl/gsl_errno.h>
#include <stdlib.h>
#include <string.h>

int fp3_crossing_open(fp3_crossing *c, const fp3_model *model, const double *params,
                      const gsl_odeiv2_system *system, const gsl_odeiv2_step_type *how) {
    const size_t count = model->state_count + 1u;
    *c = (fp3_crossing){.model = model,
                        .params = params,
                        .system = system,
                        .step = gsl_odeiv2_step_alloc(how, model->state_count),
                        .values = calloc(model->expr_count + 1u, sizeof(double)),
                        .from = calloc(5 * count, sizeof(double))};
    if (!c->step || !c->values || !c->from)
        return GSL_ENOMEM;
    c->there = c->from + count;
    c->next = c->from + 2 * count;
    return GSL_SUCCESS;
}

void fp3_crossing_close(fp3_crossing *c) {
    if (c->step)
        gsl_odeiv2_step_free(c->step);
    free(c->values);
    free(c->from);
    *c = (fp3_crossing){0};
}

static size_t bytes(const fp3_crossing *c) { return c->model->state_count * sizeof(double); }

/* Whether an event happens here; c->next are the states after it. */
static int happens(const fp3_crossing *c, double t, const double *y) {
    memcpy(c->next, y, bytes(c));
    return fp3_model_fire(c->model, c->params, t, c->next, c->values);
}

int fp3_crossing_fire(fp3_crossing *c, double t, double *y) {
    if (!happens(c, t, y))
        return GSL_SUCCESS;
    memcpy(y, c->next, bytes(c));
    if (happens(c, t, y))
        return FP3_CROSSING_STAYS;
    return ++c->happened > FP3_EVENTS_MOST ? FP3_CROSSING_MOST : GSL_SUCCESS;
}

/* c->there: the states at t0 + h. */
static int go(const fp3_crossing *c, double t0, double h) {
    const size_t count = c->model->state_count + 1u;
    double *error = c->from + 3 * count;
    memcpy(c->there, c->from, bytes(c));
    gsl_odeiv2_step_reset(c->step);
    return gsl_odeiv2_step_apply(c->step, t0, h, c->there, error, NULL, NULL, c->system);
}

int fp3_crossing_find(fp3_crossing *c, double t0, double *t, double *y, int *is_found) {
    double before = t0;
    *is_found = happens(c, *t, y);
    while (*is_found) {
        const double middle = before + (*t - before) / 2;
        if (middle <= before || middle >= *t)
            break;
        const int result = go(c, t0, middle - t0);
        if (result)
            return result;
        if (!happens(c, middle, c->there)) {
            before = middle;
            continue;
        }
        *t = middle;
        memcpy(y, c->there, bytes(c));
    }
    return *is_found ? fp3_crossing_fire(c, *t, y) : GSL_SUCCESS;
}
