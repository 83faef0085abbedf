/* SPDX-License-Identifier: Apache-2.0 */
/* step3.c - a step in space. */
#include "own3.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- bodies ---- */

/* The inertia in the world's axes, and its inverse. */
static void turn_inertia(fp3_body3 *body) {
    static const float unit[6] = {1, 1, 1, 0, 0, 0};
    static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
    double q[4];
    if (!(body->moment[0] > 0)) {
        memcpy(body->inertia, unit, sizeof unit);
        memcpy(body->back, unit, sizeof unit);
        return;
    }
    if (body->moment[0] == body->moment[1] && body->moment[0] == body->moment[2]) {
        for (int k = 0; k < 6; k++) {
            body->inertia[k] = unit[k] * body->moment[0];
            body->back[k] = unit[k] * (1 / body->moment[0]);
        }
        return;
    }
    fp3_multiply3(body->q, body->axes, q);
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double axis[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                               {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                               {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    const double inverse[3] = {1.0 / body->moment[0], 1.0 / body->moment[1], 1.0 / body->moment[2]};
    for (int k = 0; k < 6; k++) {
        double sum = 0, back = 0;
        for (int i = 0; i < 3; i++) {
            const double product = axis[row[k]][i] * axis[column[k]][i];
            sum += body->moment[i] * product;
            back += inverse[i] * product;
        }
        body->inertia[k] = (float)sum;
        body->back[k] = (float)back;
    }
}

static const float NOTHING[6] = {0};
static const fp3_pull2 NO_PULL = {{0}, {1, 1, 1, 1}, {0}};

static float slow_of(double h, float damping) {
    return damping > 0 ? (float)(1 / (1 + h * damping)) : 1;
}

static void bring_one(fp3_bodies *bodies, uint32_t slot, double h) {
    const uint32_t number = bodies->in_slot[slot];
    const fp3_body *body = &bodies->body[number];
    const fp3_body3 *space = &bodies->space->body[number];
    const double *g = bodies->def.gravity;
    const float m = fp3_inverse_mass(body->mass);
    const float *i = space->moment[0] > 0 ? space->back : NOTHING;
    bodies->heft[2 * slot] = (fp3_four){m, i[0], i[1], i[2]};
    bodies->heft[2 * slot + 1] = (fp3_four){i[3], i[4], i[5], 0};
    bodies->speed[2 * slot] = (fp3_four){body->v[0], body->v[1], body->v[2], 0};
    bodies->speed[2 * slot + 1] = (fp3_four){space->spin[0], space->spin[1], space->spin[2], 0};
    if (slot > bodies->movable)
        return;
    const float slow = slow_of(h, body->damping), slow_spin = slow_of(h, body->spin_damping);
    fp3_pull2 *pull = &bodies->pull[2 * slot];
    for (int k = 0; k < 3; k++)
        pull[0].pull[k] = (float)(h * (body->gravity * g[k] + m * body->force[k]));
    pull[0].damp = (fp3_four){slow, slow, slow, 1};
    pull[1].damp = (fp3_four){slow_spin, slow_spin, slow_spin, 1};
    if (space->moment[0] > 0) {
        const fp3_point3 more = fp3_tensor3(space->back, fp3_point3_of(space->torque));
        pull[1].pull = (fp3_four){(float)h * more.x, (float)h * more.y, (float)h * more.z, 0};
    }
}

static void bring(fp3_bodies *bodies, double h) {
    for (uint32_t k = 0; k < bodies->slots; k++) {
        bodies->way[2 * k] = (fp3_four){0, 0, 0, 1};
        bodies->way[2 * k + 1] = bodies->speed[2 * k] = bodies->speed[2 * k + 1] = (fp3_four){0};
        bodies->heft[2 * k] = bodies->heft[2 * k + 1] = (fp3_four){0};
        bodies->pull[2 * k] = bodies->pull[2 * k + 1] = NO_PULL;
        if (bodies->in_slot[k] == FP3_NOBODY)
            continue;
        turn_inertia(&bodies->space->body[bodies->in_slot[k]]);
        bring_one(bodies, k, h);
    }
}

static fp3_status lay_turning(fp3_bodies *bodies) {
    fp3_space *s = bodies->space;
    const uint32_t blocks = (bodies->slots + FP3_WIDE - 1) / FP3_WIDE;
    fp3_status status = fp3_bodies_room((void **)&s->turning, &s->turning_room, sizeof *s->turning,
                                        blocks + 1u, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&s->turning_ends, &s->turning_end_room,
                                 sizeof *s->turning_ends, blocks + 1u, bodies->error);
    for (uint32_t k = 0; !status && k < blocks * FP3_WIDE; k++) {
        static const float unit[6] = {1, 1, 1, 0, 0, 0};
        const uint32_t slot = k < bodies->slots ? k : bodies->movable, lane = k % FP3_WIDE,
                       number = bodies->in_slot[slot];
        const float *i = number == FP3_NOBODY ? unit : s->body[number].inertia,
                    *j = number == FP3_NOBODY ? unit : s->body[number].back;
        fp3_turning3_row *row = &s->turning[k / FP3_WIDE];
        fp3_wide *const words[12] = {&row->i_x, &row->i_y, &row->i_z, &row->o_x,
                                     &row->o_y, &row->o_z, &row->j_x, &row->j_y,
                                     &row->j_z, &row->k_x, &row->k_y, &row->k_z};
        for (int w = 0; w < 6; w++) {
            fp3_put(words[w], lane, i[w]);
            fp3_put(words[w + 6], lane, j[w]);
        }
        s->turning_ends[k / FP3_WIDE].a[lane] = s->turning_ends[k / FP3_WIDE].b[lane] = slot;
    }
    return status;
}

/* It goes apart, or has bounced. */
static int flies(const fp3_bodies *bodies, const fp3_touch2 *t) {
    return (t->approach < 0 && t->m.point[0].gap > 0) ||
           (bodies->may_bounce && (t->top > 0 || t->is_left));
}

/* Bodies that nothing holds follow their parabola. */
static void let_fall(fp3_bodies *bodies, double h) {
    for (uint32_t k = 0; k < bodies->movable; k++)
        bodies->pull[2 * k].drop = 0.5f * (float)h * bodies->pull[2 * k].pull;
    for (uint32_t i = 0; i < bodies->contacts.count; i++) {
        const fp3_touch2 *t = &bodies->touch[bodies->contacts.of[i]];
        if (flies(bodies, t))
            continue;
        bodies->pull[2 * fp3_slot_of(bodies, t->body_a)].drop = (fp3_four){0};
        bodies->pull[2 * fp3_slot_of(bodies, t->body_b)].drop = (fp3_four){0};
    }
    for (uint32_t i = 0; i < bodies->joint_count; i++) {
        const fp3_joint *j = &bodies->joint[i];
        if (!(j->generation & 1))
            continue;
        bodies->pull[2 * fp3_slot_of(bodies, j->a)].drop = (fp3_four){0};
        bodies->pull[2 * fp3_slot_of(bodies, j->b)].drop = (fp3_four){0};
    }
}

static int is_finite(const fp3_bodies *bodies, uint32_t slot) {
    float sum = 0;
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 4; i++)
            sum += bodies->speed[2 * slot + k][i] * 0 + bodies->way[2 * slot + k][i] * 0;
    return sum == 0;
}

static void move_one(fp3_bodies *bodies, uint32_t slot) {
    const uint32_t number = bodies->in_slot[slot];
    fp3_body *body = &bodies->body[number];
    fp3_body3 *space = &bodies->space->body[number];
    const fp3_four v = bodies->speed[2 * slot], w = bodies->speed[2 * slot + 1],
                   way = bodies->way[2 * slot], q = bodies->way[2 * slot + 1];
    const double by[4] = {way[3], q[0], q[1], q[2]};
    double turn[4];
    for (int i = 0; i < 3; i++) {
        body->v[i] = v[i];
        space->spin[i] = w[i];
        body->at[i] += way[i];
        body->force[i] = space->torque[i] = 0;
    }
    fp3_multiply3(by, space->q, turn);
    const double size =
        sqrt((turn[0] * turn[0] + turn[1] * turn[1]) + (turn[2] * turn[2] + turn[3] * turn[3]));
    for (int i = 0; i < 4; i++)
        space->q[i] = turn[i] / size;
}

static fp3_status move(fp3_bodies *bodies) {
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; k < bodies->slots; k++) {
        if (bodies->in_slot[k] == FP3_NOBODY)
            continue;
        if (is_finite(bodies, k)) {
            move_one(bodies, k);
            continue;
        }
        const fp3_four v = bodies->speed[2 * k], w = bodies->speed[2 * k + 1];
        if (!status)
            status =
                fp3_fail(bodies->error, FP3_E_FAILED,
                         "body %" PRIu32 " in step %" PRIu64
                         ": its speed is %g, %g, %g and its spin %g, %g, %g: expected finite "
                         "numbers",
                         bodies->in_slot[k], bodies->steps + 1, v[0], v[1], v[2], w[0], w[1], w[2]);
    }
    return status;
}

/* ---- a step ---- */

/* As the solver has it, law by law: points while blocks of the colour have them. */
static fp3_status run_pass(const fp3_bodies *bodies, const fp3_work2 *work, uint32_t first,
                           uint32_t end, const float shared[FP3_SHARED], int has_moved) {
    fp3_laws *laws = bodies->laws;
    const int has_friction = fp3_has_friction3(shared);
    const fp3_making3 *making = &bodies->space->making;
    fp3_status status = FP3_OK;
    for (uint32_t i = first; !status && i < end; i++) {
        const uint32_t points = making->points[i] & ~(uint32_t)FP3_HAS_TURNED;
        if (has_moved)
            status = fp3_laws_run(laws, FP3_LAW_gap3, work, i, i + 1, 0, shared);
        if (!status && has_moved && making->points[i] & FP3_HAS_TURNED)
            bodies->space->solver->renew(work, making, i);
        if (!status && has_friction && bodies->space->is_rolling)
            status = fp3_laws_run(laws, FP3_LAW_roll3, work, i, i + 1, 0, shared);
        if (!status)
            status = fp3_laws_run(laws, FP3_LAW_meet3, work, i, i + 1, 0, shared);
        for (uint32_t k = 0; !status && k < points; k++)
            status = fp3_laws_run(laws, FP3_LAW_push3, work, i, i + 1, k, shared);
        if (!status && has_friction)
            status = fp3_laws_run(laws, FP3_LAW_rub3, work, i, i + 1, 0, shared);
        if (!status)
            status = fp3_laws_run(laws, FP3_LAW_give3, work, i, i + 1, 0, shared);
    }
    return status;
}

#define LEAST_PASSED 8 /* blocks that are worth a thread */

typedef struct {
    fp3_work2 work;
    const fp3_space *space;
    const float *shared;
    int has_moved;
} passing;

static void pass_some(void *of, uint32_t from, uint32_t to) {
    const passing *p = of;
    const fp3_space *s = p->space;
    s->solver->pass(&p->work, &s->making, from, to, p->shared, s->is_rolling, p->has_moved);
}

static fp3_status pass_contacts(const fp3_bodies *bodies, const float shared[FP3_SHARED],
                                int has_moved) {
    const fp3_space *s = bodies->space;
    const fp3_law_rows *rows = &s->contacts;
    passing all = {{bodies->speed, bodies->way, NULL, bodies->movable, rows->row, rows->ends},
                   s,
                   shared,
                   has_moved};
    const uint32_t *first = rows->colours.first;
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; !status && rows->count && k < rows->colours.count; k++) {
        if (bodies->laws)
            status = run_pass(bodies, &all.work, first[k], first[k + 1], shared, has_moved);
        else
            fp3_threads_share(
                bodies->crew,
                (fp3_lap){pass_some, &all, first[k], first[k + 1],
                          fp3_threads_parts(bodies->crew, first[k + 1] - first[k], LEAST_PASSED)});
    }
    return status;
}

