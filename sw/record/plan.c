/* SPDX-License-Identifier: Apache-2.0 */
/* plan.c - see plan.h. */
#include "plan.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STEPS_MOST UINT32_MAX /* of a run */
#define ROUNDING 4e-16        /* relative, of a time or of h that was typed, and of their product */

static int is_at(double time, double step, double h) {
    return fabs(step * h - time) <= ROUNDING * fabs(time);
}

/* h as it was given, or as the program has it: whoever asks for 0.3 with h=0.1 means step 3, and so
 * does who copies the time of step 3 from a file. */
fp3_status fp3_plan_step(const fp3_source *source, double time, uint64_t *step, fp3_error *error) {
    if (!source->has_time)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "times: the program has no time step h, so its steps have no time");
    const double n = round(time / source->h_given), below = floor(time / source->h_given);
    if (!(time >= 0 && n <= STEPS_MOST))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "time %.17g is out of range: a run goes from 0 to %" PRIu32
                        " steps of h = %.17g",
                        time, STEPS_MOST, source->h_given);
    if (!is_at(time, n, source->h_given) && !is_at(time, round(time / source->h), source->h))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "time %.17g is no multiple of h = %.17g: the nearest are %.17g and %.17g",
                        time, source->h_given, below * source->h_given,
                        (below + 1) * source->h_given);
    *step = (uint64_t)(is_at(time, n, source->h_given) ? n : round(time / source->h));
    return FP3_OK;
}

fp3_status fp3_plan_make(const fp3_source *source, uint64_t steps, uint64_t every,
                         const double *times, size_t count, fp3_plan *plan, fp3_error *error) {
    fp3_status status = FP3_OK;
    *plan = (fp3_plan){.steps = steps, .every = every};
    if (!times)
        return FP3_OK;
    plan->count = count;
    if (!count)
        return fp3_fail(error, FP3_E_ARGUMENT, "no times");
    if (!(plan->list = calloc(count, sizeof *plan->list)))
        return fp3_no_memory(error);
    for (size_t i = 0; !status && i < count; i++) {
        status = fp3_plan_step(source, times[i], &plan->list[i], error);
        if (!status && plan->list[i] > steps)
            status = fp3_fail(error, FP3_E_ARGUMENT,
                              "time %.17g is beyond the end of the run, %.17g: %" PRIu64 " steps",
                              times[i], (double)steps * source->h_given, steps);
        if (!status && i && plan->list[i] <= plan->list[i - 1])
            status = fp3_fail(error, FP3_E_ARGUMENT, "time %.17g does not come after %.17g",
                              times[i], times[i - 1]);
    }
    return status;
}

fp3_status fp3_plan_parts(uint64_t parts, fp3_plan *plan, fp3_error *error) {
    *plan = (fp3_plan){.steps = parts, .count = parts, .list = calloc(parts, sizeof *plan->list)};
    for (uint64_t i = 0; plan->list && i < parts; i++)
        plan->list[i] = i + 1;
    return plan->list ? FP3_OK : fp3_no_memory(error);
}

fp3_status fp3_plan_steps(const uint64_t *steps, size_t count, fp3_plan *plan, fp3_error *error) {
    *plan = (fp3_plan){
        .steps = steps[count - 1], .count = count, .list = calloc(count, sizeof *plan->list)};
    if (!plan->list)
        return fp3_no_memory(error);
    memcpy(plan->list, steps, count * sizeof *steps);
    return FP3_OK;
}

void fp3_plan_free(fp3_plan *plan) {
    free(plan->list);
    *plan = (fp3_plan){0};
}

/* How many of the list are at or before a step. */
static size_t count_until(const fp3_plan *plan, uint64_t step) {
    size_t from = 0, to = plan->count;
    while (from < to) {
        const size_t middle = from + (to - from) / 2;
        if (plan->list[middle] <= step)
            from = middle + 1;
        else
            to = middle;
    }
    return from;
}

/* At the end there is one, whatever `every` is. */
uint64_t fp3_plan_count(const fp3_plan *plan, uint64_t from) {
    if (plan->list)
        return plan->count - (from ? count_until(plan, from - 1) : 0);
    const uint64_t every = plan->every ? plan->every : plan->steps;
    const uint64_t all = 1 + (plan->steps ? (plan->steps - 1) / every + 1 : 0);
    return all - (from ? 1 + (from - 1) / every : 0);
}

int fp3_plan_has(const fp3_plan *plan, uint64_t step) {
    if (plan->list) {
        const size_t n = count_until(plan, step);
        return n && plan->list[n - 1] == step;
    }
    return step == 0 || step == plan->steps || (plan->every && step % plan->every == 0);
}

uint64_t fp3_plan_next(const fp3_plan *plan, uint64_t step) {
    uint64_t next = plan->steps;
    if (plan->list && count_until(plan, step) < plan->count)
        next = plan->list[count_until(plan, step)];
    else if (!plan->list && plan->every)
        next = (step / plan->every + 1) * plan->every;
    return next < plan->steps ? next : plan->steps;
}
