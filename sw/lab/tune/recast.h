/* SPDX-License-Identifier: Apache-2.0 */
/* recast.h - a scene's programs with an integrator and an arithmetic, and runs of it.
 *
 *     fp3_recast choice = {.integrator = integrator, .arithmetic = FP3_COMPENSATED};
 *     fp3_status status = fp3_recast_compile(&choice, scene, error);
 *     ...
 *     fp3_recast_free(&choice);
 */
#ifndef FP3_TUNE_RECAST_H
#define FP3_TUNE_RECAST_H

#include "drawn.h"
#include "lab/scene/scaled.h"

typedef struct {
    fp3_integrator *integrator; /* of the groups that move; the choice frees it */
    fp3_arithmetic arithmetic;
    fp3_program *programs; /* of each group; all but what is compiled is the scene's */
    size_t count;
    int is_own; /* what is compiled is the scene's, too */
} fp3_recast;

/* FP3_E_PROGRAM, FP3_E_LIMIT: the scene cannot have it. */
fp3_status fp3_recast_compile(fp3_recast *choice, const fp3_scene *scene, fp3_error *error);
/* The scene's own programs. */
fp3_status fp3_recast_take(fp3_recast *choice, const fp3_scene *scene, fp3_error *error);
/* Whether it has lists of near objects, which have a skin. */
int fp3_recast_has_near(const fp3_model *model);
int fp3_recast_scene_has_near(const fp3_scene *scene);
/* The first group that moves: its integrator is the scene's. */
const fp3_program *fp3_recast_first(const fp3_scene *scene);
/* Leaves {0}, which may be freed as well. */
void fp3_recast_free(fp3_recast *choice);

/* `joined` of the scene's steps become `parts`. skin: of lists of near objects; below 0: the
 * scene's. */
typedef struct {
    const fp3_recast *choice;
    uint64_t parts, joined;
    double skin;
} fp3_recast_steps;

/* One of the scenes, loaded into an engine. The caller closes with fp3_recast_end, after a failure
 * too. */
typedef struct {
    fp3_scaled scaled;
    fp3_engine *engine;
} fp3_recast_run;
fp3_status fp3_recast_begin(const fp3_recast_steps *steps, const fp3_scene *scene,
                            uint64_t of_steps, int is_timed, fp3_recast_run *run, fp3_error *error);
void fp3_recast_end(fp3_recast_run *run);

/* Minima over alternating turns: ns[i] per object over so many steps of the scene, by engine fast
 * with one thread; 0: it failed. stop: as in fp3_scene_tune_def. */
fp3_status fp3_recast_time(const fp3_scene_tune_def *def, const fp3_recast_steps *list,
                           size_t count, const fp3_scene *scene, uint64_t of_steps, double *ns,
                           fp3_error *error);

#endif