static fp3_status pass_joints(const fp3_bodies *bodies, const float shared[FP3_SHARED]) {
    const fp3_space *s = bodies->space;
    fp3_status status = FP3_OK;
    for (uint32_t i = 1; !status && i <= FP3_JOINT_LAWS3; i++) {
        const uint32_t law = i % FP3_JOINT_LAWS3; /* points last: they must not come apart */
        const fp3_law_rows *rows = &s->joined[law];
        const fp3_work2 work = {bodies->speed,   bodies->way, bodies->base,
                                bodies->movable, rows->row,   rows->ends};
        const uint32_t *first = rows->colours.first;
        for (uint32_t k = 0; !status && rows->count && k < rows->colours.count; k++) {
            if (bodies->laws)
                status = fp3_laws_run(bodies->laws, FP3_LAW_pin3 + law, &work, first[k],
                                      first[k + 1], 0, shared);
            else
                s->solver->joint[law](&work, first[k], first[k + 1], shared);
        }
    }
    return status;
}

/* Joints first: contacts have the last word. */
static fp3_status pass_all(const fp3_bodies *bodies, const float shared[FP3_SHARED],
                           int has_moved) {
    const fp3_status status = pass_joints(bodies, shared);
    return status ? status : pass_contacts(bodies, shared, has_moved);
}

