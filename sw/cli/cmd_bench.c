/* SPDX-License-Identifier: Apache-2.0 */
/* cmd_bench.c - fp3 bench: programs on the hardware, models, or a scene; each has a file of its
 * own. */
#include "arguments.h"
#include "bench_models.h"
#include "bench_programs.h"
#include "bench_scene.h"
#include "cli.h"

#include <fp3/program.h>
#include <stdlib.h>
#include <string.h>

#define SCENE_OBJECTS 10000
#define SCENE_OBJECTS_MOST 1000000 /* the store says what it has room for */

enum { FORMS = 3 };

typedef struct {
    fp3_bench_programs programs;
    fp3_bench_models models;
    fp3_bench_scene scene;
    const char *not_for[FORMS]; /* the last option that a form does not have, by its long name */
} options;

static void add_name(struct argp_state *state, const char *what, const char *text,
                     const char **names, unsigned *count) {
    if (*count == FP3_BENCH_NAMES_MOST)
        argp_error(state, "found more than %d %s", FP3_BENCH_NAMES_MOST, what);
    names[(*count)++] = text;
}

/* ---- the forms, and which options each has ---- */

typedef enum { OF_PROGRAMS = 1, OF_MODELS = 2, OF_SCENE = 4 } form;

/* An option that only some forms have. */
static void note_option(void *user, const fp3_option *option) {
    options *o = user;
    for (unsigned k = 0; option->forms && k < FORMS; k++)
        if (!(option->forms & 1u << k))
            o->not_for[k] = option->name;
}

/* Options of one form are refused with another. */
static void check_form(struct argp_state *state, const options *o) {
    const char *const model = o->models.model_count ? o->models.models[0] : NULL;
    if (o->scene.path && model)
        argp_error(state, "found '%s' and '%s', expected one scene, or models", o->scene.path,
                   model);
    if (o->scene.path && o->not_for[2])
        argp_error(
            state,
            "found --%s and '%s': with SCENE there are --config, --steps, --quick and --json",
            o->not_for[2], o->scene.path);
    if (model && o->not_for[1])
        argp_error(state,
                   "found --%s and '%s': with MODEL there are --config, --integrator, --quick, "
                   "--no-times, --json and --csv",
                   o->not_for[1], model);
    if (model && o->models.has_no_times && !o->models.config)
        argp_error(state, "found --no-times, expected --config with it");
    if (!o->scene.path && !model && o->not_for[0])
        argp_error(state, "found --%s, expected MODEL%s", o->not_for[0],
                   strcmp(o->not_for[0], "quick") == 0 ? " or SCENE" : "");
}

static void take_argument(struct argp_state *state, char *text, options *o) {
    if (fp3_bench_is_scene(text)) {
        if (o->scene.path)
            argp_error(state, "found '%s' and '%s', expected one scene", o->scene.path, text);
        o->scene.path = text;
        return;
    }
    if (fp3_program_is_named(text) && !fp3_program_is_model(text))
        argp_error(state, "found '%s', expected a model (*.ode) or a scene (*.scene)", text);
    add_name(state, "models", text, o->models.models, &o->models.model_count);
}

static void take_config(void *user, struct argp_state *state, char *text) {
    options *o = user;
    (void)state;
    o->programs.config = o->models.config = o->scene.config = text;
}

static void take_steps(void *user, struct argp_state *state, char *text) {
    options *o = user;
    o->programs.steps = o->scene.steps = fp3_arguments_number(state, "--steps", text, 1, 10000000);
}

static void take_scenes(void *user, struct argp_state *state, char *text) {
    options *o = user;
    o->programs.scene_objects =
        text ? fp3_arguments_number(state, "--scenes", text, 100, SCENE_OBJECTS_MOST)
             : SCENE_OBJECTS;
}

static void take_json(void *user, struct argp_state *state, char *text) {
    options *o = user;
    (void)state;
    o->programs.json = o->models.json = o->scene.json = text;
}

static void take_integrator(void *user, struct argp_state *state, char *text) {
    options *o = user;
    add_name(state, "integrators", text, o->models.integrators, &o->models.integrator_count);
}

static void take_quick(void *user, struct argp_state *state, char *text) {
    options *o = user;
    (void)state;
    (void)text;
    o->models.is_quick = o->scene.is_quick = 1;
}

