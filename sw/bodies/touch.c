/* SPDX-License-Identifier: Apache-2.0 */
/* touch.c - which shapes touch: boxes, pairs, manifolds. */
#include "own3.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Shares of `size`: how near shapes have points of contact; how far a box reaches beyond its shape,
 * so that pairs are looked for now and then only. Neither changes a bit: a pair has points or not
 * by its gaps alone. */
#define REACH 0.02
#define MARGIN 0.1
/* Shapes that have moved and turned less than this since they were looked at are not looked at
 * again: what a gap is wrong by is of second order. */
#define STILL_WAY 1e-3
#define STILL_TURN 1e-3f
#define SAME_WAY 0.7f /* of a normal with the one before: impulses go on */

/* ---- boxes ---- */

static fp3_pose2 turn_of(const fp3_body *body) {
    return (fp3_pose2){.c = body->turn[0], .s = body->turn[1]};
}

/* How far a shape may come in a step. */
static double way_of(const fp3_bodies *bodies, uint32_t number, float extent) {
    const fp3_body *body = &bodies->body[number];
    const double *g = bodies->def.gravity,
                 gravity = (fabs(g[0]) + fabs(g[1]) + fabs(g[2])) * fabs((double)body->gravity);
    const double speed = bodies->space ? fp3_space_speed(bodies, number, extent)
                                       : fabs((double)body->v[0]) + fabs((double)body->v[1]) +
                                             fabs((double)body->w) * (double)extent;
    return bodies->def.h * (speed + bodies->def.h * gravity);
}

/* So far may it come in a step that points of contact on ground are found before its middle is
 * through. */
static double least_of(const fp3_bodies *bodies, float inner) {
    return REACH * bodies->def.size + 0.5 * (double)inner;
}

/* How far it may come, where that counts: of what bounces, so that its impact is found in the step
 * in which it is; of what is marked fast, so that it does not pass through; and of whoever is too
 * fast for ground. */
static double sweep_of(const fp3_bodies *bodies, const fp3_attached *shape, int is_bouncy,
                       int is_ground) {
    const fp3_body *body = &bodies->body[shape->body];
    if (body->type == FP3_STATIC || (!body->is_fast && !is_bouncy && !is_ground))
        return 0;
    const double way = way_of(bodies, shape->body, shape->extent);
    return body->is_fast || is_bouncy || way > least_of(bodies, shape->inner) ? way : 0;
}

static fp3_box box_of(const fp3_bodies *bodies, uint32_t shape, double margin) {
    if (bodies->space)
        return fp3_space_box(bodies, shape, margin);
    const fp3_attached *placed = &bodies->shape[shape];
    const fp3_body *body = &bodies->body[placed->body];
    const fp3_pose2 pose = turn_of(body);
    const fp3_bounds2 bounds = fp3_bound2(&placed->shape, &pose, 0);
    return (fp3_box){{body->at[0] + bounds.low.x - margin, body->at[1] + bounds.low.y - margin},
                     {body->at[0] + bounds.high.x + margin, body->at[1] + bounds.high.y + margin}};
}

static int is_inside(const fp3_box *inner, const fp3_box *outer) {
    return outer->low[0] <= inner->low[0] && outer->low[1] <= inner->low[1] &&
           outer->low[2] <= inner->low[2] && inner->high[0] <= outer->high[0] &&
           inner->high[1] <= outer->high[1] && inner->high[2] <= outer->high[2];
}

static void box_all(fp3_bodies *bodies, fp3_body *body, double margin) {
    for (uint32_t s = body->first_shape; s != FP3_NOBODY; s = bodies->shape[s].next)
        bodies->boxes.box[s] =
            box_of(bodies, s, margin + sweep_of(bodies, &bodies->shape[s], bodies->is_bouncy, 1));
    memcpy(body->boxed, body->at, sizeof body->boxed);
    memcpy(body->boxed_turn, body->turn, sizeof body->boxed_turn);
    if (bodies->space)
        fp3_space_boxed(bodies, (uint32_t)(body - bodies->body));
}

void fp3_bodies_place_boxes(fp3_bodies *bodies, uint32_t number) {
    box_all(bodies, &bodies->body[number], (REACH + MARGIN) * bodies->def.size);
    bodies->is_changed = 1;
}

