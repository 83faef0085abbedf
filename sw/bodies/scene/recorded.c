/* SPDX-License-Identifier: Apache-2.0 */
/* recorded.c - see recorded.h. */
#include "recorded.h"

#include "bodies/outline.h"

#include <stdlib.h>
#include <string.h>

enum { SHAPE_WORDS = 4, CORNERS = 3, JOINT_WORDS = 4, CONTACT_WORDS = 3, PLACE = 3, POINT = 7 };

/* The number of a body in the recording; below 0: it is not recorded. Nobody was removed, so a
 * body's number is its place in the scene. */
static int64_t object_of(const fp3_bodies_tables *t, uint64_t handle) {
    const size_t number = (uint32_t)handle;
    return number - t->first < t->count ? (int64_t)(number - t->first) : -1;
}

static fp3_status grow(fp3_bodies_tables *t, void *array, uint32_t *room, size_t size,
                       size_t wanted) {
    return fp3_bodies_grow(array, room, size, wanted, t->error);
}

/* An fp3_outline_fn. */
static fp3_status add_shape(void *user, const fp3_outline *o) {
    fp3_bodies_tables *t = user;
    const int64_t object = object_of(t, o->body);
    const size_t shapes = t->shape_count + 1, corners = t->corner_count + o->corners;
    const size_t triangles = t->triangle_count + o->triangles;
    if (object < 0)
        return FP3_OK;
    fp3_status status =
        grow(t, &t->shapes, &t->shape_room, SHAPE_WORDS * sizeof *t->shapes, shapes);
    if (!status)
        status = grow(t, &t->radii, &t->radius_room, sizeof *t->radii, shapes);
    if (!status)
        status = grow(t, &t->corners, &t->corner_room, PLACE * sizeof *t->corners, corners);
    if (!status)
        status =
            grow(t, &t->triangles, &t->triangle_room, CORNERS * sizeof *t->triangles, triangles);
    if (status)
        return status;
    uint32_t *words = t->shapes + SHAPE_WORDS * t->shape_count;
    words[0] = (uint32_t)object;
    words[1] = (uint32_t)o->corners;
    words[2] = (uint32_t)o->is_sensor;
    words[3] = (uint32_t)o->type;
    t->radii[t->shape_count++] = o->radius;
    for (size_t i = 0; i < CORNERS * o->triangles; i++)
        t->triangles[CORNERS * t->triangle_count + i] =
            (uint32_t)t->corner_count + o->triangle[i / CORNERS][i % CORNERS];
    t->triangle_count = triangles;
    memcpy(t->corners + PLACE * t->corner_count, o->corner, o->corners * sizeof *o->corner);
    t->corner_count = corners;
    return FP3_OK;
}

/* An fp3_outline_joint_fn. */
static fp3_status add_joint(void *user, const fp3_outline_joint *o) {
    fp3_bodies_tables *t = user;
    const int64_t a = object_of(t, o->a), b = object_of(t, o->b);
    if (a < 0 || b < 0)
        return FP3_OK;
    fp3_status status =
        grow(t, &t->joints, &t->joint_room, JOINT_WORDS * sizeof *t->joints, t->joint_count + 1);
    if (!status)
        status = grow(t, &t->handles, &t->handle_room, sizeof *t->handles, t->joint_count + 1);
    if (!status)
        status = grow(t, &t->anchors, &t->anchor_room, 2 * PLACE * sizeof *t->anchors,
                      t->joint_count + 1);
    if (status)
        return status;
    uint32_t *words = t->joints + JOINT_WORDS * t->joint_count;
    words[0] = (uint32_t)a;
    words[1] = (uint32_t)b;
    words[2] = (uint32_t)o->type;
    words[3] = 0;
    t->handles[t->joint_count] = o->joint;
    double *anchors = t->anchors + 2 * PLACE * t->joint_count++;
    memcpy(anchors, o->anchor_a, sizeof o->anchor_a);
    memcpy(anchors + PLACE, o->anchor_b, sizeof o->anchor_b);
    return FP3_OK;
}

