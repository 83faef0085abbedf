/* SPDX-License-Identifier: Apache-2.0 */
/* cmd_tune.c - fp3 tune: the cheapest integrator, step or tolerance of steps, and arithmetic for an
 * error. */
#include "arguments.h"
#include "cli.h"
#include "files.h"
#include "progress.h"
#include "run_values.h"
#include "tune_machines.h"
#include "tune_print.h"
#include "tune_scene.h"

#include <fp3/model.h>
#include <fp3/program.h>
#include <fp3/scene.h>
#include <fp3/tune.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "lab/tune/trim.h"
#include "machine/config.h"

typedef struct {
    const char *input, *config;
    int is_model, is_scene, has_hardware;
    const char *arithmetics[FP3_TUNE_MACHINES_MOST];
    unsigned arithmetic_count;
    double around;
    uint32_t objects, held_out;
    fp3_tune_scene scene; /* of objects that see each other */
    const char *cost;
    fp3_run_values values;
    fp3_files files;
    fp3_tune_def def;
    fp3_tune_print out;
    fp3_progress *progress;
} options;

static int ends_in_scene(const char *path) {
    const size_t size = strlen(path);
    return size > 6 && strcasecmp(path + size - 6, ".scene") == 0;
}

static void check(options *o, struct argp_state *state) {
    if (!o->input)
        argp_error(state, "expected a model (*.ode) or a scene (*.scene)");
    if (!(o->def.tolerance > 0))
        argp_error(state, "expected --tolerance");
    o->is_scene = !o->is_model && ends_in_scene(o->input);
    if (!o->is_scene)
        fp3_arguments_model(state, o->input, o->is_model);
    if (o->is_scene && (fp3_params_count(o->values.params) || o->objects))
        argp_error(state, "values, ranges and objects are in the scene, not in --params, --set, "
                          "--spread or --objects");
    if (!o->is_scene && (o->cost || o->scene.def.within > 0 || o->scene.def.work > 0))
        argp_error(state, "--cost, --within and --work are of a scene whose objects see each "
                          "other; a model is tuned for cycles");
    if (o->held_out)
        o->def.held_out = o->held_out;
}

static void take_spread(void *user, struct argp_state *state, char *text) {
    options *o = user;
    fp3_run_values_spread(&o->values, state, text);
}

static void take_set(void *user, struct argp_state *state, char *text) {
    options *o = user;
    if (!strncmp(text, "maxstep=", 8))
        o->def.maxstep = fp3_arguments_above_zero(state, "--set maxstep", text + 8);
    else
        fp3_run_values_set(&o->values, state, text);
}

static void take_params(void *user, struct argp_state *state, char *text) {
    options *o = user;
    fp3_files_read(&o->files, "--params", text);
    fp3_run_values_load(&o->values, state, text);
}

static void end(void *user, struct argp_state *state) {
    options *o = user;
    check(o, state);
}

