/* SPDX-License-Identifier: Apache-2.0 */
/* form3.c - see form3.h. */
#include "form3.h"

#include "base/host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FARTHEST 1e6

static int is_point(const double x[3]) {
    return fabs(x[0]) <= FARTHEST && fabs(x[1]) <= FARTHEST && fabs(x[2]) <= FARTHEST;
}

static fp3_point3 point_of(const double x[3]) {
    return (fp3_point3){(float)x[0], (float)x[1], (float)x[2]};
}

static fp3_status make_plane(const fp3_shape_def *def, fp3_form3 *form, fp3_error *error) {
    const double *n = def->normal, size = sqrt((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]);
    if (!is_point(n) || !(size > 1e-6))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "normal is %g, %g, %g, expected a direction, with numbers to 1e6", n[0],
                        n[1], n[2]);
    if (!is_point(def->centre))
        return fp3_fail(error, FP3_E_ARGUMENT, "centre of a plane: expected numbers to 1e6");
    const double unit[3] = {n[0] / size, n[1] / size, n[2] / size}, *c = def->centre;
    form->kind = FP3_FORM_PLANE;
    form->plane.normal = point_of(unit);
    form->plane.offset = (float)((unit[0] * c[0] + unit[1] * c[1]) + unit[2] * c[2]);
    return fp3_ball3((fp3_point3){0, 0, 0}, 0, &form->shape, error);
}

static fp3_status make_shape(const fp3_shape_def *def, fp3_form3 *form, fp3_error *error) {
    const float radius = (float)def->radius;
    fp3_point3 corner[FP3_HULL_CORNERS];
    if (def->corners > FP3_HULL_CORNERS)
        return fp3_fail(error, FP3_E_ARGUMENT, "corners is %u, expected at most %d", def->corners,
                        FP3_HULL_CORNERS);
    for (uint32_t i = 0; i < def->corners; i++)
        corner[i] = point_of(def->corner[i]);
    switch (def->type) {
    case FP3_SPHERE:
        if (radius == 0) /* as a circle in a plane: it would weigh nothing */
            return fp3_fail(error, FP3_E_ARGUMENT, "a sphere has radius 0");
        return fp3_ball3(point_of(def->centre), radius, &form->shape, error);
    case FP3_CAPSULE:
        if (def->corners != 2)
            return fp3_fail(error, FP3_E_ARGUMENT, "a capsule has %u corners, expected 2",
                            def->corners);
        return fp3_capsule3(corner[0], corner[1], radius, &form->shape, error);
    case FP3_BOX: {
        fp3_pose3 pose = {.at = point_of(def->centre)};
        for (int i = 0; i < 4; i++)
            pose.q[i] = (float)def->q[i];
        if (!fp3_turn3_is_good(pose.q))
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "q: expected a quaternion with a length from 1e-3 to 1e3");
        return fp3_box3(point_of(def->half), &pose, radius, &form->shape, error);
    }
    case FP3_HULL:
        return fp3_hull3(def->corners, corner, radius, &form->shape, error);
    case FP3_PLANE:
        return make_plane(def, form, error);
    default:
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "type is %d, expected FP3_SPHERE, FP3_CAPSULE, FP3_BOX, FP3_HULL or "
                        "FP3_PLANE in space",
                        (int)def->type);
    }
}

fp3_status fp3_form_make(const fp3_shape_def *def, fp3_form3 **form, fp3_error *error) {
    fp3_form3 *made = *form = calloc(1, sizeof *made);
    if (!made)
        return fp3_no_memory(error);
    made->uses = 1;
    made->given = malloc(sizeof *made->given);
    const fp3_status status = made->given ? make_shape(def, made, error) : fp3_no_memory(error);
    if (status) {
        fp3_form_give_back(made);
        *form = NULL;
        return status;
    }
    *made->given = *def;
    if (made->kind == FP3_FORM_HULL)
        made->mass = fp3_weigh3(&made->shape, 1);
    return FP3_OK;
}

static void bound(fp3_bounds3 *bounds, fp3_point3 p) {
    bounds->low = (fp3_point3){fminf(bounds->low.x, p.x), fminf(bounds->low.y, p.y),
                               fminf(bounds->low.z, p.z)};
    bounds->high = (fp3_point3){fmaxf(bounds->high.x, p.x), fmaxf(bounds->high.y, p.y),
                                fmaxf(bounds->high.z, p.z)};
}

