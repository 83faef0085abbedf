/* SPDX-License-Identifier: Apache-2.0 */
/* split.h - whether a run may be split into parts. */
#ifndef FP3_SCENE_SPLIT_H
#define FP3_SCENE_SPLIT_H

#include <fp3/program.h>
#include <fp3/scene.h>

/* Each part executes the program's first and last part, which must only prepare and complete values
 * (docs/architecture.md). Compiled programs do. why: the reason for splitting the run, for the
 * message. FP3_E_ARGUMENT: a program that does more, as some steps of its first object show, made
 * at once and one by one. Agreement is no proof. */
fp3_status fp3_split_check(const fp3_program *program, const fp3_params *params, const char *config,
                           const char *why, fp3_error *error);
/* The same for the programs of all groups. */
fp3_status fp3_split_check_scene(const fp3_scene *scene, const char *why, fp3_error *error);

#endif
