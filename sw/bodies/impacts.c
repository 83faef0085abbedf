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
#include "own3.h"
#include "turn.h"

#include <math.h>
#include <stdlib.h>

#define ROUNDS                                                                                     \
    64 /* over all contacts; a chain against the order of numbers takes one for each link */
#define TOGETHER 1e-3f /* share of `size`: points whose gaps differ by less hit at once */
#define SWEEPS 64      /* over points that hit at once, at most */

typedef struct {
    fp3_bodies *bodies;
    float *time; /* of each slot: of its last impact */
    float h, bounce;
} impacts;

typedef struct {
    fp3_point3 v, w;
} motion;

typedef struct {
    uint32_t slot;
    float m, back[6]; /* 1/mass, and the inverse of the inertia: xx, yy, zz, xy, xz, yz */
} party;

typedef struct {
    party a, b;
    float restitution, friction;
    fp3_point3 n, belt; /* belt: of b against a where their surfaces do not slide */
    uint32_t count;
} pair;

typedef struct {
    fp3_point3 arm_a, arm_b;
    float gap;
    float speed, time; /* of its impact */
    float pushed;
} point;

typedef enum { NONE, LATER, NOW } when;

/* ---- a plane is space with z = 0 ---- */

static motion motion_of(const fp3_bodies *b, const fp3_four *list, uint32_t slot) {
    if (!b->space)
        return (motion){{list[slot][0], list[slot][1], 0}, {0, 0, list[slot][2]}};
    const fp3_four v = list[2 * slot], w = list[2 * slot + 1];
    return (motion){{v[0], v[1], v[2]}, {w[0], w[1], w[2]}};
}

/* In space the way has a quaternion. */
static motion way_of(const fp3_bodies *b, uint32_t slot) {
    motion way = motion_of(b, b->way, slot);
    if (b->space)
        way.w = fp3_turn_of_way(&b->way[2 * slot]);
    return way;
}

static fp3_point3 pull_of(const fp3_bodies *b, uint32_t slot) {
    const fp3_four pull = b->pull[b->space ? 2 * slot : slot].pull;
    return (fp3_point3){pull[0], pull[1], b->space ? pull[2] : 0};
}

/* The turn of a way, and then one about a vector by its length. */
static void turn_by(fp3_four way[2], fp3_point3 by) {
    const float angle = fp3_size3(by);
    double half[2];
    if (!(angle > 0))
        return;
    fp3_turn2_of(0.5 * (double)angle, half);
    const float c = (float)half[0], s = (float)half[1] / angle;
    const fp3_point3 p = fp3_times3(s, by), q = {way[1][0], way[1][1], way[1][2]};
    const float e = way[0][3];
    const fp3_point3 made =
        fp3_add3(fp3_add3(fp3_times3(c, q), fp3_times3(e, p)), fp3_cross3(p, q));
    way[0][3] = c * e - fp3_dot3(p, q);
    way[1] = (fp3_four){made.x, made.y, made.z, 0};
}

static void change(fp3_bodies *b, uint32_t slot, motion by, float time) {
    if (!b->space) {
        const fp3_four all = {by.v.x, by.v.y, by.w.z, 0};
        b->speed[slot] += all;
        b->way[slot] -= time * all;
        return;
    }
    const fp3_four v = {by.v.x, by.v.y, by.v.z, 0}, w = {by.w.x, by.w.y, by.w.z, 0};
    b->speed[2 * slot] += v;
    b->speed[2 * slot + 1] += w;
    b->way[2 * slot] -= time * v;
    turn_by(&b->way[2 * slot], fp3_times3(-time, by.w));
}

static party party_of(const fp3_bodies *b, uint32_t number) {
    const fp3_body *body = &b->body[number];
    party p = {.slot = fp3_slot_of(b, number), .m = fp3_inverse_mass(body->mass)};
    if (!b->space)
        p.back[2] = fp3_inverse_mass(body->inertia);
    for (int i = 0; b->space && b->space->body[number].moment[0] > 0 && i < 6; i++)
        p.back[i] = b->space->body[number].back[i];
    return p;
}

static float along(motion m, fp3_point3 arm, fp3_point3 n) {
    return fp3_dot3(m.v, n) + fp3_dot3(m.w, fp3_cross3(arm, n));
}

static fp3_point3 velocity(motion m, fp3_point3 arm) { return fp3_add3(m.v, fp3_cross3(m.w, arm)); }

/* ---- when ---- */

