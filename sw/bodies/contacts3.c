/* SPDX-License-Identifier: Apache-2.0 */
/* contacts3.c - the rows of contacts in space. */
#include "own3.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

static fp3_contact3_row *row_of(const fp3_space *s, uint32_t i) {
    return (fp3_contact3_row *)s->contacts.row + s->contacts.lane[i] / FP3_WIDE;
}

/* Of a surface that moves, as its body has it, in the world. */
static fp3_point3 surface_of(const fp3_bodies *bodies, const fp3_attached *shape) {
    const float *c = bodies->body[shape->body].centre, *v = shape->surface;
    const float from_centre[3] = {c[0] + v[0], c[1] + v[1], c[2] + v[2]};
    double way[3] = {0, 0, 0};
    if (v[0] != 0 || v[1] != 0 || v[2] != 0)
        fp3_space_arm(bodies, shape->body, from_centre, way);
    return (fp3_point3){(float)way[0], (float)way[1], (float)way[2]};
}

fp3_point3 fp3_space_belt(const fp3_bodies *bodies, const fp3_attached *a, const fp3_attached *b) {
    return fp3_subtract3(surface_of(bodies, a), surface_of(bodies, b));
}

/* Speeds of surfaces that move. */
static void put_belts(fp3_bodies *bodies) {
    const fp3_space *s = bodies->space;
    for (uint32_t i = 0; i < s->contacts.count; i++) {
        const fp3_patch3 *p = &s->patch[s->contacts.of[i]];
        if (!bodies->touch[p->touch].has_belt)
            continue;
        fp3_contact3_row *row = row_of(s, i);
        const uint32_t lane = s->contacts.lane[i] % FP3_WIDE;
        const fp3_point3 n = p->m.normal, d = {row->d_x[lane], row->d_y[lane], row->d_z[lane]},
                         belt = fp3_space_belt(bodies, &bodies->shape[p->a], &bodies->shape[p->b]);
        fp3_put(&row->s1, lane, fp3_dot3(belt, d));
        fp3_put(&row->s2, lane, fp3_dot3(belt, fp3_cross3(n, d)));
    }
}

/* Of touches that push, by ranges of them: which patches have rows. */
#define CHUNKS 64
typedef struct {
    fp3_bodies *bodies;
    uint32_t first[CHUNKS + 1]; /* of each range; what is before the end of the last one */
    int is_alone;               /* one thread: a range begins where the one before has ended */
    atomic_int is_same, may_bounce, is_rolling, has_belts;
} choosing;

static uint32_t chunk_of(const fp3_bodies *bodies, uint32_t chunk) {
    return (uint32_t)((uint64_t)bodies->contacts.count * chunk / CHUNKS);
}

static void count_some(void *of, uint32_t from, uint32_t to) {
    choosing *all = of;
    const fp3_bodies *bodies = all->bodies;
    for (uint32_t chunk = from; chunk < to; chunk++) {
        uint32_t count = 0;
        for (uint32_t i = chunk_of(bodies, chunk); i < chunk_of(bodies, chunk + 1); i++) {
            const fp3_touch2 *t = &bodies->touch[bodies->contacts.of[i]];
            const fp3_patch3 *p = &bodies->space->patch[t->first_patch];
            for (uint32_t k = 0; k < t->patches; k++) /* a touch that pushes has one at least */
                count += t->patches == 1 || p[k].m.count > 0;
        }
        all->first[chunk + 1] = count;
    }
}

static void choose_some(void *of, uint32_t from, uint32_t to) {
    choosing *all = of;
    fp3_bodies *bodies = all->bodies;
    fp3_space *s = bodies->space;
    fp3_law_rows *rows = &s->contacts;
    int is_same = 1, may_bounce = 0, is_rolling = 0, has_belts = 0;
    uint32_t next = all->first[from];
    for (uint32_t i = chunk_of(bodies, from); i < chunk_of(bodies, to); i++) {
        const fp3_touch2 *t = &bodies->touch[bodies->contacts.of[i]];
        const uint32_t a = fp3_slot_of(bodies, t->body_a), b = fp3_slot_of(bodies, t->body_b);
        for (uint32_t k = t->first_patch; k < t->first_patch + t->patches; k++) {
            if (!s->patch[k].m.count)
                continue;
            s->patch[k].touch = bodies->contacts.of[i];
            rows->of[next] = k;
            is_same &= fp3_rows_put(rows, next++, a, b);
        }
        may_bounce |= t->is_bouncy;
        is_rolling |= t->rolling > 0;
        has_belts |= t->has_belt;
    }
    if (all->is_alone)
        all->first[CHUNKS] = next;
    atomic_fetch_and(&all->is_same, is_same);
    atomic_fetch_or(&all->may_bounce, may_bounce);
    atomic_fetch_or(&all->is_rolling, is_rolling);
    atomic_fetch_or(&all->has_belts, has_belts);
}

