/* SPDX-License-Identifier: Apache-2.0 */
/* recast.c - see recast.h. */
#include "recast.h"

#include "world/kinds_steps.h"
#include "world/values.h"

#include <math.h>
#include <stdlib.h>

#define SHORT_RUN 1e6   /* object-steps: making native code takes longer */
#define SHORT_TIMED 1e5 /* of the scene as it is: likewise, and nobody would do so */
#define TURNS 9
#define TIME_MOST 6.0 /* seconds; then two turns have to do */

/* ---- programs ---- */

static fp3_status compile(fp3_recast *c, const fp3_scene_group *group, fp3_program *program,
                          const fp3_compile_def *how, fp3_error *error) {
    fp3_compiled *made = NULL;
    *program = *group->program;
    program->compiled = NULL;
    if (!fp3_kinds_never_move(program->model))
        program->integrator = c->integrator;
    const fp3_status status = fp3_compile(program->model, program->integrator, how, &made, error);
    program->compiled = made;
    program->image = made ? made->image : NULL;
    return status;
}

fp3_status fp3_recast_compile(fp3_recast *c, const fp3_scene *scene, fp3_error *error) {
    fp3_program_def def = fp3_program_default();
    fp3_joined *list = calloc(scene->group_count + 1, sizeof *list);
    c->programs = calloc(scene->group_count + 1, sizeof *c->programs);
    fp3_status status = list && c->programs ? FP3_OK : fp3_no_memory(error);
    def.compile.config = scene->config;
    def.compile.arithmetic = c->arithmetic;
    def.compile.is_for_host = 1;
    for (size_t i = 0; !status && i < scene->group_count; i++) {
        status = compile(c, &scene->groups[i], &c->programs[i], &def.compile, error);
        list[i] = (fp3_joined){scene->groups[i].name, &c->programs[i], &def};
        c->count = i + 1;
    }
    if (!status && c->count > 1)
        status = fp3_programs_join(list, c->count, error);
    free(list);
    return status;
}

fp3_status fp3_recast_take(fp3_recast *c, const fp3_scene *scene, fp3_error *error) {
    c->programs = calloc(scene->group_count + 1, sizeof *c->programs);
    c->is_own = 1;
    if (!c->programs)
        return fp3_no_memory(error);
    for (; c->count < scene->group_count; c->count++)
        c->programs[c->count] = *scene->groups[c->count].program;
    return FP3_OK;
}

int fp3_recast_has_near(const fp3_model *model) {
    int has = 0;
    for (uint32_t r = 0; r < model->relation_count; r++)
        has |= model->relations[r].kind == FP3_NEAR;
    return has;
}

const fp3_program *fp3_recast_first(const fp3_scene *scene) {
    size_t i = 0;
    while (i + 1 < scene->group_count && fp3_kinds_never_move(scene->groups[i].program->model))
        i++;
    return scene->groups[i].program;
}

int fp3_recast_scene_has_near(const fp3_scene *scene) {
    int has = 0;
    for (size_t i = 0; i < scene->group_count; i++)
        has |= fp3_recast_has_near(scene->groups[i].program->model);
    return has;
}

void fp3_recast_free(fp3_recast *c) {
    for (size_t i = 0; !c->is_own && i < c->count; i++)
        fp3_compiled_free(&c->programs[i].compiled);
    free(c->programs);
    fp3_integrator_free(&c->integrator);
    *c = (fp3_recast){.programs = NULL};
}

/* ---- runs ---- */

fp3_status fp3_recast_begin(const fp3_recast_steps *steps, const fp3_scene *scene,
                            uint64_t of_steps, int is_timed, fp3_recast_run *run,
                            fp3_error *error) {
    *run = (fp3_recast_run){.engine = NULL};
    fp3_status status = fp3_scaled_open(scene, steps->parts, steps->joined, &run->scaled, error);
    if (status)
        return status;
    for (size_t i = 0; i < scene->group_count; i++) {
        run->scaled.groups[i].program = &steps->choice->programs[i];
        if (steps->skin >= 0)
            fp3_values_skin(run->scaled.groups[i].params, steps->skin);
    }
    fp3_engine_def def = fp3_scene_engine(&run->scaled.scene);
    def.engine = "fast";
    def.error = error;
    def.threads = is_timed;
    const double as_is = (double)scene->objects * (double)of_steps;
    /* All whose times are compared, or none. */
    def.is_interpreted = is_timed && as_is < SHORT_TIMED;
    def.is_without_compiler =
        !is_timed && as_is * (double)steps->parts / (double)steps->joined < SHORT_RUN;
    status = fp3_engine_open(&def, &run->engine);
    return status ? status : fp3_scene_load(&run->scaled.scene, run->engine, error);
}

void fp3_recast_end(fp3_recast_run *run) {
    fp3_engine_close(&run->engine);
    fp3_scaled_close(&run->scaled);
}

/* ---- time ---- */

static fp3_status turn(fp3_recast_run *run, uint64_t steps, double *seconds, fp3_error *error) {
    fp3_stats stats = {.seconds = 0};
    fp3_status status = fp3_scene_load(&run->scaled.scene, run->engine, error);
    if (!status)
        status = fp3_adaptive_run(run->engine, steps, &stats);
    *seconds = stats.seconds;
    return status;
}

/* The first turn makes native code, and does not count. */
static fp3_status take_turns(const fp3_scene_tune_def *def, const fp3_recast_steps *list,
                             size_t count, fp3_recast_run *runs, uint64_t of_steps, double *ns,
                             fp3_error *error) {
    double all = 0;
    fp3_status status = FP3_OK;
    for (int n = 0; n <= TURNS && (n < 3 || all < TIME_MOST); n++)
        for (size_t i = 0; !status && i < count; i++) {
            double seconds;
            if (def->stop && def->stop(def->user))
                return FP3_OK;
            status = turn(&runs[i], of_steps / list[i].joined * list[i].parts, &seconds, error);
            all += seconds;
            if (n && (ns[i] == 0 || seconds < ns[i]))
                ns[i] = seconds;
        }
    return status;
}

fp3_status fp3_recast_time(const fp3_scene_tune_def *def, const fp3_recast_steps *list,
                           size_t count, const fp3_scene *scene, uint64_t of_steps, double *ns,
                           fp3_error *error) {
    fp3_recast_run *runs = calloc(count + 1, sizeof *runs);
    fp3_status status = runs ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; i < count; i++)
        ns[i] = 0;
    for (size_t i = 0; !status && i < count; i++)
        status = fp3_recast_begin(&list[i], scene, of_steps, 1, &runs[i], error);
    if (!status)
        status = take_turns(def, list, count, runs, of_steps, ns, error);
    for (size_t i = 0; i < count; i++) {
        ns[i] *= 1e9 / (double)scene->objects;
        if (runs)
            fp3_recast_end(&runs[i]);
    }
    free(runs);
    return status;
}
