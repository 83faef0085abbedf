/* SPDX-License-Identifier: Apache-2.0 */
/* ghosts.h - neighbours in other lanes: each lane has a copy of what they publish, in rows behind
 * its own objects.
 *
 * An object that all other lanes need is in the same row of all of them, so that one copy reaches
 * all.
 */
#ifndef FP3_GHOSTS_H
#define FP3_GHOSTS_H

#include "inside.h"

#define FP3_NO_ROW UINT32_MAX

/* One copy: of a published word of an object, from its lane to another, or to all. */
typedef struct {
    uint32_t object, from_lane, from_row, to_lane, to_row;
    int to_all;
} fp3_copy;

typedef struct {
    uint32_t lanes, objects;
    uint32_t
        *rows; /* of lane l and object i at l * objects + i: where the lane has it, or FP3_NO_ROW */
    uint32_t *used; /* of each lane: rows, its own and those of ghosts */
    fp3_copy *copies;
    uint32_t count;
} fp3_ghosts;

/* Of the engine's first group, by the lists that it has. FP3_E_SYSTEM: out of memory; *ghosts is
 * then {0}. */
fp3_status fp3_ghosts_find(const fp3_engine *engine, fp3_ghosts *ghosts);
void fp3_ghosts_free(fp3_ghosts *ghosts);

static inline uint32_t fp3_ghosts_row(const fp3_ghosts *ghosts, uint32_t lane, uint32_t object) {
    return ghosts->rows[(size_t)lane * ghosts->objects + object];
}

#endif
