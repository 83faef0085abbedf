/* cmd_bench.c - fp3 bench: programs on the hardware, the ship unless another is named. The pairs of
 * program and configuration, scenes of many objects, the tables, the JSON; golden/bench.h runs one.
 * Models go to bench_models.h.
 */
#include "arguments.h"
#include "bench_models.h"
#include "bench_table.h"
#include "cli.h"
#include "files.h"
#include "json.h"
#include "machine/config.h"
#include "progress.h"

#include <glob.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define PROGRAMS "programs/ship*.s"
#define SHIP_PARAMS "programs/ship.cfg"
#define SHIP_MODEL "programs/ship.ode" /* truth of the programs by hand */
#define STEPS_LEAST 20 /* after the first, where the steps are shared by many objects */

typedef struct {
    const char *config, *program, *params, *json;
    uint64_t steps;         /* after the first, of one object; many share them */
    uint64_t scene_objects; /* 0: no scenes */
    int is_model;
    fp3_bench_models models;                 /* error against run time; the others are not for it */
    const char *not_for_models, *for_models; /* the last option of each, by its long name */
} options;

/* ---- the table of runs ---- */

typedef struct {
    json_t *runs, *scenes;
    fp3_params *params; /* those that are asked for, or the ship's: NULL until they are needed */
    fp3_params *none;   /* a model has its own */
    fp3_model *ship;    /* SHIP_MODEL, likewise */
    char **report;      /* errors of a source */
    fp3_progress *progress;
    int is_headed;                         /* the table has its head */
    fp3_error mismatch, failure, no_truth; /* the first of all, each */
} results;

static fp3_status open_program(const options *o, const char *path, const char *config, results *to,
                               fp3_program **program, fp3_error *error) {
    fp3_program_def def = fp3_program_default();
    def.compile.config = config;
    def.is_model = o->is_model;
    free(*to->report);
    return fp3_program_open(path, &def, program, to->report, error);
}

static void note_first(fp3_error *first, const fp3_bench_outcome *o, const char *why) {
    if (why[0] && !first->text[0])
        fp3_fail(first, FP3_E_FAILED, "%s, %s: %s", o->program, o->what.config, why);
}

static void note_all(const fp3_bench_outcome *o, results *to) {
    note_first(&to->mismatch, o, o->got.mismatch.text);
    note_first(&to->failure, o, o->got.failure);
    note_first(&to->no_truth, o, o->got.no_truth.text);
}

/* What the figures themselves say, once all of them are there. */
static fp3_status judge(const results *to, fp3_error *error) {
    if (to->mismatch.text[0])
        return fp3_fail(error, FP3_E_MISMATCH, "%s", to->mismatch.text);
    if (to->failure.text[0])
        return fp3_fail(error, FP3_E_FAILED, "%s", to->failure.text);
    if (to->no_truth.text[0])
        return fp3_fail(error, FP3_E_FAILED, "no truth: %s", to->no_truth.text);
    return FP3_OK;
}

/* After the first, so many as make the object-steps that one object is asked for. */
static uint64_t steps_for(const options *o, const fp3_config *config) {
    const uint64_t objects =
        (uint64_t)config->contexts * config->lanes * fp3_config_schedulers(config);
    const uint64_t least = o->steps < STEPS_LEAST ? o->steps : STEPS_LEAST;
    return o->steps / objects > least ? o->steps / objects : least;
}

/* What only a ship needs beside itself. */
static fp3_status load_ship(results *to, fp3_error *error) {
    fp3_status status = FP3_OK;
    if (!to->params && !(status = fp3_params_make(&to->params, error)))
        status = fp3_params_load(to->params, SHIP_PARAMS, error);
    if (!status && !to->ship)
        status = fp3_model_load(SHIP_MODEL, &to->ship, to->report, error);
    return status;
}