static fp3_status turn(const fp3_bodies *bodies, const float shared[FP3_SHARED]) {
    const fp3_space *s = bodies->space;
    const fp3_work2 work = {bodies->speed, bodies->way, bodies->base,
                            bodies->slots, s->turning,  s->turning_ends};
    const uint32_t blocks = (bodies->slots + FP3_WIDE - 1) / FP3_WIDE;
    if (bodies->laws)
        return fp3_laws_run(bodies->laws, FP3_LAW_turn3, &work, 0, blocks, 0, shared);
    s->solver->turn(&work, 0, blocks, shared);
    return FP3_OK;
}

static void place(fp3_bodies *bodies, float h) {
    for (uint32_t k = 0; k < bodies->slots; k++)
        bodies->way[2 * k] += h * bodies->speed[2 * k] - bodies->pull[2 * k].drop;
}

static int is_turned(const fp3_bodies *bodies, uint32_t slot) {
    return bodies->heft[2 * slot + 1][3] > 0;
}

/* A substep begins with what contacts gave in the last one, which bodies have kept. Of who has
 * turned far, it would be taken back otherwise than it was given: it gets it from its rows, as they
 * are now. */
static fp3_status give_again(fp3_bodies *bodies, const float warm[FP3_SHARED]) {
    const fp3_space *s = bodies->space;
    const size_t fours = 2 * (size_t)bodies->movable;
    fp3_status status =
        fp3_bodies_room((void **)&bodies->space->before, &bodies->space->before_room,
                        sizeof *s->before, fours, bodies->error);
    if (status)
        return status;
    memcpy(s->before, bodies->speed, fours * sizeof *s->before);
    const fp3_work2 work = {bodies->speed,   bodies->way,     NULL,
                            bodies->movable, s->contacts.row, s->contacts.ends};
    for (uint32_t i = 0; !status && i < s->contacts.blocks; i++) {
        if (!(s->points[i] & FP3_HAS_TURNED))
            continue;
        if (bodies->laws)
            status = run_pass(bodies, &work, i, i + 1, warm, 0);
        else
            s->solver->pass(&work, &s->making, i, i + 1, warm, s->is_rolling, 0);
    }
    for (uint32_t k = 0; k < fours; k++)
        if (!is_turned(bodies, k / 2))
            bodies->speed[k] = s->before[k];
    return status;
}

