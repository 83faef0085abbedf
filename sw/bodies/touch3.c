/* SPDX-License-Identifier: Apache-2.0 */
/* touch3.c - which shapes touch in space: boxes and manifolds. */
#include "lanes.h"
#include "own3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* As in a plane (touch.c), shapes that have moved and turned less than this are not looked at
 * again. Here it is more: a manifold in space costs more, and arms that do not follow a lean of
 * less than this keep a high wall from buckling on its soft contacts (docs/bodies.md). */
#define STILL_WAY 1e-2f
#define STILL_TURN 1e-2f
#define SAME_WAY 0.7f /* of a normal with the one before: impulses go on */
#define NEAR 0.2f     /* share of `size`: so far may a point go in a step and be the same */

#define FAR 1e30 /* a plane reaches everywhere */

static fp3_box grown(const fp3_body *body, const fp3_bounds3 *bounds, double margin) {
    return (fp3_box){{body->at[0] + bounds->low.x - margin, body->at[1] + bounds->low.y - margin,
                      body->at[2] + bounds->low.z - margin},
                     {body->at[0] + bounds->high.x + margin, body->at[1] + bounds->high.y + margin,
                      body->at[2] + bounds->high.z + margin}};
}

/* Of a mesh, by the corners of its own bounds. */
static fp3_bounds3 bound_mesh(const fp3_form3 *form, const fp3_pose3 *pose) {
    fp3_turn3 turn = fp3_turn_of3(pose->q);
    turn.at = pose->at;
    fp3_bounds3 all = {{0, 0, 0}, {0, 0, 0}};
    for (int i = 0; i < 8; i++) {
        const fp3_bounds3 *b = &form->bounds;
        const fp3_point3 p = fp3_placed3(&turn, (fp3_point3){i & 1 ? b->high.x : b->low.x,
                                                             i & 2 ? b->high.y : b->low.y,
                                                             i & 4 ? b->high.z : b->low.z});
        const float wide = 1e-6f * (fabsf(p.x) + fabsf(p.y) + fabsf(p.z));
        const fp3_point3 low = {p.x - wide, p.y - wide, p.z - wide},
                         high = {p.x + wide, p.y + wide, p.z + wide};
        if (i == 0)
            all = (fp3_bounds3){low, high};
        all.low =
            (fp3_point3){fminf(all.low.x, low.x), fminf(all.low.y, low.y), fminf(all.low.z, low.z)};
        all.high = (fp3_point3){fmaxf(all.high.x, high.x), fmaxf(all.high.y, high.y),
                                fmaxf(all.high.z, high.z)};
    }
    return all;
}

fp3_box fp3_space_box(const fp3_bodies *bodies, uint32_t shape, double margin) {
    const fp3_attached *placed = &bodies->shape[shape];
    const fp3_form3 *form = placed->form;
    const fp3_pose3 pose = fp3_space_pose(bodies, placed->body, (fp3_point3){0, 0, 0});
    if (form->kind == FP3_FORM_PLANE)
        return (fp3_box){{-FAR, -FAR, -FAR}, {FAR, FAR, FAR}};
    const fp3_bounds3 bounds =
        form->kind == FP3_FORM_MESH ? bound_mesh(form, &pose) : fp3_bound3(&form->shape, &pose, 0);
    return grown(&bodies->body[placed->body], &bounds, margin);
}

void fp3_space_boxed(fp3_bodies *bodies, uint32_t body) {
    fp3_body3 *space = &bodies->space->body[body];
    memcpy(space->boxed_turn, space->q, sizeof space->boxed_turn);
}

double fp3_space_turned(const fp3_bodies *bodies, uint32_t body) {
    const fp3_body3 *space = &bodies->space->body[body];
    double sum = 0;
    for (int i = 0; i < 4; i++)
        sum += fabs(space->q[i] - space->boxed_turn[i]);
    return 2.5 * sum; /* an angle is twice that of its quaternion */
}

double fp3_space_speed(const fp3_bodies *bodies, uint32_t body, float extent) {
    const float *v = bodies->body[body].v, *w = bodies->space->body[body].spin;
    return (fabs((double)v[0]) + fabs((double)v[1]) + fabs((double)v[2])) +
           (fabs((double)w[0]) + fabs((double)w[1]) + fabs((double)w[2])) * extent;
}

/* ---- manifolds ---- */