static const fp3_option table[] = {
    {"tolerance", 0, "TOL",
     "The largest error of any state, relative to the largest magnitude of that state; from 1e-7 "
     "to below 1",
     FP3_ABOVE_ZERO(options, def.tolerance)},
    {"config", 'c', "NAME",
     "Configuration whose cycles are the cost (default: that of the scene, or many_full)",
     FP3_TEXT(options, config)},
    {"arithmetic", 0, "NAME",
     "Also tune for this configuration with another arithmetic, and choose the configuration of "
     "the least cost: LUTs times the time of an object; may be repeated. all: each such "
     "configuration whose LUTs and clock are known",
     FP3_LIST(options, arithmetics, arithmetic_count, FP3_TUNE_MACHINES_MOST), .is_repeated = 1},
    {"model", 0, NULL, "The input is a model, whatever its name", FP3_FLAG(options, is_model)},
    {"spread", 0, "NAME=FIRST:LAST",
     "A range: any value from FIRST to LAST, of a model; may be repeated", FP3_CALL(take_spread),
     .is_repeated = 1},
    {"around", 0, "SHARE",
     "Of a model: a range of this share to both sides for each start and each param of an object "
     "that "
     "is not 0 and has no other value. Of a scene whose objects see each other: how far starts "
     "that "
     "are not random differ in other scenes, as a share of the state's size (default: 0.001)",
     FP3_ABOVE_ZERO(options, around)},
    {"set", 's', "NAME=VALUE", "Of a model: a value; may be repeated", FP3_CALL(take_set),
     .is_repeated = 1},
    {"params", 0, "FILE", "Of a model: a file of values; may be repeated", FP3_CALL(take_params),
     .is_repeated = 1},
    {"span", 0, "TIME",
     "The time to integrate (default: steps times h of the scene, its `until`, or the model's "
     "span)",
     FP3_ABOVE_ZERO(options, def.span)},
    {"objects", 'N', "N",
     "Of a model: number of objects in the scene (default: the contexts of the configuration; "
     "without ranges 1)",
     FP3_NUMBER(options, objects, 1, UINT32_MAX)},
    {"held-out", 0, "N",
     "Number of new objects that judge the choice (default: 64), or of scenes whose objects see "
     "each other (default: 4)",
     FP3_NUMBER(options, held_out, 1, 65536)},
    {"cost", 0, "COST",
     "Of a scene whose objects see each other: cycles, predicted (default), or time, measured on "
     "engine fast with one thread",
     FP3_TEXT(options, cost)},
    {"within", 0, "SHARE",
     "Of such a scene: the solution is known where two lengths of step agree within this (default: "
     "1e-6)",
     FP3_ABOVE_ZERO(options, scene.def.within)},
    {"work", 0, "N", "Of such a scene: how many numbers each solution may compute (default: 1e10)",
     FP3_ABOVE_ZERO(options, scene.def.work)},
    {"output", 'o', "FILE", "Write the choice as a scene, which fp3 run --scene runs",
     FP3_TEXT(options, out.scene)},
    {"json", 0, "FILE", "Also write the choice and all candidates as JSON",
     FP3_TEXT(options, out.json)},
    {"hardware", 0, NULL,
     "Also print the configuration reduced to what the program needs, and its LUTs if known",
     FP3_FLAG(options, has_hardware)},
    {0},
};

/* ---- what is tuned ---- */

static fp3_status spread_around(fp3_params *params, const fp3_quantity *q, double share,
                                fp3_error *error) {
    char text[FP3_NAME_SIZE + 64];
    if (q->is_shared || q->value == 0 || fp3_params_has(params, q->name))
        return FP3_OK;
    snprintf(text, sizeof text, "%s=%.17g:%.17g", q->name, q->value * (1 - share),
             q->value * (1 + share));
    return fp3_params_spread(params, text, error);
}

static fp3_status add_ranges(const options *o, const fp3_model *model, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; o->around > 0 && !status && i < model->param_count; i++)
        status = spread_around(o->values.params, &model->params[i], o->around, error);
    for (uint32_t i = 0; o->around > 0 && !status && i < model->state_count; i++)
        status = spread_around(o->values.params, &model->states[i], o->around, error);
    return status;
}

static void say(void *user, const char *what) { fp3_progress_say(user, "%s", what); }

/* What was found for the best configuration. */
static fp3_status tell(options *o, const fp3_tune_machines *machines, fp3_error *error) {
    const fp3_tuning *tuning = machines->list[machines->best].tuning;
    char *hardware = NULL;
    fp3_status status = FP3_OK;
    fp3_tune_print_all(&o->out, &o->def, tuning);
    fp3_tune_machines_print(machines);
    if (o->has_hardware && tuning->best < tuning->row_count)
        status = fp3_tuning_hardware(&o->def, tuning, o->objects, &hardware, error);
    if (hardware)
        fputs(hardware, stdout);
    free(hardware);
    if (!status)
        status = fp3_tune_print_files(&o->out, &o->def, tuning, o->objects, error);
    return status ? status : fp3_tune_print_judge(&o->def, tuning, error);
}

static fp3_status tune(options *o, fp3_error *error) {
    fp3_tune_machines machines;
    o->def.say = say;
    o->def.user = o->progress;
    o->out.machines = &machines;
    fp3_status status = fp3_tune_machines_find(&machines, o->def.config, o->arithmetics,
                                               o->arithmetic_count, error);
    if (!status)
        status = fp3_tune_machines_tune(&machines, &o->def, error);
    fp3_progress_end(&o->progress);
    if (!status)
        status = tell(o, &machines, error);
    fp3_tune_machines_free(&machines);
    return status;
}

