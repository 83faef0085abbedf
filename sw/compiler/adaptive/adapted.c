/* SPDX-License-Identifier: Apache-2.0 */
/* adapted.c - see adapted.h. */
#include "adapted.h"

#include "compiler/step/switching.h"

#include <fp3/compile.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

/* An update of a state rounds it by up to half of 2^-23: a tolerance below that is never met.
 * Compensated, only a like part of the increment, some sixteenth of the state, is lost. */
#define TOLERANCE_LEAST 0x1p-23
#define TOLERANCE_LEAST_COMPENSATED 0x1p-27
#define TOLERANCE_LEAST_DOUBLE 0x1p-40 /* below that the estimate, in floats, is all rounding */
#define LOCATE_LEAST 0x1p-45           /* of the end: t has 48 bits */
/* Its reciprocal, squared with an error of its size, is in range. */
#define ABSOLUTE_LEAST 0x1p-100

static fp3_status check_tolerance(double tolerance, const fp3_options *options, fp3_error *error) {
    const double least = options->arithmetic == FP3_DOUBLE_SINGLE ? TOLERANCE_LEAST_DOUBLE
                         : options->arithmetic == FP3_COMPENSATED ? TOLERANCE_LEAST_COMPENSATED
                                                                  : TOLERANCE_LEAST;
    if (tolerance >= least && tolerance <= 1)
        return FP3_OK;
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "'tolerance' is %.9g: expected a number from %.3g, %s, to 1", tolerance, least,
                    options->arithmetic == FP3_DOUBLE_SINGLE
                        ? "which the estimate of double-single can tell"
                    : options->arithmetic == FP3_COMPENSATED
                        ? "which a compensated update can keep"
                        : "to which FP32 rounds a state in each step (compensated: 7.45e-09)");
}

/* A model has the param where it is given, or where a step might pass over what t changes. */
static fp3_status check_maxstep(const fp3_model *model, double maxstep, fp3_error *error) {
    fp3_switchings switchings;
    if (maxstep > 0 && isfinite(maxstep))
        return FP3_OK;
    const fp3_status status = fp3_switchings_find(model, &switchings, error);
    const uint32_t unknown = switchings.unknown;
    fp3_switchings_close(&switchings);
    if (status)
        return status;
    if (maxstep != 0 || unknown == FP3_NONE)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "'maxstep' is %.9g: expected a finite number above 0", maxstep);
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "line %" PRIu32
                    " changes with t at times that are not known before the run, and an adaptive "
                    "step may pass over such a change: expected a 'maxstep', the longest step, "
                    "shorter than the time between two changes",
                    model->exprs[unknown].line);
}

static fp3_status check_locate(double locate, double until, fp3_error *error) {
    if (locate > 0 && isfinite(locate) && locate >= LOCATE_LEAST * fabs(until))
        return FP3_OK;
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "'locate' is %.9g: expected a finite number above 0, at least 2^-45 of 'until'",
                    locate);
}

static fp3_status check_object(double absolute, double until, double t, double h,
                               fp3_error *error) {
    if (!(absolute >= ABSOLUTE_LEAST && isfinite(absolute)))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "'absolute' is %.9g: expected a finite number from %.3g on", absolute,
                        ABSOLUTE_LEAST);
    if (!(until >= t && isfinite(until)))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "'until' is %.9g: expected a finite time that does not come before t, %.9g",
                        until, t);
    if (!(h > 0 && isfinite(h)))
        return fp3_fail(error, FP3_E_ARGUMENT, "'h_next' is %.9g: expected a finite number above 0",
                        h);
    return FP3_OK;
}

static int is_at_time(const fp3_model *model, const fp3_event *event) {
    const fp3_expr *e = &model->exprs[event->condition];
    return event->armed != FP3_NONE && model->exprs[e->operand[0]].is_known &&
           model->exprs[e->operand[1]].op == FP3_EXPR_TIME;
}

/* An event at the start time of the object never happens: no step comes before it. Earlier events
 * are past. */
static fp3_status check_time(const fp3_event *event, double time, double start, fp3_error *error) {
    const float at = (float)time, from = (float)start;
    if (!(at <= from) || (at < from && from != 0))
        return FP3_OK;
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "line %" PRIu32
                    ": the event at t = %.9g never happens, as the object starts at "
                    "t = %.9g: expected a time after the start",
                    event->line, time, start);
}

static fp3_status check_times(const fp3_model *model, const double *params, const double *initial,
                              size_t count, fp3_error *error) {
    const uint32_t t = fp3_model_adapted(model);
    const size_t states = model->state_count, all = states + model->param_count;
    uint32_t timed = 0;
    for (uint32_t k = 0; k < model->event_count; k++)
        timed += (uint32_t)is_at_time(model, &model->events[k]);
    if (!timed)
        return FP3_OK;
    double *row = calloc(all + model->expr_count + 1, sizeof *row);
    if (!row)
        return fp3_no_memory(error);
    double *values = row + all;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < count; i++) {
        for (size_t s = 0; s < states; s++)
            row[s] = initial[s * count + i];
        for (size_t p = 0; p < model->param_count; p++)
            row[states + p] = params[p * count + i];
        fp3_model_evaluate(model, &(fp3_point){.states = row, .params = row + states}, values);
        for (uint32_t k = 0; !status && k < model->event_count; k++)
            if (is_at_time(model, &model->events[k]))
                status = check_time(&model->events[k],
                                    values[model->exprs[model->events[k].condition].operand[0]],
                                    t == FP3_NONE ? 0 : row[t], error);
    }
    free(row);
    return status;
}

fp3_status fp3_adapted_check(const fp3_model *model, const fp3_options *options,
                             const double *params, const double *initial, size_t count,
                             fp3_error *error) {
    const uint32_t t = fp3_model_adapted(model);
    fp3_status status = check_times(model, params, initial, count, error);
    if (t == FP3_NONE || status)
        return status;
    const uint32_t locate = fp3_model_param(model, "locate");
    const uint32_t maxstep = fp3_model_param(model, "maxstep");
    const int is_chosen = fp3_model_chooses_steps(model);
    const double *tolerance =
        params + (is_chosen ? fp3_model_param(model, "tolerance") * count : 0);
    const double *absolute = params + (is_chosen ? fp3_model_param(model, "absolute") * count : 0);
    const double *until = params + fp3_model_param(model, "until") * count;
    const double *start = initial + t * count, *h = start + count;
    for (size_t i = 0; !status && i < count; i++) {
        status = is_chosen ? check_tolerance(tolerance[i], options, error) : FP3_OK;
        if (!status)
            status = check_object(is_chosen ? absolute[i] : 1, until[i], start[i], h[i], error);
        if (!status && locate != FP3_NONE)
            status = check_locate(params[locate * count + i], until[i], error);
        if (!status && maxstep != FP3_NONE)
            status = check_maxstep(model, params[maxstep * count + i], error);
    }
    return status;
}