/* Room for `count` patches behind all that there are; the first one's number. */
static fp3_status append(fp3_bodies *bodies, uint32_t count, uint32_t *first) {
    fp3_space *s = bodies->space;
    const fp3_status status = fp3_bodies_room((void **)&s->patch, &s->patch_room, sizeof *s->patch,
                                              (size_t)s->patch_count + count, bodies->error);
    *first = s->patch_count;
    if (!status)
        s->patch_count += count;
    return status;
}

/* A list of pairs that is new: patches in its order, each pair with room for one or more. */
fp3_status fp3_space_lay_patches(fp3_bodies *bodies) {
    fp3_space *s = bodies->space;
    size_t count = 0;
    for (uint32_t k = 0; k < bodies->touch_count; k++)
        count += bodies->touch[k].patches ? bodies->touch[k].patches : 1;
    const fp3_status status =
        fp3_bodies_room((void **)&s->old, &s->old_room, sizeof *s->old, count + 1, bodies->error);
    if (status)
        return status;
    uint32_t next = 0;
    for (uint32_t k = 0; k < bodies->touch_count; k++) {
        fp3_touch2 *t = &bodies->touch[k];
        if (t->patches)
            memcpy(&s->old[next], &s->patch[t->first_patch], t->patches * sizeof *s->old);
        t->first_patch = next;
        t->patch_room = t->patches ? t->patches : 1;
        next += t->patch_room;
    }
    fp3_patch3 *const patch = s->patch;
    const uint32_t room = s->patch_room;
    s->patch = s->old;
    s->patch_room = s->old_room;
    s->patch_count = next;
    s->old = patch;
    s->old_room = room;
    return FP3_OK;
}

static void pose_some(void *of, uint32_t from, uint32_t to) {
    const fp3_bodies *bodies = of;
    for (uint32_t k = from; k < to; k++)
        bodies->space->pose[k] = fp3_space_pose(bodies, k, (fp3_point3){0, 0, 0});
}

fp3_status fp3_space_touch_begin(fp3_bodies *bodies) {
    fp3_space *s = bodies->space;
    const fp3_status status = fp3_bodies_room((void **)&s->pose, &s->pose_room, sizeof *s->pose,
                                              bodies->body_count, bodies->error);
    if (!status)
        fp3_bodies_share(bodies, pose_some, bodies, bodies->body_count, FP3_LEAST_BODIES);
    return status;
}

void fp3_space_forget(fp3_bodies *bodies) {
    for (uint32_t k = 0; k < bodies->touch_count; k++) {
        bodies->touch[k].patches = 0;
        bodies->touch[k].is_found = 0;
    }
}

/* Vectors as fours, the last number 0: this is done for each pair in each step. Something stands
 * behind all three numbers that are read so. */
typedef int four_of_bits __attribute__((vector_size(16), may_alias));
static inline fp3_four three(const float *v) {
    static const four_of_bits kept = {-1, -1, -1, 0};
    four_of_bits bits;
    memcpy(&bits, v, sizeof bits);
    return (fp3_four)(bits & kept);
}
static inline fp3_four cross(fp3_four a, fp3_four b) {
    const fp3_four c = a * FP3_SHUFFLE(b, b, 1, 2, 0, 3) - FP3_SHUFFLE(a, a, 1, 2, 0, 3) * b;
    return FP3_SHUFFLE(c, c, 1, 2, 0, 3);
}
static inline float sum_of(fp3_four a) {
    const fp3_four b = a + FP3_SHUFFLE(a, a, 2, 3, 0, 1);
    return b[0] + b[1];
}

/* The small turn from one quaternion to another, in the axes of the world: y times x turned back.
 */
static inline fp3_four turn_between(const float p[4], const float q[4]) {
    fp3_four x, y;
    memcpy(&x, p, sizeof x);
    memcpy(&y, q, sizeof y);
    const float two = sum_of(x * y) < 0 ? -2.0f : 2.0f;
    const fp3_four turn = (x[0] * y - y[0] * x) + /* 0 and a vector; the same of x x y */
                          FP3_SHUFFLE(x, x, 0, 2, 3, 1) * FP3_SHUFFLE(y, y, 0, 3, 1, 2) -
                          FP3_SHUFFLE(x, x, 0, 3, 1, 2) * FP3_SHUFFLE(y, y, 0, 2, 3, 1);
    return two * FP3_SHUFFLE(turn, turn, 1, 2, 3, 0);
}

static inline four_of_bits are_small(fp3_four v, float most) {
    const fp3_four size = (fp3_four)((four_of_bits)v & 0x7fffffff);
    return size < (fp3_four){most, most, most, most};
}

