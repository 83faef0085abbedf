/* SPDX-License-Identifier: Apache-2.0 */
/* cmd_bench.c - fp3 bench: programs on the hardware, models, or a scene; each has a file of its own. */
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

enum { KEY_MODEL = 256, KEY_QUICK, KEY_CSV, KEY_PLOT, KEY_HTML, KEY_NO_TIMES };

static const struct argp_option table[] = {
    {"config", 'c', "NAME", 0,
     "Run on this configuration (default: on all; with SCENE: the scene's). With MODEL: measure "
     "nothing but this",
     0},
    {"program", 'p', "NAME", 0,
     "A program of programs/ by its name, or a path (default: " FP3_BENCH_SHIPS ")", 0},
    {"model", KEY_MODEL, NULL, 0, "The program is a model, whatever its name", 0},
    {"steps", 'n', "N", 0,
     "Run N steps after the first, of one object or in total (default: 10000); with SCENE: the "
     "first N (default: as many as "
     "take a fifth of a second, or all)",
     0},
    {"params", 'P', "FILE", 0,
     "Read values from FILE (default: " FP3_BENCH_SHIP_PARAMS
     " for a ship, else those of the model)",
     0},
    {"scenes", 's', "N", OPTION_ARG_OPTIONAL, "Also run scenes of N objects (default: 10000)", 0},
    {"json", 'j', "FILE", 0, "Also write the figures as JSON", 0},
    {"integrator", 'i', "NAME", 0,
     "With MODEL: measure this integrator; may be repeated (default: all that are built in)", 0},
    {"csv", KEY_CSV, "FILE", 0, "With MODEL: also write all points as CSV, a row for each", 0},
    {"plot", KEY_PLOT, "FILE", 0,
     "With MODEL: also draw the printed table into FILE (.svg or .png). Needs gnuplot", 0},
    {"html", KEY_HTML, "FILE", 0,
     "With MODEL: also write the printed table and its pictures as a page. Needs gnuplot", 0},
    {"quick", KEY_QUICK, NULL, 0,
     "With MODEL: measure fewer tolerances and objects, three times each; with SCENE: once", 0},
    {"no-times", KEY_NO_TIMES, NULL, 0,
     "With MODEL and --config: measure errors and cycles, and no nanoseconds", 0},
    {0},
};

static void add_name(struct argp_state *state, const char *what, const char *text,
                     const char **names, unsigned *count) {
    if (*count == FP3_BENCH_NAMES_MOST)
        argp_error(state, "found more than %d %s", FP3_BENCH_NAMES_MOST, what);
    names[(*count)++] = text;
}

/* ---- the forms, and which options each has ---- */

typedef enum { OF_PROGRAMS = 1, OF_MODELS = 2, OF_SCENE = 4 } form;

static const struct {
    int key;
    unsigned forms;
} allowed[] = {{'c', OF_PROGRAMS | OF_MODELS | OF_SCENE},
               {'p', OF_PROGRAMS},
               {'P', OF_PROGRAMS},
               {'n', OF_PROGRAMS | OF_SCENE},
               {KEY_MODEL, OF_PROGRAMS},
               {'s', OF_PROGRAMS},
               {'i', OF_MODELS},
               {KEY_CSV, OF_MODELS},
               {KEY_PLOT, OF_MODELS},
               {KEY_HTML, OF_MODELS},
               {KEY_NO_TIMES, OF_MODELS},
               {KEY_QUICK, OF_MODELS | OF_SCENE}};

static const char *name_of(int key) {
    const struct argp_option *at = table;
    while (at->key != key)
        at++;
    return at->name;
}

static void note_option(options *o, int key) {
    for (size_t i = 0; i < sizeof allowed / sizeof *allowed; i++)
        if (allowed[i].key == key)
            for (unsigned k = 0; k < FORMS; k++)
                if (!(allowed[i].forms & 1u << k))
                    o->not_for[k] = name_of(key);
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
                   "--no-times, --json, --csv, --plot and --html",
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

static error_t parse(int key, char *text, struct argp_state *state) {
    options *o = state->input;
    note_option(o, key);
    switch (key) {
    case 'c':
        o->programs.config = o->models.config = o->scene.config = text;
        break;
    case 'p':
        o->programs.program = text;
        break;
    case 'P':
        o->programs.params = text;
        break;
    case 'j':
        o->programs.json = o->models.json = o->scene.json = text;
        break;
    case 'i':
        add_name(state, "integrators", text, o->models.integrators, &o->models.integrator_count);
        break;
    case KEY_CSV:
        o->models.csv = text;
        break;
    case KEY_PLOT:
        o->models.plot = text;
        break;
    case KEY_HTML:
        o->models.html = text;
        break;
    case KEY_QUICK:
        o->models.is_quick = o->scene.is_quick = 1;
        break;
    case KEY_NO_TIMES:
        o->models.has_no_times = 1;
        break;
    case 'n':
        o->programs.steps = o->scene.steps =
            fp3_arguments_number(state, "--steps", text, 1, 10000000);
        break;
    case KEY_MODEL:
        o->programs.is_model = 1;
        break;
    case 's':
        o->programs.scene_objects =
            text ? fp3_arguments_number(state, "--scenes", text, 100, SCENE_OBJECTS_MOST)
                 : SCENE_OBJECTS;
        break;
    case ARGP_KEY_ARG:
        take_argument(state, text, o);
        break;
    case ARGP_KEY_END:
        check_form(state, o);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

int fp3_cmd_bench(int argc, char **argv) {
    options o = {.programs = {.steps = 10000}, .models = {.argc = argc, .argv = argv}};
    const struct argp argp = {
        .options = table,
        .parser = parse,
        .args_doc = "[MODEL...]\nSCENE",
        .doc =
            "With MODEL (the name of a file in programs/, or a path), measures error against "
            "run time: for each integrator, arithmetic and time step (or tolerance), the "
            "nanoseconds of engine fast with one thread and with all threads, and the cycles of "
            "the hardware. A plain C loop and the solvers of GSL run beside it. The printed "
            "table has the best points; --json and --csv have all. It takes one or two minutes for "
            "each model, needs a C compiler, and wants an idle machine.\v"
            "With SCENE (a path that ends in .scene), measures what a step of an object takes by "
            "engine fast, with one "
            "thread and with all. The states must be the same bits, also by engine isa.\n\n"
            "Without MODEL or SCENE, runs the ship (or --program) on the hardware under Verilator, "
            "counts its cycles, compares every write of a state bit for bit with the golden "
            "model or the isa engine, and measures the error against the truth. The exit code "
            "is 1 if any bits differ, and 3 if objects failed or there is no truth; the figures "
            "are printed in each case."};
    fp3_arguments_parse(&argp, argc, argv, &o);
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
