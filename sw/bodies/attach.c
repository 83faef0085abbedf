/* SPDX-License-Identifier: Apache-2.0 */
/* attach.c - shapes of bodies, and what bodies weigh. */
#include "own3.h"
#include "turn.h"

#include "base/host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static fp3_point2 point_of(const double x[2]) { return (fp3_point2){(float)x[0], (float)x[1]}; }

fp3_status fp3_shape_make(const fp3_shape_def *def, fp3_shape2 *shape, fp3_error *error) {
    const float radius = (float)def->radius;
    fp3_point2 corner[FP3_CORNERS];
    if (def->corners > FP3_CORNERS)
        return fp3_fail(error, FP3_E_ARGUMENT, "corners is %u, expected at most %d", def->corners,
                        FP3_CORNERS);
    for (uint32_t i = 0; i < def->corners; i++)
        corner[i] = point_of(def->corner[i]);
    switch (def->type) {
    case FP3_CIRCLE:
        return fp3_disc2(point_of(def->centre), radius, shape, error);
    case FP3_CAPSULE:
        if (def->corners != 2)
            return fp3_fail(error, FP3_E_ARGUMENT, "a capsule has %u corners, expected 2",
                            def->corners);
        return fp3_capsule2(corner[0], corner[1], radius, shape, error);
    case FP3_BOX: {
        double turn[2];
        if (!(fabs(def->angle) <= 1e12))
            return fp3_fail(error, FP3_E_ARGUMENT, "angle is %g, expected -1e12 to 1e12",
                            def->angle);
        fp3_turn2_of(def->angle, turn);
        const fp3_pose2 pose = {point_of(def->centre), (float)turn[0], (float)turn[1]};
        return fp3_box2(point_of(def->half), &pose, radius, shape, error);
    }
    case FP3_POLYGON:
        return fp3_polygon2(corner, def->corners, radius, shape, error);
    case FP3_SPHERE:
    case FP3_HULL:
    case FP3_PLANE:
        break;
    }
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "type is %d, expected FP3_CIRCLE, FP3_CAPSULE, FP3_BOX or FP3_POLYGON in a "
                    "plane",
                    (int)def->type);
}

/* Numbers in range, and none that does not count in these dimensions. */
static fp3_status check_numbers(const fp3_shape_def *def, int is_space, fp3_error *error) {
    const double plane = is_space ? 0 : 1e9, space = is_space ? 1e9 : 0; /* the most in each */
    const fp3_bodies_range ranges[] = {{"density", def->density, 0, 1e12},
                                       {"friction", def->friction, 0, 1e6},
                                       {"restitution", def->restitution, 0, 1},
                                       {"rolling", def->rolling, 0, 1e6},
                                       {"belt", def->belt, 0 - plane, plane},
                                       {"angle", def->angle, 0 - 1e3 * plane, 1e3 * plane},
                                       {"surface[0]", def->surface[0], 0 - space, space},
                                       {"surface[1]", def->surface[1], 0 - space, space},
                                       {"surface[2]", def->surface[2], 0 - space, space}};
    const double third[] = {def->centre[2], def->half[2], def->q[1], def->q[2], def->q[3]};
    static const char *const names[] = {"centre[2]", "half[2]", "q[1]", "q[2]", "q[3]"};
    fp3_status status =
        fp3_ranges_check(ranges, sizeof ranges / sizeof *ranges, "", is_space, error);
    if (!status && def->density > 0 && def->density < 1e-12)
        status = fp3_fail(error, FP3_E_ARGUMENT, /* the inverse of an inertia has to be a float */
                          "density is %g, expected 0 or 1e-12 to 1e12", def->density);
    for (size_t i = 0; !status && !is_space && i < sizeof third / sizeof *third; i++)
        if (third[i] != 0)
            status = fp3_fail(error, FP3_E_ARGUMENT, "%s is %g, expected 0 in a plane", names[i],
                              third[i]);
    for (uint32_t i = 0; !status && !is_space && i < def->corners && i < FP3_CORNERS; i++)
        if (def->corner[i][2] != 0)
            status = fp3_fail(error, FP3_E_ARGUMENT, "corner[%u][2] is %g, expected 0 in a plane",
                              i, def->corner[i][2]);
    return status;
}