/* Values and truth of a program. */
static fp3_status fill_case(const fp3_program *program, results *to, fp3_bench_outcome *x,
                            fp3_error *error) {
    const int is_ship = fp3_bench_is_ship(program);
    const fp3_status status = is_ship ? load_ship(to, error) : FP3_OK;
    x->what.program = program;
    x->what.params = to->params ? to->params : to->none;
    x->what.truth = is_ship ? to->ship : program->model;
    return status;
}

/* One pair. *is_unfit: it is left out, and error says why. */
static fp3_status bench_pair(const options *o, const fp3_program *program, fp3_bench_outcome *x,
                             results *to, int *is_unfit, fp3_error *error) {
    fp3_status status = fill_case(program, to, x, error);
    if (status)
        return status;
    if (!to->is_headed)
        fp3_bench_head(o->steps, program, x->program);
    to->is_headed = 1;
    fflush(stdout);
    fp3_progress_resume(to->progress);
    status = fp3_bench_run(&x->what, &x->got, is_unfit, error);
    fp3_progress_pause(to->progress);
    if (status && !*is_unfit) {
        const fp3_error why = *error;
        return fp3_fail(error, status, "%s, %s: %s", x->program, x->config->name, why.text);
    }
    if (status)
        return status;
    fp3_bench_row(x);
    if (x->got.no_truth.text[0])
        printf("%s, %s: no truth, so no error: %s\n", x->program, x->config->name,
               x->got.no_truth.text);
    json_array_append_new(to->runs, fp3_bench_json(x));
    note_all(x, to);
    return FP3_OK;
}

static fp3_status bench_config(const options *o, const char *path, const char *name,
                               const fp3_config *config, results *to, int *is_unfit,
                               fp3_error *error) {
    fp3_program *program = NULL;
    fp3_bench_outcome x = {.config = config, .program = name};
    x.what =
        (fp3_bench_case){.config = config->name, .awake_of = 1, .steps = steps_for(o, config) + 1};
    fp3_progress_say(to->progress, "%s, %s", name, config->name);
    fp3_progress_resume(to->progress);
    fp3_status status = open_program(o, path, config->name, to, &program, error);
    fp3_progress_pause(to->progress);
    /* A model that does not fit is refused by the compiler. */
    *is_unfit = status == FP3_E_PROGRAM && (o->is_model || fp3_program_is_model(path));
    if (!status)
        status = bench_pair(o, program, &x, to, is_unfit, error);
    fp3_program_close(&program);
    return status;
}

/* All configurations that are asked for. A pair that was asked for by name must be possible. */
static fp3_status bench_program(const options *o, const char *path, results *to, fp3_error *error) {
    char name[64];
    const char *base = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    fp3_status status = FP3_OK;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(base, "."), base);
    for (uint32_t i = 0; i < fp3_config_count && !status; i++) {
        const fp3_config *config = &fp3_configs[i];
        int is_unfit = 0;
        if (o->config && strcmp(o->config, config->name) != 0)
            continue;
        status = bench_config(o, path, name, config, to, &is_unfit, error);
        if (is_unfit && !(o->config && o->program)) {
            printf("%s, %s: left out: %s\n", name, config->name, error->text);
            free(*to->report);
            *to->report = NULL;
            status = FP3_OK;
        }
    }
    return status;
}

/* ---- scenes of many objects ---- */

/* Its cycles per object-step are told as a ratio to those of the reference before it. */
typedef struct {
    const char *name, *program;
    int is_resident; /* as many objects as contexts; else as many as are asked for */
    uint32_t visit, awake_of;
    uint64_t steps;
    int is_reference;
} scene;

#define SCENES "crowd" /* the configuration: a store for all of them */
#define SCENE_OBJECTS 10000
#define SCENE_OBJECTS_MOST 1000000 /* the store says what it has room for */
static const scene scenes[] = {
    {"resident", "ship_madd", 1, 0, 1, 64, 1},
    {"16 steps per visit", "ship_madd", 0, 16, 1, 64, 0},
    {"1 step per visit", "ship_madd", 0, 1, 1, 4, 0},
    {"all awake", "ship_sleep", 0, 16, 1, 16, 1},
    {"10 % awake", "ship_sleep", 0, 16, 10, 16, 0},
    {"1 % awake", "ship_sleep", 0, 16, 100, 16, 0},
};

