/* SPDX-License-Identifier: Apache-2.0 */
/* scaled.h - a scene with steps of another length, and what an engine makes of it.
 *
 *     fp3_scaled half;
 *     fp3_status status = fp3_scaled_open(scene, 2, 1, &half, error);
 *     if (!status)
 *         status = fp3_scene_load(&half.scene, engine, error);
 *     ...
 *     fp3_scaled_close(&half);
 */
#ifndef FP3_LAB_SCALED_H
#define FP3_LAB_SCALED_H

#include <fp3/scene.h>

typedef struct {
    fp3_scene scene; /* its groups have values of their own; the rest belongs to the other scene */
    fp3_scene_group *groups;
} fp3_scaled;

/* `joined` steps become `parts`, each of h*joined/parts; births and ends stay at their times.
 * FP3_E_ARGUMENT: one would not, or a value of `steps` is a time. The caller closes, after a
 * failure too. */
fp3_status fp3_scaled_open(const fp3_scene *scene, uint64_t parts, uint64_t joined,
                           fp3_scaled *scaled, fp3_error *error);
/* Leaves {0}, which may be closed as well. */
void fp3_scaled_close(fp3_scaled *scaled);

/* The length of a group's steps. */
double fp3_scaled_step(const fp3_scene_group *group);

/* A state of a model in double, of count objects: the sum of its words. */
fp3_status fp3_run_state_read(const fp3_program *program, fp3_engine *engine, uint32_t state,
                              size_t first, size_t count, double *values, fp3_error *error);
/* All states of a scene: a row of fp3/scene_truth.h. */
fp3_status fp3_scaled_row(const fp3_scene *scene, fp3_engine *engine, double *row,
                          fp3_error *error);

#endif
