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

typedef struct {
    fp3_bodies *bodies;
    float *time; /* of each slot: of its last impact */
    float h, bounce;
    int is_any;
} impacts;

typedef struct {
    const fp3_touch2 *touch;
    uint32_t a, b; /* slots */
    float ma, ia, mb, ib, restitution, friction;
    fp3_point2 n, arm_a, arm_b;
    float gap;
} pair;

static float along(fp3_four v, fp3_point2 arm, fp3_point2 n) {
    return v[0] * n.x + v[1] * n.y + v[2] * fp3_cross2(arm, n);
}

static void push(impacts *i, uint32_t slot, float m, float inertia, fp3_point2 arm,
                 fp3_point2 impulse, float time) {
    fp3_bodies *b = i->bodies;
    if (slot >= b->movable)
        return;
    const fp3_four change = {m * impulse.x, m * impulse.y, inertia * fp3_cross2(arm, impulse), 0};
    b->speed[slot] += change;
    b->way[slot] -= time * change;
    i->time[slot] = time;
}

static void push_both(impacts *i, const pair *p, fp3_point2 way, float impulse, float time) {
    const fp3_point2 on_b = {impulse * way.x, impulse * way.y}, on_a = {-on_b.x, -on_b.y};
    push(i, p->b, p->mb, p->ib, p->arm_b, on_b, time);
    push(i, p->a, p->ma, p->ia, p->arm_a, on_a, time);
}

/* The impulse along the normal, and that of friction, which is at most `friction` of it. */
static float hit(impacts *i, const pair *p, float speed, float time) {
    const fp3_bodies *b = i->bodies;
    const fp3_point2 t = {-p->n.y, p->n.x};
    const float an = fp3_cross2(p->arm_a, p->n), bn = fp3_cross2(p->arm_b, p->n),
                at = fp3_cross2(p->arm_a, t), bt = fp3_cross2(p->arm_b, t);
    const float mass = p->ma + p->mb;
    const float x = (1 + p->restitution) * speed / (mass + p->ia * an * an + p->ib * bn * bn);
    push_both(i, p, p->n, x, time);
    /* Friction behind it, by the speed that is left: else both together could give energy. */
    const float slide = along(b->speed[p->b], p->arm_b, t) - along(b->speed[p->a], p->arm_a, t);
    const float most = p->friction * x;
    const float y = fmaxf(fminf(-slide / (mass + p->ia * at * at + p->ib * bt * bt), most), -most);
    push_both(i, p, t, y, time);
    return x;
}

/* Whether the point closes within the step; then it has hit, and *impulse is what it gave. */
static int try(impacts *i, const pair *p, float *impulse) {
    const fp3_bodies *b = i->bodies;
    const float u = along(b->speed[p->a], p->arm_a, p->n) - along(b->speed[p->b], p->arm_b, p->n);
    const float way = along(b->way[p->b], p->arm_b, p->n) - along(b->way[p->a], p->arm_a, p->n);
    const fp3_four pull = b->pull[p->a].pull - b->pull[p->b].pull;
    const float a = (pull[0] * p->n.x + pull[1] * p->n.y) * (float)b->def.substeps / i->h;
    const float s = p->gap + way, square = u * u + 2 * a * s;
    const float earliest = fmaxf(i->time[p->a], i->time[p->b]);
    if (!(u > 0) || !(square > i->bounce * i->bounce))
        return 0;
    /* Where the substeps would stop it, which come a little farther than a parabola: what they stop
     * has no speed left to bounce with. */
    const float sub = i->h / (float)b->def.substeps, comes = (u + 0.5f * a * (i->h + sub)) * i->h;
    if (!(s <= comes + 1e-4f * (fabsf(s) + comes)))
        return 0;
    const float v = sqrtf(square), time = fmaxf(2 * s / (u + v), earliest);
    *impulse = hit(i, p, v, time);
    i->is_any = 1;
    return 1;
}

static void bring(const fp3_bodies *bodies, fp3_touch2 *t, pair *p) {
    const fp3_attached *a = &bodies->shape[t->a], *b = &bodies->shape[t->b];
    const fp3_body *x = &bodies->body[a->body], *y = &bodies->body[b->body];
    *p = (pair){.touch = t,
                .a = fp3_slot_of(bodies, a->body),
                .b = fp3_slot_of(bodies, b->body),
                .ma = fp3_inverse_mass(x->mass),
                .ia = fp3_inverse_mass(x->inertia),
                .mb = fp3_inverse_mass(y->mass),
                .ib = fp3_inverse_mass(y->inertia),
                .restitution = a->restitution > b->restitution ? a->restitution : b->restitution,
                .friction = sqrtf(a->friction * b->friction),
                .n = t->m.normal};
}

static int round_of(impacts *i) {
    fp3_bodies *bodies = i->bodies;
    int has_hit = 0;
    for (uint32_t k = 0; k < bodies->contacts.count; k++) {
        fp3_touch2 *t = &bodies->touch[bodies->contacts.of[k]];
        const fp3_attached *a = &bodies->shape[t->a], *b = &bodies->shape[t->b];
        if (!(a->restitution > 0) && !(b->restitution > 0))
            continue;
        pair p;
        bring(bodies, t, &p);
        const fp3_body *x = &bodies->body[a->body], *y = &bodies->body[b->body];
        const fp3_point2 from = {(float)(y->at[0] - x->at[0]), (float)(y->at[1] - x->at[1])};
        for (uint32_t point = 0; point < t->m.count; point++) {
            float impulse;
            p.arm_a = t->m.point[point].arm;
            p.arm_b = fp3_subtract2(p.arm_a, from);
            p.gap = t->m.point[point].gap;
            if (!try(i, &p, &impulse))
                continue;
            t->top += impulse;
            has_hit = 1;
        }
    }
    return has_hit;
}

fp3_status fp3_impacts(fp3_bodies *bodies, int *is_any) {
    uint32_t room = 0;
    impacts i = {.bodies = bodies, .h = (float)bodies->def.h, .bounce = (float)bodies->def.bounce};
    *is_any = 0;
    if (!bodies->may_bounce)
        return FP3_OK;
    const fp3_status status =
        fp3_bodies_room((void **)&i.time, &room, sizeof *i.time, bodies->slots, bodies->error);
    for (int k = 0; !status && k < ROUNDS && round_of(&i); k++)
        ;
    free(i.time);
    *is_any = i.is_any;
    return status;
}
