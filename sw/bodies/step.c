/* SPDX-License-Identifier: Apache-2.0 */
/* step.c - a step: who touches, what that does in each substep, and where bodies are then. */
#include "own3.h"
#include "share.h"
#include "trees.h"
#include "turn.h"

#include "base/host.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- slots ---- */

static int is_of_step(const fp3_body *body) { return fp3_body_lives(body) && fp3_body_moves(body); }

static fp3_status give_slots(fp3_bodies *bodies) {
    const struct {
        void **array;
        size_t size;
    } arrays[] = {{(void **)&bodies->in_slot, sizeof *bodies->in_slot},
                  {(void **)&bodies->speed, sizeof *bodies->speed},
                  {(void **)&bodies->way, sizeof *bodies->way},
                  {(void **)&bodies->base, sizeof *bodies->base},
                  {(void **)&bodies->pull, sizeof *bodies->pull},
                  {(void **)&bodies->heft, sizeof *bodies->heft}};
    uint32_t count = 0, room = bodies->slot_room;
    const size_t fours = bodies->space ? FP3_FOURS3 : 1;
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        room = bodies->slot_room;
        const fp3_status status = fp3_bodies_room(arrays[i].array, &room, arrays[i].size,
                                                  fours * (bodies->body_count + 1u), bodies->error);
        if (status)
            return status;
    }
    bodies->slot_room = room;
    for (uint32_t i = 0; i < bodies->body_count; i++) {
        bodies->body[i].slot = FP3_NOBODY;
        if (is_of_step(&bodies->body[i])) {
            bodies->body[i].slot = count;
            bodies->in_slot[count++] = i;
        }
    }
    bodies->movable = bodies->awake = count;
    bodies->in_slot[count++] = FP3_NOBODY;
    for (uint32_t i = 0; i < bodies->body_count; i++)
        if (fp3_body_lives(&bodies->body[i]) && bodies->body[i].type == FP3_KINEMATIC) {
            bodies->body[i].slot = count;
            bodies->in_slot[count++] = i;
        }
    bodies->slots = count;
    return FP3_OK;
}

/* ---- bodies ---- */

static float slowed(float damping, double h) {
    return damping == 0 ? 1 : (float)(1 / (1 + h * damping));
}