static void take_word(void *user, struct argp_state *state, char *text) {
    options *o = user;
    take_argument(state, text, o);
}

static void end(void *user, struct argp_state *state) {
    options *o = user;
    check_form(state, o);
}

static const fp3_option table[] = {
    {"config", 'c', "NAME",
     "Run on this configuration (default: on all; with SCENE: the scene's). With MODEL: measure "
     "this configuration alone",
     FP3_CALL(take_config), .forms = OF_PROGRAMS | OF_MODELS | OF_SCENE},
    {"program", 'p', "NAME",
     "A program of programs/ by its name, or a path (default: " FP3_BENCH_SHIPS ")",
     FP3_TEXT(options, programs.program), .forms = OF_PROGRAMS},
    {"model", 0, NULL, "The program is a model, whatever its name",
     FP3_FLAG(options, programs.is_model), .forms = OF_PROGRAMS},
    {"steps", 'n', "N",
     "Run N steps after the first, of one object or in total (default: 10000); with SCENE: the "
     "first N (default: those of a fifth of a second, or all)",
     FP3_CALL(take_steps), .forms = OF_PROGRAMS | OF_SCENE},
    {"params", 'P', "FILE",
     "Read values from FILE (default: " FP3_BENCH_SHIP_PARAMS " for a ship, else the model's)",
     FP3_TEXT(options, programs.params), .forms = OF_PROGRAMS},
    {"scenes", 0, "N", "Also run scenes of N objects (default: 10000)", FP3_CALL(take_scenes),
     .is_optional = 1, .forms = OF_PROGRAMS},
    {"json", 'j', "FILE", "Also write the figures as JSON", FP3_CALL(take_json)},
    {"integrator", 'i', "NAME",
     "With MODEL: measure this integrator; may be repeated (default: all built-in tables)",
     FP3_CALL(take_integrator), .is_repeated = 1, .forms = OF_MODELS},
    {"csv", 0, "FILE", "With MODEL: also write all points as CSV, a row for each",
     FP3_TEXT(options, models.csv), .forms = OF_MODELS},
    {"quick", 0, NULL,
     "With MODEL: measure fewer tolerances and objects, three times each; with SCENE: once",
     FP3_CALL(take_quick), .forms = OF_MODELS | OF_SCENE},
    {"no-times", 0, NULL, "With MODEL and --config: measure errors and cycles, and no nanoseconds",
     FP3_FLAG(options, models.has_no_times), .forms = OF_MODELS},
    {0},
};

int fp3_cmd_bench(int argc, char **argv) {
    options o = {.programs = {.steps = 10000}};
    const fp3_command command = {
        .options = table,
        .given = note_option,
        .take = take_word,
        .end = end,
        .forms = "[MODEL...]\nSCENE",
        .doc =
            "With MODEL (the name of a file in programs/, or a path), measures error against "
            "run time: for each integrator, arithmetic and time step (or tolerance), the "
            "nanoseconds of engine fast with one thread and with all threads, and the cycles of "
            "the hardware. A plain C loop and the solvers of GSL run beside it. The printed "
            "table has the best points; --json and --csv have all. A model takes one or two "
            "minutes, a C compiler and an idle machine.\v"
            "With SCENE (a path that ends in .scene), measures what a step of an object takes by "
            "engine fast, with one "
            "thread and with all. The states must be the same bits, also by engine isa.\n\n"
            "Without MODEL or SCENE, runs the ship (or --program) on the hardware under Verilator, "
            "counts its cycles, compares every write of a state bit for bit with the golden "
            "model or the isa engine, and measures the error against the truth. The exit code "
            "is 1 if any bits differ, and 3 if objects failed or there is no truth; the figures "
            "are printed in each case."};
    fp3_arguments_parse(&command, argc, argv, &o);
    fp3_error error = {.text = ""};
    char *report = NULL;
    const fp3_status status = o.scene.path ? fp3_bench_scene_run(&o.scene, &error)
                              : o.models.model_count
                                  ? fp3_bench_models_run(&o.models, &report, &error)
                                  : fp3_bench_programs_run(&o.programs, &report, &error);
    const int exit_code = fp3_cli_end("bench", status, &error, report);
    free(report);
    return exit_code;
}
