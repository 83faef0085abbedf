/* SPDX-License-Identifier: Apache-2.0 */
/* impacts.c - what bounces.
 *
 * A contact that closes within the step, faster than `bounce`, and whose surfaces have a
 * restitution is an impact: it gets its impulse at once, by the speed that it has at its own time,
 * and both bodies are put where they must be now to be where they are then. So a ball has at the
 * end of the step the place and the speed of one that bounced within it. Impacts follow each other
 * pair by pair, as those of Newton's cradle do, each at its time, until nothing comes together any
 * more.
 *
 * Along the normal a gap s closes with speed u and acceleration a. It is closed at t = 2 s/(u + v),
 * with v = sqrt(u^2 + 2 a s). The impulse turns v into -e v. A body whose speed it changes by d is
 * moved by -d t.
 */
#include "own.h"

#include <math.h>
#include <stdlib.h>

#define ROUNDS                                                                                     \
    64 /* over all contacts; a chain against the order of numbers takes one for each link */
#define TOGETHER 1e-3f /* share of `size`: points whose gaps differ by less hit at once */

typedef struct {
    fp3_bodies *bodies;
    float *time; /* of each slot: of its last impact */
    float h, bounce;
} impacts;

typedef struct {
    uint32_t a, b; /* slots */
    float ma, ia, mb, ib, restitution, friction, belt;
    fp3_point2 n;
} pair;

typedef struct {
    fp3_point2 arm_a, arm_b;
    float gap;
    float speed, time; /* of its impact */
} point;

typedef enum { NONE, LATER, NOW } when;

static float along(fp3_four v, fp3_point2 arm, fp3_point2 n) {
    return v[0] * n.x + v[1] * n.y + v[2] * fp3_cross2(arm, n);
}

/* ---- when ---- */

static when predict(const impacts *i, const pair *p, point *at) {
    const fp3_bodies *b = i->bodies;
    const float u = along(b->speed[p->a], at->arm_a, p->n) - along(b->speed[p->b], at->arm_b, p->n);
    const float way = along(b->way[p->b], at->arm_b, p->n) - along(b->way[p->a], at->arm_a, p->n);
    const fp3_four pull = b->pull[p->a].pull - b->pull[p->b].pull;
    const float a = (pull[0] * p->n.x + pull[1] * p->n.y) * (float)b->def.substeps / i->h;
    const float s = at->gap + way, square = u * u + 2 * a * s;
    if (!(u > 0) || !(square > i->bounce * i->bounce))
        return NONE;
    at->speed = sqrtf(square);
    at->time = fmaxf(2 * s / (u + at->speed), fmaxf(i->time[p->a], i->time[p->b]));
    return at->time <= i->h ? NOW : LATER;
}

/* ---- what it does ---- */

static void push(impacts *i, uint32_t slot, float m, float inertia, fp3_point2 arm,
                 fp3_point2 impulse, float time) {
    fp3_bodies *b = i->bodies;
    if (slot >= b->movable)
        return;
    const fp3_four change = {m * impulse.x, m * impulse.y, inertia * fp3_cross2(arm, impulse), 0};
    b->speed[slot] += change;
    b->way[slot] -= time * change;
    i->time[slot] = fmaxf(i->time[slot], time);
}

static void push_both(impacts *i, const pair *p, const point *at, fp3_point2 way, float impulse) {
    const fp3_point2 on_b = {impulse * way.x, impulse * way.y}, on_a = {-on_b.x, -on_b.y};
    push(i, p->b, p->mb, p->ib, at->arm_b, on_b, at->time);
    push(i, p->a, p->ma, p->ia, at->arm_a, on_a, at->time);
}

/* What an impulse of 1 at one point changes of the speed at another, along a direction. */
static float answer(const pair *p, const point *x, const point *y, fp3_point2 n) {
    return p->ma + p->mb + p->ia * fp3_cross2(x->arm_a, n) * fp3_cross2(y->arm_a, n) +
           p->ib * fp3_cross2(x->arm_b, n) * fp3_cross2(y->arm_b, n);
}

/* Behind the push, by the speed that is left: else both together could give energy. */
static void rub(impacts *i, const pair *p, const point *at, float pushed) {
    const fp3_bodies *b = i->bodies;
    const fp3_point2 t = {-p->n.y, p->n.x};
    const float slide =
        along(b->speed[p->b], at->arm_b, t) - along(b->speed[p->a], at->arm_a, t) - p->belt;
    const float most = p->friction * pushed;
    push_both(i, p, at, t, fmaxf(fminf(-slide / answer(p, at, at, t), most), -most));
}

static float hit(impacts *i, const pair *p, const point *at) {
    const float x = (1 + p->restitution) * at->speed / answer(p, at, at, p->n);
    push_both(i, p, at, p->n, x);
    rub(i, p, at, x);
    return x;
}

