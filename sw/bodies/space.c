/* SPDX-License-Identifier: Apache-2.0 */
/* space.c - what a world in space has, and what its bodies weigh. */
#include "own3.h"

#include <math.h>
#include <stdlib.h>

fp3_status fp3_space_open(const fp3_solver3 *solver, fp3_space **space, fp3_error *error) {
    *space = calloc(1, sizeof **space);
    if (!*space)
        return fp3_no_memory(error);
    (*space)->solver = solver;
    return FP3_OK;
}

void fp3_space_close(fp3_space **space) {
    fp3_space *s = *space;
    *space = NULL;
    if (!s)
        return;
    void *const arrays[] = {
        s->body,         s->patch,       s->old,           s->pose,    s->turning,
        s->turning_ends, s->meeting,     s->joint,         s->stance,  s->points,
        s->kept.form,    s->kept.corner, s->kept.triangle, s->kept.of, s};
    fp3_rows_free(&s->contacts);
    for (int i = 0; i < FP3_JOINT_LAWS3; i++)
        fp3_rows_free(&s->joined[i]);
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        free(arrays[i]);
}

void fp3_multiply3(const double p[4], const double q[4], double to[4]) {
    to[0] = (p[0] * q[0] - p[1] * q[1]) - (p[2] * q[2] + p[3] * q[3]);
    to[1] = (p[0] * q[1] + p[1] * q[0]) + (p[2] * q[3] - p[3] * q[2]);
    to[2] = (p[0] * q[2] + p[2] * q[0]) + (p[3] * q[1] - p[1] * q[3]);
    to[3] = (p[0] * q[3] + p[3] * q[0]) + (p[1] * q[2] - p[2] * q[1]);
}

void fp3_turned3_by(const double q[4], const double p[3], double to[3]) {
    const double x = q[2] * p[2] - q[3] * p[1], y = q[3] * p[0] - q[1] * p[2],
                 z = q[1] * p[1] - q[2] * p[0];
    to[0] = p[0] + 2 * (q[0] * x + (q[2] * z - q[3] * y));
    to[1] = p[1] + 2 * (q[0] * y + (q[3] * x - q[1] * z));
    to[2] = p[2] + 2 * (q[0] * z + (q[1] * y - q[2] * x));
}

void fp3_space_arm(const fp3_bodies *bodies, uint32_t body, const float at[3], double arm[3]) {
    const float *c = bodies->body[body].centre;
    const double from[3] = {(double)at[0] - c[0], (double)at[1] - c[1], (double)at[2] - c[2]};
    fp3_turned3_by(bodies->space->body[body].q, from, arm);
}

fp3_pose3 fp3_space_pose(const fp3_bodies *bodies, uint32_t body, fp3_point3 at) {
    static const float origin[3] = {0, 0, 0};
    const double *q = bodies->space->body[body].q;
    const float *c = bodies->body[body].centre;
    const int is_central = c[0] == 0 && c[1] == 0 && c[2] == 0;
    double arm[3] = {0, 0, 0};
    if (!is_central)
        fp3_space_arm(bodies, body, origin, arm);
    return (fp3_pose3){{at.x + (float)arm[0], at.y + (float)arm[1], at.z + (float)arm[2]},
                       {(float)q[0], (float)q[1], (float)q[2], (float)q[3]}};
}

static fp3_mass3 mass_of(const fp3_attached *shape) {
    fp3_mass3 mass = shape->form->mass;
    const double density = shape->is_sensor ? 0 : shape->density;
    mass.mass *= density;
    for (int i = 0; i < 6; i++)
        mass.inertia[i] *= density;
    return mass;
}

/* The origin stays where it is, and so does the speed of each point. */
static void move_centre(fp3_bodies *bodies, uint32_t number, const double centre[3]) {
    fp3_body *body = &bodies->body[number];
    const float *spin = bodies->space->body[number].spin;
    const double by[3] = {centre[0] - body->centre[0], centre[1] - body->centre[1],
                          centre[2] - body->centre[2]};
    double way[3];
    fp3_turned3_by(bodies->space->body[number].q, by, way);
    const fp3_point3 w = fp3_point3_of(spin), d = {(float)way[0], (float)way[1], (float)way[2]},
                     more = fp3_cross3(w, d);
    for (int i = 0; i < 3; i++) {
        body->at[i] += way[i];
        body->centre[i] = (float)centre[i];
    }
    body->v[0] += more.x;
    body->v[1] += more.y;
    body->v[2] += more.z;
}

#define LEAST 1e-36
#define MOST 1e36

fp3_status fp3_space_may_weigh(const fp3_bodies *bodies, uint32_t number,
                               const fp3_attached *more) {
    const fp3_body *body = &bodies->body[number];
    fp3_mass3 all = mass_of(more);
    double moment[3], q[4];
    if (body->type != FP3_DYNAMIC || !more->form)
        return FP3_OK;
    for (uint32_t s = body->first_shape; s != FP3_NOBODY; s = bodies->shape[s].next)
        all = fp3_weigh_together3((const fp3_mass3[]){all, mass_of(&bodies->shape[s])}, 2);
    fp3_axes_of_mass3(&all, moment, q);
    if (all.mass == 0)
        return FP3_OK;
    if (!(all.mass >= LEAST && all.mass <= MOST))
        return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                        "a body would have a mass of %g, expected %g to %g", all.mass, LEAST, MOST);
    for (int i = 0; i < 3 && !body->may_not_turn; i++)
        if (!(moment[i] >= LEAST && moment[i] <= MOST))
            return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                            "a body would have an inertia of %g, expected %g to %g", moment[i],
                            LEAST, MOST);
    return FP3_OK;
}

void fp3_space_weigh(fp3_bodies *bodies, uint32_t number) {
    fp3_body *body = &bodies->body[number];
    fp3_body3 *space = &bodies->space->body[number];
    fp3_mass3 all = {0};
    double moment[3];
    for (uint32_t s = body->first_shape; s != FP3_NOBODY; s = bodies->shape[s].next)
        all = fp3_weigh_together3((const fp3_mass3[]){all, mass_of(&bodies->shape[s])}, 2);
    const double centre[3] = {(float)all.centre[0], (float)all.centre[1], (float)all.centre[2]};
    move_centre(bodies, number, centre);
    const double size =
        sqrt((centre[0] * centre[0] + centre[1] * centre[1]) + centre[2] * centre[2]);
    for (uint32_t s = body->first_shape; s != FP3_NOBODY; s = bodies->shape[s].next)
        bodies->shape[s].extent = bodies->shape[s].form->shape.extent + (float)size;
    body->extent = 0;
    body->inner = body->first_shape == FP3_NOBODY ? 0 : INFINITY;
    for (uint32_t s = body->first_shape; s != FP3_NOBODY; s = bodies->shape[s].next) {
        const fp3_shape3 *shape = &bodies->shape[s].form->shape;
        bodies->shape[s].inner = shape->inner + shape->radius;
        body->extent = fmaxf(body->extent, bodies->shape[s].extent);
        body->inner = fminf(body->inner, bodies->shape[s].inner);
    }
    const int is_dynamic = body->type == FP3_DYNAMIC;
    body->mass = !is_dynamic ? 0 : all.mass > 0 ? (float)all.mass : 1;
    fp3_axes_of_mass3(&all, moment, space->axes);
    for (int i = 0; i < 3; i++)
        space->moment[i] = is_dynamic && !body->may_not_turn ? (float)moment[i] : 0;
}
