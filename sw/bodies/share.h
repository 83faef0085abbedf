/* SPDX-License-Identifier: Apache-2.0 */
/* share.h - a world that several processes of a cluster step together.
 *
 * Every rank has the whole world and makes all of a step but the passes over rows: those each rank
 * makes for its own islands alone. Behind the last substep all get what the passes of each have
 * changed, so that all have the same world again. An island is bodies that touch each other or are
 * joined; no pass goes from one to another, and so nothing depends on who has which.
 */
#ifndef FP3_BODIES_SHARE_H
#define FP3_BODIES_SHARE_H

#include "engine/cluster/processes.h"

#include <fp3/bodies.h>

/* What the passes of each rank have cost. */
typedef struct {
    uint32_t ranks;
    const uint64_t *rows; /* of each rank, step by step */
    uint64_t bytes;       /* that all ranks together sent */
} fp3_share_use;

/* same.c: all ranks together, which from now on make the same calls for the same world, with so
 * many steps. FP3_E_ARGUMENT, on all: they have not the same one. What fails on one fails on all.
 */
fp3_status fp3_share_begin(fp3_bodies *bodies, const fp3_ranks *ranks, uint64_t steps);
/* Its part that asks nobody. */
fp3_status fp3_share_make(fp3_bodies *bodies, const fp3_ranks *ranks);
/* All 0: one process steps the world alone. */
fp3_share_use fp3_share_used(const fp3_bodies *bodies);
void fp3_share_free(fp3_bodies *bodies);

/* Behind fp3_bodies_touch: which rank has which islands. */
fp3_status fp3_share_divide(fp3_bodies *bodies);
/* Whether this process makes the passes over a row of these slots. */
int fp3_share_has(const fp3_bodies *bodies, uint32_t a, uint32_t b);
/* Another number after islands have changed hands. */
uint32_t fp3_share_number(const fp3_bodies *bodies);
/* The worst status of all ranks. Each makes this call, whatever has failed before it: else the
 * others would wait for it. */
fp3_status fp3_share_agree(fp3_bodies *bodies, fp3_status status);
/* Behind the passes, or what failed before them, whose status this is: the worst of all ranks, as
 * above. 0: all have what the passes of each have changed. */
fp3_status fp3_share_gather(fp3_bodies *bodies, fp3_status status);

#endif
