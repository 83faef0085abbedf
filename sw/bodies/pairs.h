/* SPDX-License-Identifier: Apache-2.0 */
/* pairs.h - which boxes overlap, on grids by size.
 *
 * Boxes that are between half as large and as large as a cell are a level, with a grid of its own.
 * Each looks for those of its level and of coarser ones, in the few cells where their centres may
 * be. So one large box, and one far away, cost the others nothing.
 */
#ifndef FP3_BODIES_PAIRS_H
#define FP3_BODIES_PAIRS_H

#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
    double low[3], high[3]; /* high below low: there is no box */
} fp3_box;

typedef struct {
    uint32_t category, mask;
    int may_move;
} fp3_box_filter;

typedef struct {
    uint32_t dimensions; /* 2: the third is not looked at */
    fp3_box *box;
    /* Left out are pairs of two that do not move, and those of which one's mask has no bit of the
     * other's category. */
    fp3_box_filter *filter;
    uint32_t count, room, filter_room;
} fp3_boxes;

/* All pairs that overlap, as (lower number) << 32 | higher number, ascending. Grows *keys, which
 * has `room` places. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_pairs_find(const fp3_boxes *boxes, uint64_t **keys, size_t *room, size_t *count,
                          fp3_error *error);
/* Those of some boxes, which are compared with all: for few of them in less time. */
fp3_status fp3_pairs_find_of(const fp3_boxes *boxes, const uint32_t *some, uint32_t count,
                             uint64_t **keys, size_t *room, size_t *found, fp3_error *error);

#endif