/* Both at once, as of a box that lands flat: one after the other would turn it. 0: one of them
 * would be pulled. */
static float hit_twice(impacts *i, const pair *p, const point at[2]) {
    const float k11 = answer(p, &at[0], &at[0], p->n), k22 = answer(p, &at[1], &at[1], p->n),
                k12 = answer(p, &at[0], &at[1], p->n), det = k11 * k22 - k12 * k12;
    const float e = 1 + p->restitution, v1 = e * at[0].speed, v2 = e * at[1].speed;
    if (!(det > 1e-6f * k11 * k22))
        return 0;
    const float x1 = (k22 * v1 - k12 * v2) / det, x2 = (k11 * v2 - k12 * v1) / det;
    if (!(x1 > 0) || !(x2 > 0))
        return 0;
    push_both(i, p, &at[0], p->n, x1);
    push_both(i, p, &at[1], p->n, x2);
    rub(i, p, &at[0], x1);
    rub(i, p, &at[1], x2);
    return x1 + x2;
}

/* ---- all contacts ---- */

/* Its bodies and points; 0: nothing of it bounces. */
static int bring(const fp3_bodies *bodies, const fp3_touch2 *t, pair *p, point at[2]) {
    const fp3_attached *a = &bodies->shape[t->a], *b = &bodies->shape[t->b];
    const fp3_body *x = &bodies->body[a->body], *y = &bodies->body[b->body];
    const fp3_point2 from = {(float)(y->at[0] - x->at[0]), (float)(y->at[1] - x->at[1])};
    *p = (pair){.a = fp3_slot_of(bodies, a->body),
                .b = fp3_slot_of(bodies, b->body),
                .ma = fp3_inverse_mass(x->mass),
                .ia = fp3_inverse_mass(x->inertia),
                .mb = fp3_inverse_mass(y->mass),
                .ib = fp3_inverse_mass(y->inertia),
                .restitution = a->restitution > b->restitution ? a->restitution : b->restitution,
                .friction = sqrtf(a->friction * b->friction),
                .belt = a->belt + b->belt,
                .n = t->m.normal};
    for (uint32_t k = 0; k < t->m.count; k++)
        at[k] = (point){.arm_a = t->m.point[k].arm,
                        .arm_b = fp3_subtract2(t->m.point[k].arm, from),
                        .gap = t->m.point[k].gap};
    return p->restitution > 0;
}

static float strike(impacts *i, const pair *p, point at[2], uint32_t count) {
    float pushed = 0;
    if (count == 2 && predict(i, p, &at[0]) == NOW && predict(i, p, &at[1]) == NOW &&
        fabsf(at[0].time - at[1].time) * at[0].speed < TOGETHER * (float)i->bodies->def.size)
        pushed = hit_twice(i, p, at);
    for (uint32_t k = 0; k < count; k++)
        if (predict(i, p, &at[k]) == NOW)
            pushed += hit(i, p, &at[k]);
    return pushed;
}

static int round_of(impacts *i) {
    fp3_bodies *bodies = i->bodies;
    int has_hit = 0;
    for (uint32_t k = 0; k < bodies->contacts.count; k++) {
        fp3_touch2 *t = &bodies->touch[bodies->contacts.of[k]];
        pair p;
        point at[2];
        const float pushed = bring(bodies, t, &p, at) ? strike(i, &p, at, t->m.count) : 0;
        t->top += pushed;
        has_hit |= pushed > 0;
    }
    return has_hit;
}

/* What comes together fast, but not within this step, is none of the solver's business: it would
 * brake what has to bounce in the next one. */
static void leave(const impacts *i) {
    fp3_bodies *bodies = i->bodies;
    for (uint32_t k = 0; k < bodies->contacts.count; k++) {
        fp3_touch2 *t = &bodies->touch[bodies->contacts.of[k]];
        pair p;
        point at[2];
        t->is_left = bring(bodies, t, &p, at);
        for (uint32_t n = 0; p.restitution > 0 && n < t->m.count; n++) {
            if (predict(i, &p, &at[n]) == LATER)
                fp3_contact_leave(bodies, k, n);
            else
                t->is_left = 0;
        }
    }
}

fp3_status fp3_impacts(fp3_bodies *bodies, int *is_any) {
    uint32_t room = 0;
    impacts i = {.bodies = bodies, .h = (float)bodies->def.h, .bounce = (float)bodies->def.bounce};
    *is_any = 0;
    if (!bodies->may_bounce)
        return FP3_OK;
    const fp3_status status =
        fp3_bodies_room((void **)&i.time, &room, sizeof *i.time, bodies->slots, bodies->error);
    if (status)
        return status;
    for (int k = 0; k < ROUNDS && round_of(&i); k++)
        *is_any = 1;
    leave(&i);
    free(i.time);
    return FP3_OK;
}
