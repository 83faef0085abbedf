/* SPDX-License-Identifier: Apache-2.0 */
/* scene.h - a world of rigid bodies from a file: its settings, its bodies with their shapes, its
 * joints. docs/scenes.md describes the file.
 *
 *     fp3_bodies_scene *scene = NULL;
 *     if (fp3_bodies_scene_open("pyramid.scene", NULL, NULL, 1, &scene, error) ||
 *         fp3_bodies_step(scene->bodies, scene->steps))
 *         ...
 *     fp3_bodies_scene_close(&scene);
 */
#ifndef FP3_BODIES_SCENE_H
#define FP3_BODIES_SCENE_H

#include <fp3/bodies.h>
#include <fp3/image.h>

#define FP3_BODIES_SCENE_MOST 1000000 /* bodies, and joints */

/* What one entry of the file made: one body, or copies of it. */
typedef struct {
    char name[FP3_NAME_SIZE]; /* ""; joints and --group call it so */
    size_t first, count;      /* of the bodies of the scene */
} fp3_bodies_entry;

typedef struct {
    char *path, *engine; /* engine: NULL: laws are built in */
    uint64_t steps;
    double h;
    uint32_t substeps, dimensions;
    fp3_bodies_def def; /* of the world */
    fp3_bodies *bodies;
    fp3_error why; /* where the world puts its errors */
    fp3_bodies_entry *entries;
    uint64_t *handles, *joints; /* in the order of the file */
    char **files;               /* other files that were read */
    size_t entry_count, count, joint_count, file_count;
    uint32_t entry_room, room, joint_room, file_room;
} fp3_bodies_scene;

/* Whether the file is a scene of bodies; 0 also if it cannot be read. A pipe is none. */
int fp3_bodies_scene_is(const char *path);

/* engine and seed replace the file's, unless they are NULL. threads: as in fp3_bodies_def;
 * with an engine 0 is 1. The caller closes *scene, which is NULL on failure. Messages begin with
 * the path and the line. */
fp3_status fp3_bodies_scene_open(const char *path, const char *engine, const uint32_t *seed,
                                 uint32_t threads, fp3_bodies_scene **scene, fp3_error *error);
/* Closes *scene and sets it to NULL. *scene may be NULL already. */
void fp3_bodies_scene_close(fp3_bodies_scene **scene);

/* "brick[3]", or "body 3" of an entry without a name. */
void fp3_bodies_scene_name(const fp3_bodies_scene *scene, size_t body,
                           char text[FP3_NAME_SIZE + 24]);

/* Grows an array to hold `wanted` elements of `size` bytes. FP3_E_SYSTEM: it is as it was. */
fp3_status fp3_bodies_grow(void **array, uint32_t *room, size_t size, size_t wanted,
                           fp3_error *error);

#endif
