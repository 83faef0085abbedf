/* SPDX-License-Identifier: Apache-2.0 */
/* step.c - a step: who touches, what that does in each substep, and where bodies are then. */
#include "own.h"
#include "turn.h"

#include "base/host.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Contacts are springs and dampers that a substep can resolve (docs/bodies.md): no stiffer than
 * this share of the substeps' rate, in turns of the spring. */
#define STIFFNESS 30.0 /* Hz, at most */
#define RESOLVED 0.25
#define DAMPING 10.0 /* of critical damping */
#define PI 3.14159265358979323846

/* ---- slots ---- */

static int is_of_step(const fp3_body *body) { return fp3_body_lives(body) && fp3_body_moves(body); }

static fp3_status give_slots(fp3_bodies *bodies) {
    uint32_t count = 0, room = bodies->slot_room, others[3] = {room, room, room};
    const size_t wanted = bodies->body_count + 1u;
    fp3_status status = fp3_bodies_room((void **)&bodies->in_slot, &room, sizeof *bodies->in_slot,
                                        wanted, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&bodies->moving, &others[0], sizeof *bodies->moving,
                                 wanted, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&bodies->base, &others[1], sizeof *bodies->base, wanted,
                                 bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&bodies->pull, &others[2], sizeof *bodies->pull, wanted,
                                 bodies->error);
    if (status)
        return status;
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

static uint32_t slot_of(const fp3_bodies *bodies, uint32_t shape) {
    const fp3_body *body = &bodies->body[bodies->shape[shape].body];
    return body->slot == FP3_NOBODY ? bodies->movable : body->slot;
}

/* ---- rows ---- */

typedef struct {
    float rate, soft, fade; /* as contact2.ode has them */
} softness;

/* A spring of `hertz` with DAMPING, in one implicit step of length h. */
static softness soften(double hertz, double h) {
    const double omega = 2 * PI * hertz, a1 = 2 * DAMPING + h * omega, a2 = h * omega * a1,
                 a3 = 1 / (1 + a2);
    return (softness){(float)(omega / a1), (float)(a2 * a3), (float)a3};
}

static void put(fp3_wide *word, uint32_t lane, float value) { (*word)[lane] = value; }

static void fill(fp3_bodies *bodies, uint32_t active, uint32_t place, const softness *softness,
                 float scale) {
    const fp3_touch2 *t = &bodies->touch[bodies->active[active]];
    const fp3_attached *a = &bodies->shape[t->a], *b = &bodies->shape[t->b];
    const fp3_body *x = &bodies->body[a->body], *y = &bodies->body[b->body];
    const float from_x = (float)(y->at[0] - x->at[0]), from_y = (float)(y->at[1] - x->at[1]);
    const int is_against_ground =
        slot_of(bodies, t->a) >= bodies->movable || slot_of(bodies, t->b) >= bodies->movable;
    const uint32_t lane = place % FP3_WIDE;
    fp3_contact2_row *row = &bodies->row[place / FP3_WIDE];
    fp3_ends2 *ends = &bodies->ends[place / FP3_WIDE];
    ends->a[lane] = slot_of(bodies, t->a);
    ends->b[lane] = slot_of(bodies, t->b);
    put(&row->n_x, lane, t->m.normal.x);
    put(&row->n_y, lane, t->m.normal.y);
    const int second = t->m.count == 2;
    const fp3_point2 arm1 = t->m.point[0].arm, arm2 = t->m.point[second].arm;
    put(&row->a1, lane, arm1.x);
    put(&row->c1, lane, arm1.y);
    put(&row->b1, lane, arm1.x - from_x);
    put(&row->e1, lane, arm1.y - from_y);
    put(&row->s1, lane, t->m.point[0].gap);
    put(&row->j1, lane, 1);
    put(&row->a2, lane, arm2.x);
    put(&row->c2, lane, arm2.y);
    put(&row->b2, lane, arm2.x - from_x);
    put(&row->e2, lane, arm2.y - from_y);
    put(&row->s2, lane, t->m.point[second].gap);
    put(&row->j2, lane, (float)second);
    put(&row->mu, lane, sqrtf(a->friction * b->friction));
    put(&row->belt, lane, a->belt + b->belt);
    put(&row->reach, lane, a->rolling > b->rolling ? a->rolling : b->rolling);
    put(&row->rate, lane, softness[is_against_ground].rate);
    put(&row->soft, lane, softness[is_against_ground].soft);
    put(&row->fade, lane, softness[is_against_ground].fade);
    put(&row->p1, lane, scale * t->p[0]);
    put(&row->f1, lane, scale * t->f[0]);
    put(&row->p2, lane, scale * t->p[1]);
    put(&row->f2, lane, scale * t->f[1]);
    put(&row->r, lane, scale * t->r);
    put(&row->top1, lane, 0);
    put(&row->top2, lane, 0);
    const float bounce = a->restitution > b->restitution ? a->restitution : b->restitution;
    put(&row->out1, lane, bounce);
    put(&row->out2, lane, second ? bounce : 0);
}

static fp3_status colour(fp3_bodies *bodies) {
    const uint32_t count = bodies->active_count;
    uint32_t *ends = NULL, room = 0;
    fp3_status status =
        fp3_bodies_room((void **)&ends, &room, 3 * sizeof *ends, count + 1u, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&bodies->lane, &bodies->lane_room, sizeof *bodies->lane,
                                 count + 1u, bodies->error);
    if (!status) {
        uint32_t *a = ends, *b = ends + count, *colour = ends + 2 * (size_t)count;
        for (uint32_t i = 0; i < count; i++) {
            a[i] = slot_of(bodies, bodies->touch[bodies->active[i]].a);
            b[i] = slot_of(bodies, bodies->touch[bodies->active[i]].b);
        }
        status = fp3_colours_find(&bodies->colours, a, b, count, bodies->movable, FP3_WIDE, colour,
                                  bodies->lane, bodies->error);
    }
    free(ends);
    return status;
}

static fp3_status make_rows(fp3_bodies *bodies, double h) {
    fp3_status status = colour(bodies);
    if (status)
        return status;
    const uint32_t blocks = bodies->colours.first[bodies->colours.count];
    uint32_t room = bodies->block_room;
    status = fp3_bodies_room((void **)&bodies->row, &room, sizeof *bodies->row, blocks + 1u,
                             bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&bodies->ends, &bodies->block_room, sizeof *bodies->ends,
                                 blocks + 1u, bodies->error);
    if (status)
        return status;
    memset(bodies->row, 0, blocks * sizeof *bodies->row);
    for (uint32_t i = 0; i < blocks; i++)
        for (uint32_t lane = 0; lane < FP3_WIDE; lane++)
            bodies->ends[i].a[lane] = bodies->ends[i].b[lane] = bodies->movable;
    const double hertz = fmin(STIFFNESS, RESOLVED / h);
    const softness softness[2] = {soften(hertz, h), soften(2 * hertz, h)};
    const float scale = bodies->h_before > 0 ? (float)(h / bodies->h_before) : 0;
    for (uint32_t i = 0; i < bodies->active_count; i++)
        fill(bodies, i, bodies->lane[i], softness, scale);
    return FP3_OK;
}

/* Impulses go back to their contacts. */
static void keep(fp3_bodies *bodies) {
    for (uint32_t i = 0; i < bodies->active_count; i++) {
        fp3_touch2 *t = &bodies->touch[bodies->active[i]];
        const fp3_contact2_row *row = &bodies->row[bodies->lane[i] / FP3_WIDE];
        const uint32_t lane = bodies->lane[i] % FP3_WIDE;
        t->p[0] = row->p1[lane];
        t->f[0] = row->f1[lane];
        t->p[1] = row->p2[lane];
        t->f[1] = row->f2[lane];
        t->r = row->r[lane];
    }
}

/* ---- bodies ---- */

static float inverse_of(float x) { return x > 0 ? 1 / x : 0; }

static void bring(fp3_bodies *bodies, double h) {
    for (uint32_t k = 0; k < bodies->slots; k++) {
        if (bodies->in_slot[k] == FP3_NOBODY) {
            bodies->moving[k] = fp3_wide_all(0);
            continue;
        }
        const fp3_body *body = &bodies->body[bodies->in_slot[k]];
        const float m = inverse_of(body->mass), i = inverse_of(body->inertia);
        bodies->moving[k] = (fp3_wide){body->v[0], body->v[1], body->w, 0, 0, 0, m, i};
        const double *g = bodies->def.gravity;
        const float ax = (float)(h * (body->gravity * g[0] + m * body->force[0]));
        const float ay = (float)(h * (body->gravity * g[1] + m * body->force[1]));
        const float aw = (float)(h * (i * body->torque));
        const float slow = (float)(1 / (1 + h * body->damping)),
                    slow_spin = (float)(1 / (1 + h * body->spin_damping));
        bodies->pull[k] = (fp3_pull2){{ax, ay, aw}, {slow, slow, slow_spin, 1, 1, 1, 1, 1}};
    }
}

static fp3_status move(fp3_bodies *bodies) {
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; k < bodies->slots; k++) {
        if (bodies->in_slot[k] == FP3_NOBODY)
            continue;
        fp3_body *body = &bodies->body[bodies->in_slot[k]];
        const fp3_wide now = bodies->moving[k];
        float sum = 0;
        for (int i = 0; i < 6; i++)
            sum += now[i] * 0; /* NaN if one is not finite */
        if (sum != 0 && !status) {
            status =
                fp3_fail(bodies->error, FP3_E_FAILED,
                         "body %" PRIu32 " in step %" PRIu64 ": its speed or its way is not finite",
                         bodies->in_slot[k], bodies->steps + 1);
            continue;
        }
        if (sum != 0)
            continue;
        body->v[0] = now[0];
        body->v[1] = now[1];
        body->w = now[2];
        body->at[0] += now[3];
        body->at[1] += now[4];
        body->angle += now[5];
        fp3_turn2_by(body->turn, now[5]);
        body->force[0] = body->force[1] = body->torque = 0;
    }
    return status;
}