static fp3_status make(const fp3_bodies *bodies, const fp3_shape_def *def, fp3_attached *placed) {
    fp3_error *error = bodies->error;
    fp3_status status = check_numbers(def, bodies->space != NULL, error);
    if (status)
        return status;
    *placed = (fp3_attached){
        .friction = (float)def->friction,
        .restitution = (float)def->restitution,
        .rolling = (float)def->rolling,
        .belt = (float)def->belt,
        .surface = {(float)def->surface[0], (float)def->surface[1], (float)def->surface[2]},
        .density = (float)def->density,
        .category = def->category,
        .mask = def->mask,
        .is_sensor = def->is_sensor != 0};
    if (bodies->space)
        return FP3_OK;
    status = fp3_shape_make(def, &placed->given, error);
    if (status)
        return status;
    placed->mass = fp3_weigh2(&placed->given, def->is_sensor ? 0 : def->density);
    return FP3_OK;
}

/* The shape as it lies around the centre of mass. */
/* From the middle of a shape's corners to its nearest side. */
static float inner_of(const fp3_shape2 *shape) {
    const fp3_core2 *core = &shape->core;
    float least = core->count > 2 ? INFINITY : 0;
    for (uint32_t i = 0; core->count > 2 && i < core->count; i++)
        least = fminf(least, (core->corner.x[i] - shape->middle.x) * core->normal.x[i] +
                                 (core->corner.y[i] - shape->middle.y) * core->normal.y[i]);
    return least + shape->radius;
}

static void shift(fp3_attached *placed, fp3_point2 by) {
    fp3_shift2(&placed->given, by, &placed->shape);
    placed->extent = placed->shape.extent;
    placed->inner = inner_of(&placed->shape);
    placed->link = placed->given_link;
    for (uint32_t i = 0; i < 4; i++)
        placed->link.corner[i] = fp3_subtract2(placed->link.corner[i], by);
}

/* Mass, centre and inertia from shapes. A dynamic body without mass weighs 1, as in Box2D. */
static void weigh(fp3_bodies *bodies, uint32_t number) {
    if (bodies->space) {
        fp3_space_weigh(bodies, number);
        return;
    }
    fp3_body *body = &bodies->body[number];
    fp3_mass2 all = {0};
    for (uint32_t s = body->first_shape; s != FP3_NOBODY; s = bodies->shape[s].next)
        all = fp3_weigh_together2((const fp3_mass2[]){all, bodies->shape[s].mass}, 2);
    const fp3_point2 centre = {(float)all.x, (float)all.y};
    body->extent = 0;
    body->inner = body->first_shape == FP3_NOBODY ? 0 : INFINITY;
    for (uint32_t s = body->first_shape; s != FP3_NOBODY; s = bodies->shape[s].next) {
        shift(&bodies->shape[s], centre);
        body->extent = fmaxf(body->extent, bodies->shape[s].shape.extent);
        body->inner = fminf(body->inner, bodies->shape[s].inner);
    }
    /* The origin stays where it is. */
    const double c = body->turn[0], s = body->turn[1], dx = (double)centre.x - body->centre[0],
                 dy = (double)centre.y - body->centre[1];
    body->at[0] += c * dx - s * dy;
    body->at[1] += s * dx + c * dy;
    body->v[0] -= body->w * (float)(s * dx + c * dy);
    body->v[1] += body->w * (float)(c * dx - s * dy);
    body->centre[0] = centre.x;
    body->centre[1] = centre.y;
    const int is_dynamic = body->type == FP3_DYNAMIC;
    body->mass = !is_dynamic ? 0 : all.mass > 0 ? (float)all.mass : 1;
    body->inertia = !is_dynamic || body->may_not_turn ? 0 : (float)all.inertia;
}

static uint32_t next_free(fp3_bodies *bodies) {
    uint32_t number = bodies->free_shape;
    while (number < bodies->shape_count && bodies->shape[number].generation & 1)
        number++;
    bodies->free_shape = number + 1;
    if (number >= bodies->shape_count)
        bodies->boxes.count = bodies->shape_count = number + 1;
    return number;
}

