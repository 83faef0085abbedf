/* SPDX-License-Identifier: Apache-2.0 */
/* scene_read.h - what the file of a scene says, into a scene. */
#ifndef FP3_SCENE_READ_H
#define FP3_SCENE_READ_H

#include <fp3/scene.h>

/* Fills the scene from the file at scene->path; config replaces the file's unless it is NULL. After
 * a failure the scene is half full, and may be closed. */
fp3_status fp3_scene_read(fp3_scene *scene, const char *config, fp3_error *error);

#endif
