/* SPDX-License-Identifier: Apache-2.0 */
/* scene_read.h - what the file of a scene says, into a scene. */
#ifndef FP3_SCENE_READ_H
#define FP3_SCENE_READ_H

#include <fp3/scene.h>

/* Fills the scene from the file at scene->path; config replaces the file's unless it is NULL. draw
 * is added to the seed of each `random`: other objects of the same kind of scene. After a failure
 * the scene is half full, and may be closed. */
fp3_status fp3_scene_read(fp3_scene *scene, const char *config, uint64_t draw, fp3_error *error);

/* fp3_scene_open with another draw. */
fp3_status fp3_scene_open_drawn(const char *path, const char *config, uint64_t draw,
                                fp3_scene **scene, fp3_error *error);

#endif