/* The mesh becomes the form's, or is freed. */
static fp3_status finish(fp3_mesh3 *mesh, fp3_form3 **form, fp3_error *error) {
    fp3_form3 *made = *form = calloc(1, sizeof *made);
    if (!made) {
        fp3_free_mesh3(&mesh);
        return fp3_no_memory(error);
    }
    made->kind = FP3_FORM_MESH;
    made->uses = 1;
    made->mesh = mesh;
    made->bounds = (fp3_bounds3){fp3_mesh_point3(mesh, 0), fp3_mesh_point3(mesh, 0)};
    for (uint32_t i = 1; i < fp3_mesh_points3(mesh); i++)
        bound(&made->bounds, fp3_mesh_point3(mesh, i));
    const fp3_point3 low = made->bounds.low, high = made->bounds.high,
                     far = {fmaxf(fabsf(low.x), fabsf(high.x)), fmaxf(fabsf(low.y), fabsf(high.y)),
                            fmaxf(fabsf(low.z), fabsf(high.z))};
    const fp3_status status = fp3_ball3((fp3_point3){0, 0, 0}, 0, &made->shape, error);
    made->shape.extent = 1.000001f * fp3_size3(far);
    return status;
}

fp3_status fp3_form_make_mesh(const double *points, size_t count, const uint32_t *triangles,
                              size_t triangle_count, fp3_form3 **form, fp3_error *error) {
    *form = NULL;
    for (size_t i = 0; i < count; i++)
        if (!is_point(points + 3 * i))
            return fp3_fail(error, FP3_E_ARGUMENT, "point %zu: expected numbers to 1e6", i);
    if (count > UINT32_MAX || triangle_count > UINT32_MAX)
        return fp3_fail(error, FP3_E_ARGUMENT, "more than 2^32 points or triangles");
    fp3_point3 *point = malloc((count + 1) * sizeof *point);
    fp3_mesh3 *mesh = NULL;
    fp3_status status = point ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; !status && i < count; i++)
        point[i] = point_of(points + 3 * i);
    if (!status)
        status = fp3_make_mesh3((uint32_t)count, point, (uint32_t)triangle_count,
                                (const uint32_t(*)[3])(const void *)triangles, &mesh, error);
    if (!status)
        status = finish(mesh, form, error);
    free(point);
    return status;
}

fp3_status fp3_form_make_heights(size_t columns, size_t rows, double dx, double dy,
                                 const double *heights, fp3_form3 **form, fp3_error *error) {
    const size_t most = 10000, count = columns <= most && rows <= most ? columns * rows : 0;
    fp3_mesh3 *mesh = NULL;
    float *height = malloc((count + 1) * sizeof *height);
    fp3_status status = height ? FP3_OK : fp3_no_memory(error);
    *form = NULL;
    for (size_t i = 0; !status && i < count; i++)
        height[i] = (float)heights[i];
    if (!status)
        status = fp3_make_heights3((uint32_t)(columns <= most ? columns : most + 1),
                                   (uint32_t)(rows <= most ? rows : most + 1), (float)dx, (float)dy,
                                   height, &mesh, error);
    if (!status)
        status = finish(mesh, form, error);
    free(height);
    return status;
}

void fp3_form_give_back(fp3_form3 *form) {
    if (!form || --form->uses)
        return;
    fp3_free_mesh3(&form->mesh);
    free(form->given);
    free(form);
}

/* ---- what touches ---- */

/* From b's side to a's: `to` is where a is as seen from b. */
static void turn_around(fp3_manifold3 *m, fp3_point3 to) {
    m->normal = fp3_times3(-1, m->normal);
    for (uint32_t k = 0; k < m->count; k++)
        m->point[k].arm = fp3_subtract3(m->point[k].arm, to);
}

/* Of ground and a hull. */
static uint32_t collide_ground(const fp3_form3 *a, const fp3_pose3 *pose_a, const fp3_shape3 *b,
                               const fp3_pose3 *pose_b, float reach, uint32_t most,
                               fp3_mesh_touch3 *to) {
    if (a->kind == FP3_FORM_MESH)
        return fp3_collide_mesh3(a->mesh, pose_a, b, pose_b, reach, most, to);
    to->triangle = 0;
    fp3_collide_plane3(&a->plane, pose_a, b, pose_b, reach, &to->manifold);
    return to->manifold.count > 0;
}

uint32_t fp3_form_collide(const fp3_form3 *a, const fp3_pose3 *pose_a, const fp3_form3 *b,
                          const fp3_pose3 *pose_b, float reach, uint32_t most,
                          fp3_mesh_touch3 *to) {
    if (a->kind == FP3_FORM_HULL && b->kind == FP3_FORM_HULL) {
        to->triangle = 0;
        fp3_collide3(&a->shape, pose_a, &b->shape, pose_b, reach, &to->manifold);
        return to->manifold.count > 0;
    }
    if (b->kind == FP3_FORM_HULL)
        return collide_ground(a, pose_a, &b->shape, pose_b, reach, most, to);
    if (a->kind != FP3_FORM_HULL)
        return 0; /* ground does not touch ground */
    const uint32_t count = collide_ground(b, pose_b, &a->shape, pose_a, reach, most, to);
    for (uint32_t i = 0; i < count && i < most; i++)
        turn_around(&to[i].manifold, fp3_subtract3(pose_a->at, pose_b->at));
    return count;
}

