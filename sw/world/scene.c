/* SPDX-License-Identifier: Apache-2.0 */
/* scene.c - a scene from its file to an engine. */
#include <fp3/program.h>
#include <fp3/scene.h>

#include "adaptive.h"
#include "apply.h"
#include "base/definition.h"
#include "base/host.h"
#include "engine/common/inside.h"
#include "lifetime.h"
#include "scene_read.h"
#include "split.h"

#include <stdlib.h>
#include <string.h>

fp3_status fp3_scene_open(const char *path, const char *config, fp3_scene **scene,
                          fp3_error *error) {
    return fp3_scene_open_drawn(path, config, 0, scene, error);
}

fp3_status fp3_scene_open_drawn(const char *path, const char *config, uint64_t draw,
                                fp3_scene **scene, fp3_error *error) {
    FP3_HOST;
    fp3_scene *s = *scene = calloc(1, sizeof *s);
    fp3_status status = FP3_OK;
    if (s) {
        s->steps = 1;
        s->path = strdup(path);
    }
    if (!s || !s->path)
        status = fp3_no_memory(error);
    if (!status)
        status = fp3_scene_read(s, config, draw, error);
    if (status)
        fp3_scene_close(scene);
    return status;
}

void fp3_scene_close(fp3_scene **scene) {
    fp3_scene *s = *scene;
    if (!s)
        return;
    for (size_t i = 0; i < s->group_count; i++) {
        free(s->groups[i].name);
        free(s->groups[i].path);
        free(s->groups[i].integrator_file);
        free(s->groups[i].params_file);
        for (size_t k = 0; k < s->groups[i].file_count; k++)
            free(s->groups[i].files[k]);
        free(s->groups[i].files);
        fp3_program_close(&s->groups[i].program);
        fp3_params_free(&s->groups[i].params);
    }
    free(s->groups);
    free(s->path);
    free(s->config);
    free(s->engine);
    free(s);
    *scene = NULL;
}

void fp3_scene_set_engine(const fp3_scene *scene, fp3_engine_def *def) {
    if (fp3_definition_check(def, sizeof *def, "fp3_engine_def", NULL))
        return; /* fp3_engine_open refuses it, and says why */
    def->engine = scene->engine;
    def->config = scene->config;
    def->objects = (uint32_t)scene->objects;
    def->visit = scene->visit;
    def->seed = scene->seed;
}

/* What the programs read of each other's objects. The caller frees each group's `foreign`. */
static fp3_status find_foreign(const fp3_scene *scene, fp3_group *groups, fp3_error *error) {
    fp3_joined *list = calloc(scene->group_count, sizeof *list);
    fp3_status status = list ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; !status && i < scene->group_count; i++)
        list[i] = (fp3_joined){.name = scene->groups[i].name, .program = scene->groups[i].program};
    for (size_t i = 0; !status && i < scene->group_count; i++) {
        fp3_foreign *foreign = NULL;
        status = fp3_program_foreign(list, scene->group_count, i, &foreign,
                                     &groups[i].foreign_count, error);
        groups[i].foreign = foreign;
    }
    free(list);
    return status;
}

static fp3_status load_programs(const fp3_scene *scene, fp3_engine *engine, fp3_error *error) {
    fp3_group *groups = calloc(scene->group_count, sizeof *groups);
    if (!groups)
        return fp3_no_memory(error);
    for (size_t i = 0; i < scene->group_count; i++)
        groups[i] = (fp3_group){.image = scene->groups[i].program->image,
                                .objects = scene->groups[i].objects};
    fp3_status status = find_foreign(scene, groups, error);
    if (!status)
        status = fp3_engine_load_groups(engine, groups, scene->group_count);
    for (size_t i = 0; i < scene->group_count; i++)
        free((fp3_foreign *)(uintptr_t)groups[i].foreign);
    free(groups);
    fp3_error *said = fp3_engine_definition(engine)->error;
    if (status && said) {
        const fp3_error why = *said;
        fp3_fail_at(said, status, scene->path, (unsigned)scene->line, 0, "%s", why.text);
    }
    return status;
}

/* A run is split for the objects of all groups. */
static fp3_status check_split(const fp3_scene *scene, fp3_error *error) {
    const size_t adaptive = fp3_scene_adaptive_count(scene);
    int is_split = adaptive && adaptive < scene->group_count;
    for (size_t i = 0; i < scene->group_count; i++)
        is_split |= fp3_lifetime_is_any(&scene->groups[i]);
    return is_split ? fp3_split_check_scene(scene,
                                            adaptive ? "adaptive steps of another group"
                                                     : "births and ends of objects",
                                            error)
                    : FP3_OK;
}

/* Groups that see each other make their steps together: h holds that of each. */
static fp3_status check_h(const fp3_scene *scene, const fp3_engine *engine, const double *h,
                          fp3_error *error) {
    const fp3_layout *layout = fp3_engine_layout(engine);
    for (uint32_t i = 0; i < layout->count; i++)
        for (uint32_t k = 0; k < layout->groups[i].foreign_count; k++) {
            const size_t other = layout->groups[i].foreign[k].group;
            if ((float)h[i] != (float)h[other] &&
                !fp3_model_chooses_steps(scene->groups[i].program->model))
                return fp3_fail_at(error, FP3_E_ARGUMENT, scene->path,
                                   (unsigned)scene->groups[i].line, 0,
                                   "'h' is %.9g, and %.9g in group '%s': groups that see each "
                                   "other make their steps together, so give the scene one h",
                                   h[i], h[other], scene->groups[other].name);
        }
    return FP3_OK;
}

fp3_status fp3_scene_load(const fp3_scene *scene, fp3_engine *engine, fp3_error *error) {
    FP3_HOST;
    fp3_engine_hush(error);
    double *h = calloc(scene->group_count, sizeof *h);
    fp3_status status = h ? load_programs(scene, engine, error) : fp3_no_memory(error);
    if (!status)
        status = check_split(scene, error);
    for (size_t i = 0; !status && i < scene->group_count; i++) {
        const fp3_scene_group *group = &scene->groups[i];
        const fp3_apply_to to = {.engine = engine,
                                 .group = i,
                                 .first = group->first,
                                 .objects = group->objects,
                                 .h = &h[i]};
        status = fp3_apply(group->program, group->params, &to, error);
        if (!status)
            status = fp3_lifetime_apply(group, engine);
    }
    if (!status)
        status = check_h(scene, engine, h, error);
    free(h);
    return fp3_engine_hear(engine, status, error);
}
