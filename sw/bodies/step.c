/* SPDX-License-Identifier: Apache-2.0 */
/* step.c - a step: who touches, what that does in each substep, and where bodies are then. */
#include "guess.h"
#include "heavy.h"
#include "own3.h"
#include "share.h"
#include "turn.h"

#include "base/host.h"

#include <inttypes.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* ---- slots ---- */

/* In the order of their slots. */
enum { BY_FORCES, BY_CALLER, NOT, KINDS = NOT };
#define CHUNKS 64 /* of all bodies */

static int kind_of(const fp3_body *body) {
    if (!fp3_body_lives(body))
        return NOT;
    return fp3_body_moves(body) ? BY_FORCES : body->type == FP3_KINEMATIC ? BY_CALLER : NOT;
}

typedef struct {
    fp3_bodies *bodies;
    uint32_t slot[CHUNKS][KINDS]; /* of a chunk: how many there are; the first one's slot */
} slotting;

static uint32_t chunk_of(const fp3_bodies *bodies, uint32_t chunk) {
    return (uint32_t)((uint64_t)bodies->body_count * chunk / CHUNKS);
}

static void count_chunks(void *of, uint32_t from, uint32_t to) {
    slotting *all = of;
    for (uint32_t chunk = from; chunk < to; chunk++) {
        uint32_t count[KINDS + 1] = {0};
        const uint32_t end = chunk_of(all->bodies, chunk + 1);
        for (uint32_t i = chunk_of(all->bodies, chunk); i < end; i++)
            count[kind_of(&all->bodies->body[i])]++;
        memcpy(all->slot[chunk], count, sizeof all->slot[chunk]);
    }
}

static void fill_chunks(void *of, uint32_t from, uint32_t to) {
    slotting *all = of;
    fp3_bodies *bodies = all->bodies;
    for (uint32_t chunk = from; chunk < to; chunk++) {
        const uint32_t end = chunk_of(bodies, chunk + 1);
        for (uint32_t i = chunk_of(bodies, chunk); i < end; i++) {
            const int kind = kind_of(&bodies->body[i]);
            const uint32_t slot = kind == NOT ? FP3_NOBODY : all->slot[chunk][kind]++;
            bodies->body[i].slot = slot;
            if (kind != NOT)
                bodies->in_slot[slot] = i;
        }
    }
}

/* Counts become slots, from `next` on. */
static uint32_t add_up(slotting *all, int kind, uint32_t next) {
    for (uint32_t chunk = 0; chunk < CHUNKS; chunk++) {
        const uint32_t count = all->slot[chunk][kind];
        all->slot[chunk][kind] = next;
        next += count;
    }
    return next;
}

static fp3_status give_slots(fp3_bodies *bodies) {
    const struct {
        void **array;
        size_t size;
    } arrays[] = {{(void **)&bodies->in_slot, sizeof *bodies->in_slot},
                  {(void **)&bodies->speed, sizeof *bodies->speed},
                  {(void **)&bodies->way, sizeof *bodies->way},
                  {(void **)&bodies->base, sizeof *bodies->base},
                  {(void **)&bodies->pull, sizeof *bodies->pull},
                  {(void **)&bodies->heft, sizeof *bodies->heft},
                  {(void **)&bodies->is_held, sizeof *bodies->is_held}};
    uint32_t room = bodies->slot_room;
    const size_t fours = bodies->space ? FP3_FOURS3 : 1;
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        room = bodies->slot_room;
        const fp3_status status = fp3_bodies_room(arrays[i].array, &room, arrays[i].size,
                                                  fours * (bodies->body_count + 1u), bodies->error);
        if (status)
            return status;
    }
    bodies->slot_room = room;
    slotting all = {.bodies = bodies};
    const uint32_t least = CHUNKS * FP3_LEAST_BODIES / (bodies->body_count + 1) + 1;
    fp3_bodies_share(bodies, count_chunks, &all, CHUNKS, least);
    bodies->movable = bodies->awake = add_up(&all, BY_FORCES, 0);
    bodies->in_slot[bodies->movable] = FP3_NOBODY;
    bodies->slots = add_up(&all, BY_CALLER, bodies->movable + 1);
    fp3_bodies_share(bodies, fill_chunks, &all, CHUNKS, least);
    return fp3_cut_bodies(bodies);
}

/* ---- bodies ---- */

static float slowed(float damping, double h) {
    return damping == 0 ? 1 : (float)(1 / (1 + h * damping));
}

