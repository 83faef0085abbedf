/* SPDX-License-Identifier: Apache-2.0 */
/* cuts.c - which bodies and rows each thread has.
 *
 * What two processors write in turn is slow, so one thread has neighbours. Contacts ascend by their
 * first body; who has the first half of them has the bodies up to a slot, and of each colour the
 * rows of these. Slots are cut where eight begin: a line of memory is one thread's.
 */
#include "own.h"

#include <stdlib.h>
#include <string.h>

static uint32_t eights(uint32_t slot) { return slot / FP3_WIDE * FP3_WIDE; }

fp3_status fp3_cut_bodies(fp3_bodies *bodies) {
    const uint32_t threads = fp3_threads_most(bodies->crew);
    if (bodies->cut && bodies->cuts == threads && bodies->cut_movable == bodies->movable &&
        bodies->cut_slots == bodies->slots)
        return FP3_OK;
    const fp3_status status = fp3_bodies_room((void **)&bodies->cut, &bodies->cut_room,
                                              sizeof *bodies->cut, threads + 1u, bodies->error);
    for (uint32_t t = 0; !status && t < threads; t++)
        bodies->cut[t] = eights((uint32_t)((uint64_t)bodies->movable * t / threads));
    if (status)
        return status;
    bodies->cut[threads] = bodies->slots;
    bodies->cuts = threads;
    bodies->cut_movable = bodies->movable;
    bodies->cut_slots = bodies->slots;
    bodies->cut_version++;
    return FP3_OK;
}

/* The first one of its bodies that moves. */
static uint32_t owner_of(const fp3_bodies *bodies, const fp3_law_rows *rows, uint32_t i) {
    const uint32_t a = rows->a[i], b = rows->b[i];
    return a < bodies->movable && (a < b || b >= bodies->movable) ? a : b;
}

void fp3_cut_by_contacts(fp3_bodies *bodies, const fp3_law_rows *rows) {
    for (uint32_t t = 1; t < bodies->cuts; t++) {
        uint32_t slot = bodies->movable;
        if (rows->count)
            slot = owner_of(bodies, rows, (uint32_t)((uint64_t)rows->count * t / bodies->cuts));
        slot = eights(slot < bodies->movable ? slot : bodies->movable);
        bodies->cut[t] = slot > bodies->cut[t - 1] ? slot : bodies->cut[t - 1];
    }
    bodies->cut_version++;
}

fp3_status fp3_cut_rows(const fp3_bodies *bodies, fp3_law_rows *rows) {
    const uint32_t threads = bodies->cuts, *first = rows->colours.first,
                   together = fp3_blocks_together(bodies), lanes = together * FP3_WIDE;
    if (!rows->count || (rows->is_cut && rows->cut_version == bodies->cut_version))
        return FP3_OK;
    const fp3_status status =
        fp3_bodies_room((void **)&rows->cut, &rows->cut_room, sizeof *rows->cut,
                        (size_t)rows->colours.count * threads + 2, bodies->error);
    if (status)
        return status;
    memset(rows->cut, 0, ((size_t)rows->colours.count * threads + 2) * sizeof *rows->cut);
    for (uint32_t i = 0; threads > 1 && i < rows->count; i++) {
        const uint32_t owner = owner_of(bodies, rows, i);
        uint32_t t = 0;
        while (t + 1 < threads && bodies->cut[t + 1] <= owner)
            t++;
        rows->cut[rows->colour[i] * threads + t + 1]++; /* how many it has, but for the last */
    }
    for (uint32_t k = 0; k < rows->colours.count; k++) {
        const uint32_t blocks = first[k + 1] - first[k];
        uint32_t *cut = &rows->cut[k * threads], sum = 0;
        cut[0] = first[k];
        for (uint32_t t = 1; t < threads; t++) {
            sum += cut[t];
            const uint32_t upto = (sum + lanes / 2) / lanes * together;
            cut[t] = first[k] + (upto < blocks ? upto : blocks);
        }
    }
    rows->cut[rows->colours.count * threads] = first[rows->colours.count];
    rows->is_cut = 1;
    rows->cut_version = bodies->cut_version;
    return FP3_OK;
}

typedef struct {
    const uint32_t *cut;
    void (*part)(void *of, uint32_t from, uint32_t to);
    void *of;
} owned;

static void do_owned(void *of, uint32_t from, uint32_t to) {
    const owned *all = of;
    if (all->cut[from] < all->cut[to])
        all->part(all->of, all->cut[from], all->cut[to]);
}

void fp3_bodies_share_slots(fp3_bodies *bodies, void (*part)(void *of, uint32_t from, uint32_t to),
                            void *of) {
    owned all = {bodies->cut, part, of};
    const uint32_t parts = fp3_threads_parts(bodies->crew, bodies->slots, FP3_LEAST_BODIES);
    fp3_threads_share(bodies->crew, (fp3_lap){do_owned, &all, 0, bodies->cuts, parts});
}

void fp3_rows_of(const fp3_bodies *bodies, const fp3_law_rows *rows, uint32_t from, uint32_t to,
                 void (*part)(void *of, uint32_t from, uint32_t to), void *of) {
    if (bodies->cuts == 1) { /* also those of other ranks, behind all colours */
        part(of, 0, rows->blocks);
        return;
    }
    for (uint32_t k = 0; rows->count && k < rows->colours.count; k++) {
        const uint32_t *cut = &rows->cut[k * bodies->cuts];
        if (cut[from] < cut[to])
            part(of, cut[from], cut[to]);
    }
}

typedef struct {
    const fp3_bodies *bodies;
    const fp3_law_rows *rows;
    void (*part)(void *of, uint32_t from, uint32_t to);
    void *of;
} cut_rows;

static void do_rows(void *of, uint32_t from, uint32_t to) {
    const cut_rows *all = of;
    fp3_rows_of(all->bodies, all->rows, from, to, all->part, all->of);
}

void fp3_bodies_share_rows(const fp3_bodies *bodies, const fp3_law_rows *rows,
                           void (*part)(void *of, uint32_t from, uint32_t to), void *of) {
    cut_rows all = {bodies, rows, part, of};
    const uint32_t parts = fp3_threads_parts(bodies->crew, rows->count, FP3_LEAST_PAIRS);
    fp3_threads_share(bodies->crew, (fp3_lap){do_rows, &all, 0, bodies->cuts, parts});
}
