/* SPDX-License-Identifier: Apache-2.0 */
/* body.c - bodies come and go; handles. */
#include "own3.h"
#include "turn.h"

#include "base/host.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static fp3_status check(const fp3_body_def *def, size_t which, int is_space, fp3_error *error) {
    const double plane = is_space ? 0 : 1e12, space = is_space ? 1e12 : 0; /* the most in each */
    const fp3_bodies_range ranges[] = {{"x[0]", def->x[0], -1e12, 1e12},
                                       {"x[1]", def->x[1], -1e12, 1e12},
                                       {"x[2]", def->x[2], 0 - space, space},
                                       {"angle", def->angle, 0 - plane, plane},
                                       {"v[0]", def->v[0], -1e12, 1e12},
                                       {"v[1]", def->v[1], -1e12, 1e12},
                                       {"v[2]", def->v[2], 0 - space, space},
                                       {"w", def->w, 0 - plane, plane},
                                       {"q[1]", def->q[1], 0 - space, space},
                                       {"q[2]", def->q[2], 0 - space, space},
                                       {"q[3]", def->q[3], 0 - space, space},
                                       {"spin[0]", def->spin[0], 0 - space, space},
                                       {"spin[1]", def->spin[1], 0 - space, space},
                                       {"spin[2]", def->spin[2], 0 - space, space},
                                       {"damping", def->damping, 0, 1e12},
                                       {"spin_damping", def->spin_damping, 0, 1e12},
                                       {"gravity", def->gravity, -1e12, 1e12}};
    const double *q = def->q,
                 size = sqrt((q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]));
    char of[32];
    snprintf(of, sizeof of, "body %zu: ", which);
    if (def->type != FP3_DYNAMIC && def->type != FP3_KINEMATIC && def->type != FP3_STATIC)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "%stype is %d, expected FP3_DYNAMIC, FP3_KINEMATIC or FP3_STATIC", of,
                        (int)def->type);
    if (is_space && !(size >= 1e-3 && size <= 1e3))
        return fp3_fail(error, FP3_E_ARGUMENT, "%sthe length of q is %g, expected 1e-3 to 1e3", of,
                        size);
    return fp3_ranges_check(ranges, sizeof ranges / sizeof *ranges, of, is_space, error);
}

static void place(fp3_body *body, const fp3_body_def *def) {
    double turn[2];
    const uint32_t generation = body->generation + 1;
    fp3_turn2_of(def->angle, turn);
    *body = (fp3_body){.at = {def->x[0], def->x[1], def->x[2]},
                       .angle = def->angle,
                       .turn = {(float)turn[0], (float)turn[1]},
                       .damping = (float)def->damping,
                       .spin_damping = (float)def->spin_damping,
                       .gravity = (float)def->gravity,
                       .mass = def->type == FP3_DYNAMIC ? 1 : 0, /* until it has a shape */
                       .generation = generation,
                       .first_shape = FP3_NOBODY,
                       .slot = FP3_NOBODY,
                       .next_asleep = FP3_NOBODY,
                       .type = (uint8_t)def->type,
                       .may_not_turn = def->may_not_turn != 0,
                       .may_not_sleep = def->may_not_sleep != 0,
                       .is_fast = def->is_fast != 0};
    if (def->type == FP3_STATIC)
        return;
    body->v[0] = (float)def->v[0];
    body->v[1] = (float)def->v[1];
    body->v[2] = (float)def->v[2];
    body->w = def->may_not_turn ? 0 : (float)def->w;
}

static void place_in_space(fp3_body3 *body, const fp3_body_def *def) {
    const double *q = def->q,
                 size = sqrt((q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]));
    *body = (fp3_body3){.q = {q[0] / size, q[1] / size, q[2] / size, q[3] / size},
                        .axes = {1, 0, 0, 0}};
    for (int i = 0; i < 3; i++)
        body->spin[i] = def->type == FP3_STATIC || def->may_not_turn ? 0 : (float)def->spin[i];
}

