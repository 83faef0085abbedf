/* SPDX-License-Identifier: Apache-2.0 */
/* contacts3.c - the rows of contacts in space. */
#include "own3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* As in a plane (contacts.c). */
#define STIFFNESS 30.0 /* Hz, at most */
#define RESOLVED 0.25
#define DAMPING 10.0 /* of critical damping */

static fp3_contact3_row *row_of(const fp3_space *s, uint32_t i) {
    return (fp3_contact3_row *)s->contacts.row + s->contacts.lane[i] / FP3_WIDE;
}

/* A tangent that hardly turns while the normal hardly does: square to the axis on which the normal
 * is smallest. */
static fp3_point3 tangent_of(fp3_point3 n) {
    const float x = fabsf(n.x), y = fabsf(n.y), z = fabsf(n.z);
    const fp3_point3 axis = x <= y && x <= z ? (fp3_point3){1, 0, 0}
                            : y <= z         ? (fp3_point3){0, 1, 0}
                                             : (fp3_point3){0, 0, 1};
    const fp3_point3 d = fp3_cross3(n, axis);
    return fp3_times3(1 / fp3_size3(d), d);
}

#define PUT3(row, name, lane, p)                                                                   \
    do {                                                                                           \
        fp3_put(&(row)->name##_x, lane, (p).x);                                                    \
        fp3_put(&(row)->name##_y, lane, (p).y);                                                    \
        fp3_put(&(row)->name##_z, lane, (p).z);                                                    \
    } while (0)

/* Masses and inertias of both; what nothing can push has neither. */
#define PUT_BODY(row, x, lane, bodies, number)                                                     \
    do {                                                                                           \
        const float *back = (bodies)->space->body[number].back;                                    \
        const int turns = (bodies)->space->body[number].moment[0] > 0;                             \
        fp3_put(&(row)->m##x, lane, fp3_inverse_mass((bodies)->body[number].mass));                \
        PUT3(row, i##x, lane, turns ? fp3_point3_of(back) : nothing);                              \
        PUT3(row, o##x, lane, turns ? fp3_point3_of(back + 3) : nothing);                          \
    } while (0)

static fp3_point3 middle_of(const fp3_manifold3 *m) {
    fp3_point3 sum = m->point[0].arm;
    for (uint32_t k = 1; k < m->count; k++)
        sum = fp3_add3(sum, m->point[k].arm);
    return fp3_times3(1 / (float)m->count, sum);
}

static float distance_of(const fp3_manifold3 *m, fp3_point3 middle) {
    float sum = 0;
    for (uint32_t k = 0; k < m->count; k++)
        sum += fp3_size3(fp3_subtract3(m->point[k].arm, middle));
    return sum / (float)m->count;
}

static void fill_points(const fp3_patch3 *p, fp3_contact3_row *row, uint32_t lane) {
    for (uint32_t k = 0; k < p->m.count; k++) {
        fp3_contact3_point *to = &row->point[k];
        PUT3(to, a, lane, fp3_arm_a3(p, p->m.point[k].arm, p->m.point[k].gap));
        PUT3(to, b, lane, fp3_arm_b3(p, p->m.point[k].arm, p->m.point[k].gap));
        fp3_put(&to->gap, lane, p->m.point[k].gap);
        fp3_put(&to->j, lane, 1);
        fp3_put(&to->p, lane, p->p[k]);
    }
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

static void fill_friction(fp3_bodies *bodies, const fp3_patch3 *p, fp3_contact3_row *row,
                          uint32_t lane) {
    const fp3_attached *a = &bodies->shape[p->a], *b = &bodies->shape[p->b];
    const fp3_point3 middle = middle_of(&p->m), n = p->m.normal, d = tangent_of(n),
                     s = fp3_cross3(n, d), f = fp3_point3_of(p->f), l = fp3_point3_of(p->roll);
    const fp3_point3 belt = fp3_space_belt(bodies, a, b);
    float gap = 0;
    for (uint32_t k = 0; k < p->m.count; k++)
        gap += p->m.point[k].gap / (float)p->m.count;
    PUT3(row, d, lane, d);
    PUT3(row, c, lane, fp3_arm_a3(p, middle, gap));
    PUT3(row, e, lane, fp3_arm_b3(p, middle, gap));
    fp3_put(&row->s1, lane, fp3_dot3(belt, d));
    fp3_put(&row->s2, lane, fp3_dot3(belt, s));
    fp3_put(&row->mu, lane, sqrtf(a->friction * b->friction));
    fp3_put(&row->radius, lane, distance_of(&p->m, middle));
    fp3_put(&row->total, lane, (p->p[0] + p->p[1]) + (p->p[2] + p->p[3]));
    fp3_put(&row->f1, lane, fp3_dot3(f, d));
    fp3_put(&row->f2, lane, fp3_dot3(f, s));
    fp3_put(&row->ft, lane, p->twist);
    fp3_put(&row->reach, lane, a->rolling > b->rolling ? a->rolling : b->rolling);
    PUT3(row, l, lane, fp3_along3(l, -fp3_dot3(l, n), n));
    bodies->space->is_rolling |= a->rolling > 0 || b->rolling > 0;
    bodies->may_bounce |= a->restitution > 0 || b->restitution > 0;
}

static void fill(fp3_bodies *bodies, uint32_t i, const fp3_softness *softness) {
    static const fp3_point3 nothing = {0, 0, 0};
    fp3_space *space = bodies->space;
    const fp3_patch3 *p = &space->patch[space->contacts.of[i]];
    const fp3_attached *a = &bodies->shape[p->a], *b = &bodies->shape[p->b];
    const int is_against_ground = fp3_slot_of(bodies, a->body) >= bodies->movable ||
                                  fp3_slot_of(bodies, b->body) >= bodies->movable;
    const uint32_t lane = space->contacts.lane[i] % FP3_WIDE;
    fp3_contact3_row *row = row_of(space, i);
    PUT_BODY(row, a, lane, bodies, a->body);
    PUT_BODY(row, b, lane, bodies, b->body);
    PUT3(row, n, lane, p->m.normal);
    fp3_put(&row->ra, lane, a->form->shape.radius);
    fp3_put(&row->rb, lane, b->form->shape.radius);
    fp3_put(&row->rate, lane, softness[is_against_ground].rate);
    fp3_put(&row->soft, lane, softness[is_against_ground].soft);
    fp3_put(&row->fade, lane, softness[is_against_ground].fade);
    fill_points(p, row, lane);
    fill_friction(bodies, p, row, lane);
}

/* The patches of all touches that push. */
static fp3_status choose(fp3_bodies *bodies) {
    fp3_space *s = bodies->space;
    s->contacts.count = 0;
    const fp3_status status =
        fp3_bodies_room((void **)&s->contacts.of, &s->contacts.of_room, sizeof *s->contacts.of,
                        s->patch_count + 1u, bodies->error);
    for (uint32_t i = 0; !status && i < bodies->contacts.count; i++) {
        const fp3_touch2 *t = &bodies->touch[bodies->contacts.of[i]];
        for (uint32_t k = t->first_patch; k < t->first_patch + t->patches; k++)
            if (s->patch[k].m.count) {
                s->patch[k].touch = bodies->contacts.of[i];
                s->contacts.of[s->contacts.count++] = k;
            }
    }
    return status;
}

static fp3_status lay(fp3_bodies *bodies) {
    fp3_space *s = bodies->space;
    const uint32_t count = s->contacts.count;
    uint32_t *ends = NULL, room = 0;
    fp3_status status =
        fp3_bodies_room((void **)&ends, &room, 2 * sizeof *ends, count + 1u, bodies->error);
    for (uint32_t i = 0; !status && i < count; i++) {
        const fp3_patch3 *p = &s->patch[s->contacts.of[i]];
        ends[i] = fp3_slot_of(bodies, bodies->shape[p->a].body);
        ends[count + i] = fp3_slot_of(bodies, bodies->shape[p->b].body);
    }
    if (!status)
        status = fp3_rows_lay(bodies, &s->contacts, ends, ends + count, sizeof(fp3_contact3_row));
    free(ends);
    return status;
}

fp3_status fp3_space_contacts_begin(fp3_bodies *bodies, double h) {
    fp3_space *s = bodies->space;
    fp3_status status = choose(bodies);
    if (!status)
        status = lay(bodies);
    if (!status)
        status = fp3_bodies_room((void **)&s->points, &s->points_room, sizeof *s->points,
                                 s->contacts.count + 64u, bodies->error);
    if (status)
        return status;
    const double hertz = fmin(STIFFNESS, RESOLVED / h);
    const fp3_softness softness[2] = {fp3_soften(hertz, DAMPING, h),
                                      fp3_soften(2 * hertz, DAMPING, h)};
    bodies->may_bounce = s->is_rolling = 0;
    for (uint32_t i = 0; i < s->contacts.count; i++)
        fill(bodies, i, softness);
    const fp3_law_rows *rows = &s->contacts;
    const fp3_work2 work = {bodies->speed,   bodies->way, NULL,
                            bodies->movable, rows->row,   rows->ends};
    const uint32_t blocks = rows->colours.first[rows->colours.count];
    for (uint32_t i = 0; i < blocks; i++)
        s->points[i] = (uint8_t)fp3_points_of3((const fp3_contact3_row *)rows->row + i);
    s->solver->prepare(&work, 0, blocks);
    return FP3_OK;
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

static int is_finite(const fp3_patch3 *p) {
    float sum = p->twist + p->top;
    for (int k = 0; k < 4; k++)
        sum += p->p[k];
    for (int k = 0; k < 3; k++)
        sum += p->f[k] + p->roll[k];
    return isfinite(sum);
}

void fp3_space_contacts_end(fp3_bodies *bodies) {
    fp3_space *s = bodies->space;
    for (uint32_t i = 0; i < s->contacts.count; i++) {
        fp3_patch3 *p = &s->patch[s->contacts.of[i]];
        const fp3_contact3_row *row = row_of(s, i);
        const uint32_t lane = s->contacts.lane[i] % FP3_WIDE;
        const fp3_point3 n = p->m.normal, d = {row->d_x[lane], row->d_y[lane], row->d_z[lane]};
        const fp3_point3 f =
            fp3_along3(fp3_times3(row->f1[lane], d), row->f2[lane], fp3_cross3(n, d));
        p->top = 0;
        for (uint32_t k = 0; k < p->m.count; k++) {
            p->p[k] = row->point[k].p[lane];
            p->top += row->point[k].top[lane];
        }
        p->twist = row->ft[lane];
        memcpy(p->f, &f, sizeof p->f);
        p->roll[0] = row->l_x[lane];
        p->roll[1] = row->l_y[lane];
        p->roll[2] = row->l_z[lane];
        if (!is_finite(p)) { /* else it would never heal */
            memset(p->p, 0, sizeof p->p);
            memset(p->f, 0, sizeof p->f);
            memset(p->roll, 0, sizeof p->roll);
            p->twist = p->top = 0;
        }
    }
    for (uint32_t i = 0; i < bodies->contacts.count; i++) {
        fp3_touch2 *t = &bodies->touch[bodies->contacts.of[i]];
        for (uint32_t k = t->first_patch; k < t->first_patch + t->patches; k++)
            t->top += s->patch[k].top;
    }
}
