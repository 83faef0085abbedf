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

enum {
    KEY_WITH = 256,
    KEY_WITHOUT,
    KEY_REPORT,
    KEY_IMAGE,
    KEY_PARAMS,
    KEY_LIST,
    KEY_OBSERVE,
    KEY_MODEL,
    KEY_DOUBLE,
    KEY_TOLERANCE,
    KEY_UNTIL,
    KEY_NATIVE
};

static const struct argp_option table[] = {
    {"model", KEY_MODEL, NULL, 0, "MODEL is a model, whatever its name", 0},
    {"integrator", 'i', "NAME", 0,
     "A built-in table, or a file (default: " FP3_FIXED_INTEGRATOR
     ", with --tolerance " FP3_ADAPTIVE_INTEGRATOR ")",
     0},
    {"tolerance", KEY_TOLERANCE, "TOL", 0,
     "Each object chooses its own steps, each with an error of about TOL", 0},
    {"until", KEY_UNTIL, "TIME", 0,
     "Where objects end (default: the model's span). Without --tolerance: fixed steps, cut at "
     "events",
     0},
    {"config", 'c', "NAME", 0,
     "The configuration to schedule for (default single_full, world where objects see each other)",
     0},
    {"compensated", 'k', NULL, 0, "Carry rounding errors of updates to the next step (Kahan)", 0},
    {"double-single", KEY_DOUBLE, NULL, 0,
     "States and all arithmetic as sums of two floats, 48 bits", 0},
    {"observe", KEY_OBSERVE, "STATE", 0, "Keep this state; may be repeated (default: all)", 0},
    {"with", KEY_WITH, "PASS", 0, "Also a pass that changes bits; may be repeated", 0},
    {"without", KEY_WITHOUT, "PASS", 0, "Not this pass; `all`: none; may be repeated", 0},
    {"output", 'o', "FILE", 0, "Write the assembly (default: standard output)", 0},
    {"native", KEY_NATIVE, NULL, 0,
     "Write native code of engine fast instead of assembly, for fp3 run --native on machines "
     "without a compiler",
     0},
    {"image", KEY_IMAGE, "FILE", 0, "Write the image (*.fp3)", 0},
    {"params", KEY_PARAMS, "FILE", 0,
     "Write the program's values for fp3 run --params; values computed from h and params as "
     "formulas",
     0},
    {"set", 's', "NAME=VALUE", 0, "A param, a state's start or h, for --params; may be repeated",
     0},
    {"report", KEY_REPORT, NULL, 0,
     "Print the cost of a step and the savings of each pass, instead of assembly", 0},
    {"list", KEY_LIST, NULL, 0, "List integrators and passes", 0},
    {0},
};

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

static error_t parse(int key, char *text, struct argp_state *state) {
    options *o = state->input;
    fp3_error error;
    switch (key) {
    case 'i':
        o->def.integrator = text;
        break;
    case 'c':
        o->def.compile.config = text;
        break;
    case 'k':
        fp3_arguments_arithmetic(state, &o->def.compile, FP3_COMPENSATED);
        break;
    case KEY_DOUBLE:
        fp3_arguments_arithmetic(state, &o->def.compile, FP3_DOUBLE_SINGLE);
        break;
    case KEY_TOLERANCE:
        fp3_run_adaptive_tolerance(&o->def, state, text);
        break;
    case KEY_UNTIL:
        fp3_run_adaptive_until(&o->def, state, text);
        break;
    case KEY_OBSERVE:
        if (o->def.compile.observed_count == OBSERVED_MAX)
            argp_error(state, "found more than %d states", OBSERVED_MAX);
        o->observed[o->def.compile.observed_count++] = text;
        o->def.compile.observed = o->observed;
        break;
    case KEY_WITH:
    case KEY_WITHOUT:
        turn(state, o, text, key == KEY_WITH);
        break;
    case 'o':
        o->assembly = text;
        break;
    case KEY_IMAGE:
        o->image = text;
        break;
    case KEY_PARAMS:
        o->values = text;
        break;
    case 's':
        if (fp3_params_set(o->params, text, &error))
            argp_failure(state, 2, 0, "%s", error.text);
        break;
    case KEY_REPORT:
        o->wants_report = o->def.compile.finds_savings = 1;
        break;
    case KEY_NATIVE:
        o->is_native = 1;
        break;
    case KEY_LIST:
        exit(list());
    case ARGP_KEY_ARG:
        if (o->model)
            argp_error(state, "found '%s', expected one model", text);
        o->model = text;
        break;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "expected a model (*.ode)");
        break;
    case KEY_MODEL:
        o->def.is_model = 1;
        break;
    case ARGP_KEY_END:
        fp3_arguments_model(state, o->model, o->def.is_model);
        fp3_run_adaptive_check(&o->def, 1, state);
        o->def.is_model = 1;
        if (o->is_native && !o->assembly)
            argp_error(state, "--native: expected --output FILE");
        if (fp3_params_count(o->params) && !o->values)
            argp_error(state, "--set: values are of the host's, and go to --params FILE");
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

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
    static const struct argp argp = {
        .options = table,
        .parser = parse,
        .args_doc = "MODEL",
        .doc = "Compiles the equations of MODEL (*.ode) and an integrator to a program for a "
               "configuration. Prints the assembly, or writes the files named by options.",
    };
    fp3_error error;
    options o = {.def = fp3_program_default()};
    if (fp3_params_make(&o.params, &error))
        return fp3_cli_fail("compile", FP3_E_SYSTEM, &error);
    fp3_arguments_parse(&argp, argc, argv, &o);

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