static void bring_some(void *of, uint32_t from, uint32_t to) {
    fp3_bodies *bodies = of;
    const double h = bodies->def.h / bodies->def.substeps;
    for (uint32_t k = from; k < to; k++) {
        bodies->way[k] = (fp3_four){0};
        bodies->is_held[k] = 0;
        if (bodies->in_slot[k] == FP3_NOBODY) {
            bodies->speed[k] = bodies->heft[k] = (fp3_four){0};
            bodies->pull[k] = (fp3_pull2){{0}, {1, 1, 1, 1}, {0}};
            continue;
        }
        const fp3_body *body = &bodies->body[bodies->in_slot[k]];
        const float m = fp3_inverse_mass(body->mass), i = fp3_inverse_mass(body->inertia);
        bodies->heft[k] = (fp3_four){m, i, 0, i > 0 ? i / m * (body->extent * body->extent) : 0};
        const float spin = i > 0 || k > bodies->movable ? body->w : 0;
        bodies->speed[k] = (fp3_four){body->v[0], body->v[1], spin, 0};
        const double *g = bodies->def.gravity;
        const float ax = (float)(h * (body->gravity * g[0] + m * body->force[0]));
        const float ay = (float)(h * (body->gravity * g[1] + m * body->force[1]));
        const float aw = (float)(h * (i * body->torque));
        const float slow = slowed(body->damping, h), slow_spin = slowed(body->spin_damping, h);
        const fp3_four pull = {ax, ay, aw, 0};
        bodies->pull[k] = (fp3_pull2){pull, {slow, slow, slow_spin, 1}, 0.5f * (float)h * pull};
        if (k > bodies->movable)
            bodies->pull[k] = (fp3_pull2){{0}, {1, 1, 1, 1}, {0}};
    }
}

/* It has bounced, or goes apart. */
static int flies(const fp3_bodies *bodies, const fp3_touch2 *t) {
    int is_apart = t->approach < 0;
    for (uint32_t k = 0; k < t->m.count; k++)
        is_apart &= t->m.point[k].gap > 0;
    return is_apart || (bodies->may_bounce && (t->top > 0 || t->is_left));
}

/* Two threads may say of a body that it is held. */
static void hold(fp3_bodies *bodies, uint32_t a, uint32_t b) {
    __atomic_store_n(&bodies->is_held[a], 1, __ATOMIC_RELAXED);
    __atomic_store_n(&bodies->is_held[b], 1, __ATOMIC_RELAXED);
}

static void hold_some(void *of, uint32_t from, uint32_t to) {
    fp3_bodies *bodies = of;
    for (uint32_t i = from; i < to; i++) {
        const fp3_touch2 *t = &bodies->touch[bodies->contacts.of[i]];
        if (!flies(bodies, t))
            hold(bodies, fp3_slot_of(bodies, t->body_a), fp3_slot_of(bodies, t->body_b));
    }
}

static void drop_some(void *of, uint32_t from, uint32_t to) {
    fp3_bodies *bodies = of;
    const uint32_t fours = bodies->space ? FP3_FOURS3 : 1;
    for (uint32_t k = from; k < to; k++)
        if (bodies->is_held[k])
            bodies->pull[fours * k].drop = (fp3_four){0};
}

/* Bodies that have no row, alone. */
static void let_fall(fp3_bodies *bodies) {
    fp3_bodies_share(bodies, hold_some, bodies, bodies->contacts.count, FP3_LEAST_PAIRS);
    for (uint32_t law = 0; law < FP3_JOINT_LAWS; law++) {
        const fp3_law_rows *rows = fp3_joint_rows(bodies, law);
        for (uint32_t i = 0; i < rows->count; i++)
            hold(bodies, rows->a[i], rows->b[i]);
    }
    fp3_bodies_share_slots(bodies, drop_some, bodies);
    fp3_heavy_hold(bodies);
}

static int is_finite(fp3_four v, fp3_four way) {
    int is = 1;
    for (int i = 0; i < 3; i++)
        is &= isfinite(v[i]) && isfinite(way[i]);
    return is;
}

typedef struct {
    fp3_bodies *bodies;
    atomic_int has_failed;
} moving;

static void move_some(void *of, uint32_t from, uint32_t to) {
    moving *all = of;
    fp3_bodies *bodies = all->bodies;
    for (uint32_t k = from; k < to; k++) {
        if (bodies->in_slot[k] == FP3_NOBODY)
            continue;
        fp3_body *body = &bodies->body[bodies->in_slot[k]];
        const fp3_four v = bodies->speed[k], way = bodies->way[k];
        if (!is_finite(v, way)) {
            atomic_store(&all->has_failed, 1);
            continue;
        }
        body->v[0] = v[0];
        body->v[1] = v[1];
        body->w = v[2];
        body->at[0] += way[0];
        body->at[1] += way[1];
        body->angle += way[2];
        fp3_turn2_by(body->turn, way[2]);
        body->force[0] = body->force[1] = body->torque = 0;
    }
}

static fp3_status move(fp3_bodies *bodies) {
    moving all = {bodies, 0};
    fp3_bodies_share_slots(bodies, move_some, &all);
    for (uint32_t k = 0; all.has_failed && k < bodies->slots; k++) {
        const fp3_four v = bodies->speed[k];
        if (bodies->in_slot[k] != FP3_NOBODY && !is_finite(v, bodies->way[k]))
            return fp3_fail(bodies->error, FP3_E_FAILED,
                            "body %" PRIu32 " in step %" PRIu64
                            ": its speed is %g, %g and its spin %g: expected finite numbers",
                            bodies->in_slot[k], bodies->steps + 1, v[0], v[1], v[2]);
    }
    return FP3_OK;
}

