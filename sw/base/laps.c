/* SPDX-License-Identifier: Apache-2.0 */
/* laps.c - see laps.h. */
#include "laps.h"

#include <stdlib.h>

void fp3_laps_begin(fp3_laps *all, fp3_threads *crew) {
    /* Others may still read the list of their last step. */
    if (all->crew != crew)
        fp3_threads_let_go(all->crew);
    all->count = 0;
    all->crew = crew;
    all->may_be_written = 0;
    all->status = FP3_OK;
}

static void need_to_write(fp3_laps *all) {
    if (!all->may_be_written)
        fp3_threads_let_go(all->crew);
    all->may_be_written = 1;
}

static int make_room(fp3_laps *all) {
    if (all->count < all->room)
        return 1;
    need_to_write(all);
    const uint32_t room = 2 * all->room + 64;
    fp3_lap *made = realloc(all->stage, room * sizeof *made);
    if (!made)
        return 0;
    for (uint32_t i = all->room; i < room; i++)
        made[i] = (fp3_lap){.parts = 0}; /* is like none */
    all->stage = made;
    all->room = room;
    return 1;
}

void fp3_laps_add(fp3_laps *all, void (*part)(void *of, uint32_t from, uint32_t to), void *of,
                  uint32_t first, uint32_t end, uint32_t parts) {
    if (all->status)
        return;
    if (!make_room(all)) {
        all->status = FP3_E_SYSTEM;
        return;
    }
    fp3_lap *s = &all->stage[all->count++];
    if (s->part == part && s->of == of && s->first == first && s->end == end && s->parts == parts)
        return;
    need_to_write(all);
    *s = (fp3_lap){part, of, first, end, parts};
}

fp3_status fp3_laps_do(const fp3_laps *all) {
    if (!all->status)
        fp3_threads_do(all->crew, all->stage, all->count);
    return all->status;
}

void fp3_laps_free(fp3_laps *all) {
    free(all->stage);
    *all = (fp3_laps){.stage = NULL};
}