/* ---- questions ---- */

static int cast_hull(const fp3_shape3 *shape, const fp3_pose3 *pose, const fp3_shape3 *moving,
                     const fp3_pose3 *turn, fp3_point3 way, float slop, fp3_hit3 *hit) {
    return moving ? fp3_cast3(shape, pose, moving, turn, way, slop, hit)
                  : fp3_ray3(shape, pose, (fp3_point3){0, 0, 0}, way, hit);
}

/* The point of a shape (NULL: the origin) that is lowest before a plane, and its gap. */
static float lowest(const fp3_plane3 *plane, const fp3_pose3 *pose, const fp3_shape3 *shape,
                    const fp3_pose3 *turn, fp3_point3 *normal, fp3_point3 *at) {
    fp3_turn3 of = fp3_turn_of3(pose->q), own = fp3_turn_of3(turn->q);
    own.at = turn->at;
    const fp3_point3 n = fp3_turned3(&of, plane->normal);
    const uint32_t count = shape ? shape->count : 1;
    float best = INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        const fp3_point3 p = shape ? fp3_placed3(&own, shape->corner[i]) : (fp3_point3){0, 0, 0};
        const float gap = fp3_dot3(n, fp3_subtract3(p, pose->at)) - plane->offset;
        if (gap < best) {
            best = gap;
            *at = p;
        }
    }
    const float radius = shape ? shape->radius : 0;
    *at = fp3_along3(*at, -radius, n);
    *normal = n;
    return best - radius;
}

static int cast_plane(const fp3_plane3 *plane, const fp3_pose3 *pose, const fp3_shape3 *moving,
                      const fp3_pose3 *turn, fp3_point3 way, float slop, fp3_hit3 *hit) {
    static const fp3_pose3 here = {{0, 0, 0}, {1, 0, 0, 0}};
    fp3_point3 n, at;
    const float gap = lowest(plane, pose, moving, turn ? turn : &here, &n, &at);
    const float down = -fp3_dot3(way, n), left = moving ? gap - 0.5f * slop : gap;
    if (left > 0 && !(down >= left))
        return 0;
    const float fraction = left > 0 ? left / down : 0;
    const fp3_point3 there = fp3_along3(at, fraction, way);
    *hit = (fp3_hit3){fraction, n, fp3_subtract3(there, pose->at)};
    return 1;
}

int fp3_form_cast(const fp3_form3 *form, const fp3_pose3 *pose, const fp3_shape3 *moving,
                  const fp3_pose3 *turn, fp3_point3 way, float slop, fp3_hit3 *hit) {
    fp3_shape3 triangle;
    int found = 0;
    if (form->kind == FP3_FORM_HULL)
        return cast_hull(&form->shape, pose, moving, turn, way, slop, hit);
    if (form->kind == FP3_FORM_PLANE)
        return cast_plane(&form->plane, pose, moving, turn, way, slop, hit);
    for (uint32_t i = 0; i < fp3_mesh_triangles3(form->mesh); i++) {
        fp3_hit3 one;
        fp3_mesh_triangle3(form->mesh, i, &triangle);
        if (cast_hull(&triangle, pose, moving, turn, way, slop, &one) &&
            (!found || one.fraction < hit->fraction)) {
            *hit = one;
            found = 1;
        }
    }
    return found;
}

int fp3_form_separation(const fp3_form3 *form, const fp3_pose3 *pose, const fp3_shape3 *shape,
                        const fp3_pose3 *turn, fp3_apart3 *apart) {
    fp3_shape3 triangle;
    int found = 0;
    if (form->kind == FP3_FORM_HULL)
        return fp3_separation3(&form->shape, pose, shape, turn, apart);
    if (form->kind == FP3_FORM_PLANE) {
        fp3_point3 at;
        apart->gap = lowest(&form->plane, pose, shape, turn, &apart->normal, &at);
        apart->arm_b = fp3_subtract3(at, pose->at);
        apart->arm_a = fp3_along3(apart->arm_b, -apart->gap, apart->normal);
        return 1;
    }
    for (uint32_t i = 0; i < fp3_mesh_triangles3(form->mesh); i++) {
        fp3_apart3 one;
        fp3_mesh_triangle3(form->mesh, i, &triangle);
        if (fp3_separation3(&triangle, pose, shape, turn, &one) &&
            (!found || one.gap < apart->gap)) {
            *apart = one;
            found = 1;
        }
    }
    return found;
}