/* Whether no shape of a body can have left its box since it was made. */
static int is_boxed(const fp3_bodies *bodies, const fp3_body *body) {
    const double turned = bodies->space
                              ? fp3_space_turned(bodies, (uint32_t)(body - bodies->body))
                              : fabs((double)body->turn[0] - (double)body->boxed_turn[0]) +
                                    fabs((double)body->turn[1] - (double)body->boxed_turn[1]);
    const double way =
        fmax(fmax(fabs(body->at[0] - body->boxed[0]), fabs(body->at[1] - body->boxed[1])),
             fabs(body->at[2] - body->boxed[2]));
    return !body->is_fast && !bodies->is_bouncy &&
           way_of(bodies, (uint32_t)(body - bodies->body), body->extent) <=
               least_of(bodies, body->inner) && /* roundings of a box: 2^-20 are enough */
           way + (turned + 0x1p-20) * (double)body->extent <= MARGIN * bodies->def.size;
}

typedef struct {
    fp3_bodies *bodies;
    atomic_int has_left;
} boxing;

static void box_some(void *of, uint32_t from, uint32_t to) {
    boxing *all = of;
    fp3_bodies *bodies = all->bodies;
    const double reach = REACH * bodies->def.size, margin = (REACH + MARGIN) * bodies->def.size;
    for (uint32_t k = from; k < to; k++) {
        fp3_body *body = k == bodies->movable ? NULL : &bodies->body[bodies->in_slot[k]];
        if (!body || is_boxed(bodies, body))
            continue;
        int is_inside_all = 1;
        for (uint32_t s = body->first_shape; s != FP3_NOBODY; s = bodies->shape[s].next) {
            const fp3_box now = box_of(
                bodies, s, reach + sweep_of(bodies, &bodies->shape[s], bodies->is_bouncy, 1));
            is_inside_all &= is_inside(&now, &bodies->boxes.box[s]);
        }
        if (is_inside_all)
            continue;
        atomic_store(&all->has_left, 1);
        box_all(bodies, body, margin);
    }
}

/* Whether a shape of something that moves has left its box. */
static int renew_boxes(fp3_bodies *bodies) {
    boxing all = {bodies, bodies->is_changed};
    fp3_bodies_share_slots(bodies, box_some, &all);
    return all.has_left;
}

/* ---- pairs ---- */

static int may_touch(const fp3_bodies *bodies, uint32_t a, uint32_t b) {
    const fp3_attached *x = &bodies->shape[a], *y = &bodies->shape[b];
    return x->body != y->body &&
           (bodies->body[x->body].type == FP3_DYNAMIC ||
            bodies->body[y->body].type == FP3_DYNAMIC) &&
           !fp3_joints_part(bodies, x->body, y->body);
}

static float radius_of(const fp3_attached *shape) {
    return shape->form ? shape->form->shape.radius : shape->shape.radius;
}

static fp3_touch2 meet(const fp3_bodies *bodies, uint32_t a, uint32_t b) {
    const fp3_attached *x = &bodies->shape[a], *y = &bodies->shape[b];
    static const float still[3] = {0, 0, 0};
    return (fp3_touch2){.a = a,
                        .b = b,
                        .body_a = x->body,
                        .body_b = y->body,
                        .friction = sqrtf(x->friction * y->friction),
                        .belt = x->belt + y->belt,
                        .rolling = x->rolling > y->rolling ? x->rolling : y->rolling,
                        .radius_a = radius_of(x),
                        .radius_b = radius_of(y),
                        .has_belt = memcmp(x->surface, still, sizeof still) != 0 ||
                                    memcmp(y->surface, still, sizeof still) != 0,
                        .is_bouncy = x->restitution > 0 || y->restitution > 0,
                        .is_sensor = x->is_sensor || y->is_sensor};
}

/* Both lists ascend. Who was there goes on with what it has. is_apart_new: who is joined has
 * changed. */
