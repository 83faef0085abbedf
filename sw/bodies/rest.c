/* SPDX-License-Identifier: Apache-2.0 */
/* rest.c - who sleeps and who wakes.
 *
 * Islands are dynamic bodies that touch each other, directly or by others. They are found by union
 * with the lowest number, so no order matters. All of an island fall asleep together, in a ring by
 * which they wake together.
 */
#include "own3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void fp3_bodies_wake(fp3_bodies *bodies, uint32_t number) {
    uint32_t next = number;
    bodies->is_still = 0;
    while (bodies->body[next].rest < 0) {
        fp3_body *body = &bodies->body[next];
        next = body->next_asleep;
        body->rest = 0;
        body->next_asleep = FP3_NOBODY;
    }
    bodies->body[number].rest = 0;
}

static void mark(fp3_bodies *bodies, const uint64_t *handles, size_t count, uint8_t is_marked) {
    for (size_t i = 0; i < count; i++)
        bodies->body[(uint32_t)handles[i]].is_marked = is_marked;
}

/* Of two bodies of which one is marked. */
static void wake_pair(fp3_bodies *bodies, uint32_t a, uint32_t b) {
    fp3_bodies_wake(bodies, a);
    fp3_bodies_wake(bodies, b);
}

void fp3_bodies_wake_around(fp3_bodies *bodies, const uint64_t *handles, size_t count) {
    bodies->is_still = 0;
    for (size_t i = 0; i < count; i++)
        fp3_bodies_wake(bodies, (uint32_t)handles[i]);
    mark(bodies, handles, count, 1);
    for (uint32_t k = 0; k < bodies->touch_count; k++) {
        fp3_touch2 *t = &bodies->touch[k];
        const uint32_t a = t->body_a, b = t->body_b;
        if (!(bodies->body[a].is_marked | bodies->body[b].is_marked))
            continue;
        t->is_found = 0;
        if (t->m.count)
            wake_pair(bodies, a, b);
    }
    for (uint32_t i = 0; i < bodies->joint_count; i++) {
        const fp3_joint *j = &bodies->joint[i];
        if (j->generation & 1 && (bodies->body[j->a].is_marked | bodies->body[j->b].is_marked))
            wake_pair(bodies, j->a, j->b);
    }
    mark(bodies, handles, count, 0);
}