fp3_status fp3_bodies_tables_open(const fp3_bodies_scene *scene, size_t first, size_t count,
                                  fp3_bodies_tables *tables, fp3_error *error) {
    *tables = (fp3_bodies_tables){.scene = scene, .first = first, .count = count, .error = error};
    const fp3_status status = fp3_bodies_outlines(scene->bodies, add_shape, tables, error);
    return status ? status : fp3_bodies_outline_joints(scene->bodies, add_joint, tables);
}

static fp3_status add_contact(fp3_bodies_tables *t, uint64_t number, const fp3_contact *c) {
    const int64_t a = object_of(t, c->body_a), b = object_of(t, c->body_b);
    if (a < 0 || b < 0)
        return FP3_OK;
    fp3_status status = grow(t, &t->contacts, &t->contact_room, CONTACT_WORDS * sizeof *t->contacts,
                             t->contact_count + 1);
    if (!status)
        status =
            grow(t, &t->points, &t->point_room, POINT * sizeof *t->points, t->contact_count + 1);
    if (status)
        return status;
    uint32_t *words = t->contacts + CONTACT_WORDS * t->contact_count;
    words[0] = (uint32_t)number;
    words[1] = (uint32_t)a;
    words[2] = (uint32_t)b;
    double *point = t->points + POINT * t->contact_count++;
    const double values[POINT] = {c->point[0],
                                  c->point[1],
                                  c->point[2],
                                  c->normal[0],
                                  c->normal[1],
                                  c->normal[2],
                                  c->impulse * t->scene->substeps / t->scene->h};
    memcpy(point, values, sizeof values);
    return FP3_OK;
}

fp3_status fp3_bodies_tables_look(fp3_bodies_tables *t, uint64_t number, int has_contacts) {
    const fp3_contact *list;
    size_t count;
    for (size_t i = 0; i < t->joint_count; i++)
        if (fp3_bodies_is_joined(t->scene->bodies, t->handles[i]))
            t->joints[JOINT_WORDS * i + 3] = (uint32_t)number + 1;
    if (!has_contacts)
        return FP3_OK;
    fp3_status status = fp3_bodies_contacts(t->scene->bodies, &list, &count);
    for (size_t i = 0; !status && i < count; i++)
        status = add_contact(t, number, &list[i]);
    return status;
}

void fp3_bodies_tables_gather(fp3_bodies_tables *t) {
    const fp3_extra extras[FP3_BODIES_TABLES] = {
        {"shapes:of", FP3_EXTRA_UINT32, t->shape_count, SHAPE_WORDS, t->shapes},
        {"shapes:radius", FP3_EXTRA_DOUBLE, t->shape_count, 1, t->radii},
        {"shapes:corners", FP3_EXTRA_DOUBLE, t->corner_count, PLACE, t->corners},
        {"shapes:triangles", FP3_EXTRA_UINT32, t->triangle_count, CORNERS, t->triangles},
        {"joints:of", FP3_EXTRA_UINT32, t->joint_count, JOINT_WORDS, t->joints},
        {"joints:anchors", FP3_EXTRA_DOUBLE, t->joint_count, 2 * PLACE, t->anchors},
        {"contacts:of", FP3_EXTRA_UINT32, t->contact_count, CONTACT_WORDS, t->contacts},
        {"contacts:points", FP3_EXTRA_DOUBLE, t->contact_count, POINT, t->points}};
    memcpy(t->extras, extras, sizeof extras);
}

void fp3_bodies_tables_close(fp3_bodies_tables *t) {
    free(t->shapes);
    free(t->radii);
    free(t->corners);
    free(t->triangles);
    free(t->joints);
    free(t->anchors);
    free(t->handles);
    free(t->contacts);
    free(t->points);
    *t = (fp3_bodies_tables){0};
}