static when predict(const impacts *i, const pair *p, point *at) {
    const fp3_bodies *b = i->bodies;
    const float u = along(motion_of(b, b->speed, p->a.slot), at->arm_a, p->n) -
                    along(motion_of(b, b->speed, p->b.slot), at->arm_b, p->n);
    const float way =
        along(way_of(b, p->b.slot), at->arm_b, p->n) - along(way_of(b, p->a.slot), at->arm_a, p->n);
    const fp3_point3 pull = fp3_subtract3(pull_of(b, p->a.slot), pull_of(b, p->b.slot));
    const float a = fp3_dot3(pull, p->n) * (float)b->def.substeps / i->h;
    const float s = at->gap + way, square = u * u + 2 * a * s;
    if (!(u > 0) || !(square > i->bounce * i->bounce))
        return NONE;
    at->speed = sqrtf(square);
    at->time = fmaxf(2 * s / (u + at->speed), fmaxf(i->time[p->a.slot], i->time[p->b.slot]));
    return at->time <= i->h ? NOW : LATER;
}

/* ---- what it does ---- */

static void push(impacts *i, const party *p, fp3_point3 arm, fp3_point3 impulse, float time) {
    if (p->slot >= i->bodies->movable)
        return;
    const motion by = {fp3_times3(p->m, impulse), fp3_tensor3(p->back, fp3_cross3(arm, impulse))};
    change(i->bodies, p->slot, by, time);
    i->time[p->slot] = fmaxf(i->time[p->slot], time);
}

static void push_both(impacts *i, const pair *p, const point *at, fp3_point3 way, float impulse) {
    push(i, &p->b, at->arm_b, fp3_times3(impulse, way), at->time);
    push(i, &p->a, at->arm_a, fp3_times3(-impulse, way), at->time);
}

/* What an impulse of 1 at one point changes of the speed at another, along a direction. */
static float answer(const pair *p, const point *x, const point *y, fp3_point3 n) {
    return p->a.m + p->b.m +
           fp3_dot3(fp3_cross3(x->arm_a, n), fp3_tensor3(p->a.back, fp3_cross3(y->arm_a, n))) +
           fp3_dot3(fp3_cross3(x->arm_b, n), fp3_tensor3(p->b.back, fp3_cross3(y->arm_b, n)));
}

/* Behind the push, by the speed that is left: else both together could give energy. */
static void rub(impacts *i, const pair *p, const point *at) {
    const fp3_bodies *b = i->bodies;
    const fp3_point3 u =
        fp3_subtract3(fp3_subtract3(velocity(motion_of(b, b->speed, p->b.slot), at->arm_b),
                                    velocity(motion_of(b, b->speed, p->a.slot), at->arm_a)),
                      p->belt);
    const fp3_point3 slide = fp3_along3(u, -fp3_dot3(u, p->n), p->n);
    const float speed = fp3_size3(slide);
    if (!(speed > 0))
        return;
    const fp3_point3 t = fp3_times3(1 / speed, slide);
    push_both(i, p, at, t, -fminf(speed / answer(p, at, at, t), p->friction * at->pushed));
}

/* All of these points at once, as of a box that lands flat: one after the other would turn it. By
 * Gauss and Seidel's sweeps: no point pulls, and the speeds that they end with are one answer even
 * where the impulses of four points are not. */
static void hit(impacts *i, const pair *p, point *const at[], uint32_t count) {
    float speed[4], impulse[4] = {0}, most = 0;
    for (uint32_t k = 0; k < count; k++) {
        speed[k] = -at[k]->speed; /* so far */
        most = fmaxf(most, at[k]->speed);
    }
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        float largest = 0;
        for (uint32_t k = 0; k < count; k++) {
            const float left = p->restitution * at[k]->speed - speed[k];
            const float next = fmaxf(impulse[k] + left / answer(p, at[k], at[k], p->n), 0),
                        by = next - impulse[k];
            impulse[k] = next;
            largest = fmaxf(largest, fabsf(by != 0 ? left : 0));
            for (uint32_t m = 0; m < count && by != 0; m++)
                speed[m] += by * answer(p, at[m], at[k], p->n);
        }
        if (!(largest > 1e-7f * most))
            break;
    }
    for (uint32_t k = 0; k < count; k++) {
        push_both(i, p, at[k], p->n, impulse[k]);
        at[k]->pushed = impulse[k];
    }
    for (uint32_t k = 0; k < count; k++)
        rub(i, p, at[k]);
}

/* ---- all contacts ---- */

