/* SPDX-License-Identifier: Apache-2.0 */
/* kept.h - a driver's side of lists of near objects that the hardware makes itself.
 *
 * The driver adds two phases before each phase that goes through the list. In the first, the check,
 * an object raises a flag if it has moved by more than half the skin since the list was made. The
 * second makes the list; it is left out if no object has raised the flag. So a run of many steps
 * needs no host in between. The list has every pair within the reach, in the order of the objects'
 * numbers, as the host's has: results are the same.
 */
#ifndef FP3_KEPT_H
#define FP3_KEPT_H

#include "engine/common/luggage.h"

#define FP3_KEPT_CONSTANTS 4

typedef struct {
    const fp3_list *list; /* NULL: the host makes lists */
    uint32_t *code;       /* what the hardware runs */
    uint32_t count;
    uint32_t room;            /* entries of an object's list */
    uint32_t next[2], end[2]; /* words of the store that are free, in each half */
    /* Words of a record that nothing else has: where the object was when the list was made, and the
     * list of all. */
    uint32_t made[FP3_NEAR_DIMENSIONS], all;
    uint32_t constant;          /* the first of those that nothing else has */
    uint32_t log2, log2_before; /* of a record's words, during the run and else */
    fp3_luggage before; /* what all held when the run began; NULLs: nothing is changed yet */
} fp3_own_list;

/* Before a run, behind fp3_store_lists_begin: whether the hardware makes its list, and what it runs
 * then. The caller ends it with fp3_kept_end, also after a failure. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_kept_begin(fp3_engine *engine, fp3_own_list *kept);
/* Behind the other lists: the list as the host has made it, and what a check needs. FP3_E_PROGRAM:
 * an object has more neighbours than there is room for. */
fp3_status fp3_kept_install(fp3_engine *engine, const fp3_own_list *kept);
/* The run has ended as a list had no room: FP3_E_PROGRAM, which says whose. */
fp3_status fp3_kept_no_room(fp3_engine *engine, const fp3_own_list *kept);
/* All words are again what they were, and the program is the group's. */
fp3_status fp3_kept_end(fp3_engine *engine, fp3_own_list *kept);

#endif
