/* SPDX-License-Identifier: Apache-2.0 */
/* origin.h - what objects and groups held when the last run began, so that it can be made again.
 *
 * It mirrors what the host writes. What a run changes is read back when the next run begins, and
 * only if a run reads it or it is a state: the first run after a load costs no access.
 */
#ifndef FP3_ORIGIN_H
#define FP3_ORIGIN_H

#include "backend.h"

/* An engine that finds failures by itself keeps no copies, unless objects see each other: the
 * pointers are NULL. */
struct fp3_origin {
    uint32_t *registers; /* columns of all objects */
    uint32_t *constants; /* of all groups */
    uint64_t *known;     /* of each object: the registers that are as they are here */
    uint64_t *began;     /* ... that were when the last run began */
    /* Of each group and list: what entries remembered when the last run began, and how many rows
     * the group had: guests may have come since. */
    fp3_remembered (*remembered)[FP3_LISTS_MAX];
    uint32_t *rows;
    uint32_t groups;   /* of these */
    int has_constants; /* the constants are as they are here */
    /* The last run. is_complete: it came to its end, and nothing was written or loaded since. */
    uint32_t clock, visit, seed, steps, flags;
    uint64_t made; /* before it, as lifetimes count */
    int is_complete;
};

/* All is 0. FP3_E_SYSTEM: out of memory; close frees what there is. */
fp3_status fp3_origin_open(fp3_engine *engine);
void fp3_origin_close(fp3_engine *engine);

/* The host writes. */
void fp3_origin_write(fp3_engine *engine, fp3_cells cells, const void *words);
/* A load. is_moved: objects and constants are elsewhere, and may have lost something. FP3_E_SYSTEM:
 * out of memory. */
fp3_status fp3_origin_load(fp3_engine *engine, int is_moved);

/* Gives the lists of another engine, which was loaded likewise, what entries remembered when the
 * last run began, and its groups as many rows; row: as of fp3_list_restore. FP3_E_SYSTEM: out of
 * memory. */
fp3_status fp3_origin_remember(const fp3_engine *engine, const uint32_t *row, fp3_layout *layout,
                               fp3_error *error);

/* Before and after a run of so many steps. */
fp3_status fp3_origin_begin(fp3_engine *engine, uint32_t steps);
void fp3_origin_end(fp3_engine *engine, int is_complete, uint32_t flags);

#endif
