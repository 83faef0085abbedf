/* SPDX-License-Identifier: Apache-2.0 */
/* outline.c - see outline.h. */
#include "outline.h"

#include "own3.h"

#include <math.h>
#include <stdlib.h>

/* What an outline points to: as much as a form needs. */
typedef struct {
    double (*corner)[3];
    uint32_t (*triangle)[3];
} room;

static void put_point(fp3_point3 p, double to[3]) {
    to[0] = (double)p.x;
    to[1] = (double)p.y;
    to[2] = (double)p.z;
}

static void put2(const fp3_shape2 *shape, const room *to, fp3_outline *made) {
    made->radius = (double)shape->radius;
    for (uint32_t k = 0; k < made->corners; k++) {
        to->corner[k][0] = (double)shape->core.corner.x[k];
        to->corner[k][1] = (double)shape->core.corner.y[k];
        to->corner[k][2] = 0;
    }
}

/* The fan of each face. */
static void put_hull(const fp3_shape3 *shape, const room *to, fp3_outline *made) {
    made->radius = (double)shape->radius;
    for (uint32_t k = 0; k < shape->count; k++)
        put_point(shape->corner[k], to->corner[k]);
    for (uint32_t f = 0; f < shape->faces; f++) {
        const uint8_t first = shape->first[f], *next = shape->next, *from = shape->from;
        for (uint8_t half = next[first]; next[half] != first; half = next[half]) {
            uint32_t *triangle = to->triangle[made->triangles++];
            triangle[0] = from[first];
            triangle[1] = from[half];
            triangle[2] = from[next[half]];
        }
    }
}

static void put_plane(const fp3_plane3 *plane, const room *to, fp3_outline *made) {
    made->radius = INFINITY;
    put_point(fp3_times3(plane->offset, plane->normal), to->corner[0]);
    put_point(fp3_times3(plane->offset + 1, plane->normal), to->corner[1]);
}

static void put_mesh(const fp3_mesh3 *mesh, const room *to, fp3_outline *made) {
    for (uint32_t k = 0; k < made->corners; k++)
        put_point(fp3_mesh_point3(mesh, k), to->corner[k]);
    for (; made->triangles < fp3_mesh_triangles3(mesh); made->triangles++)
        for (int k = 0; k < 3; k++)
            to->triangle[made->triangles][k] =
                fp3_mesh_corners3(mesh, (uint32_t)made->triangles)[k];
}

static void put3(const fp3_form3 *form, const room *to, fp3_outline *made) {
    if (form->kind == FP3_FORM_HULL)
        put_hull(&form->shape, to, made);
    else if (form->kind == FP3_FORM_PLANE)
        put_plane(&form->plane, to, made);
    else
        put_mesh(form->mesh, to, made);
}

static size_t corners_of(const fp3_attached *shape) {
    const fp3_form3 *form = shape->form;
    return !form                          ? shape->given.core.count
           : form->kind == FP3_FORM_HULL  ? form->shape.count
           : form->kind == FP3_FORM_PLANE ? 2
                                          : fp3_mesh_points3(form->mesh);
}

static fp3_status put(const fp3_bodies *bodies, const fp3_attached *shape, fp3_outline_fn *one,
                      void *user, fp3_error *error) {
    const fp3_form3 *form = shape->form;
    const size_t triangles = form && form->mesh ? fp3_mesh_triangles3(form->mesh) : FP3_HALVES3;
    fp3_outline made = {.body = fp3_bodies_handle(bodies, shape->body),
                        .type = (fp3_body_type)bodies->body[shape->body].type,
                        .is_sensor = shape->is_sensor,
                        .corners = corners_of(shape)};
    const room to = {malloc(made.corners * sizeof *to.corner),
                     malloc(triangles * sizeof *to.triangle)};
    fp3_status status = to.corner && to.triangle ? FP3_OK : fp3_no_memory(error);
    if (!status) {
        if (form)
            put3(form, &to, &made);
        else
            put2(&shape->given, &to, &made);
        made.corner = (const double(*)[3])to.corner;
        made.triangle = (const uint32_t(*)[3])to.triangle;
        status = one(user, &made);
    }
    free(to.corner);
    free(to.triangle);
    return status;
}

fp3_status fp3_bodies_outlines(const fp3_bodies *bodies, fp3_outline_fn *one, void *user,
                               fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < bodies->shape_count; i++)
        if (bodies->shape[i].generation & 1)
            status = put(bodies, &bodies->shape[i], one, user, error);
    return status;
}

fp3_status fp3_bodies_outline_joints(const fp3_bodies *bodies, fp3_outline_joint_fn *one,
                                     void *user) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < bodies->joint_count; i++) {
        const fp3_joint_def *def = &bodies->joint[i].def;
        if (bodies->joint[i].generation & 1)
            status =
                one(user, &(fp3_outline_joint){
                              .type = def->type,
                              .joint = (uint64_t)bodies->joint[i].generation << 32 | i,
                              .a = def->a,
                              .b = def->b,
                              .anchor_a = {def->anchor_a[0], def->anchor_a[1], def->anchor_a[2]},
                              .anchor_b = {def->anchor_b[0], def->anchor_b[1], def->anchor_b[2]}});
    }
    return status;
}
