/* SPDX-License-Identifier: Apache-2.0 */
/* store_lists.h - a driver's side of objects that see each other: during a run the hardware's store
 * has the lists of neighbours, and published words are in one of its halves.
 *
 * Between runs the lower half has them, and the registers of lists hold what the caller wrote
 * there.
 */
#ifndef FP3_STORE_LISTS_H
#define FP3_STORE_LISTS_H

#include "kept.h"

typedef struct {
    uint32_t *saved; /* what the registers of lists hold between runs, list by list; NULL: there are
                        no lists */
    uint32_t *words; /* of one register of all objects */
    uint32_t *place; /* of each object's list, likewise: the word of its lane's store where it is */
    int is_written;  /* the lists are in the store */
    const fp3_own_list *kept; /* of which the hardware makes one; NULL: none */
} fp3_store_lists;

/* See fp3_backend.check. FP3_E_PROGRAM: the hardware cannot run such a program. */
fp3_status fp3_store_lists_check(fp3_engine *engine, const fp3_members *group);

/* Whether the host comes between phases: lists follow the objects, or words come from other ranks.
 * Each phase is then a run of its own. */
int fp3_store_lists_is_by_phase(const fp3_engine *engine);

/* Before a run. Whatever becomes of it, the caller ends it with fp3_store_lists_end. */
fp3_status fp3_store_lists_begin(fp3_engine *engine, fp3_store_lists *lists);
/* Before a part of a run: lists that are not in the store, or stale, are written. FP3_E_PROGRAM:
 * there is no room for them, or an object has too many neighbours. Else as fp3_lists_follow. */
fp3_status fp3_store_lists_follow(fp3_engine *engine, fp3_store_lists *lists);
/* After a part: what entries remember, to the lists. */
fp3_status fp3_store_lists_remember(fp3_engine *engine, const fp3_store_lists *lists);
/* After a part: which half has the published words. */
fp3_status fp3_store_lists_look(fp3_engine *engine);
fp3_status fp3_store_lists_end(fp3_engine *engine, fp3_store_lists *lists);

#endif
