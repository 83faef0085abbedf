/* fp3/scene.h - a scene: groups of objects, each with a program and values, from a file.
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
 *         fp3_engine_advance(engine, scene->steps, NULL) || fp3_engine_get(engine, 0, "x", &x))
 *         fprintf(stderr, "%s\n", error.text);
 *     fp3_engine_close(&engine);
 *     fp3_scene_close(&scene);
 *
 * docs/scenes.md describes the file.
 */
#ifndef FP3_SCENE_H
#define FP3_SCENE_H

#include <fp3/api.h>
#include <fp3/engine.h>
#include <fp3/program.h>
#include <stddef.h>
#include <stdint.h>

FP3_API_BEGIN

/* Steps of the first and of the last object of a group; those of the others lie evenly between, whole. */
typedef struct {
    uint64_t first, last;
} fp3_scene_steps;

typedef struct {
    char *path;                          /* of the program */
    char *integrator_file, *params_file; /* NULL: none was read */
    fp3_program *program;
    /* What the file says. More may be set before fp3_scene_load. */
    fp3_params *params;
    size_t first, objects; /* the group is objects first .. first + objects - 1 */
    /* fp3_engine_live; born {0, 0} and gone {FP3_FOREVER, FP3_FOREVER} are what the file need not say. */
    fp3_scene_steps born, gone;
    int line; /* of the scene file */
} fp3_scene_group;

/* Read it, never change it (but params). All that it points to belongs to it. */
typedef struct {
    char *path, *config, *engine;
    uint64_t steps;
    uint32_t visit; /* 0: all steps */
    fp3_scene_group *groups;
    size_t group_count, objects;
    int line; /* of the file's `groups` */
} fp3_scene;

/* Reads the file and opens all its programs. config replaces the file's unless it is NULL. What the
 * file does not say is: engine "rtl", steps 1 (FP3_ADAPTIVE_ATTEMPTS if all groups are adaptive), visit 0. The caller closes *scene, which is NULL on
 * failure. Messages begin with the path and the line of the file. */
fp3_status fp3_scene_open(const char *path, const char *config, fp3_scene **scene,
                          fp3_error *error);
/* Sets *scene to NULL; that it was NULL before does no harm. */
void fp3_scene_close(fp3_scene **scene);

/* The lifetime of an object of a group, 0 .. objects - 1. */
void fp3_scene_life(const fp3_scene_group *group, size_t object, uint64_t *born, uint64_t *gone);

/* The definition of an engine for the scene: fp3_engine_default() with its engine, configuration,
 * objects and visit. The scene must outlive the engine. */
fp3_engine_def fp3_scene_engine(const fp3_scene *scene);

/* Loads programs, values and lifetimes into an engine that has as many objects as the scene. What the engine
 * refuses is told where its definition says, with the path and the line of `groups` in front.
 * FP3_E_ARGUMENT: also if objects have lifetimes or only some groups adaptive steps, which splits a run, and a program's first or last part does
 * more than prepare and complete values. */
fp3_status fp3_scene_load(const fp3_scene *scene, fp3_engine *engine, fp3_error *error);

FP3_API_END

#endif
