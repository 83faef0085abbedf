/* SPDX-License-Identifier: Apache-2.0 */
/* bench_scene.h - fp3 bench SCENE.scene: what a step of a scene takes on this machine. */
#ifndef FP3_CLI_BENCH_SCENE_H
#define FP3_CLI_BENCH_SCENE_H

#include <fp3/status.h>
#include <stdint.h>

typedef struct {
    const char *path;
    const char *config; /* NULL: the scene's */
    const char *json;   /* or NULL */
    uint64_t steps;     /* 0: as many of the scene's as take a fifth of a second, or all */
    int is_quick;       /* each is run once instead of five times */
} fp3_bench_scene;

/* Whether a file is one by its name. */
int fp3_bench_is_scene(const char *path);

/* Runs the scene from its start by engine fast, with one thread and with one for each processor;
 * prints a row for each and writes them as JSON. FP3_E_MISMATCH: states differ by a bit among
 * these, or from the isa engine after as many steps as that makes in some seconds. FP3_E_FAILED: an
 * object failed. Both after the table is printed. */
fp3_status fp3_bench_scene_run(const fp3_bench_scene *what, fp3_error *error);

#endif