/* The patches of all touches that push. */
static fp3_status choose(fp3_bodies *bodies) {
    fp3_space *s = bodies->space;
    fp3_law_rows *rows = &s->contacts;
    fp3_status status = fp3_bodies_room((void **)&rows->of, &rows->of_room, sizeof *rows->of,
                                        s->patch_count + 1u, bodies->error);
    if (!status)
        status = fp3_rows_make_room(bodies, rows, s->patch_count);
    if (status)
        return status;
    const uint32_t parts = fp3_threads_parts(bodies->crew, bodies->contacts.count, FP3_LEAST_PAIRS);
    choosing all = {.bodies = bodies, .is_alone = parts == 1, .is_same = 1};
    if (!all.is_alone)
        fp3_threads_share(bodies->crew, (fp3_lap){count_some, &all, 0, CHUNKS, parts});
    for (uint32_t chunk = 0; chunk < CHUNKS; chunk++)
        all.first[chunk + 1] += all.first[chunk];
    fp3_threads_share(bodies->crew, (fp3_lap){choose_some, &all, 0, CHUNKS, parts});
    rows->count = all.first[CHUNKS];
    rows->is_whole = 1;
    rows->is_same = all.is_same;
    bodies->may_bounce = all.may_bounce;
    s->is_rolling = all.is_rolling;
    s->has_belts = all.has_belts;
    return FP3_OK;
}

static fp3_work2 work_of(const fp3_bodies *bodies) {
    const fp3_law_rows *rows = &bodies->space->contacts;
    return (fp3_work2){bodies->speed, bodies->way, NULL, bodies->movable, rows->row, rows->ends};
}

static fp3_making3 making_of(const fp3_bodies *bodies, double h) {
    const fp3_space *s = bodies->space;
    return (fp3_making3){s->patch,
                         s->contacts.of,
                         s->contacts.at,
                         bodies->heft,
                         {fp3_contact_softness(bodies, h, 1), fp3_contact_softness(bodies, h, 2)},
                         s->points};
}

typedef struct {
    fp3_work2 work;
    const fp3_making3 *making;
    void (*make)(const fp3_work2 *, const fp3_making3 *, uint32_t first, uint32_t end);
} making;

static void make_some(void *of, uint32_t from, uint32_t to) {
    const making *all = of;
    all->make(&all->work, all->making, from, to);
}

/* prepare or keep, over all rows. */
static void make(const fp3_bodies *bodies,
                 void (*prepare)(const fp3_work2 *, const fp3_making3 *, uint32_t, uint32_t)) {
    making all = {work_of(bodies), &bodies->space->making, prepare};
    fp3_bodies_share_rows(bodies, &bodies->space->contacts, make_some, &all);
}

fp3_status fp3_space_contacts_begin(fp3_bodies *bodies, double h) {
    fp3_space *s = bodies->space;
    fp3_law_rows *rows = &s->contacts;
    fp3_status status = choose(bodies);
    if (!status)
        status = fp3_rows_lay(bodies, rows, rows->a, rows->b, sizeof(fp3_contact3_row));
    if (!status && !rows->is_cut)
        fp3_cut_by_contacts(bodies, rows);
    if (!status)
        status = fp3_cut_rows(bodies, rows);
    if (status)
        return status;
    status = fp3_bodies_room((void **)&s->points, &s->points_room, sizeof *s->points,
                             rows->blocks + 1u, bodies->error);
    if (status)
        return status;
    s->making = making_of(bodies, h);
    make(bodies, s->solver->prepare);
    if (s->has_belts)
        put_belts(bodies);
    return FP3_OK;
}