/* A model that has the name itself means its own: it has no adaptive steps. */
static fp3_status own_maxstep(options *o, const fp3_model *model, fp3_error *error) {
    const double value = o->def.maxstep;
    if (value == 0 || (fp3_model_param(model, "maxstep") == FP3_NONE &&
                       fp3_model_state(model, "maxstep") == FP3_NONE))
        return FP3_OK;
    o->def.maxstep = 0;
    return fp3_params_put(o->values.params, "maxstep", value, error);
}

static fp3_status tune_model(options *o, char **report, fp3_error *error) {
    fp3_program_def how = fp3_program_default();
    fp3_program *program = NULL;
    const fp3_config *config;
    how.is_model = 1;
    how.compile.config = o->def.config = o->config ? o->config : "many_full";
    fp3_status status = fp3_config_choose(o->def.config, &config, error);
    if (!status)
        status = fp3_program_open(o->input, &how, &program, report, error);
    if (!status)
        status = own_maxstep(o, program->model, error);
    if (!status)
        status = add_ranges(o, program->model, error);
    if (!status) {
        if (!o->objects)
            o->objects = o->around > 0 || fp3_tune_print_has_ranges(o->values.params)
                             ? config->contexts * config->lanes
                             : 1;
        o->out.program = o->input;
        o->def.program = program;
        o->def.params = o->values.params;
        status = tune(o, error);
    }
    fp3_program_close(&program);
    return status;
}

static fp3_status check_scene(const options *o, const fp3_scene *scene, fp3_error *error) {
    const fp3_scene_group *group = &scene->groups[0];
    fp3_files files = {0};
    if (scene->group_count != 1)
        return fp3_fail_at(error, FP3_E_ARGUMENT, scene->path, (unsigned)scene->line, 0,
                           "found %zu groups, expected one", scene->group_count);
    if (!group->program->model)
        return fp3_fail_at(error, FP3_E_ARGUMENT, scene->path, (unsigned)group->line, 0,
                           "'%s' is no model (*.ode): no other program has integrators",
                           group->path);
    if (group->born.last || group->gone.first != FP3_FOREVER)
        return fp3_fail_at(error, FP3_E_ARGUMENT, scene->path, (unsigned)group->line, 0,
                           "found lifetimes, which are steps: expected objects that live all the "
                           "time");
    fp3_files_read(&files, "scene", o->input);
    fp3_files_read_group(&files, group);
    fp3_files_write(&files, "--output", o->out.scene);
    fp3_files_write(&files, "--json", o->out.json);
    return fp3_files_check(&files, error);
}

/* Of adaptive steps; 0: there is none. */
static double scene_maxstep(const fp3_scene *scene) {
    const fp3_model *model = scene->groups[0].program->model;
    const uint32_t param =
        fp3_model_adapted(model) == FP3_NONE ? FP3_NONE : fp3_model_param(model, "maxstep");
    return param == FP3_NONE ? 0 : model->params[param].value;
}

static fp3_status scene_span(const fp3_scene *scene, double *span, fp3_error *error) {
    const fp3_scene_group *group = &scene->groups[0];
    const fp3_model *model = group->program->model;
    double h = model->step;
    fp3_status status = FP3_OK;
    if (*span != 0)
        return FP3_OK;
    if (fp3_model_adapted(model) != FP3_NONE)
        *span = model->params[fp3_model_param(model, "until")].value;
    else {
        if (fp3_params_has(group->params, FP3_NAME_STEP))
            status = fp3_params_get(group->params, FP3_NAME_STEP, &h, error);
        *span = (double)(float)h * (double)scene->steps;
    }
    return status;
}

/* The tuner adapts the model itself: values of what adaptive steps add to it are refused as unknown
 * names. */
static fp3_status open_fixed(const fp3_scene *scene, fp3_program **program, fp3_error *error) {
    fp3_program_def how = fp3_program_default();
    how.is_model = 1;
    how.compile.config = scene->config;
    return fp3_model_adapted(scene->groups[0].program->model) == FP3_NONE
               ? FP3_OK
               : fp3_program_open(scene->groups[0].path, &how, program, NULL, error);
}

static int sees_others(const fp3_scene *scene) {
    int sees = 0;
    for (size_t i = 0; i < scene->group_count; i++)
        sees |= scene->groups[i].program->sees_others;
    return sees;
}