/* ---- a step ---- */

static fp3_status begin_in_plane(fp3_bodies *bodies, double h) {
    fp3_bodies_share_slots(bodies, bring_some, bodies);
    fp3_status status = fp3_contacts_begin(bodies, h);
    if (!status)
        status = fp3_joints_begin(bodies, h);
    if (!status)
        status = fp3_guess_begin(bodies);
    int has_hit = 0;
    if (!status)
        status = fp3_impacts(bodies, &has_hit);
    if (status)
        return status;
    if (has_hit)
        fp3_contacts_follow(bodies);
    return FP3_OK;
}

static fp3_status end_in_plane(fp3_bodies *bodies, double h) {
    fp3_contacts_end(bodies, h);
    const fp3_status status = move(bodies);
    fp3_joints_end(bodies, h);
    return status;
}

static fp3_status pass(fp3_bodies *bodies, double h) {
    const fp3_status status = fp3_substeps_do(bodies, h);
    return status ? fp3_fail(bodies->error, status, "could not make a step: %s",
                             bodies->laws ? fp3_laws_why(bodies->laws) : "out of memory")
                  : FP3_OK;
}

#define FEW 1000 /* bodies and pairs (in space each is three): fewer end before a thread wakes */
#define LONG 64  /* steps */

/* Where others have their processors, threads hold each other up: then one steps alone, first for a
 * step, then twice as long as the last time. */
static fp3_threads *crew_of(fp3_bodies *bodies) {
    const uint32_t work = (bodies->touch_count + bodies->movable) * (bodies->space ? 3 : 1);
    if (work < FEW || !bodies->threads || bodies->share)
        return NULL;
    if (fp3_threads_held_up(bodies->threads)) {
        bodies->pause = bodies->pause < LONG ? 2 * bodies->pause + 1 : LONG;
        bodies->alone = bodies->pause;
    } else if (!bodies->alone)
        bodies->pause /= 2;
    if (!bodies->alone)
        return bodies->threads;
    bodies->alone--;
    return NULL;
}

static void count_step(fp3_bodies *bodies) {
    bodies->steps++;
    bodies->time = (double)bodies->steps * bodies->def.h;
}

static fp3_status step(fp3_bodies *bodies) {
    const double h = bodies->def.h / bodies->def.substeps;
    fp3_status status = FP3_OK;
    if (bodies->is_still && !bodies->is_changed) {
        count_step(bodies);
        return FP3_OK;
    }
    bodies->crew = crew_of(bodies);
    bodies->has_turned = 0;
    bodies->ended_before = bodies->change_count[FP3_CONTACT_ENDED];
    for (int wakes = 1; !status && wakes;) {
        status = give_slots(bodies);
        if (!status)
            status = fp3_bodies_touch(bodies, &wakes);
    }
    if (!status)
        status = fp3_share_divide(bodies);
    if (!status)
        status = bodies->space ? fp3_space_begin(bodies, h) : begin_in_plane(bodies, h);
    if (!status) {
        let_fall(bodies);
        status = pass(bodies, h);
    }
    status = fp3_share_gather(bodies, status);
    if (status)
        return status;
    status = bodies->space ? fp3_space_end(bodies, h) : end_in_plane(bodies, h);
    count_step(bodies);
    const fp3_status told = fp3_contacts_tell(bodies), rested = fp3_bodies_rest(bodies);
    bodies->is_still = bodies->slots == 1;
    return fp3_share_agree(bodies, status ? status : told ? told : rested);
}

/* What the caller's changes have ended since the last call stays. */
static void forget(fp3_bodies *bodies) {
    bodies->change_count[FP3_CONTACT_BEGAN] = bodies->change_count[FP3_CONTACT_HIT] = 0;
    bodies->change_count[FP3_CONTACT_ENDED] -= bodies->told;
    if (bodies->told)
        memmove(bodies->change[FP3_CONTACT_ENDED], bodies->change[FP3_CONTACT_ENDED] + bodies->told,
                bodies->change_count[FP3_CONTACT_ENDED] * sizeof(fp3_contact));
    bodies->told = 0;
}

fp3_status fp3_bodies_step(fp3_bodies *bodies, uint64_t steps) {
    FP3_HOST;
    fp3_status first = FP3_OK;
    fp3_error first_error = {.text = ""};
    forget(bodies);
    for (uint64_t i = 0; i < steps && (!first || first == FP3_E_FAILED); i++) {
        const fp3_status status = step(bodies);
        if (!status || (first && status == FP3_E_FAILED))
            continue;
        first = status;
        if (bodies->error)
            first_error = *bodies->error;
    }
    if (first && bodies->error)
        *bodies->error = first_error;
    bodies->told = bodies->change_count[FP3_CONTACT_ENDED];
    return first;
}

double fp3_bodies_time(const fp3_bodies *bodies) { return bodies->time; }
size_t fp3_bodies_awake(const fp3_bodies *bodies) { return bodies->awake; }
size_t fp3_bodies_touching(const fp3_bodies *bodies) { return bodies->touching; }