/* A body that has turned by t rad in this step, and whose moments of inertia are as 1 to r, may
 * answer an impulse by 1 + r t^2 times what its row says: a thin rod that falls flat would be
 * thrown. */
#define TURNED 0.02f

/* Whether it has; then its heft is as it is turned, and the last number of it is 1. */
static int has_turned(fp3_bodies *bodies, uint32_t slot) {
    const fp3_four q = bodies->way[2 * slot + 1];
    fp3_four *heft = &bodies->heft[2 * slot];
    const uint32_t number = bodies->in_slot[slot];
    const float *m = bodies->space->body[number].moment;
    const float least = fminf(fminf(m[0], m[1]), m[2]), most = fmaxf(fmaxf(m[0], m[1]), m[2]);
    const float turned = 4 * ((q[0] * q[0] + q[1] * q[1]) + q[2] * q[2]);
    float i[6];
    if (!(least > 0) || (heft[1][3] == 0 && !(turned * most > TURNED * least)))
        return 0;
    fp3_space_back(bodies, number, 1, i);
    heft[0] = (fp3_four){heft[0][0], i[0], i[1], i[2]};
    heft[1] = (fp3_four){i[3], i[4], i[5], 1};
    return 1;
}

/* Several threads may find one. */
void fp3_space_find_turned(fp3_bodies *bodies, uint32_t first, uint32_t end) {
    int has = 0;
    for (uint32_t k = first; k < end; k++)
        has |= has_turned(bodies, k);
    if (has)
        __atomic_store_n(&bodies->has_turned, 1, __ATOMIC_RELAXED);
}

#define FAR 1e9f /* farther than anything comes in a step */

void fp3_space_contact_leave(fp3_bodies *bodies, uint32_t i, uint32_t point) {
    fp3_contact3_row *row = row_of(bodies->space, i);
    const uint32_t lane = bodies->space->contacts.lane[i] % FP3_WIDE;
    row->total[lane] -= row->point[point].p[lane];
    row->point[point].p[lane] = 0;
    row->point[point].gap[lane] = FAR;
    fp3_wide *const words[] = {&row->f1, &row->f2, &row->ft, &row->l_x, &row->l_y, &row->l_z};
    for (size_t k = 0; k < sizeof words / sizeof *words; k++)
        fp3_put(words[k], lane, 0);
}

/* The way of a point of a body along n. */
static float way_of(const fp3_bodies *bodies, uint32_t slot, fp3_point3 arm, fp3_point3 n) {
    const fp3_four d = bodies->way[2 * slot];
    const fp3_point3 way = {d[0], d[1], d[2]}, turn = fp3_turn_of_way(&bodies->way[2 * slot]);
    return fp3_dot3(way, n) + fp3_dot3(turn, fp3_cross3(arm, n));
}

void fp3_space_contacts_follow(fp3_bodies *bodies) {
    const fp3_space *s = bodies->space;
    for (uint32_t i = 0; i < s->contacts.count; i++) {
        const fp3_patch3 *p = &s->patch[s->contacts.of[i]];
        const uint32_t lane = s->contacts.lane[i] % FP3_WIDE;
        const fp3_ends2 *ends = &s->contacts.ends[s->contacts.lane[i] / FP3_WIDE];
        fp3_contact3_row *row = row_of(s, i);
        for (uint32_t k = 0; k < p->m.count; k++) {
            const fp3_point3 arm = p->m.point[k].arm, n = p->m.normal;
            row->point[k].gap[lane] +=
                way_of(bodies, ends->b[lane], fp3_subtract3(arm, p->from), n) -
                way_of(bodies, ends->a[lane], arm, n);
        }
    }
}

static void sum_tops(void *of, uint32_t from, uint32_t to) {
    const fp3_bodies *bodies = of;
    for (uint32_t i = from; i < to; i++) {
        fp3_touch2 *t = &bodies->touch[bodies->contacts.of[i]];
        for (uint32_t k = t->first_patch; k < t->first_patch + t->patches; k++)
            t->top += bodies->space->patch[k].top;
    }
}

void fp3_space_contacts_end(fp3_bodies *bodies) {
    make(bodies, bodies->space->solver->keep);
    fp3_bodies_share(bodies, sum_tops, bodies, bodies->contacts.count, FP3_LEAST_PAIRS);
}
