/* SPDX-License-Identifier: Apache-2.0 */
/* fp3/scene.h - groups of objects, each with a program and values, from a file.
 *
 *     fp3_error error;
 *     fp3_scene *scene = NULL;
 *     fp3_status status = fp3_scene_open("mixed.scene", NULL, &scene, &error);
 *     if (status)
 *         return fp3_exit_code(status);
 *     fp3_engine_def def = fp3_scene_engine(scene);
 *     def.error = &error;
 *     fp3_engine *engine = NULL;
 *     float x;
 *     if (fp3_engine_open(&def, &engine) || fp3_scene_load(scene, engine, &error) ||
 *         fp3_adaptive_run(engine, scene->steps, NULL) || fp3_engine_get(engine, 0, "x", &x))
 *         fprintf(stderr, "%s\n", error.text);
 *     fp3_engine_close(&engine);
 *     fp3_scene_close(&scene);
 *
 * docs/scenes.md describes the file.
 *
 * Threads: any number of threads may read a scene at the same time. Loading it into an engine does
 * not change it.
 */
#ifndef FP3_SCENE_H
#define FP3_SCENE_H

#include <fp3/engine.h>
#include <fp3/program.h>
#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

FP3_API_BEGIN

/* The steps of a group's first and last object. The steps of the other objects lie evenly between,
 * rounded down. */
typedef struct {
    uint64_t first, last;
} fp3_scene_steps;

typedef struct {
    char *name; /* by which models call the group: the model's, if not given */
    char *path; /* of the program */
    char *integrator_file, *params_file; /* NULL if none was read */
    char **files;                        /* of points and links that were read */
    size_t file_count;
    fp3_program *program;
    /* The values in the file. More may be set before fp3_scene_load. */
    fp3_params *params;
    size_t first, objects; /* the group is objects first .. first + objects - 1 */
    /* See fp3_engine_live. The defaults are born {0, 0} and gone {FP3_FOREVER, FP3_FOREVER}. */
    fp3_scene_steps born, gone;
    int line; /* of the scene file */
} fp3_scene_group;

/* Never change a scene, except for params. Everything that it points to belongs to the scene. */
typedef struct {
    char *path, *config, *engine;
    uint64_t steps;
    uint32_t visit; /* steps per visit; 0: all steps */
    uint32_t seed;  /* as in fp3_engine_def */
    fp3_scene_group *groups;
    size_t group_count, objects;
    int line; /* of `groups` in the file */
} fp3_scene;

/* Reads the file and opens all its programs. config replaces the file's unless it is NULL. Defaults
 * of the file: config "world" if objects of the first group's model see each other; engine "rtl",
 * or "fast" with a configuration for such objects; steps 1 (FP3_ADAPTIVE_ATTEMPTS if all groups are
 * adaptive); visit 0; seed 0. The caller closes *scene, which is NULL on failure. Messages begin
 * with the path and the line of the file. */
fp3_status fp3_scene_open(const char *path, const char *config, fp3_scene **scene,
                          fp3_error *error);
/* Closes *scene and sets it to NULL. *scene may be NULL already. */
void fp3_scene_close(fp3_scene **scene);

/* The lifetime of one object of a group; object is 0 .. objects - 1. */
void fp3_scene_life(const fp3_scene_group *group, size_t object, uint64_t *born, uint64_t *gone);

/* For fp3_scene_engine() only: writes what the scene says into a definition of this version. */
void fp3_scene_set_engine(const fp3_scene *scene, fp3_engine_def *def);
/* The definition of an engine for the scene: fp3_engine_default() with the scene's engine,
 * configuration, objects and visit. The scene must outlive the engine. */
static inline fp3_engine_def fp3_scene_engine(const fp3_scene *scene) {
    fp3_engine_def def = fp3_engine_default();
    fp3_scene_set_engine(scene, &def);
    return def;
}

/* Loads programs, values and lifetimes into an engine that has as many objects as the scene. If the
 * engine refuses a call, error has the message as well as the error of the engine's definition;
 * the message begins with the path and the line of `groups`. FP3_E_ARGUMENT: also if the run has to
 * be split (objects have lifetimes, or only some groups have adaptive steps), and the first or last
 * part of a program does more than prepare and complete values. */
fp3_status fp3_scene_load(const fp3_scene *scene, fp3_engine *engine, fp3_error *error);

FP3_API_END

#endif