static void bring_points(const fp3_bodies *b, uint32_t row, pair *p, point at[4]) {
    if (b->space) {
        const fp3_patch3 *patch = &b->space->patch[b->space->contacts.of[row]];
        p->n = patch->m.normal;
        p->count = patch->m.count;
        for (uint32_t k = 0; k < p->count; k++)
            at[k] =
                (point){.arm_a = fp3_arm_a3(patch, patch->m.point[k].arm, patch->m.point[k].gap),
                        .arm_b = fp3_arm_b3(patch, patch->m.point[k].arm, patch->m.point[k].gap),
                        .gap = patch->m.point[k].gap};
        return;
    }
    const fp3_touch2 *t = &b->touch[b->contacts.of[row]];
    const fp3_body *x = &b->body[b->shape[t->a].body], *y = &b->body[b->shape[t->b].body];
    const fp3_point3 from = {(float)(y->at[0] - x->at[0]), (float)(y->at[1] - x->at[1]), 0};
    p->n = (fp3_point3){t->m.normal.x, t->m.normal.y, 0};
    p->count = t->m.count;
    for (uint32_t k = 0; k < p->count; k++) {
        const fp3_point3 arm = {t->m.point[k].arm.x, t->m.point[k].arm.y, 0};
        const float half = 0.5f * t->m.point[k].gap; /* each to its own surface */
        at[k] = (point){.arm_a = fp3_along3(arm, -half, p->n),
                        .arm_b = fp3_subtract3(fp3_along3(arm, half, p->n), from),
                        .gap = t->m.point[k].gap};
    }
}

/* A row's bodies and points; 0: nothing of it bounces. */
static int bring(const fp3_bodies *b, uint32_t row, pair *p, point at[4]) {
    const fp3_touch2 *t = fp3_row_touch(b, row);
    const fp3_attached *x = &b->shape[t->a], *y = &b->shape[t->b];
    p->restitution = x->restitution > y->restitution ? x->restitution : y->restitution;
    if (!(p->restitution > 0))
        return 0;
    bring_points(b, row, p, at);
    p->a = party_of(b, x->body);
    p->b = party_of(b, y->body);
    p->friction = sqrtf(x->friction * y->friction);
    p->belt = b->space ? fp3_space_belt(b, x, y)
                       : fp3_times3(x->belt + y->belt, (fp3_point3){-p->n.y, p->n.x, 0});
    return 1;
}

/* Points that hit at about the time of the first one hit with it. */
static float strike(impacts *i, const pair *p, point at[4]) {
    float pushed = 0;
    for (uint32_t k = 0; k < p->count; k++) {
        if (predict(i, p, &at[k]) != NOW)
            continue;
        point *together[4] = {&at[k]};
        uint32_t count = 1;
        for (uint32_t m = k + 1; m < p->count; m++)
            if (predict(i, p, &at[m]) == NOW && fabsf(at[m].time - at[k].time) * at[k].speed <
                                                    TOGETHER * (float)i->bodies->def.size)
                together[count++] = &at[m];
        hit(i, p, together, count);
        for (uint32_t m = 0; m < count; m++)
            pushed += together[m]->pushed;
    }
    return pushed;
}

static int round_of(impacts *i) {
    fp3_bodies *b = i->bodies;
    const uint32_t rows = fp3_rows_count(b);
    int has_hit = 0;
    for (uint32_t k = 0; k < rows; k++) {
        pair p;
        point at[4];
        const float pushed = bring(b, k, &p, at) ? strike(i, &p, at) : 0;
        fp3_row_touch(b, k)->top += pushed;
        has_hit |= pushed > 0;
    }
    return has_hit;
}

/* What comes together fast, but not within this step, is none of the solver's business: it would
 * brake what has to bounce in the next one. */
static void leave(const impacts *i) {
    fp3_bodies *b = i->bodies;
    const uint32_t rows = fp3_rows_count(b);
    for (uint32_t k = 0; k < rows; k++)
        fp3_row_touch(b, k)->is_left = 1;
    for (uint32_t k = 0; k < rows; k++) {
        fp3_touch2 *t = fp3_row_touch(b, k);
        pair p;
        point at[4];
        if (!bring(b, k, &p, at)) {
            t->is_left = 0;
            continue;
        }
        for (uint32_t n = 0; n < p.count; n++) {
            if (predict(i, &p, &at[n]) != LATER)
                t->is_left = 0;
            else if (b->space)
                fp3_space_contact_leave(b, k, n);
            else
                fp3_contact_leave(b, k, n);
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