static void tell_scene(const scene *s, const fp3_bench_outcome *o, double per, double ratio,
                       results *to) {
    const uint64_t cycles = o->got.all.counter[FP3_COUNTER_CYCLES];
    printf("%-20s %-12s %7" PRIu64 " %7" PRIu64 " %6" PRIu64 " %6" PRIu32 " %10" PRIu64
           " %8.3f %7.3f",
           s->name, s->program, o->got.objects, o->got.awake, o->what.steps, s->visit, cycles, per,
           ratio);
    printf("  mismatches %" PRIu64 " of %" PRIu64 " words\n", o->got.mismatches, o->got.words);
    fflush(stdout);
    json_t *object = fp3_bench_common_json(o);
    json_object_set_new(object, "scene", json_string(s->name));
    json_object_set_new(object, "awake", json_integer((json_int_t)o->got.awake));
    json_object_set_new(object, "visit", json_integer((json_int_t)s->visit));
    json_object_set_new(object, "cycles", json_integer((json_int_t)cycles));
    json_object_set_new(object, "cycles_per_object_step", json_real(per));
    json_object_set_new(object, "ratio", json_real(ratio));
    json_array_append_new(to->scenes, object);
    note_all(o, to);
}

static fp3_status bench_scene(const options *o, const scene *s, double *reference, results *to,
                              fp3_error *error) {
    char path[64];
    int is_unfit;
    fp3_program *program = NULL;
    fp3_bench_outcome x = {.config = fp3_config_find(SCENES), .program = s->program};
    x.what = (fp3_bench_case){.config = SCENES,
                              .objects = s->is_resident ? 0 : (uint32_t)o->scene_objects,
                              .visit = s->visit,
                              .awake_of = s->awake_of,
                              .steps = s->steps};
    snprintf(path, sizeof path, "programs/%s.s", s->program);
    fp3_status status = open_program(o, path, SCENES, to, &program, error);
    if (!status)
        status = fill_case(program, to, &x, error);
    fp3_progress_say(to->progress, "scene '%s'", s->name);
    fp3_progress_resume(to->progress);
    if (!status)
        status = fp3_bench_run(&x.what, &x.got, &is_unfit, error);
    fp3_progress_pause(to->progress);
    if (!status) {
        const double per =
            (double)x.got.all.counter[FP3_COUNTER_CYCLES] / (double)x.got.all.object_steps;
        *reference = s->is_reference ? per : *reference;
        tell_scene(s, &x, per, per / *reference, to);
    } else {
        const fp3_error why = *error;
        fp3_fail(error, status, "scene '%s': %s", s->name, why.text);
    }
    fp3_program_close(&program);
    return status;
}

static fp3_status bench_scenes(const options *o, results *to, fp3_error *error) {
    double reference = 0;
    fp3_status status = FP3_OK;
    printf("\nScenes on " SCENES ": ships from the object store.\n\n%-20s %-12s %7s %7s %6s %6s "
           "%10s %8s %7s\n",
           "scene", "program", "objects", "awake", "steps", "visit", "cycles", "/object", "ratio");
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes && !status; i++)
        status = bench_scene(o, &scenes[i], &reference, to, error);
    return status;
}

/* ---- all of it ---- */

/* Says so, and which there are, if there is no such configuration. */
static fp3_status check_config(const options *o, fp3_error *error) {
    fp3_engine *probe = NULL;
    fp3_engine_def def = fp3_engine_default();
    def.error = error;
    def.config = o->config ? o->config : def.config;
    fp3_status status = fp3_engine_open(&def, &probe);
    fp3_engine_close(&probe);
    return status;
}

