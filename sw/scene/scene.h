/* scene.h - a scene: objects of different kinds, each with a program and values, from a file.
 *
 *     fp3_scene *scene = NULL;
 *     if (fp3_scene_load("fleet.scene", NULL, &scene, &error))
 *         return fp3_fail(...);
 *     def.objects = (uint32_t)scene->objects;
 *     ... fp3_engine_open ...
 *     if (fp3_scene_apply(scene, engine, &error) ...
 *     fp3_scene_free(&scene);
 *
 * docs/scenes.md describes the file.
 */
#ifndef FP3_SCENE_H
#define FP3_SCENE_H

#include "program.h"

typedef struct {
    char *program; /* path */
    char *integrator;
    fp3_program_source source;
    size_t first, objects;
    fp3_params params;
    int line;
} fp3_scene_group;

typedef struct {
    char *path, *config, *engine; /* config, engine: NULL if the file does not say */
    uint64_t steps, visit;        /* 1 and 0 (all) if it does not */
    fp3_scene_group *groups;
    size_t count, objects; /* groups, and objects of all */
} fp3_scene;

/* Programs are compiled, assembled or loaded; config: replaces that of the file unless it is NULL. The caller frees *scene, which is NULL on failure. Messages begin
 * with the path and the line, those about a program with its own path. */
fp3_status fp3_scene_load(const char *path, const char *config, fp3_scene **scene,
                          fp3_error *error);
/* Sets *scene to NULL; that it was NULL before does no harm. */
void fp3_scene_free(fp3_scene **scene);

/* Loads programs and values into an engine for so many objects. */
fp3_status fp3_scene_apply(fp3_scene *scene, fp3_engine *engine, fp3_error *error);

#endif