fp3_status fp3_bodies_add(fp3_bodies *bodies, const fp3_body_def *defs, size_t count,
                          uint64_t *handles) {
    FP3_HOST;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < count; i++)
        status = check(&defs[i], i, bodies->space != NULL, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&bodies->body, &bodies->body_room, sizeof *bodies->body,
                                 bodies->living + count + 1, bodies->error);
    if (!status && bodies->space)
        status =
            fp3_bodies_room((void **)&bodies->space->body, &bodies->space->body_room,
                            sizeof *bodies->space->body, bodies->living + count + 1, bodies->error);
    if (status)
        return status;
    for (size_t i = 0; i < count; i++) {
        uint32_t number = bodies->free_body;
        while (number < bodies->body_count && fp3_body_lives(&bodies->body[number]))
            number++;
        bodies->free_body = number + 1;
        if (number >= bodies->body_count)
            bodies->body_count = number + 1;
        bodies->is_still = 0;
        place(&bodies->body[number], &defs[i]);
        if (bodies->space)
            place_in_space(&bodies->space->body[number], &defs[i]);
        handles[i] = fp3_bodies_handle(bodies, number);
        bodies->living++;
    }
    return FP3_OK;
}

static void drop_shapes(fp3_bodies *bodies, fp3_body *body) {
    for (uint32_t s = body->first_shape; s != FP3_NOBODY; s = bodies->shape[s].next) {
        bodies->shape[s].generation++;
        fp3_form_give_back(bodies->shape[s].form);
        bodies->shape[s].form = NULL;
        bodies->boxes.box[s].high[0] = -INFINITY;
        bodies->boxes.box[s].low[0] = INFINITY;
        if (s < bodies->free_shape)
            bodies->free_shape = s;
    }
    body->first_shape = FP3_NOBODY;
}

/* Contacts of shapes that are gone. */
static void drop_contacts(fp3_bodies *bodies) {
    uint32_t kept = 0;
    for (uint32_t k = 0; k < bodies->touch_count; k++) {
        const fp3_touch2 *t = &bodies->touch[k];
        if (bodies->shape[t->a].generation & bodies->shape[t->b].generation & 1)
            bodies->touch[kept++] = *t;
    }
    bodies->touch_count = kept;
}

/* What they touch ends; after a failure nothing is told. */
static fp3_status end_contacts(fp3_bodies *bodies, const uint64_t *handles, size_t count) {
    const uint32_t before = bodies->change_count[FP3_CONTACT_ENDED];
    fp3_status status = FP3_OK;
    for (size_t i = 0; i < count; i++)
        bodies->body[(uint32_t)handles[i]].is_marked = 1;
    for (uint32_t k = 0; !status && k < bodies->touch_count; k++) {
        const fp3_touch2 *t = &bodies->touch[k];
        if (t->is_touching &&
            (bodies->body[t->body_a].is_marked | bodies->body[t->body_b].is_marked))
            status = fp3_contact_tell(bodies, FP3_CONTACT_ENDED, t);
    }
    for (size_t i = 0; i < count; i++)
        bodies->body[(uint32_t)handles[i]].is_marked = 0;
    if (status)
        bodies->change_count[FP3_CONTACT_ENDED] = before;
    return status;
}

fp3_status fp3_bodies_remove(fp3_bodies *bodies, const uint64_t *handles, size_t count) {
    uint32_t number;
    fp3_status status = FP3_OK;
    size_t checked = 0;
    /* A body that was counted has an even generation until all are. */
    for (; !status && checked < count; checked++) {
        status = fp3_bodies_numbered(bodies, handles, checked, &number);
        if (!status)
            bodies->body[number].generation++;
    }
    for (size_t i = 0; i + (status != 0) < checked; i++)
        bodies->body[(uint32_t)handles[i]].generation--;
    if (!status)
        status = end_contacts(bodies, handles, count);
    if (status)
        return status;
    fp3_bodies_wake_around(bodies, handles, count);
    for (size_t i = 0; i < count; i++)
        bodies->body[(uint32_t)handles[i]].is_marked = 1;
    fp3_joints_drop(bodies);
    for (size_t i = 0; i < count; i++) {
        number = (uint32_t)handles[i];
        drop_shapes(bodies, &bodies->body[number]);
    }
    drop_contacts(bodies);
    for (size_t i = 0; i < count; i++) {
        number = (uint32_t)handles[i];
        bodies->body[number].generation++;
        if (number < bodies->free_body)
            bodies->free_body = number;
        bodies->living--;
    }
    return FP3_OK;
}

size_t fp3_bodies_count(const fp3_bodies *bodies) { return bodies->living; }

uint32_t fp3_bodies_dimensions(const fp3_bodies *bodies) { return bodies->def.dimensions; }

void fp3_bodies_handles(const fp3_bodies *bodies, uint64_t *handles) {
    for (uint32_t i = 0; i < bodies->body_count; i++)
        if (fp3_body_lives(&bodies->body[i]))
            *handles++ = fp3_bodies_handle(bodies, i);
}