/* Speeds of a substep before its passes. */
static fp3_status begin_substep(fp3_bodies *bodies, int is_first, const float warm[FP3_SHARED]) {
    const int has_turned = !is_first && bodies->space->has_turned;
    for (uint32_t k = 0; has_turned && k < 2 * bodies->movable; k++)
        if (is_turned(bodies, k / 2))
            bodies->base[k] = bodies->speed[k];
    bodies->solver->speed(bodies->speed, bodies->base, bodies->pull, 2 * bodies->movable, is_first);
    return is_first     ? pass_contacts(bodies, warm, 0)
           : has_turned ? give_again(bodies, warm)
                        : FP3_OK;
}

/* As in a plane (step.c); and bodies turn. */
fp3_status fp3_space_substeps(fp3_bodies *bodies, double h) {
    const float inverse = (float)(1 / h), least = (float)-bodies->def.push;
    const float push[FP3_SHARED] = {1, inverse, least, 0, (float)h},
                mend[FP3_SHARED] = {0, inverse, least, 0, (float)h},
                warm[FP3_SHARED] = {1, inverse, least, 1, (float)h};
    fp3_status status = FP3_OK;
    for (uint32_t step = 0; !status && step < bodies->def.substeps; step++) {
        status = begin_substep(bodies, step == 0, warm);
        if (!status)
            status = pass_joints(bodies, warm);
        if (!status)
            status = pass_all(bodies, push, 0);
        place(bodies, (float)h);
        if (!status)
            status = turn(bodies, mend);
        fp3_space_joints_follow(bodies, h, 0);
        fp3_space_contacts_turn(bodies);
        if (!status)
            status = pass_all(bodies, mend, 1);
    }
    return status;
}

fp3_status fp3_space_begin(fp3_bodies *bodies, double h) {
    bring(bodies, h);
    fp3_status status = lay_turning(bodies);
    if (!status)
        status = fp3_space_contacts_begin(bodies, h);
    if (!status)
        status = fp3_space_joints_begin(bodies);
    if (status)
        return status;
    fp3_space_joints_follow(bodies, h, 1);
    int has_hit;
    status = fp3_impacts(bodies, &has_hit);
    if (status)
        return status;
    if (has_hit)
        fp3_space_contacts_follow(bodies);
    let_fall(bodies, h);
    return FP3_OK;
}

fp3_status fp3_space_end(fp3_bodies *bodies, double h) {
    fp3_space_joints_stand(bodies);
    fp3_space_contacts_end(bodies);
    const fp3_status status = move(bodies);
    fp3_space_joints_end(bodies, h);
    return status;
}
