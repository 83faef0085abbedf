/* SPDX-License-Identifier: Apache-2.0 */
/* contacts.c - the rows of contacts. */
#include "own.h"

#include <math.h>
#include <stdlib.h>

/* Contacts are springs and dampers that a substep can resolve (docs/bodies.md): no stiffer than
 * this share of the substeps' rate, in turns of the spring. */
#define STIFFNESS 30.0 /* Hz, at most */
#define RESOLVED 0.25
#define DAMPING 10.0 /* of critical damping */

static fp3_contact2_row *row_of(const fp3_bodies *bodies, uint32_t i) {
    return (fp3_contact2_row *)bodies->contacts.row + bodies->contacts.lane[i] / FP3_WIDE;
}

static void fill(fp3_bodies *bodies, uint32_t i, const fp3_softness *softness) {
    const fp3_touch2 *t = &bodies->touch[bodies->contacts.of[i]];
    const fp3_attached *a = &bodies->shape[t->a], *b = &bodies->shape[t->b];
    const fp3_body *x = &bodies->body[a->body], *y = &bodies->body[b->body];
    const float from_x = (float)(y->at[0] - x->at[0]), from_y = (float)(y->at[1] - x->at[1]);
    const int is_against_ground = fp3_slot_of(bodies, a->body) >= bodies->movable ||
                                  fp3_slot_of(bodies, b->body) >= bodies->movable;
    const uint32_t lane = bodies->contacts.lane[i] % FP3_WIDE;
    fp3_contact2_row *row = row_of(bodies, i);
    fp3_put(&row->ma, lane, fp3_inverse_mass(x->mass));
    fp3_put(&row->ia, lane, fp3_inverse_mass(x->inertia));
    fp3_put(&row->mb, lane, fp3_inverse_mass(y->mass));
    fp3_put(&row->ib, lane, fp3_inverse_mass(y->inertia));
    fp3_put(&row->n_x, lane, t->m.normal.x);
    fp3_put(&row->n_y, lane, t->m.normal.y);
    const int second = t->m.count == 2;
    const fp3_point2 arm1 = t->m.point[0].arm, arm2 = t->m.point[second].arm;
    fp3_put(&row->a1, lane, arm1.x);
    fp3_put(&row->c1, lane, arm1.y);
    fp3_put(&row->b1, lane, arm1.x - from_x);
    fp3_put(&row->e1, lane, arm1.y - from_y);
    fp3_put(&row->gap1, lane, t->m.point[0].gap);
    fp3_put(&row->j1, lane, 1);
    fp3_put(&row->a2, lane, arm2.x);
    fp3_put(&row->c2, lane, arm2.y);
    fp3_put(&row->b2, lane, arm2.x - from_x);
    fp3_put(&row->e2, lane, arm2.y - from_y);
    fp3_put(&row->gap2, lane, t->m.point[second].gap);
    fp3_put(&row->j2, lane, (float)second);
    fp3_put(&row->ra, lane, a->shape.radius);
    fp3_put(&row->rb, lane, b->shape.radius);
    fp3_put(&row->mu, lane, sqrtf(a->friction * b->friction));
    fp3_put(&row->belt, lane, a->belt + b->belt);
    fp3_put(&row->reach, lane, a->rolling > b->rolling ? a->rolling : b->rolling);
    fp3_put(&row->rate, lane, softness[is_against_ground].rate);
    fp3_put(&row->soft, lane, softness[is_against_ground].soft);
    fp3_put(&row->fade, lane, softness[is_against_ground].fade);
    fp3_put(&row->p1, lane, t->p[0]);
    fp3_put(&row->f1, lane, t->f[0]);
    fp3_put(&row->p2, lane, t->p[1]);
    fp3_put(&row->f2, lane, t->f[1]);
    fp3_put(&row->r, lane, t->r);
    fp3_put(&row->top1, lane, 0);
    fp3_put(&row->top2, lane, 0);
    bodies->may_bounce |= a->restitution > 0 || b->restitution > 0;
}

static fp3_status lay(fp3_bodies *bodies) {
    const uint32_t count = bodies->contacts.count;
    uint32_t *ends = NULL, room = 0;
    fp3_status status =
        fp3_bodies_room((void **)&ends, &room, 2 * sizeof *ends, count + 1u, bodies->error);
    for (uint32_t i = 0; !status && i < count; i++) {
        const fp3_touch2 *t = &bodies->touch[bodies->contacts.of[i]];
        ends[i] = fp3_slot_of(bodies, bodies->shape[t->a].body);
        ends[count + i] = fp3_slot_of(bodies, bodies->shape[t->b].body);
    }
    if (!status)
        status =
            fp3_rows_lay(bodies, &bodies->contacts, ends, ends + count, sizeof(fp3_contact2_row));
    free(ends);
    return status;
}

fp3_status fp3_contacts_begin(fp3_bodies *bodies, double h) {
    const fp3_status status = lay(bodies);
    if (status)
        return status;
    const double hertz = fmin(STIFFNESS, RESOLVED / h);
    const fp3_softness softness[2] = {fp3_soften(hertz, DAMPING, h),
                                      fp3_soften(2 * hertz, DAMPING, h)};
    bodies->may_bounce = 0;
    for (uint32_t i = 0; i < bodies->contacts.count; i++)
        fill(bodies, i, softness);
    const fp3_law_rows *rows = &bodies->contacts;
    const fp3_work2 work = {bodies->speed,   bodies->way, NULL,
                            bodies->movable, rows->row,   rows->ends};
    bodies->solver->prepare(&work, 0, rows->colours.first[rows->colours.count]);
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

void fp3_contacts_end(fp3_bodies *bodies) {
    for (uint32_t i = 0; i < bodies->contacts.count; i++) {
        fp3_touch2 *t = &bodies->touch[bodies->contacts.of[i]];
        const fp3_contact2_row *row = row_of(bodies, i);
        const uint32_t lane = bodies->contacts.lane[i] % FP3_WIDE;
        t->p[0] = row->p1[lane];
        t->f[0] = row->f1[lane];
        t->p[1] = row->p2[lane];
        t->f[1] = row->f2[lane];
        t->r = row->r[lane];
        t->top += row->top1[lane] + row->top2[lane];
        if (!isfinite(t->p[0] + t->f[0] + t->p[1] + t->f[1] + t->r)) /* else it would never heal */
            t->p[0] = t->f[0] = t->p[1] = t->f[1] = t->r = 0;
    }
}
