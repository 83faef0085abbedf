/* SPDX-License-Identifier: Apache-2.0 */
/* scene_invariants.h - how much the invariants of a scene's models change over rows of its states,
 * whoever made these: of each object, and of all objects together (invariants.h).
 *
 *     fp3_scene_invariants *of = NULL;
 *     fp3_scene_invariant changed[2];
 *     fp3_status status = fp3_scene_invariants_open(scene, steps, &of, error);
 *     if (!status && fp3_scene_invariants_count(of) <= 2)
 *         status = fp3_scene_invariants_look(of, start, rows, times, changed, error);
 *     fp3_scene_invariants_close(&of);
 *
 * It shares no code with the compiler.
 */
#ifndef FP3_CHECK_SCENE_INVARIANTS_H
#define FP3_CHECK_SCENE_INVARIANTS_H

#include <fp3/scene.h>

typedef struct fp3_scene_invariants fp3_scene_invariants;

/* Rows belong to these steps of the scene, which ascend; like the scene, they must outlive it.
 * Groups whose objects are removed have none, and of all objects together there are none where
 * objects come and go. FP3_E_PROGRAM: as of fp3_crowd_open. The caller closes *of, which is NULL on
 * failure. */
fp3_status fp3_scene_invariants_open(const fp3_scene *scene, const uint64_t *steps,
                                     fp3_scene_invariants **of, fp3_error *error);
/* Sets *of to NULL, which it may be already. */
void fp3_scene_invariants_close(fp3_scene_invariants **of);

size_t fp3_scene_invariants_count(const fp3_scene_invariants *of);
const fp3_definition *fp3_scene_invariants_name(const fp3_scene_invariants *of, size_t number);
/* NULL: of all objects together. */
const fp3_scene_group *fp3_scene_invariants_group(const fp3_scene_invariants *of, size_t number);

/* Of the object that it has changed most of, at the time when it had; NaN is the largest change. */
typedef struct {
    double first, change;
    double relative; /* of all objects together: to its size */
    size_t object;   /* of the group */
    size_t time;
} fp3_scene_invariant;

/* Of all invariants. start: a row (fp3/scene_truth.h); NULL: the scene's, in double. rows: `times`
 * more after it; without any there is no change: NaN. Where sums over pairs have very many terms,
 * some of the times are left out, never the last. */
fp3_status fp3_scene_invariants_look(fp3_scene_invariants *of, const double *start,
                                     const double *rows, size_t times, fp3_scene_invariant *changed,
                                     fp3_error *error);

#endif