static void bring(fp3_bodies *bodies, double h) {
    for (uint32_t k = 0; k < bodies->slots; k++) {
        bodies->way[k] = (fp3_four){0};
        if (bodies->in_slot[k] == FP3_NOBODY) {
            bodies->speed[k] = bodies->heft[k] = (fp3_four){0};
            bodies->pull[k] = (fp3_pull2){{0}, {1, 1, 1, 1}, {0}};
            continue;
        }
        const fp3_body *body = &bodies->body[bodies->in_slot[k]];
        const float m = fp3_inverse_mass(body->mass), i = fp3_inverse_mass(body->inertia);
        bodies->heft[k] = (fp3_four){m, i};
        bodies->speed[k] = (fp3_four){body->v[0], body->v[1], body->w, 0};
        const double *g = bodies->def.gravity;
        const float ax = (float)(h * (body->gravity * g[0] + m * body->force[0]));
        const float ay = (float)(h * (body->gravity * g[1] + m * body->force[1]));
        const float aw = (float)(h * (i * body->torque));
        const float slow = slowed(body->damping, h), slow_spin = slowed(body->spin_damping, h);
        bodies->pull[k] = (fp3_pull2){{ax, ay, aw, 0}, {slow, slow, slow_spin, 1}, {0}};
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

static void hold(fp3_bodies *bodies, const fp3_law_rows *rows, int is_contact) {
    for (uint32_t i = 0; i < rows->count; i++) {
        if (is_contact && flies(bodies, &bodies->touch[rows->of[i]]))
            continue;
        bodies->pull[rows->a[i]].drop = (fp3_four){0};
        bodies->pull[rows->b[i]].drop = (fp3_four){0};
    }
}

/* Bodies that have no row. */
static void let_fall(fp3_bodies *bodies, double h) {
    for (uint32_t k = 0; k < bodies->movable; k++)
        bodies->pull[k].drop = 0.5f * (float)h * bodies->pull[k].pull;
    hold(bodies, &bodies->contacts, 1);
    for (int law = 0; law < FP3_JOINT_LAWS; law++)
        hold(bodies, &bodies->joined[law], 0);
}

static int is_finite(fp3_four v, fp3_four way) {
    int is = 1;
    for (int i = 0; i < 3; i++)
        is &= isfinite(v[i]) && isfinite(way[i]);
    return is;
}

static fp3_status move(fp3_bodies *bodies) {
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; k < bodies->slots; k++) {
        if (bodies->in_slot[k] == FP3_NOBODY)
            continue;
        fp3_body *body = &bodies->body[bodies->in_slot[k]];
        const fp3_four v = bodies->speed[k], way = bodies->way[k];
        if (!is_finite(v, way)) {
            if (!status)
                status = fp3_fail(bodies->error, FP3_E_FAILED,
                                  "body %" PRIu32 " in step %" PRIu64
                                  ": its speed is %g, %g and its spin %g: expected finite numbers",
                                  bodies->in_slot[k], bodies->steps + 1, v[0], v[1], v[2]);
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
    return status;
}

/* ---- a step ---- */

/* Rows of a colour. gap2 goes before contact2, wherever bodies have moved. */
static fp3_status pass_colour(const fp3_bodies *bodies, fp3_law law, const fp3_work2 *work,
                              uint32_t first, uint32_t end, const float shared[FP3_SHARED]) {
    if (bodies->laws) {
        const fp3_status status = fp3_laws_run(bodies->laws, law, work, first, end, 0, shared);
        return status || law != FP3_LAW_gap2
                   ? status
                   : fp3_laws_run(bodies->laws, FP3_LAW_contact2, work, first, end, 0, shared);
    }
    if (law == FP3_LAW_gap2)
        bodies->solver->moved(work, first, end, shared);
    else
        bodies->solver->law[law](work, first, end, shared);
    return FP3_OK;
}

static fp3_status pass(const fp3_bodies *bodies, fp3_law law, const fp3_law_rows *rows,
                       int is_joint, const float shared[FP3_SHARED]) {
    const fp3_work2 work = {bodies->speed,   bodies->way, is_joint ? bodies->base : NULL,
                            bodies->movable, rows->row,   rows->ends};
    const uint32_t *first = rows->colours.first;
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; !status && rows->count && k < rows->colours.count; k++)
        status = pass_colour(bodies, law, &work, first[k], first[k + 1], shared);
    return status;
}

static fp3_status pass_joints(const fp3_bodies *bodies, const float shared[FP3_SHARED]) {
    fp3_status status = FP3_OK;
    for (int i = 0; !status && i < FP3_JOINT_LAWS; i++)
        status = pass(bodies, (fp3_law)(FP3_LAW_twist2 + i), &bodies->joined[i], 1, shared);
    return status;
}

/* Joints first: contacts have the last word. */
static fp3_status pass_all(fp3_bodies *bodies, int has_moved, const float shared[FP3_SHARED]) {
    fp3_trees_solve(bodies, !has_moved);
    const fp3_status status = pass_joints(bodies, shared);
    return status ? status
                  : pass(bodies, has_moved ? FP3_LAW_gap2 : FP3_LAW_contact2, &bodies->contacts, 0,
                         shared);
}

/* Arms of joints turn within a step, so joints give their impulses anew in each substep; contacts
 * give what bodies have kept of the last one. */
static fp3_status solve(fp3_bodies *bodies, double h) {
    const fp3_solver2 *solver = bodies->solver;
    const float inverse = (float)(1 / h), least = (float)-bodies->def.push;
    const float push[FP3_SHARED] = {1, inverse, least, 0, (float)h},
                mend[FP3_SHARED] = {0, inverse, least, 0, (float)h},
                warm[FP3_SHARED] = {1, inverse, least, 1, (float)h};
    fp3_status status = FP3_OK;
    for (uint32_t step = 0; !status && step < bodies->def.substeps; step++) {
        solver->speed(bodies->speed, bodies->base, bodies->pull, bodies->movable, step == 0);
        if (step == 0)
            status = pass(bodies, FP3_LAW_warm2, &bodies->contacts, 0, warm);
        fp3_trees_forget(bodies);
        if (!status)
            status = pass_joints(bodies, warm);
        if (!status)
            status = pass_all(bodies, 0, push);
        solver->place(bodies->speed, bodies->way, bodies->pull, bodies->slots, (float)h);
        if (!status)
            status = pass_all(bodies, 1, mend);
    }
    return status;
}

static fp3_status step_in_plane(fp3_bodies *bodies, double h) {
    bring(bodies, h);
    fp3_status status = fp3_contacts_begin(bodies, h);
    if (!status)
        status = fp3_joints_begin(bodies, h);
    if (status)
        return status;
    int has_hit;
    status = fp3_impacts(bodies, &has_hit);
    if (status)
        return status;
    if (has_hit)
        fp3_contacts_follow(bodies);
    let_fall(bodies, h);
    status = fp3_share_gather(bodies, solve(bodies, h));
    if (status)
        return fp3_fail(bodies->error, status, "the engine could not make a step: %s",
                        bodies->laws ? fp3_laws_why(bodies->laws) : "");
    fp3_contacts_end(bodies, h);
    status = move(bodies);
    fp3_joints_end(bodies, h);
    return status;
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
    bodies->ended_before = bodies->change_count[FP3_CONTACT_ENDED];
    for (int wakes = 1; !status && wakes;) {
        status = give_slots(bodies);
        if (!status)
            status = fp3_bodies_touch(bodies, &wakes);
    }
    if (!status)
        status = fp3_share_divide(bodies);
    if (!status)
        status = bodies->space ? fp3_space_step(bodies, h) : step_in_plane(bodies, h);
    if (status && status != FP3_E_FAILED)
        return status;
    count_step(bodies);
    const fp3_status told = fp3_contacts_tell(bodies), rested = fp3_bodies_rest(bodies);
    bodies->is_still = bodies->slots == 1;
    return status ? status : told ? told : rested;
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
