/* SPDX-License-Identifier: Apache-2.0 */
/* bodies.c - see bodies.h. */
#include "bodies.h"

#include "inks.h"
#include "outline.h"
#include "solid.h"
#include "turned.h"

#include <math.h>
#include <string.h>

#define RIM (5 * FP3_VIEW_PART / 2)
#define FRONT INT32_MIN /* a depth before which nothing is */
#define VEIL 77         /* of 256, what a sensor in space covers */

typedef struct {
    const fp3_view_page *page;
    const fp3_view_camera *camera;
    fp3_view_raster *raster;
    size_t first; /* value of the snapshot */
    double pixel; /* of the picture, as a length of the recording; in space, in its middle */
} drawing;

static const fp3_view_ink touch = {196, 120, 0};

/* ---- places ---- */

static void to_world(const drawing *d, const double x[3], double world[3]) {
    for (unsigned k = 0; k < 3; k++)
        world[k] = k < d->page->axes->count ? fp3_view_camera_world(d->camera, k, x[k]) : 0;
}

static fp3_view_place see(const drawing *d, const double x[3]) {
    double world[3], size;
    to_world(d, x, world);
    return fp3_view_camera_see(d->camera, world, &size);
}

/* What of a line is before the eye; 0: nothing. */
static int cut(const drawing *d, double ends[2][3]) {
    double world[2][3];
    for (int i = 0; i < 2; i++)
        to_world(d, ends[i], world[i]);
    return fp3_view_camera_cut(d->camera, (const double(*)[3])world, ends);
}

/* In space marks are before all bodies. */
static fp3_view_place see_mark(const drawing *d, const double x[3]) {
    fp3_view_place place = see(d, x);
    place.depth = d->camera->is_flat ? place.depth : FRONT;
    return place;
}

static double pixel_of(const fp3_view_camera *camera) {
    double size;
    (void)fp3_view_camera_see(camera, (const double[3]){0, 0, 0}, &size);
    return FP3_VIEW_FINE * FP3_VIEW_PART / (size * camera->scale[0]);
}

/* ---- marks ---- */

