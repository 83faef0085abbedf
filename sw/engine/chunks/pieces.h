/* SPDX-License-Identifier: Apache-2.0 */
/* pieces.h - objects that see each other, cut into pieces that see few objects of other pieces.
 *
 * A piece has objects that follow each other in an order of all, their *place*. What it sees of
 * others are ranges of places: within a piece objects stand together that the same pieces see.
 */
#ifndef FP3_PIECES_H
#define FP3_PIECES_H

#include "engine/cluster/places.h"
#include "engine/common/inside.h"

typedef struct {
    uint32_t first, count; /* places */
} fp3_stretch;

typedef struct {
    fp3_stretch own;
    uint32_t ghosts;                   /* objects of other pieces that it sees ... */
    uint32_t range_first, range_count; /* ... and the ranges that they are, by place */
} fp3_piece;

typedef struct {
    uint32_t objects, count;
    uint32_t *place, *object; /* of each object; of each place */
    fp3_piece *pieces;
    fp3_stretch *ranges;
} fp3_pieces;

/* Where objects are, and how long a list of each is. */
typedef struct {
    const fp3_positions *places;
    const uint32_t *lengths;
} fp3_pieces_by;

/* Of the engine's only group. lists: who sees whom. by: what they are cut by; NULL: by the links
 * that the engine has, whose configuration is another one meanwhile. count: at least 1, at most the
 * objects. The caller frees *cut, also after a failure. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_pieces_make(fp3_engine *engine, const fp3_lists *lists, const fp3_pieces_by *by,
                           uint32_t count, fp3_pieces *cut, fp3_error *error);
/* Leaves {0}, which may be freed as well. */
void fp3_pieces_free(fp3_pieces *cut);

/* The row of an object in the store, own objects first, then ghosts by place. It is one of these.
 */
uint32_t fp3_pieces_row(const fp3_pieces *cut, const fp3_piece *piece, uint32_t object);

#endif