static fp3_status merge(fp3_bodies *bodies, size_t count, int is_apart_new) {
    uint32_t kept = 0, old = 0;
    const fp3_status status = fp3_bodies_room((void **)&bodies->merged, &bodies->merged_room,
                                              sizeof *bodies->merged, count + 1, bodies->error);
    fp3_status told = FP3_OK;
    if (status)
        return status;
    fp3_touch2 *next = bodies->merged;
    for (size_t k = 0; k < count; k++) {
        const uint64_t key = bodies->key[k];
        const uint32_t a = (uint32_t)(key >> 32), b = (uint32_t)key;
        while (old < bodies->touch_count &&
               ((uint64_t)bodies->touch[old].a << 32 | bodies->touch[old].b) < key)
            old++;
        const fp3_touch2 *was = old < bodies->touch_count ? &bodies->touch[old] : NULL;
        const int is_known = was && was->a == a && was->b == b;
        if ((is_known && !is_apart_new) || may_touch(bodies, a, b))
            next[kept++] = is_known ? *was : meet(bodies, a, b);
    }
    for (uint32_t k = 0, at = 0; k < bodies->touch_count; k++) { /* who is there no more */
        const fp3_touch2 *was = &bodies->touch[k];
        const uint64_t key = (uint64_t)was->a << 32 | was->b;
        while (at < kept && ((uint64_t)next[at].a << 32 | next[at].b) < key)
            at++;
        if (was->is_touching && (at == kept || ((uint64_t)next[at].a << 32 | next[at].b) != key))
            told = told ? told : fp3_contact_tell(bodies, FP3_CONTACT_ENDED, was);
    }
    const uint32_t room = bodies->merged_room;
    bodies->merged = bodies->touch;
    bodies->merged_room = bodies->touch_room;
    bodies->touch = next;
    bodies->touch_room = room;
    bodies->touch_count = kept;
    bodies->is_changed = 0;
    if (!bodies->space)
        return told;
    const fp3_status laid = fp3_space_lay_patches(bodies);
    if (laid)
        fp3_space_forget(bodies);
    return told ? told : laid;
}

static fp3_status renew_pairs(fp3_bodies *bodies) {
    size_t count = 0;
    const int is_apart_new = bodies->is_apart_stale;
    fp3_status status = fp3_joints_find_apart(bodies);
    if (!status)
        status =
            fp3_pairs_find(&bodies->boxes, &bodies->key, &bodies->key_room, &count, bodies->error);
    return status ? status : merge(bodies, count, is_apart_new);
}

/* ---- manifolds ---- */

/* Impulses go on at the points that there are still, in their order, if the normal is about the
 * same: by features they would not, where boxes are alike (docs/bodies.md). */
static void go_on(fp3_touch2 *t) {
    const float same = t->m.normal.x * t->before.x + t->m.normal.y * t->before.y;
    if (t->m.count != t->points || same < SAME_WAY) {
        const float p = t->p[0] + t->p[1], f = t->f[0] + t->f[1];
        const int is_same = t->points && t->m.count && same >= SAME_WAY;
        for (uint32_t k = 0; k < 2; k++) {
            t->p[k] = is_same && k < t->m.count ? p / (float)t->m.count : 0;
            t->f[k] = is_same && k < t->m.count ? f / (float)t->m.count : 0;
        }
        t->r = is_same ? t->r : 0;
    }
    t->before = t->m.normal;
    t->points = t->m.count;
}

/* From b's side to a's: `to` is where a is as seen from b. */
static void turn_around(fp3_manifold2 *m, fp3_point2 to) {
    const fp3_manifold2 was = *m;
    m->normal = (fp3_point2){-was.normal.x, -was.normal.y};
    for (uint32_t k = 0; k < was.count; k++) {
        m->point[k] = was.point[was.count - 1 - k];
        m->point[k].arm = fp3_subtract2(m->point[k].arm, to);
    }
}

static float angle_between(fp3_point2 from, const float to[2]) {
    return from.x * to[1] - from.y * to[0];
}

