/* SPDX-License-Identifier: Apache-2.0 */
/* contacts3.c - the rows of contacts in space. */
#include "own3.h"

#include <math.h>
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

/* The patches of all touches that push. */
static fp3_status choose(fp3_bodies *bodies) {
    fp3_space *s = bodies->space;
    fp3_law_rows *rows = &s->contacts;
    fp3_status status = fp3_bodies_room((void **)&rows->of, &rows->of_room, sizeof *rows->of,
                                        s->patch_count + 1u, bodies->error);
    if (!status)
        status = fp3_rows_make_room(bodies, rows, s->patch_count);
    rows->count = 0;
    rows->is_whole = rows->is_same = 1;
    bodies->may_bounce = s->has_turned = s->is_rolling = s->has_belts = 0;
    for (uint32_t i = 0; !status && i < bodies->contacts.count; i++) {
        const fp3_touch2 *t = &bodies->touch[bodies->contacts.of[i]];
        const uint32_t a = fp3_slot_of(bodies, t->body_a), b = fp3_slot_of(bodies, t->body_b);
        for (uint32_t k = t->first_patch; k < t->first_patch + t->patches; k++) {
            if (!s->patch[k].m.count)
                continue;
            s->patch[k].touch = bodies->contacts.of[i];
            rows->of[rows->count] = k;
            rows->is_same &= fp3_rows_put(rows, rows->count++, a, b);
        }
        bodies->may_bounce |= t->is_bouncy;
        s->is_rolling |= t->rolling > 0;
        s->has_belts |= t->has_belt;
    }
    return status;
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

fp3_status fp3_space_contacts_begin(fp3_bodies *bodies, double h) {
    fp3_space *s = bodies->space;
    fp3_law_rows *rows = &s->contacts;
    fp3_status status = choose(bodies);
    if (!status)
        status = fp3_rows_lay(bodies, rows, rows->a, rows->b, sizeof(fp3_contact3_row));
    if (status)
        return status;
    status = fp3_bodies_room((void **)&s->points, &s->points_room, sizeof *s->points,
                             rows->blocks + 1u, bodies->error);
    if (status)
        return status;
    const fp3_work2 work = work_of(bodies);
    s->making = making_of(bodies, h);
    s->solver->prepare(&work, &s->making, 0, rows->blocks);
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

void fp3_space_contacts_turn(fp3_bodies *bodies) {
    fp3_space *s = bodies->space;
    s->has_turned = 0;
    for (uint32_t k = 0; k < bodies->movable; k++)
        s->has_turned |= has_turned(bodies, k);
    for (uint32_t i = 0; s->has_turned && i < s->contacts.blocks; i++) {
        const fp3_ends2 *ends = &s->contacts.ends[i];
        float has = 0;
        for (int lane = 0; lane < FP3_WIDE; lane++)
            has += bodies->heft[2 * ends->a[lane] + 1][3] + bodies->heft[2 * ends->b[lane] + 1][3];
        if (has > 0)
            s->points[i] |= FP3_HAS_TURNED;
    }
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

void fp3_space_contacts_end(fp3_bodies *bodies) {
    const fp3_space *s = bodies->space;
    const fp3_work2 work = work_of(bodies);
    s->solver->keep(&work, &s->making, 0, s->contacts.blocks);
    for (uint32_t i = 0; i < bodies->contacts.count; i++) {
        fp3_touch2 *t = &bodies->touch[bodies->contacts.of[i]];
        for (uint32_t k = t->first_patch; k < t->first_patch + t->patches; k++)
            t->top += s->patch[k].top;
    }
}
