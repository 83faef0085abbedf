/* SPDX-License-Identifier: Apache-2.0 */
/* contacts.c - the rows of contacts. */
#include "own.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

static fp3_contact2_row *row_of(const fp3_bodies *bodies, uint32_t i) {
    return (fp3_contact2_row *)bodies->contacts.row + bodies->contacts.lane[i] / FP3_WIDE;
}

typedef struct {
    fp3_bodies *bodies;
    atomic_int is_same, may_bounce;
} laying;

static void lay_some(void *of, uint32_t from, uint32_t to) {
    laying *all = of;
    fp3_bodies *bodies = all->bodies;
    fp3_law_rows *rows = &bodies->contacts;
    int is_same = 1, may_bounce = 0;
    for (uint32_t i = from; i < to; i++) {
        const fp3_touch2 *t = &bodies->touch[rows->of[i]];
        is_same &=
            fp3_rows_put(rows, i, fp3_slot_of(bodies, t->body_a), fp3_slot_of(bodies, t->body_b));
        may_bounce |= t->is_bouncy;
    }
    if (!is_same)
        atomic_store(&all->is_same, 0);
    if (may_bounce)
        atomic_store(&all->may_bounce, 1);
}

static fp3_status lay(fp3_bodies *bodies) {
    fp3_law_rows *rows = &bodies->contacts;
    const fp3_status status = fp3_rows_make_room(bodies, rows, rows->count);
    if (status)
        return status;
    laying all = {bodies, 1, 0};
    fp3_bodies_share(bodies, lay_some, &all, rows->count, FP3_LEAST_PAIRS);
    rows->is_whole = 1;
    rows->is_same = all.is_same;
    bodies->may_bounce = all.may_bounce;
    return fp3_rows_lay(bodies, rows, rows->a, rows->b, sizeof(fp3_contact2_row));
}

static fp3_work2 work_of(const fp3_bodies *bodies) {
    return (fp3_work2){bodies->speed,   bodies->way,          NULL,
                       bodies->movable, bodies->contacts.row, bodies->contacts.ends};
}

/* What their rows are made of; h: of a substep. */
static fp3_making2 making_of(const fp3_bodies *bodies, double h) {
    return (fp3_making2){bodies->touch,
                         bodies->contacts.of,
                         bodies->contacts.at,
                         bodies->heft,
                         {fp3_contact_softness(bodies, h, 1), fp3_contact_softness(bodies, h, 2)}};
}

typedef struct {
    fp3_work2 work;
    fp3_making2 making;
    void (*make)(const fp3_work2 *, const fp3_making2 *, uint32_t first, uint32_t end);
} making;

static void make_some(void *of, uint32_t from, uint32_t to) {
    const making *all = of;
    all->make(&all->work, &all->making, from, to);
}

/* prepare or keep, over all rows. */
static void make(const fp3_bodies *bodies,
                 void (*prepare)(const fp3_work2 *, const fp3_making2 *, uint32_t, uint32_t),
                 double h) {
    making all = {work_of(bodies), making_of(bodies, h), prepare};
    fp3_bodies_share_rows(bodies, &bodies->contacts, make_some, &all);
}

fp3_status fp3_contacts_begin(fp3_bodies *bodies, double h) {
    fp3_status status = lay(bodies);
    if (!status && !bodies->contacts.is_cut)
        fp3_cut_by_contacts(bodies, &bodies->contacts);
    if (!status)
        status = fp3_cut_rows(bodies, &bodies->contacts);
    if (status)
        return status;
    make(bodies, bodies->solver->prepare, h);
    return FP3_OK;
}

/* Farther than anything comes in a step. */
#define FAR 1e9f

void fp3_contact_leave(fp3_bodies *bodies, uint32_t i, uint32_t point) {
    fp3_contact2_row *row = row_of(bodies, i);
    fp3_wide *const words[2][3] = {{&row->gap1, &row->p1, &row->f1},
                                   {&row->gap2, &row->p2, &row->f2}};
    const uint32_t lane = bodies->contacts.lane[i] % FP3_WIDE;
    fp3_put(words[point][0], lane, FAR);
    fp3_put(words[point][1], lane, 0);
    fp3_put(words[point][2], lane, 0);
}

/* The way of a body along the normal at an arm. */
static float way_of(fp3_four way, float along, const fp3_point2 *n) {
    return way[0] * n->x + way[1] * n->y + way[2] * along;
}

void fp3_contacts_follow(fp3_bodies *bodies) {
    for (uint32_t i = 0; i < bodies->contacts.count; i++) {
        const fp3_touch2 *t = &bodies->touch[bodies->contacts.of[i]];
        const uint32_t lane = bodies->contacts.lane[i] % FP3_WIDE;
        const fp3_ends2 *ends = &bodies->contacts.ends[bodies->contacts.lane[i] / FP3_WIDE];
        const fp3_four a = bodies->way[ends->a[lane]], b = bodies->way[ends->b[lane]];
        fp3_contact2_row *row = row_of(bodies, i);
        row->gap1[lane] +=
            way_of(b, row->b1[lane], &t->m.normal) - way_of(a, row->a1[lane], &t->m.normal);
        row->gap2[lane] +=
            way_of(b, row->b2[lane], &t->m.normal) - way_of(a, row->a2[lane], &t->m.normal);
    }
}

void fp3_contacts_end(fp3_bodies *bodies, double h) { make(bodies, bodies->solver->keep, h); }