/* The manifold by what has moved since it was found; 0: too much has. */
static int follow(fp3_patch3 *p, const fp3_pose3 *a, const fp3_pose3 *b, fp3_four from,
                  float size) {
    const fp3_four was = three(&p->from.x), way = from - was, n = three(&p->m.normal.x);
    const fp3_four qa = turn_between(p->turn_a, a->q), qb = turn_between(p->turn_b, b->q);
    const four_of_bits are =
        are_small(way, STILL_WAY * size) & are_small(qa, STILL_TURN) & are_small(qb, STILL_TURN);
    if (!(are[0] & are[1] & are[2]))
        return 0;
    /* Of a point whose arm at a is r: (way + qb x (r - was) - qa x r) . n */
    const fp3_four slope = cross(n, qb - qa);
    const float rise = sum_of(way * n - was * cross(n, qb));
    int are_near = 1;
    for (uint32_t k = 0; k < p->m.count; k++) {
        p->m.point[k].gap = p->gap[k] + (rise + sum_of(three(&p->m.point[k].arm.x) * slope));
        are_near &= p->m.point[k].gap < 0.02f * size;
    }
    return are_near;
}

/* Impulses go on at the points that there are still. */
static void go_on(fp3_patch3 *p, const fp3_patch3 *was, float size) {
    uint8_t from[4];
    if (!was || fp3_dot3(was->m.normal, p->m.normal) < SAME_WAY)
        return;
    fp3_match_manifold3(&was->m, &p->m, NEAR * size, from);
    for (uint32_t k = 0; k < p->m.count; k++)
        p->p[k] = from[k] < 4 ? was->p[from[k]] : 0;
    p->twist = was->twist;
    memcpy(p->f, was->f, sizeof p->f);
    memcpy(p->roll, was->roll, sizeof p->roll);
}

static const fp3_patch3 *find(const fp3_patch3 *old, uint32_t count, uint32_t part) {
    for (uint32_t k = 0; k < count; k++)
        if (old[k].part == part)
            return &old[k];
    return NULL;
}

/* What events and sleep have to know of it. */
static void sum_up(fp3_bodies *bodies, fp3_touch2 *t, fp3_four from) {
    const fp3_space *s = bodies->space;
    const fp3_patch3 *best = NULL;
    float least = INFINITY;
    uint32_t deepest = 0;
    t->m.count = 0;
    t->top = 0;
    for (uint32_t k = t->first_patch; k < t->first_patch + t->patches; k++)
        for (uint32_t i = 0; i < s->patch[k].m.count; i++)
            if (s->patch[k].m.point[i].gap < least) {
                best = &s->patch[k];
                least = best->m.point[i].gap;
                deepest = i;
            }
    if (!best)
        return;
    const fp3_body *x = &bodies->body[t->body_a], *y = &bodies->body[t->body_b];
    const fp3_point3 arm = best->m.point[deepest].arm;
    const fp3_four r = three(&best->m.point[deepest].arm.x), n = three(&best->m.normal.x),
                   u = (three(y->v) + cross(three(s->body[t->body_b].spin), r - from)) -
                       (three(x->v) + cross(three(s->body[t->body_a].spin), r));
    t->m.count = 1;
    t->m.point[0].gap = least;
    t->approach = -sum_of(u * n);
    t->at[0] = x->at[0] + arm.x;
    t->at[1] = x->at[1] + arm.y;
    t->at[2] = x->at[2] + arm.z;
    memcpy(t->normal, &best->m.normal, sizeof t->normal);
}

static fp3_status look(fp3_bodies *bodies, const fp3_form3 *a, const fp3_pose3 *pose_a,
                       const fp3_form3 *b, const fp3_pose3 *pose_b, float reach, uint32_t *count) {
    fp3_space *s = bodies->space;
    fp3_status status = fp3_bodies_room((void **)&s->meeting, &s->meeting_room, sizeof *s->meeting,
                                        16, bodies->error);
    if (status)
        return status;
    *count = fp3_form_collide(a, pose_a, b, pose_b, reach, s->meeting_room, s->meeting);
    if (*count <= s->meeting_room)
        return FP3_OK;
    status = fp3_bodies_room((void **)&s->meeting, &s->meeting_room, sizeof *s->meeting, *count,
                             bodies->error);
    if (!status)
        *count = fp3_form_collide(a, pose_a, b, pose_b, reach, s->meeting_room, s->meeting);
    return status;
}

/* Arms from the centre of mass of a, not from its origin. */
static void shift(fp3_manifold3 *m, fp3_point3 by) {
    for (uint32_t k = 0; k < m->count; k++)
        m->point[k].arm = fp3_add3(m->point[k].arm, by);
}

