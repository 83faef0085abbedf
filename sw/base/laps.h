/* SPDX-License-Identifier: Apache-2.0 */
/* laps.h - a list of what threads do together, which is made anew again and again.
 *
 * Whoever does the same each time makes the same list. Then nothing of it is written, and every
 * thread has it in its cache.
 */
#ifndef FP3_LAPS_H
#define FP3_LAPS_H

#include "threads.h"

typedef struct {
    fp3_lap *stage;
    uint32_t count, room;
    fp3_threads *crew;  /* NULL: the caller alone */
    int may_be_written; /* nobody reads what was there before */
    fp3_status status;  /* FP3_E_SYSTEM: there was no memory */
} fp3_laps;

void fp3_laps_begin(fp3_laps *all, fp3_threads *crew);
/* Behind what is there: part(of, from, to) for `parts` ranges of first .. end-1. */
void fp3_laps_add(fp3_laps *all, void (*part)(void *of, uint32_t from, uint32_t to), void *of,
                  uint32_t first, uint32_t end, uint32_t parts);
fp3_status fp3_laps_do(const fp3_laps *all);
/* Behind fp3_threads_free. */
void fp3_laps_free(fp3_laps *all);

#endif