/* ---- a step ---- */

typedef void law_of(const fp3_solver2 *, const fp3_work2 *, uint32_t, uint32_t, const float[3]);

static void contact(const fp3_solver2 *s, const fp3_work2 *work, uint32_t first, uint32_t end,
                    const float shared[3]) {
    s->pass(work, first, end, shared[0], shared[1], shared[2]);
}
static void warm(const fp3_solver2 *s, const fp3_work2 *work, uint32_t first, uint32_t end,
                 const float shared[3]) {
    (void)shared;
    s->warm(work, first, end);
}
static void bounce(const fp3_solver2 *s, const fp3_work2 *work, uint32_t first, uint32_t end,
                   const float shared[3]) {
    (void)shared;
    s->bounce(work, first, end);
}
static law_of *const built_in[FP3_LAWS] = {contact, warm, bounce};

/* All contacts, colour by colour. */
static fp3_status pass(const fp3_bodies *bodies, fp3_law law, const fp3_work2 *work, float push,
                       double h) {
    const float shared[3] = {push, (float)(1 / h), (float)-bodies->def.push};
    const uint32_t *first = bodies->colours.first;
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; !status && k < bodies->colours.count; k++)
        if (bodies->laws)
            status = fp3_laws_run(bodies->laws, law, work, first[k], first[k + 1], shared);
        else
            built_in[law](bodies->solver, work, first[k], first[k + 1], shared);
    return status;
}

