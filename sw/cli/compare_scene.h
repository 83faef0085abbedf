/* SPDX-License-Identifier: Apache-2.0 */
/* compare_scene.h - fp3 compare SCENE.scene: the error of a scene in FP32, and what it is made of.
 */
#ifndef FP3_CLI_COMPARE_SCENE_H
#define FP3_CLI_COMPARE_SCENE_H

#include <fp3/status.h>
#include <stdint.h>

typedef struct {
    const char *path;
    const char *config;              /* NULL: the scene's */
    const char *json, *csv, *states; /* or NULL */
    uint64_t steps;                  /* 0: the scene's */
    uint32_t halvings;               /* of the time step, beside the scene's own */
    double within, work;             /* of the solution: fp3/scene_truth.h */
} fp3_compare_scene;

/* Runs the scene by engine fast with each time step; prints a row for each state and writes them.
 * FP3_E_FAILED, after that: the solution is not known to the end, or objects failed. */
fp3_status fp3_compare_scene_run(const fp3_compare_scene *what, fp3_error *error);

#endif