static fp3_status make_room(fp3_bodies *bodies, size_t more) {
    const size_t wanted = bodies->shape_count + more + 1;
    fp3_status status = fp3_bodies_room((void **)&bodies->shape, &bodies->shape_room,
                                        sizeof *bodies->shape, wanted, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&bodies->boxes.box, &bodies->boxes.room,
                                 sizeof *bodies->boxes.box, wanted, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&bodies->boxes.filter, &bodies->boxes.filter_room,
                                 sizeof *bodies->boxes.filter, wanted, bodies->error);
    return status;
}

/* Where a body's next shape goes: shapes are in the order in which they came. */
static uint32_t *end_of(fp3_bodies *bodies, uint32_t number) {
    uint32_t *end = &bodies->body[number].first_shape;
    while (*end != FP3_NOBODY)
        end = &bodies->shape[*end].next;
    return end;
}

/* There is room. *end becomes where the next one goes. */
static void place_shape(fp3_bodies *bodies, uint32_t number, const fp3_attached *made,
                        uint32_t **end, uint64_t *handle) {
    const uint32_t at = next_free(bodies);
    const uint32_t generation = bodies->shape[at].generation + 1;
    bodies->shape[at] = *made;
    bodies->shape[at].generation = generation;
    bodies->shape[at].body = number;
    bodies->shape[at].next = FP3_NOBODY;
    fp3_form_keep(made->form);
    bodies->is_bouncy |= made->restitution > 0;
    bodies->boxes.box[at] = (fp3_box){{-INFINITY, -INFINITY, 0}, {-INFINITY, -INFINITY, 0}};
    bodies->boxes.filter[at] =
        (fp3_box_filter){made->category, made->mask, bodies->body[number].type != FP3_STATIC};
    **end = at;
    *end = &bodies->shape[at].next;
    if (handle)
        *handle = (uint64_t)generation << 32 | at;
}

/* Of bodies that have new shapes. */
static void place_all(fp3_bodies *bodies, const uint64_t *handles, size_t count) {
    fp3_bodies_wake_around(bodies, handles, count);
    for (size_t i = 0; i < count; i++) {
        weigh(bodies, (uint32_t)handles[i]);
        fp3_bodies_place_boxes(bodies, (uint32_t)handles[i]);
    }
}

fp3_status fp3_bodies_attach(fp3_bodies *bodies, const uint64_t *handles, size_t count,
                             const fp3_shape_def *shape, uint64_t *shapes) {
    FP3_HOST;
    fp3_attached made = {0};
    fp3_status status = make(bodies, shape, &made);
    uint32_t number;
    if (!status && bodies->space)
        status = fp3_form_make(shape, &made.form, bodies->error);
    for (size_t i = 0; !status && i < count; i++) {
        status = fp3_bodies_numbered(bodies, handles, i, &number);
        if (!status && made.form && made.form->kind != FP3_FORM_HULL &&
            bodies->body[number].type == FP3_DYNAMIC)
            status = fp3_fail(bodies->error, FP3_E_ARGUMENT,
                              "a plane is ground: its body must not be dynamic");
        if (!status && bodies->space)
            status = fp3_space_may_weigh(bodies, number, &made);
    }
    if (!status)
        status = make_room(bodies, count);
    for (size_t i = 0; !status && i < count; i++) {
        uint32_t *end = end_of(bodies, (uint32_t)handles[i]);
        place_shape(bodies, (uint32_t)handles[i], &made, &end, shapes ? &shapes[i] : NULL);
    }
    fp3_form_give_back(made.form);
    if (!status)
        place_all(bodies, handles, count);
    return status;
}

static fp3_status attach_form(fp3_bodies *bodies, uint64_t handle, fp3_form3 *form,
                              const fp3_shape_def *surface) {
    fp3_attached made = {0};
    fp3_shape_def material = *surface;
    material.type = FP3_SPHERE; /* whatever the caller says: it is not looked at */
    fp3_status status = make(bodies, &material, &made);
    if (!status)
        status = make_room(bodies, 1);
    made.form = form;
    if (!status) {
        uint32_t *end = end_of(bodies, (uint32_t)handle);
        place_shape(bodies, (uint32_t)handle, &made, &end, NULL);
        place_all(bodies, &handle, 1);
    }
    fp3_form_give_back(form);
    return status;
}