static fp3_status solve(fp3_bodies *bodies, double h) {
    const fp3_solver2 *solver = bodies->solver;
    const fp3_work2 work = {bodies->moving, bodies->movable, bodies->row, bodies->ends};
    fp3_status status = FP3_OK;
    solver->prepare(&work, 0, bodies->colours.first[bodies->colours.count],
                    (float)bodies->def.bounce);
    for (uint32_t step = 0; !status && step < bodies->def.substeps; step++) {
        solver->speed(bodies->moving, bodies->base, bodies->pull, bodies->movable, step == 0);
        if (step == 0)
            status = pass(bodies, FP3_LAW_WARM2, &work, 1, h);
        if (!status)
            status = pass(bodies, FP3_LAW_CONTACT2, &work, 1, h);
        solver->place(bodies->moving, bodies->slots, (float)h);
        if (!status)
            status = pass(bodies, FP3_LAW_CONTACT2, &work, 0, h);
    }
    return status ? status : pass(bodies, FP3_LAW_BOUNCE2, &work, 0, h);
}

static fp3_status step(fp3_bodies *bodies) {
    const double h = bodies->def.h / bodies->def.substeps;
    fp3_status status = FP3_OK;
    for (int wakes = 1; !status && wakes;) {
        status = give_slots(bodies);
        if (!status)
            status = fp3_bodies_touch(bodies, &wakes);
    }
    if (!status)
        status = make_rows(bodies, h);
    if (status)
        return status;
    bring(bodies, h);
    status = solve(bodies, h);
    if (status)
        return fp3_fail(bodies->error, status, "the engine could not make a step");
    keep(bodies);
    bodies->h_before = (float)h;
    status = move(bodies);
    bodies->steps++;
    bodies->time = (double)bodies->steps * bodies->def.h;
    const fp3_status rested = fp3_bodies_rest(bodies);
    return status ? status : rested;
}

fp3_status fp3_bodies_step(fp3_bodies *bodies, uint64_t steps) {
    FP3_HOST;
    fp3_status first = FP3_OK;
    for (uint64_t i = 0; i < steps; i++) {
        const fp3_status status = step(bodies);
        if (status && status != FP3_E_FAILED)
            return status;
        first = first ? first : status;
    }
    return first;
}

double fp3_bodies_time(const fp3_bodies *bodies) { return bodies->time; }
size_t fp3_bodies_awake(const fp3_bodies *bodies) { return bodies->awake; }
size_t fp3_bodies_touching(const fp3_bodies *bodies) { return bodies->touching; }
