/* SPDX-License-Identifier: Apache-2.0 */
/* run.h - the steps of a scene of bodies, with snapshots and contacts in files. */
#ifndef FP3_BODIES_SCENE_RUN_H
#define FP3_BODIES_SCENE_RUN_H

#include "scene.h"

#include "engine/cluster/processes.h"

#include <fp3/recording.h>

typedef struct {
    /* path: NULL: no snapshots. observed: names as fp3_bodies_read has them; by default x, angle,
     * v, w and at_rest; "contacts": what touches at each snapshot, in HDF5 alone. `group` is not
     * looked at. */
    const fp3_recording_def *recording;
    size_t first, count;       /* the bodies that are recorded */
    const char *contacts;      /* a CSV of contacts that began, ended and hit; NULL: none */
    const fp3_ranks *ranks;    /* several processes step the world; NULL: one does */
    fp3_progress_fn *progress; /* or NULL */
    void *user;
} fp3_bodies_run_def;

/* What happened. */
typedef struct {
    uint64_t begin;      /* steps of the checkpoint from which the run goes on */
    uint64_t steps;      /* that are made in the end */
    uint64_t changes[3]; /* by fp3_contact_change */
    double seconds;
    char chain[65]; /* of the checkpoints or, without them, of the snapshots in HDF5; "": there are
                     * none (docs/checkpoints.md) */
} fp3_bodies_tally;

/* Makes the steps of the recording's definition, or goes on from its restart: then the scene has
 * another world. On success files get their names; after a failure
 * nothing is written but checkpoints. */
fp3_status fp3_bodies_scene_run(fp3_bodies_scene *scene, const fp3_bodies_run_def *def,
                                fp3_bodies_tally *tally, fp3_error *error);

#endif