/* The manifold by what has moved since it was found; 0: too much has. */
static int follow(fp3_touch2 *t, const fp3_body *a, const fp3_body *b, double size) {
    const float still = (float)(STILL_WAY * size), reach = (float)(REACH * size);
    const fp3_point2 way = fp3_subtract2(t->from, t->found_from);
    const float qa = angle_between(t->turn_a, a->turn), qb = angle_between(t->turn_b, b->turn);
    if (!t->is_found || !(fabsf(way.x) < still) || !(fabsf(way.y) < still) ||
        !(fabsf(qa) < STILL_TURN) || !(fabsf(qb) < STILL_TURN))
        return 0;
    t->m = t->found;
    for (uint32_t k = 0; k < t->m.count; k++) {
        const fp3_point2 arm_a = t->found.point[k].arm, arm_b = fp3_subtract2(arm_a, t->found_from);
        t->m.point[k].gap += fp3_dot2(way, t->m.normal) + qb * fp3_cross2(arm_b, t->m.normal) -
                             qa * fp3_cross2(arm_a, t->m.normal);
        if (!(t->m.point[k].gap < reach))
            return 0;
    }
    return t->m.count > 0;
}

/* How near two shapes have points of contact. */
static float reach_of(const fp3_bodies *bodies, const fp3_attached *a, const fp3_attached *b) {
    const int is_bouncy = a->restitution > 0 || b->restitution > 0;
    const int is_ground =
        bodies->body[a->body].type != FP3_DYNAMIC || bodies->body[b->body].type != FP3_DYNAMIC;
    const double sweep =
        sweep_of(bodies, a, is_bouncy, is_ground) + sweep_of(bodies, b, is_bouncy, is_ground);
    return (float)(REACH * bodies->def.size + sweep);
}

static void collide(fp3_bodies *bodies, fp3_touch2 *t, const fp3_body *x, const fp3_body *y) {
    const fp3_attached *a = &bodies->shape[t->a], *b = &bodies->shape[t->b];
    const fp3_pose2 pose_a = turn_of(x);
    fp3_pose2 pose_b = turn_of(y);
    pose_b.at = t->from;
    const float reach = reach_of(bodies, a, b);
    if (a->is_link)
        fp3_collide_link2(&a->link, &pose_a, &b->shape, &pose_b, reach, &t->m);
    else if (b->is_link) {
        pose_b.at = (fp3_point2){-pose_b.at.x, -pose_b.at.y};
        fp3_collide_link2(&b->link, &(fp3_pose2){{0, 0}, pose_b.c, pose_b.s}, &a->shape,
                          &(fp3_pose2){pose_b.at, pose_a.c, pose_a.s}, reach, &t->m);
        turn_around(&t->m, pose_b.at);
    } else
        fp3_collide2(&a->shape, &pose_a, &b->shape, &pose_b, reach, &t->m);
    t->found = t->m;
    t->found_from = t->from;
    t->turn_a = (fp3_point2){x->turn[0], x->turn[1]};
    t->turn_b = (fp3_point2){y->turn[0], y->turn[1]};
    t->is_found = 1;
}

/* Something that moves by itself, or that the caller moves. */
static int is_awake(const fp3_bodies *bodies, uint32_t number) {
    const fp3_body *body = &bodies->body[number];
    return fp3_body_moves(body) || (body->type == FP3_KINEMATIC && fp3_body_goes(bodies, number));
}

static uint32_t deepest_of(const fp3_touch2 *t) {
    return t->m.count == 2 && t->m.point[1].gap < t->m.point[0].gap;
}

/* How fast the points of both bodies come together where they are nearest. */
static float approach_of(const fp3_body *x, const fp3_body *y, const fp3_touch2 *t,
                         fp3_point2 arm) {
    const float bx = arm.x - t->from.x, by = arm.y - t->from.y;
    const float ux = (y->v[0] - y->w * by) - (x->v[0] - x->w * arm.y);
    const float uy = (y->v[1] + y->w * bx) - (x->v[1] + x->w * arm.x);
    return -(ux * t->m.normal.x + uy * t->m.normal.y);
}

/* Whether the shapes touch. */
static int look_at(fp3_bodies *bodies, fp3_touch2 *t, const fp3_body *x, const fp3_body *y) {
    t->from = (fp3_point2){(float)(y->at[0] - x->at[0]), (float)(y->at[1] - x->at[1])};
    if (!follow(t, x, y, bodies->def.size))
        collide(bodies, t, x, y);
    go_on(t);
    t->top = 0;
    if (!t->m.count)
        return 0;
    const fp3_point2 arm = t->m.point[deepest_of(t)].arm;
    if (t->is_sensor) /* others get it with their rows */
        t->approach = approach_of(x, y, t, arm);
    t->at[0] = x->at[0] + arm.x;
    t->at[1] = x->at[1] + arm.y;
    t->normal[0] = t->m.normal.x;
    t->normal[1] = t->m.normal.y;
    return 1;
}

