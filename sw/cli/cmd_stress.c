/* SPDX-License-Identifier: Apache-2.0 */
/* cmd_stress.c - fp3 stress: what FP32 does to integrators and models, each figure beside what it
 * should be. */
#include "arguments.h"
#include "bench_scene.h"
#include "cli.h"
#include "files.h"
#include "json.h"
#include "lab/stress/suite.h"
#include "progress.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define INTEGRATORS_MAX 64
#define MODELS_MAX 48
#define ARITHMETICS_MAX 64

typedef struct {
    const char *integrators[INTEGRATORS_MAX + 1];
    unsigned integrator_count;
    const char *arithmetics[ARITHMETICS_MAX + 1];
    unsigned arithmetic_count;
    const char *models[MODELS_MAX];
    unsigned model_count;
    const char *json, *section;
    int is_quick, is_model, shows_all;
    fp3_progress *progress;
} options;

static int is_scene(const options *o, const char *path) {
    return !o->is_model && fp3_bench_is_scene(path);
}

/* ---- what is printed and written ---- */

static void print(const options *o, const fp3_verdicts *verdicts) {
    for (size_t i = 0; i < verdicts->count; i++) {
        const fp3_verdict *v = &verdicts->list[i];
        if (v->holds && !o->shows_all && strcmp(v->section, "scene") != 0)
            continue;
        printf("%s %s: %s%s%s%s%s: %s: measured %.7g, expected %s %.7g", v->holds ? "ok  " : "FAIL",
               v->section, v->model, *v->integrator ? ", " : "", v->integrator,
               *v->arithmetic ? ", " : "", v->arithmetic, v->name, v->measured,
               fp3_relation_name(v->relation), v->expected);
        if (v->tolerance > 0)
            printf(", tolerance %.2g", v->tolerance);
        printf(v->holds ? "\n" : "\n     why: %s\n", v->why);
    }
    printf("%zu results, %zu do not hold\n", verdicts->count, fp3_verdicts_failed(verdicts));
}

/* JSON has neither NaN nor infinities. */
static json_t *column(const double *values, size_t count) {
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(array, fp3_json_number(values[i]));
    return array;
}

static json_t *row(const fp3_verdict *v) {
    return json_pack("{ss ss ss ss ss ss so so so sb ss}", "section", v->section, "name", v->name,
                     "model", v->model, "integrator", v->integrator, "arithmetic", v->arithmetic,
                     "relation", fp3_relation_name(v->relation), "expected",
                     fp3_json_number(v->expected), "measured", fp3_json_number(v->measured),
                     "tolerance", fp3_json_number(v->tolerance), "holds", v->holds, "why", v->why);
}

static fp3_status write_json(const char *path, const fp3_verdicts *verdicts, fp3_error *error) {
    json_t *results = json_array(), *curves = json_array();
    for (size_t i = 0; i < verdicts->count; i++)
        json_array_append_new(results, row(&verdicts->list[i]));
    for (size_t i = 0; i < verdicts->curve_count; i++) {
        const fp3_curve *c = &verdicts->curves[i];
        json_array_append_new(curves,
                              json_pack("{ss ss so so}", "figure", c->figure, "series", c->series,
                                        "x", column(c->x, c->count), "y", column(c->y, c->count)));
    }
    json_t *all = json_pack("{so so}", "results", results, "curves", curves);
    return fp3_json_write(path, all, 17, error);
}

/* ---- the work ---- */

static void say(void *user, const char *section, const char *what) {
    fp3_progress_say(user, "%s, %s", section, what);
}

static fp3_status check_files_of(const options *o, const fp3_scene *scene, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < scene->group_count; i++) {
        fp3_files files = {0};
        fp3_files_read_group(&files, &scene->groups[i]);
        fp3_files_write(&files, "--json", o->json);
        status = fp3_files_check(&files, error);
    }
    return status;
}

static fp3_status stress_scene(const options *o, const fp3_stress_options *how, const char *path,
                               fp3_verdicts *verdicts, fp3_error *error) {
    fp3_scene *scene = NULL;
    fp3_status status = fp3_scene_open(path, NULL, &scene, error);
    if (!status)
        status = check_files_of(o, scene, error);
    if (!status)
        status = fp3_stress_scene(how, scene, verdicts, error);
    fp3_scene_close(&scene);
    return status;
}

static fp3_status stress_file(const options *o, const fp3_stress_options *how, const char *path,
                              fp3_verdicts *verdicts, char **report, fp3_error *error) {
    static const char *const usual[] = {"rk4", NULL};
    const char *const *names = o->integrator_count ? how->integrators : usual;
    fp3_model *model = NULL;
    if (is_scene(o, path))
        return stress_scene(o, how, path, verdicts, error);
    fp3_status status = fp3_model_load(path, &model, report, error);
    if (!status)
        status = fp3_model_check_alone(model, error);
    for (unsigned i = 0; !status && names[i]; i++)
        status = fp3_stress_model(how, model, names[i], verdicts, error);
    fp3_model_free(&model);
    return status;
}

