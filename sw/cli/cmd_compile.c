/* SPDX-License-Identifier: Apache-2.0 */
/* cmd_compile.c - fp3 compile: a model and an integrator to assembly. */
#include "arguments.h"
#include "cli.h"
#include "files.h"
#include "phases_print.h"
#include "progress.h"
#include "run_adaptive.h"

#include <fp3/program.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"

#define OBSERVED_MAX 64

typedef struct {
    const char *model, *assembly, *image, *values;
    fp3_program_def def;
    const char *observed[OBSERVED_MAX];
    fp3_params *params;
    int wants_report, is_native;
} options;

static int list(void) {
    printf("integrators\n");
    for (unsigned i = 0; fp3_integrator_name(i); i++) {
        fp3_integrator *integrator = NULL;
        fp3_error error;
        if (fp3_integrator_find(fp3_integrator_name(i), &integrator, &error))
            return fp3_cli_fail("compile", FP3_E_SYSTEM, &error);
        printf("  %-20s order %u  %s\n", integrator->name, integrator->order, integrator->doc);
        fp3_integrator_free(&integrator);
    }
    printf("passes\n");
    for (int i = 0; i < FP3_PASS_COUNT; i++)
        printf("  %-14s %s%s\n", fp3_pass_name((fp3_pass)i), fp3_pass_doc((fp3_pass)i),
               fp3_pass_changes_bits((fp3_pass)i) ? " (changes bits; off by default)" : "");
    return 0;
}

static void turn(struct argp_state *state, options *o, const char *name, int is_on) {
    const fp3_pass pass = fp3_pass_find(name);
    if (!is_on && strcmp(name, "all") == 0) {
        o->def.compile.passes = 0;
        return;
    }
    if (pass == FP3_PASS_COUNT)
        argp_error(state, "found '%s', expected a pass (fp3 compile --list names them)", name);
    else if (is_on)
        o->def.compile.passes |= FP3_PASS(pass);
    else
        o->def.compile.passes &= ~FP3_PASS(pass);
}

static void take_tolerance(void *user, struct argp_state *state, char *text) {
    options *o = user;
    fp3_run_adaptive_tolerance(&o->def, state, text);
}

static void take_until(void *user, struct argp_state *state, char *text) {
    options *o = user;
    fp3_run_adaptive_until(&o->def, state, text);
}

static void take_compensated(void *user, struct argp_state *state, char *text) {
    options *o = user;
    (void)text;
    fp3_arguments_arithmetic(state, &o->def.compile, FP3_COMPENSATED);
}

static void take_double_single(void *user, struct argp_state *state, char *text) {
    options *o = user;
    (void)text;
    fp3_arguments_arithmetic(state, &o->def.compile, FP3_DOUBLE_SINGLE);
}

static void take_observe(void *user, struct argp_state *state, char *text) {
    options *o = user;
    if (o->def.compile.observed_count == OBSERVED_MAX)
        argp_error(state, "found more than %d states", OBSERVED_MAX);
    o->observed[o->def.compile.observed_count++] = text;
    o->def.compile.observed = o->observed;
}

static void take_with(void *user, struct argp_state *state, char *text) {
    options *o = user;
    turn(state, o, text, 1);
}

static void take_without(void *user, struct argp_state *state, char *text) {
    options *o = user;
    turn(state, o, text, 0);
}

static void take_set(void *user, struct argp_state *state, char *text) {
    options *o = user;
    fp3_error error;
    if (fp3_params_set(o->params, text, &error))
        argp_failure(state, 2, 0, "%s", error.text);
}

static void take_report(void *user, struct argp_state *state, char *text) {
    options *o = user;
    (void)state;
    (void)text;
    o->wants_report = o->def.compile.finds_savings = 1;
}

static void take_list(void *user, struct argp_state *state, char *text) {
    (void)user;
    (void)state;
    (void)text;
    exit(list());
}

