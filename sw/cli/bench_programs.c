/* SPDX-License-Identifier: Apache-2.0 */
/* bench_programs.c - see bench_programs.h. The pairs of program and configuration, scenes of many
 * objects, the tables, the JSON; lab/golden/bench.h runs one.
 */
#include "bench_programs.h"

#include "bench_table.h"
#include "cli.h"
#include "engine/board/hardware.h"
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

#define SHIP_MODEL "programs/ship.ode" /* truth of the programs by hand */
#define STEPS_LEAST 20 /* after the first, where the steps are shared by many objects */

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

static fp3_status open_program(const fp3_bench_programs *o, const char *path, const char *config,
                               results *to, fp3_program **program, fp3_error *error) {
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
static uint64_t steps_for(const fp3_bench_programs *o, const fp3_config *config) {
    const uint64_t objects =
        (uint64_t)config->contexts * config->lanes * fp3_config_schedulers(config);
    const uint64_t least = o->steps < STEPS_LEAST ? o->steps : STEPS_LEAST;
    return o->steps / objects > least ? o->steps / objects : least;
}

/* What only a ship needs beside itself. */
static fp3_status load_ship(results *to, fp3_error *error) {
    fp3_status status = FP3_OK;
    if (!to->params && !(status = fp3_params_make(&to->params, error)))
        status = fp3_params_load(to->params, FP3_BENCH_SHIP_PARAMS, error);
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
static fp3_status bench_pair(const fp3_bench_programs *o, const fp3_program *program,
                             fp3_bench_outcome *x, results *to, int *is_unfit, fp3_error *error) {
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
    *is_unfit |= status == FP3_E_ARGUMENT && x->config->storage; /* its records lack the numbers */
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

static fp3_status bench_config(const fp3_bench_programs *o, const char *path, const char *name,
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
static fp3_status bench_program(const fp3_bench_programs *o, const char *path, results *to,
                                fp3_error *error) {
    char name[64];
    const char *base = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    fp3_status status = FP3_OK;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(base, "."), base);
    for (uint32_t i = 0; i < fp3_config_count && !status; i++) {
        const fp3_config *config = &fp3_configs[i];
        int is_unfit = 0;
        if (o->config ? strcmp(o->config, config->name) != 0
                      : !config->take && !fp3_hardware_is_there(config->name))
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

static fp3_status bench_scene(const fp3_bench_programs *o, const scene *s, double *reference,
                              results *to, fp3_error *error) {
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

static fp3_status bench_scenes(const fp3_bench_programs *o, results *to, fp3_error *error) {
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
static fp3_status check_config(const fp3_bench_programs *o, fp3_error *error) {
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

static fp3_status bench_ships(const fp3_bench_programs *o, results *to, fp3_error *error) {
    glob_t paths = {0};
    fp3_status status = FP3_OK;
    if (glob(FP3_BENCH_SHIPS, 0, NULL, &paths))
        status = fp3_fail(error, FP3_E_ARGUMENT, "no program " FP3_BENCH_SHIPS);
    for (size_t i = 0; i < paths.gl_pathc && !status; i++)
        status = bench_program(o, paths.gl_pathv[i], to, error);
    globfree(&paths);
    return status;
}

static fp3_status bench_programs(const fp3_bench_programs *o, const char *path, results *to,
                                 fp3_error *error) {
    const fp3_status status =
        o->program ? bench_program(o, path, to, error) : bench_ships(o, to, error);
    if (status || json_array_size(to->runs) > 0)
        return status;
    return fp3_fail(error, FP3_E_ARGUMENT, "no configuration asked for can execute %s",
                    o->program ? path : FP3_BENCH_SHIPS);
}

static fp3_status check_files(const fp3_bench_programs *o, const char *program, fp3_error *error) {
    fp3_files files = {0};
    fp3_files_read(&files, "--program", program);
    fp3_files_read(&files, "--params", o->params);
    fp3_files_write(&files, "--json", o->json);
    if (o->program && !strcmp(o->program, "-"))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--program: found '-', expected a file: each configuration reads it again");
    return fp3_files_check(&files, error);
}

fp3_status fp3_bench_programs_run(const fp3_bench_programs *o, char **report, fp3_error *error) {
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