/* Asked for by a path, or by a name in programs/: assembly, else a model. */
static fp3_status find_program(const char *program, char *path, size_t size, fp3_error *error) {
    static const char *const endings[] = {"s", "ode"};
    struct stat found;
    snprintf(path, size, "%s", program);
    if (strchr(program, '/') || fp3_program_is_named(program) || !strcmp(program, "-"))
        return FP3_OK;
    for (int i = 0; i < 2; i++) {
        snprintf(path, size, "programs/%s.%s", program, endings[i]);
        if (stat(path, &found) == 0)
            return FP3_OK;
    }
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "--program: no program programs/%s.s or programs/%s.ode; a path has a / or an "
                    "ending",
                    program, program);
}

static fp3_status bench_ships(const options *o, results *to, fp3_error *error) {
    glob_t paths = {0};
    fp3_status status = FP3_OK;
    if (glob(PROGRAMS, 0, NULL, &paths))
        status = fp3_fail(error, FP3_E_ARGUMENT, "no program " PROGRAMS);
    for (size_t i = 0; i < paths.gl_pathc && !status; i++)
        status = bench_program(o, paths.gl_pathv[i], to, error);
    globfree(&paths);
    return status;
}

static fp3_status bench_programs(const options *o, const char *path, results *to,
                                 fp3_error *error) {
    const fp3_status status =
        o->program ? bench_program(o, path, to, error) : bench_ships(o, to, error);
    if (status || json_array_size(to->runs) > 0)
        return status;
    return fp3_fail(error, FP3_E_ARGUMENT, "no configuration asked for can execute %s",
                    o->program ? path : PROGRAMS);
}

static fp3_status check_files(const options *o, const char *program, fp3_error *error) {
    fp3_files files = {0};
    fp3_files_read(&files, "--program", program);
    fp3_files_read(&files, "--params", o->params);
    fp3_files_write(&files, "--json", o->json);
    if (o->program && !strcmp(o->program, "-"))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--program: found '-', expected a file: each configuration reads it again");
    return fp3_files_check(&files, error);
}

static fp3_status bench(const options *o, char **report, fp3_error *error) {
    results to = {.runs = json_array(), .scenes = json_array(), .report = report};
    char path[4096] = "";
    fp3_status status = o->program ? find_program(o->program, path, sizeof path, error) : FP3_OK;
    if (!status)
        status = check_files(o, o->program ? path : NULL, error);
    if (!status)
        status = check_config(o, error);
    if (!status)
        status = fp3_params_make(&to.none, error);
    if (!status && o->params && !(status = fp3_params_make(&to.params, error)))
        status = fp3_params_load(to.params, o->params, error);
    to.progress = status ? NULL : fp3_progress_begin("bench", NULL);
    fp3_progress_pause(to.progress); /* tables are printed in between */
    if (!status)
        status = bench_programs(o, path, &to, error);
    if (!status && o->scene_objects)
        status = bench_scenes(o, &to, error);
    fp3_progress_end(&to.progress);
    if (!status && o->json)
        status = fp3_json_write(
            o->json, json_pack("{s:O, s:O}", "runs", to.runs, "scenes", to.scenes), 17, error);
    if (!status)
        status = judge(&to, error);
    json_decref(to.runs);
    json_decref(to.scenes);
    fp3_model_free(&to.ship);
    fp3_params_free(&to.params);
    fp3_params_free(&to.none);
    return status;
}

enum { KEY_MODEL = 256, KEY_QUICK, KEY_CSV, KEY_PLOT, KEY_HTML };

static const struct argp_option table[] = {
    {"config", 'c', "NAME", 0, "Run on this configuration (default: on all)", 0},
    {"program", 'p', "NAME", 0,
     "A program of programs/ by its name, or a path (default: " PROGRAMS ")", 0},
    {"model", KEY_MODEL, NULL, 0, "The program is a model, whatever its name", 0},
    {"steps", 'n', "N", 0,
     "Run N steps after the first, of one object or in total (default: 10000)", 0},
    {"params", 'P', "FILE", 0,
     "Read values from FILE (default: " SHIP_PARAMS " for a ship, else those of the model)", 0},
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
     "With MODEL: measure fewer tolerances and objects, three times each", 0},
    {0},
};

