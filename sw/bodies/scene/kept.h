/* SPDX-License-Identifier: Apache-2.0 */
/* kept.h - the checkpoints of a run of a scene, where it begins, and its hashes.
 *
 *     fp3_bodies_kept kept;
 *     fp3_status status = fp3_bodies_kept_open(scene, def, &kept, error);
 *     ... steps from kept.begin on; fp3_bodies_kept_take after each stop ...
 *     fp3_bodies_kept_close(&kept);
 */
#ifndef FP3_BODIES_SCENE_KEPT_H
#define FP3_BODIES_SCENE_KEPT_H

#include "scene.h"

#include "bodies/past.h"
#include "record/expected.h"

#include <fp3/recording.h>

typedef struct {
    const fp3_recording_def *def;
    const fp3_hdf5_ops *calls;
    fp3_bodies_past past;
    fp3_output *output; /* NULL: none is written */
    uint64_t begin;     /* steps that are made where the run begins */
    fp3_digest chain;   /* of snapshots */
} fp3_bodies_kept;

/* With def's restart the scene gets the world of that file. The definition must outlive *kept, and
 * the caller closes it, after a failure too. FP3_E_ARGUMENT: the file is none of this scene, or has
 * more steps than the run. */
fp3_status fp3_bodies_kept_open(fp3_bodies_scene *scene, const fp3_recording_def *def,
                                fp3_bodies_kept *kept, fp3_error *error);
void fp3_bodies_kept_close(fp3_bodies_kept *kept);

/* The step at which a part of the run ends that would end at `next`. */
uint64_t fp3_bodies_kept_next(const fp3_bodies_kept *kept, uint64_t step, uint64_t next);
/* Writes a checkpoint if it is time. */
fp3_status fp3_bodies_kept_take(fp3_bodies_kept *kept, const fp3_bodies_scene *scene, uint64_t step,
                                fp3_error *error);
/* A link for the state after this step; it is compared with what is expected. */
fp3_status fp3_bodies_kept_hash(fp3_bodies_kept *kept, const fp3_bodies_scene *scene, uint64_t step,
                                fp3_error *error);

#endif