static void end(void *user, struct argp_state *state) {
    options *o = user;
    if (!o->model)
        argp_error(state, "expected a model (*.ode)");
    fp3_arguments_model(state, o->model, o->def.is_model);
    fp3_run_adaptive_check(&o->def, 1, state);
    o->def.is_model = 1;
    if (o->is_native && !o->assembly)
        argp_error(state, "--native: expected --output FILE");
    if (fp3_params_count(o->params) && !o->values)
        argp_error(state, "--set: the host writes values: expected --params FILE, too");
}

static const fp3_option table[] = {
    {"model", 0, NULL, "MODEL is a model, whatever its name", FP3_FLAG(options, def.is_model)},
    {"integrator", 'i', "NAME",
     "A built-in table, or a file (default: " FP3_FIXED_INTEGRATOR
     ", with --tolerance " FP3_ADAPTIVE_INTEGRATOR ")",
     FP3_TEXT(options, def.integrator)},
    {"tolerance", 0, "TOL", "Each object chooses its own steps, each with an error of about TOL",
     FP3_CALL(take_tolerance)},
    {"until", 0, "TIME",
     "The time at which objects end (default: the model's span). Without --tolerance: fixed steps, "
     "cut at "
     "events",
     FP3_CALL(take_until)},
    {"config", 'c', "NAME",
     "The configuration to schedule for (default single_full, world where objects see each other)",
     FP3_TEXT(options, def.compile.config)},
    {"compensated", 'k', NULL, "Carry rounding errors of updates to the next step (Kahan)",
     FP3_CALL(take_compensated)},
    {"double-single", 0, NULL, "States and all arithmetic as sums of two floats, 48 bits",
     FP3_CALL(take_double_single)},
    {"observe", 0, "STATE", "Keep this state; may be repeated (default: all)",
     FP3_CALL(take_observe), .is_repeated = 1},
    {"with", 0, "PASS", "Turn this pass on, which changes bits; may be repeated",
     FP3_CALL(take_with), .is_repeated = 1},
    {"without", 0, "PASS", "Turn this pass off (all: all passes); may be repeated",
     FP3_CALL(take_without), .is_repeated = 1},
    {"output", 'o', "FILE", "Write the assembly (default: standard output)",
     FP3_TEXT(options, assembly)},
    {"native", 0, NULL,
     "Write native code of engine fast instead of assembly, for fp3 run --native on machines "
     "without a compiler",
     FP3_FLAG(options, is_native)},
    {"image", 0, "FILE", "Write the image (*.fp3)", FP3_TEXT(options, image)},
    {"params", 0, "FILE",
     "Write the program's values for fp3 run --params; values computed from h and params as "
     "formulas",
     FP3_TEXT(options, values)},
    {"set", 's', "NAME=VALUE", "A param, a state's start or h, for --params; may be repeated",
     FP3_CALL(take_set), .is_repeated = 1},
    {"report", 0, NULL,
     "Print the cost of a step and the savings of each pass, instead of assembly",
     FP3_CALL(take_report)},
    {"list", 0, NULL, "List integrators and passes", FP3_CALL(take_list)},
    {0},
};

static const char *saved_what(fp3_pass pass) {
    return pass == FP3_PASS_AHEAD   ? "cycles"
           : pass == FP3_PASS_CHAIN ? "instructions"
           : pass == FP3_PASS_SCALE ? "products"
           : pass == FP3_PASS_SHARE ? "registers"
                                    : "operations";
}

static void report(const fp3_compiled *c, const fp3_config *config) {
    fp3_neighbourhood around = {0};
    fp3_neighbourhood_find(c->image, &around, NULL);
    printf("operations              %" PRIu32 "\n", c->operations);
    printf("instructions            %" PRIu32 "\n", c->instructions);
    if (around.is_any)
        fp3_phases_print(c->image, &around, config);
    else if (c->cycles > 0)
        printf("cycles per object-step  %.6g\n", c->cycles);
    else
        printf("cycles per object-step  not known beforehand: schedulers share units\n");
    if (!around.is_any)
        printf("bound                   %.6g (issue and units %.6g, longest path %.6g)\n", c->bound,
               c->bound_issue, c->bound_path);
    printf("object registers        %" PRIu32 "\n", c->registers);
    printf("shared constants        %" PRIu32 "\n", c->constants);
    printf("executed ahead, copies  %" PRIu32 ", %" PRIu32 "\n", c->ahead, c->copies);
    if (c->spills)
        printf("loads and stores        %" PRIu32
               ", of values that do not fit into the registers\n",
               c->spills);
    printf("order                   %u\n", c->order);
    for (int i = 0; i < FP3_PASS_COUNT; i++)
        if (c->passes & FP3_PASS(i))
            printf("pass %-14s     saves %" PRIu32 " %s\n", fp3_pass_name((fp3_pass)i), c->saved[i],
                   saved_what((fp3_pass)i));
}

