/* SPDX-License-Identifier: Apache-2.0 */
/* tune_scene.h - fp3 tune SCENE.scene, of objects that see each other: fp3/scene_tune.h, printed
 * and written. */
#ifndef FP3_CLI_TUNE_SCENE_H
#define FP3_CLI_TUNE_SCENE_H

#include "progress.h"

#include <fp3/scene_tune.h>

typedef struct {
    fp3_scene_tune_def def;    /* without `say` and `stop` */
    double span;               /* 0: the scene's steps */
    const char *output, *json; /* or NULL */
    fp3_progress *progress;
} fp3_tune_scene;

/* A first Ctrl-C ends the search, and what it has is printed; a second one ends the command.
 * FP3_E_FAILED, after that: nothing meets the tolerance, or not so in held-out scenes; there is no
 * solution; the search was ended. */
fp3_status fp3_tune_scene_run(fp3_tune_scene *what, fp3_error *error);

#endif
