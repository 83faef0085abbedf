/* SPDX-License-Identifier: Apache-2.0 */
/* run_adaptive.c - see run_adaptive.h. */
#include "run_adaptive.h"

#include "arguments.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SMALL                                                                                      \
    0.01 /* states that are beside 1, which `absolute` takes for their size if nothing is said */

void fp3_run_adaptive_tolerance(fp3_program_def *def, struct argp_state *state, const char *text) {
    def->is_adaptive = 1;
    def->adaptive.tolerance = fp3_arguments_above_zero(state, "--tolerance", text);
}

void fp3_run_adaptive_until(fp3_program_def *def, struct argp_state *state, const char *text) {
    def->adaptive.until = fp3_arguments_above_zero(state, "--until", text);
}

fp3_status fp3_run_adaptive_maxstep(fp3_program_def *def, const fp3_params *params,
                                    fp3_error *error) {
    return def->is_adaptive && fp3_params_has(params, "maxstep")
               ? fp3_params_get(params, "maxstep", &def->adaptive.maxstep, error)
               : FP3_OK;
}

void fp3_run_adaptive_check(fp3_program_def *def, int is_model, struct argp_state *state) {
    if (def->is_adaptive && !is_model)
        argp_error(state, "--tolerance: only a model (*.ode, or --model) is compiled");
    if (def->adaptive.until == 0 || def->is_adaptive)
        return;
    if (!is_model)
        argp_error(state,
                   "--until: only a model (*.ode, or --model) is compiled; the time at which "
                   "the objects of a program end is its param, --set until=..");
    def->is_adaptive = 1;
    def->adaptive.tolerance = 0;
}

void fp3_run_adaptive_record(fp3_program_def *def, const fp3_recording_def *record,
                             struct argp_state *state) {
    if (!record->times)
        argp_error(state,
                   "--tolerance: objects have no step in common; expected --times of snapshots");
    if (def->adaptive.until == 0 && record->times[record->time_count - 1] > 0)
        def->adaptive.until = record->times[record->time_count - 1];
}

/* Nothing if the count is not observed: the program does not keep it. */
static void print_counts(const fp3_image *image, const char *name, const fp3_adaptive_counts *c,
                         size_t objects) {
    if (!fp3_image_find(image, name, FP3_CLASS(FP3_SYMBOL_STATE)))
        return;
    printf("%-16s %" PRIu32, name, c->median);
    if (objects > 1)
        printf(" is the median of the objects, %" PRIu32 " the least, %" PRIu32 " the most",
               c->least, c->most);
    putchar('\n');
}

fp3_status fp3_run_adaptive_print(fp3_engine *engine, const fp3_image *image, size_t first,
                                  size_t objects) {
    fp3_adaptive_report report;
    fp3_status status = fp3_adaptive_report_make(engine, first, objects, &report);
    if (status)
        return status;
    print_counts(image, "accepted", &report.accepted, objects);
    print_counts(image, "rejected", &report.rejected, objects);
    if (report.stopped)
        printf("%-16s %zu of %zu, at events\n", "stopped", report.stopped, objects);
    if (report.largest > 0) {
        if (report.smallest > 0)
            printf("%-16s %.9g\n", "smallest step", (double)report.smallest);
        printf("%-16s %.9g\n", "largest step", (double)report.largest);
    }
    return FP3_OK;
}

/* A step with a NaN in it is rejected as one with too large an error is. */
static void add_cause(const fp3_adaptive_object *found, uint32_t flags,
                      char text[FP3_ADAPTIVE_TEXT_SIZE]) {
    const size_t size = strlen(text);
    if (found->end == FP3_ADAPTIVE_STUCK && flags & FP3_FLAG_INVALID)
        snprintf(
            text + size, FP3_ADAPTIVE_TEXT_SIZE - size,
            ", or it has no derivative there: an operation gave no number (0/0, a root below 0)");
}

fp3_status fp3_run_adaptive_failed(fp3_engine *engine, size_t first, size_t objects, uint32_t flags,
                                   size_t *failed, char text[FP3_ADAPTIVE_TEXT_SIZE]) {
    fp3_adaptive_report report;
    fp3_status status = fp3_adaptive_report_make(engine, first, objects, &report);
    *failed = status ? 0 : report.failed;
    if (*failed) {
        fp3_adaptive_text(report.first, &report.why, text);
        add_cause(&report.why, flags, text);
    }
    return status;
}

/* The largest start of a state of the model's own; 0: all are, or there is no value. */
static double largest_start(const fp3_program *program, const fp3_params *params) {
    const fp3_compiled *c = program->compiled;
    float *values = calloc(c->input_count + 1u, sizeof *values);
    int is_spread;
    double largest = 0;
    if (values && !fp3_program_inputs(program, params, 0, values, &is_spread, NULL))
        for (uint32_t i = 0; i < c->input_count; i++)
            if (c->inputs[i].state < fp3_model_adapted(program->model))
                largest = fmax(largest, fabs((double)values[i]));
    free(values);
    return largest;
}

void fp3_run_adaptive_warning(const fp3_program *program, const fp3_params *params,
                              char text[FP3_RUN_ADAPTIVE_TEXT_SIZE]) {
    const fp3_model *m = program->model;
    text[0] = '\0';
    if (!m || !fp3_model_chooses_steps(m) || fp3_params_has(params, "absolute"))
        return;
    const double absolute = m->params[fp3_model_param(m, "absolute")].value;
    const double tolerance = m->params[fp3_model_param(m, "tolerance")].value;
    const double largest = largest_start(program, params);
    if (absolute == tolerance && largest > 0 && largest < SMALL)
        snprintf(
            text, FP3_RUN_ADAPTIVE_TEXT_SIZE,
            "no state starts above %.3g, and a step may be wrong by 'absolute', which is %.3g like "
            "the tolerance: set it to the tolerance times the size of the states",
            largest, absolute);
}