static fp3_status tune_world(options *o, fp3_error *error) {
    fp3_tune_scene *w = &o->scene;
    fp3_scene_tune_def def = fp3_scene_tune_default();
    def.path = o->input;
    def.config = o->config;
    def.tolerance = o->def.tolerance;
    def.within = w->def.within > 0 ? w->def.within : def.within;
    def.work = w->def.work > 0 ? w->def.work : def.work;
    def.around = o->around > 0 ? o->around : def.around;
    def.held_out = o->held_out ? o->held_out : def.held_out;
    if (o->arithmetic_count || o->has_hardware)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "%s: objects see each other: expected no --arithmetic and no --hardware",
                        o->input);
    if (o->cost && strcmp(o->cost, "time") != 0 && strcmp(o->cost, "cycles") != 0)
        return fp3_fail(error, FP3_E_ARGUMENT, "--cost: found '%s', expected cycles or time",
                        o->cost);
    if (o->cost && strcmp(o->cost, "time") == 0)
        def.cost = FP3_SCENE_COST_TIME;
    *w = (fp3_tune_scene){.def = def,
                          .span = o->def.span,
                          .output = o->out.scene,
                          .json = o->out.json,
                          .progress = o->progress};
    o->progress = NULL;
    return fp3_tune_scene_run(w, error);
}

static fp3_status tune_scene(options *o, fp3_error *error) {
    fp3_scene *scene = NULL;
    fp3_program *fixed = NULL;
    fp3_status status = fp3_scene_open(o->input, o->config, &scene, error);
    const int is_world = !status && sees_others(scene);
    if (is_world) {
        fp3_scene_close(&scene);
        return tune_world(o, error);
    }
    if (!status && (o->around > 0 || o->cost || o->scene.def.within > 0 || o->scene.def.work > 0))
        status = fp3_fail(error, FP3_E_ARGUMENT,
                          "%s: --around, --cost, --within and --work are of a scene whose objects "
                          "see each other",
                          o->input);
    if (!status)
        status = check_scene(o, scene, error);
    if (!status)
        status = scene_span(scene, &o->def.span, error);
    if (!status)
        status = open_fixed(scene, &fixed, error);
    if (!status) {
        o->objects = (uint32_t)scene->objects;
        o->def.maxstep = scene_maxstep(scene);
        o->out.program = scene->groups[0].path;
        o->def.config = scene->config;
        o->def.program = fixed ? fixed : scene->groups[0].program;
        o->def.params = scene->groups[0].params;
        status = tune(o, error);
    }
    fp3_program_close(&fixed);
    fp3_scene_close(&scene);
    return status;
}

int fp3_cmd_tune(int argc, char **argv) {
    static const fp3_command command = {
        .options = table,
        FP3_WORD(options, input, "model or scene"),
        .end = end,
        .forms = "MODEL\nSCENE",
        .doc =
            "Finds the cheapest integrator, step (or tolerance of adaptive steps) and arithmetic "
            "that meet a tolerance over ranges of parameters, by measuring a sample of objects "
            "against truth, and judges the choice by new objects. Costs are predicted cycles of "
            "an object over the span; for adaptive steps by the mean number of attempts of the "
            "sample. Exit code 3 if nothing meets the tolerance, or there is no truth."};
    options o = {.def = fp3_tune_default()};
    fp3_error error = {.text = ""};
    char *report = NULL;
    fp3_status status = fp3_params_make(&o.values.params, &error);
    if (status)
        return fp3_cli_fail("tune", status, &error);
    fp3_arguments_parse(&command, argc, argv, &o);
    fp3_files_read(&o.files, "INPUT", o.input);
    fp3_files_write(&o.files, "--output", o.out.scene);
    fp3_files_write(&o.files, "--json", o.out.json);
    status = fp3_files_check(&o.files, &error);
    if (!status) {
        o.progress = fp3_progress_begin("tune", o.input);
        status = o.is_scene ? tune_scene(&o, &error) : tune_model(&o, &report, &error);
        fp3_progress_end(&o.progress);
    }
    const int exit_code = fp3_cli_end("tune", status, &error, report);
    free(report);
    fp3_run_values_free(&o.values);
    return exit_code;
}