static fp3_status check_ground(const fp3_bodies *bodies, uint64_t handle) {
    uint32_t number;
    const fp3_status status = fp3_bodies_numbered(bodies, &handle, 0, &number);
    if (status)
        return status;
    if (!bodies->space)
        return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                        "triangles and heights are in space: expected a world of 3 dimensions");
    return bodies->body[number].type == FP3_DYNAMIC
               ? fp3_fail(bodies->error, FP3_E_ARGUMENT,
                          "triangles and heights are ground: their body must not be dynamic")
               : FP3_OK;
}

fp3_status fp3_bodies_attach_mesh(fp3_bodies *bodies, uint64_t handle, const double *points,
                                  size_t count, const uint32_t *triangles, size_t triangle_count,
                                  const fp3_shape_def *surface) {
    FP3_HOST;
    fp3_form3 *form = NULL;
    fp3_status status = check_ground(bodies, handle);
    if (!status)
        status = fp3_form_make_mesh(points, count, triangles, triangle_count, &form, bodies->error);
    return status ? status : attach_form(bodies, handle, form, surface);
}

fp3_status fp3_bodies_attach_heights(fp3_bodies *bodies, uint64_t handle, size_t columns,
                                     size_t rows, double dx, double dy, const double *heights,
                                     const fp3_shape_def *surface) {
    FP3_HOST;
    fp3_form3 *form = NULL;
    fp3_status status = check_ground(bodies, handle);
    if (!status)
        status = fp3_form_make_heights(columns, rows, dx, dy, heights, &form, bodies->error);
    return status ? status : attach_form(bodies, handle, form, surface);
}

fp3_status fp3_bodies_attach_chain(fp3_bodies *bodies, uint64_t handle, const double *corners,
                                   size_t count, int is_loop, const fp3_shape_def *surface) {
    FP3_HOST;
    const size_t edges = is_loop ? count : count - 1;
    uint32_t number;
    fp3_status status = fp3_bodies_numbered(bodies, &handle, 0, &number);
    if (!status && count < (is_loop ? 3u : 2u))
        status = fp3_fail(bodies->error, FP3_E_ARGUMENT, "the chain has %zu corners, expected %d",
                          count, is_loop ? 3 : 2);
    if (!status && bodies->space)
        status = fp3_fail(bodies->error, FP3_E_ARGUMENT,
                          "a chain is in a plane: expected triangles or heights in space");
    if (!status && bodies->body[number].type == FP3_DYNAMIC)
        status = fp3_fail(bodies->error, FP3_E_ARGUMENT,
                          "a chain is ground: its body must not be dynamic");
    if (!status)
        status = make_room(bodies, edges);
    fp3_attached *made = NULL;
    uint32_t room = 0;
    if (!status)
        status = fp3_bodies_room((void **)&made, &room, sizeof *made, edges, bodies->error);
    for (size_t i = 0; !status && i < edges; i++) {
        fp3_shape_def edge = *surface;
        edge.type = FP3_CAPSULE;
        edge.corners = 2;
        for (uint32_t k = 0; k < 2; k++)
            memcpy(edge.corner[k], corners + 2 * ((i + k) % count), 2 * sizeof *corners);
        status = make(bodies, &edge, &made[i]);
        made[i].is_link = 1;
        made[i].given_link.radius = made[i].given.radius;
        made[i].given_link.ends = (!is_loop && i == 0 ? FP3_LINK2_FIRST : 0) +
                                  (!is_loop && i + 1 == edges ? FP3_LINK2_LAST : 0);
        for (size_t k = 0; k < 4; k++) {
            const size_t at = i + k + count - 1; /* the corner before is the first of four */
            const int is_beyond = !is_loop && (i + k == 0 || i + k > count);
            const double *p = corners + 2 * (at % count);
            made[i].given_link.corner[k] = point_of(p);
            if (is_beyond) { /* the ground goes on as it ends */
                const double *end = corners + 2 * (i + k == 0 ? 0 : count - 1),
                             *inner = corners + 2 * (i + k == 0 ? 1 : count - 2);
                made[i].given_link.corner[k] =
                    (fp3_point2){(float)(2 * end[0] - inner[0]), (float)(2 * end[1] - inner[1])};
            }
        }
    }
    uint32_t *end = status ? NULL : end_of(bodies, number);
    for (size_t i = 0; !status && i < edges; i++)
        place_shape(bodies, number, &made[i], &end, NULL);
    free(made);
    if (!status)
        place_all(bodies, &handle, 1);
    return status;
}
