/* SPDX-License-Identifier: Apache-2.0 */
/* near.c - which shapes are so near that they may touch: boxes that reach beyond them, and their
 * pairs.
 *
 * Pairs are looked for where a shape has left its box, and for all bodies at once only if many
 * have.
 */
#include "own3.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Share of `size`: how far a box reaches beyond what its shape may touch. It changes no bit: a pair
 * has points or not by its gaps alone. */
#define MARGIN 0.1

/* ---- boxes ---- */

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
    return FP3_REACH * bodies->def.size + 0.5 * (double)inner;
}

double fp3_shape_sweep(const fp3_bodies *bodies, const fp3_attached *shape, int is_bouncy,
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
    const fp3_pose2 pose = fp3_body_turn(body);
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
        bodies->boxes.box[s] = box_of(
            bodies, s, margin + fp3_shape_sweep(bodies, &bodies->shape[s], bodies->is_bouncy, 1));
    memcpy(body->boxed, body->at, sizeof body->boxed);
    memcpy(body->boxed_turn, body->turn, sizeof body->boxed_turn);
    if (bodies->space)
        fp3_space_boxed(bodies, (uint32_t)(body - bodies->body));
}

void fp3_bodies_place_boxes(fp3_bodies *bodies, uint32_t number) {
    box_all(bodies, &bodies->body[number], (FP3_REACH + MARGIN) * bodies->def.size);
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

/* Bodies that have left their boxes: so few are compared with all in less time than it takes to
 * look for all pairs. */
#define FEW 64

typedef struct {
    fp3_bodies *bodies;
    atomic_uint left;     /* how many bodies have left their boxes */
    uint32_t number[FEW]; /* of them: in any order, all if they are few */
} boxing;

static void box_some(void *of, uint32_t from, uint32_t to) {
    boxing *all = of;
    fp3_bodies *bodies = all->bodies;
    const double reach = FP3_REACH * bodies->def.size,
                 margin = (FP3_REACH + MARGIN) * bodies->def.size;
    for (uint32_t k = from; k < to; k++) {
        fp3_body *body = k == bodies->movable ? NULL : &bodies->body[bodies->in_slot[k]];
        if (!body || is_boxed(bodies, body))
            continue;
        int is_inside_all = 1;
        for (uint32_t s = body->first_shape; s != FP3_NOBODY; s = bodies->shape[s].next) {
            const fp3_box now =
                box_of(bodies, s,
                       reach + fp3_shape_sweep(bodies, &bodies->shape[s], bodies->is_bouncy, 1));
            is_inside_all &= is_inside(&now, &bodies->boxes.box[s]);
        }
        if (is_inside_all)
            continue;
        const unsigned at = atomic_fetch_add(&all->left, 1);
        if (at < FEW)
            all->number[at] = bodies->in_slot[k];
        box_all(bodies, body, margin);
    }
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

static fp3_status renew_all_pairs(fp3_bodies *bodies) {
    size_t count = 0;
    const int is_apart_new = bodies->is_apart_stale;
    fp3_status status = fp3_joints_find_apart(bodies);
    if (!status)
        status =
            fp3_pairs_find(&bodies->boxes, &bodies->key, &bodies->key_room, &count, bodies->error);
    return status ? status : merge(bodies, count, is_apart_new);
}

static uint64_t key_of(const fp3_touch2 *t) { return (uint64_t)t->a << 32 | t->b; }

static int is_of_marked(const fp3_bodies *bodies, const fp3_touch2 *t) {
    return bodies->body[t->body_a].is_marked | bodies->body[t->body_b].is_marked;
}

/* The pairs of bodies that are marked; how many all others have. Whether they are those that there
 * were. */
static int are_known(const fp3_bodies *bodies, size_t count, uint32_t *others) {
    size_t at = 0;
    int are = 1;
    *others = 0;
    for (uint32_t k = 0; k < bodies->touch_count; k++) {
        const fp3_touch2 *t = &bodies->touch[k];
        if (!is_of_marked(bodies, t))
            ++*others;
        else if (at < count && bodies->key[at] == key_of(t))
            at++;
        else
            are = 0;
    }
    return are && at == count;
}

/* Behind `count` keys of bodies that are marked room for those of all others; both ascend
 * together then, from the last one down. */
static fp3_status join(fp3_bodies *bodies, size_t count, uint32_t others) {
    size_t to = count + others;
    if (to > bodies->key_room) {
        uint64_t *key = realloc(bodies->key, 2 * to * sizeof *key);
        if (!key)
            return fp3_no_memory(bodies->error);
        bodies->key = key;
        bodies->key_room = 2 * to;
    }
    for (uint32_t k = bodies->touch_count; k-- > 0;) {
        const fp3_touch2 *t = &bodies->touch[k];
        if (is_of_marked(bodies, t))
            continue;
        for (; count > 0 && bodies->key[count - 1] > key_of(t); count--)
            bodies->key[--to] = bodies->key[count - 1];
        bodies->key[--to] = key_of(t);
    }
    return FP3_OK;
}

/* Shapes of bodies, and their pairs that may touch. */
static fp3_status find_pairs_of(fp3_bodies *bodies, const uint32_t *number, uint32_t bodies_count,
                                size_t *count) {
    uint32_t some[2 * FEW], shapes = 0;
    size_t kept = 0;
    for (uint32_t i = 0; i < bodies_count; i++)
        for (uint32_t s = bodies->body[number[i]].first_shape; s != FP3_NOBODY;
             s = bodies->shape[s].next)
            some[shapes++] = s;
    const fp3_status status = fp3_pairs_find_of(&bodies->boxes, some, shapes, &bodies->key,
                                                &bodies->key_room, count, bodies->error);
    for (size_t k = 0; !status && k < *count; k++)
        if (may_touch(bodies, (uint32_t)(bodies->key[k] >> 32), (uint32_t)bodies->key[k]))
            bodies->key[kept++] = bodies->key[k];
    *count = kept;
    return status;
}

/* All boxes but those of these bodies are as they were. */
static fp3_status renew_pairs_of(fp3_bodies *bodies, const uint32_t *number,
                                 uint32_t bodies_count) {
    size_t count = 0;
    uint32_t others = 0;
    fp3_status status = find_pairs_of(bodies, number, bodies_count, &count);
    for (uint32_t i = 0; i < bodies_count; i++)
        bodies->body[number[i]].is_marked = 1;
    const int is_all = !status && are_known(bodies, count, &others);
    if (!status && !is_all)
        status = join(bodies, count, others);
    for (uint32_t i = 0; i < bodies_count; i++)
        bodies->body[number[i]].is_marked = 0;
    if (is_all)
        bodies->is_changed = 0;
    return status || is_all ? status : merge(bodies, count + others, 0);
}

static uint32_t shapes_of(const fp3_bodies *bodies, const uint32_t *number, uint32_t count) {
    uint32_t shapes = 0;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t s = bodies->body[number[i]].first_shape; s != FP3_NOBODY && shapes <= 2 * FEW;
             s = bodies->shape[s].next)
            shapes++;
    return shapes;
}

fp3_status fp3_pairs_renew(fp3_bodies *bodies) {
    boxing all = {.bodies = bodies};
    fp3_bodies_share_slots(bodies, box_some, &all);
    if (!all.left && !bodies->is_changed)
        return FP3_OK;
    const int are_few = !bodies->is_changed && !bodies->is_apart_stale && all.left <= FEW &&
                        shapes_of(bodies, all.number, all.left) <= 2 * FEW;
    bodies->is_changed = 1; /* until all is done */
    return are_few ? renew_pairs_of(bodies, all.number, all.left) : renew_all_pairs(bodies);
}
