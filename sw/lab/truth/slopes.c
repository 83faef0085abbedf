/* SPDX-License-Identifier: Apache-2.0 */
/* slopes.c - see slopes.h. */
#include "slopes.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "language/evaluate.h"

fp3_status fp3_slopes_open(fp3_slopes *s, const fp3_model *model, const double *params,
                           const double *initial, double end, fp3_error *error) {
    *s = (fp3_slopes){.model = model,
                      .params = params,
                      .initial = initial,
                      .values = calloc(model->expr_count + 1u, sizeof *s->values)};
    return s->values ? fp3_switches_open(&s->switches, model, params, end, error)
                     : fp3_no_memory(error);
}

void fp3_slopes_close(fp3_slopes *s) {
    fp3_switches_close(&s->switches);
    fp3_differentiated_close(&s->partial);
    free(s->values);
    *s = (fp3_slopes){0};
}

static int take_rates(const fp3_slopes *s, double dydt[]) {
    int result = GSL_SUCCESS;
    for (uint32_t i = 0; i < s->model->state_count; i++) {
        dydt[i] = s->values[s->model->states[i].derivative];
        if (!isfinite(dydt[i]))
            result = GSL_EDOM; /* GSL takes a smaller step */
    }
    return result;
}

static fp3_point point_of(const fp3_slopes *s, double t, const double y[]) {
    return (fp3_point){.states = y, .params = s->params, .initial = s->initial, .t = t};
}

/* What a switch keeps out may have no value beyond it, as the root of max(x, 0): there nothing is
 * held. */
int fp3_slopes_of(double t, const double y[], double dydt[], void *slopes) {
    const fp3_slopes *s = slopes;
    const fp3_point point = point_of(s, t, y);
    if (s->has_stopped) {
        memset(dydt, 0, s->model->state_count * sizeof *dydt);
        return GSL_SUCCESS;
    }
    if (s->switches.has_any) {
        fp3_switches_evaluate(&s->switches, &point, s->values);
        if (take_rates(s, dydt) == GSL_SUCCESS)
            return GSL_SUCCESS;
    }
    fp3_model_evaluate(s->model, &point, s->values);
    return take_rates(s, dydt);
}

static int differentiate(fp3_slopes *s) {
    fp3_error error;
    if (s->partial.partial)
        return GSL_SUCCESS;
    double *values = NULL;
    if (!fp3_differentiate(s->model, 1, &s->partial, &error))
        values = realloc(s->values, (s->partial.model.expr_count + 1u) * sizeof *values);
    if (values)
        s->values = values;
    else
        fp3_differentiated_close(&s->partial);
    return values ? GSL_SUCCESS : GSL_ENOMEM;
}

int fp3_slopes_jacobian(double t, const double y[], double *dfdy, double dfdt[], void *slopes) {
    fp3_slopes *s = slopes;
    const uint32_t count = s->model->state_count;
    if (s->has_stopped) {
        memset(dfdy, 0, count * count * sizeof *dfdy);
        return fp3_slopes_of(t, y, dfdt, s);
    }
    int result = differentiate(s);
    if (!result)
        result = fp3_slopes_of(t, y, dfdt, s);
    if (result)
        return result;
    const fp3_model *more = &s->partial.model;
    const fp3_point point = point_of(s, t, y);
    for (uint32_t i = s->model->expr_count; i < more->expr_count; i++)
        s->values[i] = fp3_ode_compute(&more->exprs[i], &point, s->values);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t by = 0; by <= count; by++) {
            const uint32_t expr = s->partial.partial[i * (count + 1) + by];
            double *to = by < count ? &dfdy[i * count + by] : &dfdt[i];
            *to = expr == FP3_NONE ? 0 : s->values[expr];
            if (!isfinite(*to))
                result = GSL_EDOM;
        }
    return result;
}