static fp3_status write_values(const options *o, const fp3_program *program, fp3_error *error) {
    char *text = NULL;
    fp3_status status = fp3_program_values_text(program, o->params, &text, error);
    if (!status)
        status = fp3_file_write(o->values, text, strlen(text), error);
    free(text);
    return status;
}

/* Nothing is executed, so the program need not be compiled twice. */
static fp3_status write_native(const options *o, const fp3_program *program, fp3_error *error) {
    fp3_engine *engine = NULL;
    fp3_engine_def def = fp3_engine_default();
    def.engine = "fast";
    def.config = program->config;
    def.objects = 1;
    def.is_interpreted = 1;
    def.error = error;
    fp3_status status = fp3_engine_open(&def, &engine);
    if (!status)
        status = fp3_engine_load(engine, program->image);
    if (!status)
        status = fp3_engine_write_native(engine, o->assembly);
    fp3_engine_close(&engine);
    return status;
}

static fp3_status write_outputs(const options *o, const fp3_program *program, fp3_error *error) {
    const fp3_compiled *c = program->compiled;
    fp3_status status = FP3_OK;
    if (o->values)
        status = write_values(o, program, error);
    if (!status && o->image)
        status = fp3_image_save(c->image, o->image, error);
    if (!status && o->is_native)
        status = write_native(o, program, error);
    else if (!status && o->assembly)
        status = fp3_file_write(o->assembly, c->assembly, strlen(c->assembly), error);
    if (!status && o->wants_report)
        report(c, fp3_config_find(program->config));
    else if (!status && !o->assembly && !o->image && !o->values)
        fputs(c->assembly, stdout);
    return status;
}

static fp3_status check_files(const options *o, fp3_error *error) {
    fp3_files files = {0};
    fp3_files_read(&files, "MODEL", o->model);
    fp3_files_read(&files, "--integrator", fp3_cli_integrator_file(o->def.integrator));
    fp3_files_write(&files, "--output", o->assembly);
    fp3_files_write(&files, "--image", o->image);
    fp3_files_write(&files, "--params", o->values);
    return fp3_files_check(&files, error);
}

int fp3_cmd_compile(int argc, char **argv) {
    static const fp3_command command = {
        .options = table,
        FP3_WORD(options, model, "model"),
        .end = end,
        .forms = "MODEL",
        .doc = "Compiles the equations of MODEL (*.ode) and an integrator to a program for a "
               "configuration. Prints the assembly, or writes the files named by options.",
    };
    fp3_error error;
    options o = {.def = fp3_program_default()};
    if (fp3_params_make(&o.params, &error))
        return fp3_cli_fail("compile", FP3_E_SYSTEM, &error);
    fp3_arguments_parse(&command, argc, argv, &o);

    fp3_program *program = NULL;
    char *text = NULL;
    fp3_status status = check_files(&o, &error);
    fp3_progress *progress = status ? NULL : fp3_progress_begin("compile", o.model);
    fp3_progress_say(progress, "looking for an order of instructions");
    if (!status)
        status = fp3_run_adaptive_maxstep(&o.def, o.params, &error);
    if (!status)
        status = fp3_program_open(o.model, &o.def, &program, &text, &error);
    fp3_progress_end(&progress);
    if (!status)
        fp3_cli_warn("compile", o.model, program->compiled->warning);
    if (!status)
        status = write_outputs(&o, program, &error);
    const int exit_code = fp3_cli_end("compile", status, &error, text);
    free(text);
    fp3_program_close(&program);
    fp3_params_free(&o.params);
    return exit_code;
}