static void add_name(struct argp_state *state, const char *what, const char *text,
                     const char **names, unsigned *count) {
    if (*count == FP3_BENCH_NAMES_MOST)
        argp_error(state, "found more than %d %s", FP3_BENCH_NAMES_MOST, what);
    names[(*count)++] = text;
}

/* Options of one form are refused with the other. */
static void check_form(struct argp_state *state, const options *o) {
    if (o->models.model_count && o->not_for_models)
        argp_error(
            state,
            "found --%s and '%s': with MODEL there are --integrator, --quick, --json, --csv, "
            "--plot and --html",
            o->not_for_models, o->models.models[0]);
    if (!o->models.model_count && o->for_models)
        argp_error(state, "found --%s, expected MODEL", o->for_models);
}

/* The long name of an option, if it is one of these. */
static const char *name_among(int key, const int *keys) {
    for (; *keys; keys++)
        for (const struct argp_option *at = table; *keys == key && at->name; at++)
            if (at->key == key)
                return at->name;
    return NULL;
}

static error_t parse(int key, char *text, struct argp_state *state) {
    options *o = state->input;
    static const int programs[] = {'c', 'p', 'P', 'n', KEY_MODEL, 's', 0};
    static const int models[] = {'i', KEY_CSV, KEY_PLOT, KEY_HTML, KEY_QUICK, 0};
    if (name_among(key, programs))
        o->not_for_models = name_among(key, programs);
    if (name_among(key, models))
        o->for_models = name_among(key, models);
    switch (key) {
    case 'c':
        o->config = text;
        break;
    case 'p':
        o->program = text;
        break;
    case 'P':
        o->params = text;
        break;
    case 'j':
        o->json = o->models.json = text;
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
        o->models.is_quick = 1;
        break;
    case 'n':
        o->steps = fp3_arguments_number(state, "--steps", text, 1, 10000000);
        break;
    case KEY_MODEL:
        o->is_model = 1;
        break;
    case 's':
        o->scene_objects =
            text ? fp3_arguments_number(state, "--scenes", text, 100, SCENE_OBJECTS_MOST)
                 : SCENE_OBJECTS;
        break;
    case ARGP_KEY_ARG:
        if (fp3_program_is_named(text) && !fp3_program_is_model(text))
            argp_error(state, "found '%s', expected a model (*.ode)", text);
        add_name(state, "models", text, o->models.models, &o->models.model_count);
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
    options o = {.steps = 10000, .models = {.argc = argc, .argv = argv}};
    const struct argp argp = {
        .options = table,
        .parser = parse,
        .args_doc = "[MODEL...]",
        .doc =
            "With MODEL (the name of a file in programs/, or a path), measures error against "
            "run time: for each integrator, arithmetic and time step (or tolerance), the "
            "nanoseconds of engine fast with one thread and with all threads, and the cycles of "
            "the hardware. A plain C loop and the solvers of GSL run beside it. The printed "
            "table has the best points; --json and --csv have all. It takes one or two minutes for "
            "each model, needs a C compiler, and wants an idle machine.\v"
            "Without MODEL, runs the ship (or --program) on the hardware under Verilator, "
            "counts its cycles, compares every write of a state bit for bit with the golden "
            "model or the isa engine, and measures the error against the truth. The exit code "
            "is 1 if any bits differ, and 3 if objects failed or there is no truth; the figures "
            "are printed in each case."};
    fp3_arguments_parse(&argp, argc, argv, &o);
    fp3_error error = {.text = ""};
    char *report = NULL;
    const fp3_status status = o.models.model_count
                                  ? fp3_bench_models_run(&o.models, &report, &error)
                                  : bench(&o, &report, &error);
    const int exit_code = fp3_cli_end("bench", status, &error, report);
    free(report);
    return exit_code;
}