static uint32_t root_of(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static void unite(const fp3_bodies *bodies, uint32_t *parent, uint32_t body_a, uint32_t body_b) {
    uint32_t a = bodies->body[body_a].slot, b = bodies->body[body_b].slot;
    if (a >= bodies->movable || b >= bodies->movable)
        return;
    a = root_of(parent, a);
    b = root_of(parent, b);
    parent[a > b ? a : b] = a < b ? a : b;
}

void fp3_bodies_islands(const fp3_bodies *bodies, uint32_t *root) {
    for (uint32_t k = 0; k < bodies->movable; k++)
        root[k] = k;
    for (uint32_t i = 0; i < bodies->contacts.count; i++) {
        const fp3_touch2 *t = &bodies->touch[bodies->contacts.of[i]];
        unite(bodies, root, t->body_a, t->body_b);
    }
    for (uint32_t i = 0; i < bodies->joint_count; i++)
        if (bodies->joint[i].generation & 1)
            unite(bodies, root, bodies->joint[i].a, bodies->joint[i].b);
    for (uint32_t k = 0; k < bodies->movable; k++)
        root[k] = root_of(root, k);
}

/* What moves by itself carries others along: they do not rest. */
static void stir(fp3_bodies *bodies, uint32_t a, uint32_t b) {
    if (bodies->body[a].type == FP3_KINEMATIC && fp3_body_goes(bodies, a))
        bodies->body[b].rest = fminf(bodies->body[b].rest, 0);
    if (bodies->body[b].type == FP3_KINEMATIC && fp3_body_goes(bodies, b))
        bodies->body[a].rest = fminf(bodies->body[a].rest, 0);
}

static void stir_all(fp3_bodies *bodies) {
    if (bodies->slots == bodies->movable + 1) /* nothing does */
        return;
    for (uint32_t i = 0; i < bodies->contacts.count; i++) {
        const fp3_touch2 *t = &bodies->touch[bodies->contacts.of[i]];
        stir(bodies, t->body_a, t->body_b);
    }
    for (uint32_t i = 0; i < bodies->joint_count; i++)
        if (bodies->joint[i].generation & 1)
            stir(bodies, bodies->joint[i].a, bodies->joint[i].b);
}

int fp3_body_goes(const fp3_bodies *bodies, uint32_t number) {
    const fp3_body *body = &bodies->body[number];
    const float *spin = bodies->space ? bodies->space->body[number].spin : (float[]){body->w, 0, 0};
    return body->v[0] != 0 || body->v[1] != 0 || body->v[2] != 0 || spin[0] != 0 || spin[1] != 0 ||
           spin[2] != 0;
}

static float length_of(const float v[3]) {
    return sqrtf((v[0] * v[0] + v[1] * v[1]) + v[2] * v[2]);
}

static float speed_of(const fp3_bodies *bodies, uint32_t number, float extent) {
    const fp3_body *body = &bodies->body[number];
    const float spin = bodies->space ? length_of(bodies->space->body[number].spin) : fabsf(body->w);
    return length_of(body->v) + spin * extent;
}

/* How long each has been slow; whether one has long enough. A fast corner counts, too: the speed of
 * the farthest point of its shapes. */
static int count_rest(fp3_bodies *bodies) {
    const float h = (float)bodies->def.h, most = (float)bodies->def.rest_speed;
    int is_any = 0;
    for (uint32_t k = 0; k < bodies->movable; k++) {
        fp3_body *body = &bodies->body[bodies->in_slot[k]];
        const float speed = speed_of(bodies, bodies->in_slot[k], body->extent);
        body->rest = speed < most && !body->may_not_sleep ? body->rest + h : 0;
    }
    stir_all(bodies);
    for (uint32_t k = 0; k < bodies->movable; k++) {
        const fp3_body *body = &bodies->body[bodies->in_slot[k]];
        is_any |= body->rest > 0 && body->rest >= (float)bodies->def.rest_time;
    }
    return is_any;
}

static void fall_asleep(fp3_bodies *bodies, const uint32_t *root, float *least) {
    const uint32_t count = bodies->movable;
    for (uint32_t k = 0; k < count; k++)
        least[k] = INFINITY;
    for (uint32_t k = 0; k < count; k++) {
        least[root[k]] = fminf(least[root[k]], bodies->body[bodies->in_slot[k]].rest);
    }
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t number = bodies->in_slot[k];
        fp3_body *body = &bodies->body[number], *first = &bodies->body[bodies->in_slot[root[k]]];
        if (!(least[root[k]] > 0) || !(least[root[k]] >= (float)bodies->def.rest_time))
            continue;
        body->next_asleep = k == root[k] ? number : first->next_asleep;
        first->next_asleep = number;
        body->rest = -1;
        body->v[0] = body->v[1] = body->v[2] = body->w = 0;
        if (bodies->space)
            memset(bodies->space->body[number].spin, 0, sizeof bodies->space->body[number].spin);
        bodies->awake--;
    }
}

fp3_status fp3_bodies_rest(fp3_bodies *bodies) {
    if (!(bodies->def.rest_speed > 0) || !count_rest(bodies))
        return FP3_OK;
    uint32_t *root = malloc((bodies->movable + 1u) * sizeof *root);
    float *least = malloc((bodies->movable + 1u) * sizeof *least);
    if (root && least) {
        fp3_bodies_islands(bodies, root);
        fall_asleep(bodies, root, least);
    }
    const int is_made = root && least;
    free(root);
    free(least);
    return is_made ? FP3_OK : fp3_no_memory(bodies->error);
}
