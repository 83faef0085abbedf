/* SPDX-License-Identifier: Apache-2.0 */
/* follow.h - lists of those that are near, made again as objects move. */
#ifndef FP3_ENGINE_FOLLOW_H
#define FP3_ENGINE_FOLLOW_H

#include "lists.h"

/* At the beginning of a phase: makes the lists of those that are near again, where they are stale.
 * Words of the group's objects: words[register] is that of row 0, NULL: there is none; row: of each
 * object, NULL: its number. Lists are of rows; where rows are given and some objects do not live,
 * `objects` are those that live, in the first rows. Rows from `seekers` on make no steps:
 * nobody needs their lists. *is_new: some were made. FP3_E_LIMIT,
 * FP3_E_SYSTEM as of fp3_near_make. crew: as of fp3_where_they_are. */
fp3_status fp3_lists_follow(fp3_lists *lists, uint32_t objects, uint32_t seekers,
                            const uint32_t *const *words, const uint32_t *row, size_t stride,
                            const fp3_crew *crew, int *is_new, fp3_error *error);

#endif
