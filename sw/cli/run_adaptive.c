/* run_adaptive.c - see run_adaptive.h. */
#include "run_adaptive.h"

#include <fp3/model.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

static double above_zero(struct argp_state *state, const char *option, const char *text) {
    double value = 0;
    fp3_error error;
    if (fp3_constant_read(text, &value, &error))
        argp_error(state, "%s: '%s' is no number: %s", option, text, error.text);
    if (!(value > 0 && isfinite(value)))
        argp_error(state, "%s: found '%s', expected a number above 0", option, text);
    return value;
}

void fp3_run_adaptive_tolerance(fp3_program_def *def, struct argp_state *state, const char *text) {
    def->is_adaptive = 1;
    def->adaptive.tolerance = above_zero(state, "--tolerance", text);
}

void fp3_run_adaptive_until(fp3_program_def *def, struct argp_state *state, const char *text) {
    def->adaptive.until = above_zero(state, "--until", text);
}

void fp3_run_adaptive_check(const fp3_program_def *def, int is_model, uint64_t cycle_limit,
                            struct argp_state *state) {
    if (def->is_adaptive && cycle_limit)
        argp_error(state, "--cycle-limit: a limit is of one run, and adaptive steps may take "
                          "several; --steps limits attempts");
    if (def->is_adaptive && !is_model)
        argp_error(state, "--tolerance: only a model (*.ode, or --model) is compiled");
    if (def->adaptive.until != 0 && !def->is_adaptive)
        argp_error(state, "--until: expected --tolerance, too; fixed steps are counted by --steps");
}

void fp3_run_adaptive_record(fp3_program_def *def, const fp3_recording_def *record,
                             struct argp_state *state) {
    if (!record->times)
        argp_error(state,
                   "--tolerance: objects have no step in common; expected --times of snapshots");
    if (def->adaptive.until == 0 && record->times[record->time_count - 1] > 0)
        def->adaptive.until = record->times[record->time_count - 1];
}

static void print_counts(const char *name, const fp3_adaptive_counts *c, size_t objects) {
    printf("%-16s %" PRIu32, name, c->median);
    if (objects > 1)
        printf(" is the median of the objects, %" PRIu32 " the least, %" PRIu32 " the most",
               c->least, c->most);
    putchar('\n');
}

fp3_status fp3_run_adaptive_print(fp3_engine *engine) {
    const size_t objects = fp3_engine_objects(engine);
    fp3_adaptive_report report;
    char text[FP3_ADAPTIVE_TEXT_SIZE];
    fp3_status status = fp3_adaptive_report_make(engine, 0, objects, &report);
    if (status)
        return status;
    print_counts("accepted", &report.accepted, objects);
    print_counts("rejected", &report.rejected, objects);
    if (report.largest > 0) {
        if (report.smallest > 0)
            printf("%-16s %.9g\n", "smallest step", (double)report.smallest);
        printf("%-16s %.9g\n", "largest step", (double)report.largest);
    }
    if (report.failed) {
        fp3_adaptive_text(report.first, &report.why, text);
        printf("%-16s %zu of %zu, first %s\n", "failed", report.failed, objects, text);
    }
    return FP3_OK;
}

fp3_status fp3_run_adaptive_judge(fp3_engine *engine, fp3_error *error) {
    const size_t objects = fp3_engine_objects(engine);
    fp3_adaptive_report report;
    char text[FP3_ADAPTIVE_TEXT_SIZE];
    fp3_status status = fp3_adaptive_report_make(engine, 0, objects, &report);
    if (status || !report.failed)
        return status;
    fp3_adaptive_text(report.first, &report.why, text);
    return fp3_fail(error, FP3_E_FAILED,
                    "%s; %zu of %zu objects failed (with --allow-failures the exit code is 0)",
                    text, report.failed, objects);
}
