/* SPDX-License-Identifier: Apache-2.0 */
/* step3.c - a step in space. */
#include "guess.h"
#include "heavy.h"
#include "own3.h"

#include <inttypes.h>
#include <math.h>
#include <stdatomic.h>
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

static void bring_one(fp3_bodies *bodies, uint32_t slot) {
    const double h = bodies->def.h / bodies->def.substeps;
    const uint32_t number = bodies->in_slot[slot];
    const fp3_body *body = &bodies->body[number];
    const fp3_body3 *space = &bodies->space->body[number];
    const double *g = bodies->def.gravity;
    const float m = fp3_inverse_mass(body->mass);
    const float *i = space->moment[0] > 0 ? space->back : NOTHING;
    bodies->heft[2 * slot] = (fp3_four){m, i[0], i[1], i[2]};
    bodies->heft[2 * slot + 1] = (fp3_four){i[3], i[4], i[5], 0};
    bodies->speed[2 * slot] = (fp3_four){body->v[0], body->v[1], body->v[2], 0};
    if (space->moment[0] > 0 || slot > bodies->movable)
        bodies->speed[2 * slot + 1] = (fp3_four){space->spin[0], space->spin[1], space->spin[2], 0};
    else
        bodies->speed[2 * slot + 1] = (fp3_four){0};
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
    if (slot < bodies->movable) /* unless something holds it (step.c) */
        pull[0].drop = 0.5f * (float)h * pull[0].pull;
}

/* What a block of eight slots turns with. */
static void fill_turning(const fp3_bodies *bodies, uint32_t block) {
    static const float unit[6] = {1, 1, 1, 0, 0, 0};
    const fp3_space *s = bodies->space;
    fp3_turning3_row *row = &s->turning[block];
    for (uint32_t lane = 0; lane < FP3_WIDE; lane++) {
        const uint32_t k = block * FP3_WIDE + lane, slot = k < bodies->slots ? k : bodies->movable,
                       number = bodies->in_slot[slot];
        const float *i = number == FP3_NOBODY ? unit : s->body[number].inertia,
                    *j = number == FP3_NOBODY ? unit : s->body[number].back;
        fp3_wide *const words[12] = {&row->i_x, &row->i_y, &row->i_z, &row->o_x,
                                     &row->o_y, &row->o_z, &row->j_x, &row->j_y,
                                     &row->j_z, &row->k_x, &row->k_y, &row->k_z};
        for (int w = 0; w < 6; w++) {
            fp3_put(words[w], lane, i[w]);
            fp3_put(words[w + 6], lane, j[w]);
        }
        s->turning_ends[block].a[lane] = s->turning_ends[block].b[lane] = slot;
    }
}

/* Slots from .. to - 1, which begin with a block of eight. */
static void bring_some(void *of, uint32_t from, uint32_t to) {
    fp3_bodies *bodies = of;
    for (uint32_t k = from; k < to; k++) {
        bodies->way[2 * k] = (fp3_four){0, 0, 0, 1};
        bodies->way[2 * k + 1] = bodies->speed[2 * k] = bodies->speed[2 * k + 1] = (fp3_four){0};
        bodies->heft[2 * k] = bodies->heft[2 * k + 1] = (fp3_four){0};
        bodies->pull[2 * k] = bodies->pull[2 * k + 1] = NO_PULL;
        bodies->is_held[k] = 0;
        if (bodies->in_slot[k] == FP3_NOBODY)
            continue;
        turn_inertia(&bodies->space->body[bodies->in_slot[k]]);
        bring_one(bodies, k);
    }
    for (uint32_t block = from / FP3_WIDE; block * FP3_WIDE < to; block++)
        fill_turning(bodies, block);
}

static fp3_status bring(fp3_bodies *bodies) {
    fp3_space *s = bodies->space;
    const uint32_t blocks = (bodies->slots + FP3_WIDE - 1) / FP3_WIDE;
    fp3_status status = fp3_bodies_room((void **)&s->turning, &s->turning_room, sizeof *s->turning,
                                        blocks + 1u, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&s->turning_ends, &s->turning_end_room,
                                 sizeof *s->turning_ends, blocks + 1u, bodies->error);
    if (!status)
        fp3_bodies_share_slots(bodies, bring_some, bodies);
    return status;
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

typedef struct {
    fp3_bodies *bodies;
    atomic_int has_failed;
} moving;

static void move_some(void *of, uint32_t from, uint32_t to) {
    moving *all = of;
    for (uint32_t k = from; k < to; k++) {
        if (all->bodies->in_slot[k] == FP3_NOBODY)
            continue;
        if (is_finite(all->bodies, k))
            move_one(all->bodies, k);
        else
            atomic_store(&all->has_failed, 1);
    }
}

static fp3_status move(fp3_bodies *bodies) {
    moving all = {bodies, 0};
    fp3_bodies_share_slots(bodies, move_some, &all);
    for (uint32_t k = 0; all.has_failed && k < bodies->slots; k++) {
        const fp3_four v = bodies->speed[2 * k], w = bodies->speed[2 * k + 1];
        if (bodies->in_slot[k] != FP3_NOBODY && !is_finite(bodies, k))
            return fp3_fail(bodies->error, FP3_E_FAILED,
                            "body %" PRIu32 " in step %" PRIu64
                            ": its speed is %g, %g, %g and its spin %g, %g, %g: expected finite "
                            "numbers",
                            bodies->in_slot[k], bodies->steps + 1, v[0], v[1], v[2], w[0], w[1],
                            w[2]);
    }
    return FP3_OK;
}

/* ---- a step ---- */

fp3_status fp3_space_begin(fp3_bodies *bodies, double h) {
    int has_hit = 0;
    fp3_status status = bring(bodies);
    if (!status)
        status = fp3_space_contacts_begin(bodies, h);
    if (!status)
        status = fp3_heavy_find(bodies, &fp3_heavy_laws3, fp3_space_firm(h).rate);
    if (!status)
        status = fp3_space_joints_begin(bodies);
    if (!status)
        status = fp3_guess_begin(bodies);
    if (status)
        return status;
    fp3_space_joints_first(bodies);
    status = fp3_impacts(bodies, &has_hit);
    if (!status && has_hit)
        fp3_space_contacts_follow(bodies);
    return status;
}

fp3_status fp3_space_end(fp3_bodies *bodies, double h) {
    fp3_space_joints_stand(bodies);
    fp3_space_contacts_end(bodies);
    const fp3_status status = move(bodies);
    fp3_space_joints_end(bodies, h);
    return status;
}