/* Who was there goes to the other array: new ones take their place. */
static fp3_status put_aside(fp3_bodies *bodies, fp3_touch2 *t, uint32_t count) {
    fp3_space *s = bodies->space;
    fp3_status status = fp3_bodies_room((void **)&s->old, &s->old_room, sizeof *s->old,
                                        t->patches + 1u, bodies->error);
    if (status)
        return status;
    memcpy(s->old, &s->patch[t->first_patch], t->patches * sizeof *s->old);
    if (count <= t->patch_room)
        return FP3_OK;
    status = append(bodies, 2 * count, &t->first_patch);
    t->patch_room = status ? 0 : 2 * count;
    return status;
}

static fp3_four from_of(const fp3_bodies *bodies, const fp3_touch2 *t) {
    const double *a = bodies->body[t->body_a].at, *b = bodies->body[t->body_b].at;
    return (fp3_four){(float)(b[0] - a[0]), (float)(b[1] - a[1]), (float)(b[2] - a[2]), 0};
}

int fp3_space_follow(fp3_bodies *bodies, fp3_touch2 *t) {
    const fp3_space *s = bodies->space;
    const fp3_four from = from_of(bodies, t);
    int is_followed = t->is_found && t->patches > 0;
    for (uint32_t k = 0; is_followed && k < t->patches; k++)
        is_followed = follow(&s->patch[t->first_patch + k], &s->pose[t->body_a],
                             &s->pose[t->body_b], from, (float)bodies->def.size);
    if (is_followed)
        sum_up(bodies, t, from);
    return is_followed;
}

/* Where both bodies of a pair are, as seen from a's centre of mass. */
typedef struct {
    fp3_pose3 a, b;
    fp3_four from;
} placed;

static placed placed_of(const fp3_bodies *bodies, const fp3_touch2 *t) {
    placed both = {bodies->space->pose[t->body_a], bodies->space->pose[t->body_b],
                   from_of(bodies, t)};
    both.b.at = fp3_add3((fp3_point3){both.from[0], both.from[1], both.from[2]}, both.b.at);
    return both;
}

/* Patches of what was found, which have room. */
static void renew(fp3_bodies *bodies, fp3_touch2 *t, const placed *both,
                  const fp3_mesh_touch3 *meeting, uint32_t count, const fp3_patch3 *old) {
    for (uint32_t k = 0; k < count; k++) {
        fp3_patch3 *p = &bodies->space->patch[t->first_patch + k];
        *p = (fp3_patch3){.a = t->a,
                          .b = t->b,
                          .part = meeting[k].triangle,
                          .from = {both->from[0], both->from[1], both->from[2]},
                          .friction = t->friction,
                          .rolling = t->rolling,
                          .radius_a = t->radius_a,
                          .radius_b = t->radius_b};
        p->m = meeting[k].manifold;
        shift(&p->m, both->a.at);
        for (uint32_t i = 0; i < p->m.count; i++)
            p->gap[i] = p->m.point[i].gap;
        memcpy(p->turn_a, both->a.q, sizeof p->turn_a);
        memcpy(p->turn_b, both->b.q, sizeof p->turn_b);
        go_on(p, find(old, t->patches, p->part), (float)bodies->def.size);
    }
    t->patches = count;
    t->is_found = 1;
    sum_up(bodies, t, both->from);
}

#define FEW 8

int fp3_space_collide_in_place(fp3_bodies *bodies, fp3_touch2 *t, float reach) {
    const placed both = placed_of(bodies, t);
    fp3_mesh_touch3 meeting[FEW];
    fp3_patch3 old[FEW];
    if (t->patches > FEW)
        return 0;
    const uint32_t count = fp3_form_collide(bodies->shape[t->a].form, &both.a,
                                            bodies->shape[t->b].form, &both.b, reach, FEW, meeting);
    if (count > FEW || count > t->patch_room)
        return 0;
    memcpy(old, &bodies->space->patch[t->first_patch], t->patches * sizeof *old);
    renew(bodies, t, &both, meeting, count, old);
    return 1;
}

fp3_status fp3_space_collide(fp3_bodies *bodies, fp3_touch2 *t, float reach) {
    fp3_space *s = bodies->space;
    const placed both = placed_of(bodies, t);
    uint32_t count = 0;
    fp3_status status = look(bodies, bodies->shape[t->a].form, &both.a, bodies->shape[t->b].form,
                             &both.b, reach, &count);
    if (!status && (count || t->patches))
        status = put_aside(bodies, t, count);
    if (!status)
        renew(bodies, t, &both, s->meeting, count, s->old);
    return status;
}
