/* SPDX-License-Identifier: Apache-2.0 */
/* touch.c - which shapes touch: manifolds. */
#include "own3.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Shapes that have moved and turned less than this since they were looked at are not looked at
 * again: what a gap is wrong by is of second order. */
#define STILL_WAY 1e-3
#define STILL_TURN 1e-3f
#define SAME_WAY 0.7f /* of a normal with the one before: impulses go on */

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
    const float still = (float)(STILL_WAY * size), reach = (float)(FP3_REACH * size);
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
    const double sweep = fp3_shape_sweep(bodies, a, is_bouncy, is_ground) +
                         fp3_shape_sweep(bodies, b, is_bouncy, is_ground);
    return (float)(FP3_REACH * bodies->def.size + sweep);
}

static void collide(fp3_bodies *bodies, fp3_touch2 *t, const fp3_body *x, const fp3_body *y) {
    const fp3_attached *a = &bodies->shape[t->a], *b = &bodies->shape[t->b];
    const fp3_pose2 pose_a = fp3_body_turn(x);
    fp3_pose2 pose_b = fp3_body_turn(y);
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
    fp3_status status = fp3_pairs_renew(bodies);
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