/* An area of one colour, as far away as its first corner. */
static void fill(const drawing *d, const fp3_view_place *corners, unsigned count,
                 const fp3_view_paint *paint) {
    const fp3_view_slope slope = {.first = corners[0].depth, .one = 1};
    fp3_view_raster_area(d->raster, corners, count, &slope, paint);
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A point beside x, by lengths across the view. */
static fp3_view_place see_beside(const drawing *d, const double x[3], double right, double up) {
    double at[3];
    for (int k = 0; k < 3; k++)
        at[k] = x[k] + (d->camera->right[k] * right + d->camera->up[k] * up);
    return see_mark(d, at);
}

/* A line, twice as wide as a length. */
static void draw_bar(const drawing *d, const double from[3], const double to[3], double half,
                     fp3_view_ink ink) {
    double ends[2][3];
    const double *a = ends[0], *b = ends[1];
    memcpy(ends[0], from, sizeof ends[0]);
    memcpy(ends[1], to, sizeof ends[1]);
    if (!cut(d, ends))
        return;
    const double way[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const double right = dot(d->camera->right, way), up = dot(d->camera->up, way);
    const double length = sqrt(right * right + up * up);
    const double x = length > 0 ? half * up / length : 0;
    const double y = length > 0 ? half * right / length : 0;
    const fp3_view_place corners[4] = {see_beside(d, a, -x, y), see_beside(d, a, x, -y),
                                       see_beside(d, b, x, -y), see_beside(d, b, -x, y)};
    fill(d, corners, 4, &(fp3_view_paint){.ink = ink, .cover = 256});
}

static void draw_dot(const drawing *d, const double x[3], double radius, fp3_view_ink ink) {
    fp3_view_place corners[12];
    double ends[2][3];
    memcpy(ends[0], x, sizeof ends[0]);
    memcpy(ends[1], x, sizeof ends[1]);
    if (!cut(d, ends))
        return;
    for (unsigned i = 0; i < 12; i++) {
        double way[2];
        fp3_view_turned(30.0 * i, way);
        corners[i] = see_beside(d, x, radius * way[0], radius * way[1]);
    }
    fill(d, corners, 12, &(fp3_view_paint){.ink = ink, .cover = 256});
}

/* ---- shapes ---- */

/* Static bodies are grey, sensors pale, and those that sleep paler than those that are awake, as
 * planes are. */
static fp3_view_ink ink_of(const drawing *d, const fp3_view_shape *shape) {
    const fp3_view_page *page = d->page;
    const size_t at = d->first + shape->object, asleep = page->axes->asleep;
    const fp3_view_ink full = shape->type == 2 ? fp3_view_ink_none : fp3_view_ink_of(page, at);
    const int sleeps = shape->type != 2 && asleep != FP3_VIEW_NO_COLUMN &&
                       page->recording->columns[asleep].values[at] < 0;
    const uint32_t tenths = shape->is_sensor ? 8 : sleeps || isinf(shape->radius) ? 6 : 3;
    return fp3_view_ink_mix(full, fp3_view_ink_back, FP3_VIEW_SHARE / 10 * tenths);
}

static void draw_flat(const drawing *d, const fp3_view_shape *shape, const fp3_view_pose *pose,
                      const fp3_view_paint *paint) {
    double points[FP3_VIEW_WAYS][3];
    fp3_view_place corners[FP3_VIEW_WAYS];
    const fp3_view_recording *r = d->page->recording;
    const unsigned count = fp3_view_outline(r, shape, d->pixel, points);
    for (unsigned i = 0; i < count; i++) {
        double x[3];
        fp3_view_pose_place(pose, points[i], x);
        corners[i] = see(d, x);
    }
    fill(d, corners, count, paint);
    if (shape->corners > 1)
        return;
    double middle[3], edge[3]; /* how far a circle is turned */
    fp3_view_pose_place(pose, r->corners[shape->first], middle);
    fp3_view_pose_place(pose, points[0], edge);
    draw_bar(d, middle, edge, d->pixel / 2, paint->rim);
}

/* ---- shapes in space ---- */

static void cross(const double a[3], const double b[3], double to[3]) {
    for (int k = 0; k < 3; k++)
        to[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Two directions that are square to this one and to each other, as long as each other. */
static void find_across(const double way[3], double across[2][3]) {
    const double x = fabs(way[0]), y = fabs(way[1]), z = fabs(way[2]);
    const double axis[3] = {x <= y && x <= z, y < x && y <= z, z < x && z < y};
    cross(axis, way, across[0]);
    cross(way, across[0], across[1]);
    const double a = sqrt(dot(across[0], across[0])), b = sqrt(dot(across[1], across[1]));
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
            across[i][k] /= i ? b : a;
}

/* The disc that is within the ball around all that is seen. */
static void draw_plane(const drawing *d, const double ends[2][3], const fp3_view_paint *paint) {
    const fp3_view_camera *c = d->camera;
    double normal[3], across[2][3], corners[FP3_VIEW_WAYS][3];
    for (int k = 0; k < 3; k++)
        normal[k] = ends[1][k] - ends[0][k];
    find_across(normal, across);
    const double high = dot(ends[0], normal) / dot(normal, normal);
    const double left = c->depth * c->depth / 4 - high * high * dot(normal, normal);
    for (unsigned i = 0; i < FP3_VIEW_WAYS; i++) {
        double way[2];
        fp3_view_turned(360.0 * i / FP3_VIEW_WAYS, way);
        for (int k = 0; k < 3; k++)
            corners[i][k] =
                high * normal[k] + sqrt(left) * (way[0] * across[0][k] + way[1] * across[1][k]);
    }
    if (left > 0)
        fp3_view_solid_face(d->raster, c, (const double(*)[3])corners, FP3_VIEW_WAYS, paint);
}

/* Moved out by the shape's radius. */
static void draw_triangle(const drawing *d, double corners[3][3], double radius,
                          const fp3_view_paint *paint) {
    double u[3], v[3], normal[3];
    for (int k = 0; k < 3; k++) {
        u[k] = corners[1][k] - corners[0][k];
        v[k] = corners[2][k] - corners[0][k];
    }
    cross(u, v, normal);
    const double size = sqrt(dot(normal, normal));
    for (int i = 0; i < 9 && size > 0; i++)
        corners[i / 3][i % 3] += radius * normal[i % 3] / size;
    fp3_view_solid_face(d->raster, d->camera, (const double(*)[3])corners, 3, paint);
}

static void place(const drawing *d, const fp3_view_pose *pose, size_t corner, double world[3]) {
    double x[3];
    fp3_view_pose_place(pose, d->page->recording->corners[corner], x);
    to_world(d, x, world);
}

/* A segment has no width. Sectors show how what is round is turned. */
static void draw_edge(const drawing *d, const fp3_view_shape *shape, const fp3_view_pose *pose,
                      const uint32_t ends[2], const fp3_view_paint *paint) {
    const fp3_view_recording *r = d->page->recording;
    const double radius = shape->radius * d->camera->scale[0];
    double at[2][3], way[3], across[2][3], sectors[2][3], size;
    for (int i = 0; i < 2; i++)
        place(d, pose, ends[i], at[i]);
    for (int k = 0; k < 3; k++)
        way[k] = r->corners[ends[1]][k] - r->corners[ends[0]][k];
    way[2] += ends[0] == ends[1];
    find_across(way, across);
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
            sectors[i][k] = dot(pose->turn[k], across[i]);
    if (radius > 0)
        fp3_view_solid_round(d->raster, d->camera, (const double(*)[3])at, radius,
                             shape->triangles ? NULL : (const double(*)[3])sectors, paint);
    else if (!shape->triangles && fp3_view_camera_cut(d->camera, (const double(*)[3])at, at))
        fp3_view_raster_line(d->raster, fp3_view_camera_see(d->camera, at[0], &size),
                             fp3_view_camera_see(d->camera, at[1], &size), paint->rim, 256);
}

static void draw_solid(const drawing *d, const fp3_view_shape *shape, const fp3_view_pose *pose,
                       fp3_view_paint *paint) {
    const fp3_view_recording *r = d->page->recording;
    const double radius = shape->radius * d->camera->scale[0];
    double at[3][3];
    d->raster->veil++;
    paint->cover = shape->is_sensor ? VEIL : 256;
    if (isinf(radius)) {
        place(d, pose, shape->first, at[0]);
        place(d, pose, shape->first + 1, at[1]);
        paint->rims = 0;
        draw_plane(d, (const double(*)[3])at, paint);
        return;
    }
    for (size_t i = shape->triangle; i < shape->triangle + shape->triangles; i++) {
        for (int k = 0; k < 3; k++)
            place(d, pose, r->triangles[i].corners[k], at[k]);
        paint->rims = radius > 0 ? 0 : r->triangles[i].rims;
        draw_triangle(d, at, radius, paint);
    }
    for (size_t i = shape->edge; i < shape->edge + shape->edges; i++)
        draw_edge(d, shape, pose, r->edges[i].ends, paint);
}

static void draw_shape(const drawing *d, const fp3_view_shape *shape) {
    fp3_view_pose pose;
    if (!fp3_view_pose_of(d->page->recording, d->page->axes, d->first + shape->object, &pose))
        return;
    const fp3_view_ink ink = ink_of(d, shape);
    fp3_view_paint paint = {
        .ink = ink,
        .rim = fp3_view_ink_mix(ink, fp3_view_ink_line, FP3_VIEW_SHARE / 2),
        .width = RIM,
        .rims = UINT64_MAX,
        .cover = 256,
    };
    if (!d->camera->is_flat)
        draw_solid(d, shape, &pose, &paint);
    else if (isfinite(shape->radius))
        draw_flat(d, shape, &pose, &paint);
}

/* ---- joints and contacts ---- */

static void draw_joint(const drawing *d, const fp3_view_joint *joint) {
    const uint32_t ends[2] = {joint->a, joint->b};
    double x[2][3];
    for (int i = 0; i < 2; i++) {
        fp3_view_pose pose;
        if (!fp3_view_pose_of(d->page->recording, d->page->axes, d->first + ends[i], &pose))
            return;
        fp3_view_pose_place(&pose, joint->anchor[i], x[i]);
    }
    draw_bar(d, x[0], x[1], d->pixel, fp3_view_ink_joint);
    for (int i = 0; i < 2; i++)
        draw_dot(d, x[i], 2.5 * d->pixel, fp3_view_ink_joint);
}

/* A line is as long as the root of the force, so that small ones are seen beside large ones: the
 * largest of the recording has 60 pixels. */
static void draw_contact(const drawing *d, const fp3_view_contact *c) {
    const double most = d->page->recording->force_most;
    const double length = most > 0 && c->force > 0 ? 60 * d->pixel * sqrt(c->force / most) : 0;
    double to[3];
    for (int k = 0; k < 3; k++)
        to[k] = c->point[k] + length * c->normal[k];
    draw_bar(d, c->point, to, d->pixel, touch);
    draw_dot(d, c->point, 2 * d->pixel, touch);
}

/* Sensors are behind all others in a plane; in space others are seen through them. */
void fp3_view_bodies_draw(const fp3_view_page *page, const fp3_view_camera *camera,
                          fp3_view_raster *raster, size_t snapshot) {
    const fp3_view_recording *r = page->recording;
    const drawing d = {page, camera, raster, snapshot * r->objects, pixel_of(camera)};
    for (uint32_t pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < r->shape_count; i++)
            if ((pass == 0) == (!r->shapes[i].is_sensor == !camera->is_flat))
                draw_shape(&d, &r->shapes[i]);
    for (size_t i = 0; i < r->joint_count; i++)
        if (snapshot < r->joints[i].snapshots)
            draw_joint(&d, &r->joints[i]);
    for (size_t i = 0; page->has_contacts && i < r->contact_count; i++)
        if (r->contacts[i].snapshot == snapshot)
            draw_contact(&d, &r->contacts[i]);
}