static fp3_status stress(const options *o, fp3_verdicts *verdicts, char **report,
                         fp3_error *error) {
    const fp3_stress_options how = {.is_quick = o->is_quick,
                                    .integrators = o->integrator_count ? o->integrators : NULL,
                                    .arithmetics = o->arithmetic_count ? o->arithmetics : NULL,
                                    .section = o->section,
                                    .say = say,
                                    .say_user = o->progress};
    fp3_status status = FP3_OK;
    if (!o->model_count)
        return fp3_stress_suite(&how, verdicts, error);
    for (unsigned i = 0; !status && i < o->model_count; i++)
        status = stress_file(o, &how, o->models[i], verdicts, report, error);
    return status;
}

/* ---- the command ---- */

static void take_word(void *user, struct argp_state *state, char *text) {
    options *o = user;
    if (o->model_count == MODELS_MAX)
        argp_error(state, "found more than %d models", MODELS_MAX);
    else
        o->models[o->model_count++] = text;
}

static void end(void *user, struct argp_state *state) {
    options *o = user;
    for (unsigned i = 0; i < o->model_count; i++)
        if (!is_scene(o, o->models[i]))
            fp3_arguments_model(state, o->models[i], o->is_model);
        else if (o->integrator_count)
            argp_error(state, "found --integrator with '%s': a scene names its own", o->models[i]);
    if ((o->section || o->arithmetic_count) && o->model_count)
        argp_error(state,
                   "found --%s with a model: the option is for the suite without a "
                   "model",
                   o->section ? "only" : "arithmetic");
}

static const fp3_option table[] = {
    {"model", 0, NULL, "MODEL is a model, whatever its name", FP3_FLAG(options, is_model)},
    {"integrator", 'i', "NAME",
     "A built-in table, or a file; may be repeated (default: rk4 for models, else all built-in "
     "tables)",
     FP3_LIST(options, integrators, integrator_count, INTEGRATORS_MAX), .is_repeated = 1},
    {"json", 0, "FILE", "Also write results and curves as JSON", FP3_TEXT(options, json)},
    {"quick", 0, NULL, "Fewer steps and angles and, without a MODEL, three integrators",
     FP3_FLAG(options, is_quick)},
    {"all", 0, NULL, "Also print figures that hold", FP3_FLAG(options, shows_all)},
    {"only", 0, "SECTION", "Without a MODEL: this section alone", FP3_TEXT(options, section)},
    {"arithmetic", 0, "NAME",
     "Without a MODEL: plain, compensated, double_single, or a configuration with another "
     "arithmetic; may be repeated (default: all)",
     FP3_LIST(options, arithmetics, arithmetic_count, ARITHMETICS_MAX), .is_repeated = 1},
    {0},
};

static fp3_status check_files(const options *o, fp3_error *error) {
    fp3_files files = {0};
    for (unsigned i = 0; i < o->model_count; i++)
        fp3_files_read(&files, "MODEL", o->models[i]);
    for (unsigned i = 0; i < o->integrator_count; i++)
        fp3_files_read(&files, "--integrator", fp3_cli_integrator_file(o->integrators[i]));
    fp3_files_write(&files, "--json", o->json);
    return fp3_files_check(&files, error);
}

int fp3_cmd_stress(int argc, char **argv) {
    static const fp3_command command = {
        .options = table,
        .take = take_word,
        .end = end,
        .forms = "[MODEL|SCENE...]",
        .doc = "Measures what FP32 does to integrators and models, and compares each figure with "
               "theory or a publication. With MODEL (*.ode), measures its "
               "invariants, its error at each step size, whether it returns when time runs "
               "backwards, and where it fails when parameters are spread over decades. With "
               "SCENE (a path that ends in .scene), runs it on engine fast, and measures how near "
               "the limits of its integrators the fastest springs and dampers of objects that see "
               "each other come; it prints these figures in each case. Without a file, runs the "
               "suite of docs/stress.md. Prints each figure that does not hold, "
               "and why; then the exit code is 3. All results are written in each case."};
    options o = {0};
    fp3_arguments_parse(&command, argc, argv, &o);
    fp3_error error;
    fp3_verdicts verdicts = {0};
    char *report = NULL;
    fp3_status status = check_files(&o, &error);
    if (!status) {
        o.progress = fp3_progress_begin("stress", NULL);
        status = stress(&o, &verdicts, &report, &error);
        fp3_progress_end(&o.progress);
    }
    if (!status)
        print(&o, &verdicts);
    if (!status && o.json)
        status = write_json(o.json, &verdicts, &error);
    if (!status && fp3_verdicts_failed(&verdicts))
        status = fp3_fail(&error, FP3_E_FAILED, "%zu of %zu results do not hold",
                          fp3_verdicts_failed(&verdicts), verdicts.count);
    const int exit_code = fp3_cli_end("stress", status, &error, report);
    free(report);
    fp3_verdicts_free(&verdicts);
    return exit_code;
}