/* What pairs are in a step. */
enum { APART, NEAR, WAKES, UNKNOWN };

/* Of what one of its bodies does alone, or both do while they sleep, nothing is new. */
static int is_asleep(const fp3_bodies *bodies, const fp3_touch2 *t) {
    return t->is_found && !is_awake(bodies, t->body_a) && !is_awake(bodies, t->body_b);
}

static uint8_t state_of(const fp3_bodies *bodies, const fp3_touch2 *t) {
    const int is_waking = bodies->body[t->body_a].rest < 0 || bodies->body[t->body_b].rest < 0;
    return t->is_sensor ? APART : is_waking ? WAKES : NEAR;
}

/* Whether all is known of it. */
static int look_at_in_space(fp3_bodies *bodies, fp3_touch2 *t) {
    return fp3_space_follow(bodies, t) ||
           fp3_space_collide_in_place(bodies, t,
                                      reach_of(bodies, &bodies->shape[t->a], &bodies->shape[t->b]));
}

static void look_at_some(void *of, uint32_t from, uint32_t to) {
    fp3_bodies *bodies = of;
    for (uint32_t k = from; k < to; k++) {
        fp3_touch2 *t = &bodies->touch[k];
        const fp3_body *x = &bodies->body[t->body_a], *y = &bodies->body[t->body_b];
        if (is_asleep(bodies, t))
            bodies->near[k] = APART;
        else if (bodies->space && !look_at_in_space(bodies, t))
            bodies->near[k] = UNKNOWN;
        else
            bodies->near[k] = (bodies->space ? t->m.count > 0 : look_at(bodies, t, x, y))
                                  ? state_of(bodies, t)
                                  : APART;
    }
}

/* In space a pair may get more manifolds than it has had room for: one after the other. */
static fp3_status collide_all_in_space(fp3_bodies *bodies) {
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; !status && k < bodies->touch_count; k++) {
        fp3_touch2 *t = &bodies->touch[k];
        if (bodies->near[k] != UNKNOWN)
            continue;
        status = fp3_space_collide(bodies, t,
                                   reach_of(bodies, &bodies->shape[t->a], &bodies->shape[t->b]));
        bodies->near[k] = t->m.count > 0 ? state_of(bodies, t) : APART;
    }
    return status;
}

static fp3_status look_at_all(fp3_bodies *bodies) {
    fp3_status status = bodies->space ? fp3_space_touch_begin(bodies) : FP3_OK;
    if (!status)
        fp3_bodies_share(bodies, look_at_some, bodies, bodies->touch_count, FP3_LEAST_PAIRS);
    if (!status && bodies->space)
        status = collide_all_in_space(bodies);
    if (status)
        fp3_space_forget(bodies);
    return status;
}

/* Who has a row; and who is touched by something awake wakes. */
static int choose(fp3_bodies *bodies) {
    int wakes = 0;
    bodies->contacts.count = 0;
    for (uint32_t k = 0; k < bodies->touch_count; k++) {
        if (bodies->near[k] == APART)
            continue;
        bodies->contacts.of[bodies->contacts.count++] = k;
        if (bodies->near[k] != WAKES)
            continue;
        const fp3_touch2 *t = &bodies->touch[k];
        if (bodies->body[t->body_a].rest < 0)
            fp3_bodies_wake(bodies, t->body_a);
        else if (bodies->body[t->body_b].rest < 0)
            fp3_bodies_wake(bodies, t->body_b);
        wakes = 1;
    }
    return wakes;
}

fp3_status fp3_bodies_touch(fp3_bodies *bodies, int *wakes) {
    fp3_status status = renew_boxes(bodies) ? renew_pairs(bodies) : FP3_OK;
    if (!status)
        status =
            fp3_bodies_room((void **)&bodies->contacts.of, &bodies->contacts.of_room,
                            sizeof *bodies->contacts.of, bodies->touch_count + 1u, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&bodies->near, &bodies->near_room, sizeof *bodies->near,
                                 bodies->touch_count + 1u, bodies->error);
    if (!status)
        status = look_at_all(bodies);
    *wakes = !status && choose(bodies);
    return status;
}
