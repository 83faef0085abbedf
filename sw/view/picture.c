/* SPDX-License-Identifier: Apache-2.0 */
/* picture.c - see picture.h. */
#include "picture.h"

#include "outline.h"
#include "turned.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STOPS 6
#define SHARE_MOST 65535 /* of the way from the least to the most */
#define TRAILS_MOST 8    /* objects; of more, trails hide each other */

static const fp3_view_ink back = {238, 240, 244}, plain = {36, 87, 199}, none = {128, 128, 128};
static const fp3_view_ink ink = {51, 61, 87}, mark = {191, 26, 20}, touch = {196, 120, 0};

/* ---- objects ---- */

static int is_there(const fp3_view_picture *p, size_t at) {
    const fp3_view_recording *r = p->page->recording;
    for (unsigned k = 0; k < p->page->axes->count; k++)
        if (!isfinite(r->columns[p->page->axes->columns[k]].values[at]))
            return 0;
    return p->life == FP3_VIEW_NO_COLUMN || r->columns[p->life].values[at] == 1;
}

static fp3_view_place see(const fp3_view_picture *p, size_t at, double *size) {
    const fp3_view_recording *r = p->page->recording;
    double point[FP3_VIEW_AXES] = {0};
    for (unsigned k = 0; k < p->page->axes->count; k++)
        point[k] = fp3_view_camera_world(&p->camera, k,
                                         (double)r->columns[p->page->axes->columns[k]].values[at]);
    return fp3_view_camera_see(&p->camera, point, size);
}

static uint8_t between(uint8_t from, uint8_t to, uint32_t share) {
    return (uint8_t)((from * (SHARE_MOST - share) + to * share + SHARE_MOST / 2) / SHARE_MOST);
}

/* The page's colours (page/shaders.js). */
static fp3_view_ink colour_of(const fp3_view_page *page, size_t at) {
    static const fp3_view_ink stops[STOPS] = {{52, 41, 122},  {38, 98, 168},  {22, 146, 156},
                                              {74, 184, 112}, {170, 205, 66}, {250, 218, 72}};
    if (page->fields->colour == FP3_VIEW_NO_COLUMN)
        return plain;
    const fp3_view_field *field = &page->fields->list[page->fields->colour];
    const double value = fp3_view_field_value(page->recording, field, at);
    const double width = field->most - field->least;
    if (!isfinite(value))
        return none;
    const double part = width > 0 ? fmin(1, fmax(0, (value - field->least) / width)) : 0.5;
    const uint32_t share = (uint32_t)floor(part * SHARE_MOST * (STOPS - 1) + 0.5);
    const uint32_t stop = share / SHARE_MOST < STOPS - 1 ? share / SHARE_MOST : STOPS - 2;
    const uint32_t rest = share - stop * SHARE_MOST;
    const fp3_view_ink *a = &stops[stop], *b = a + 1;
    return (fp3_view_ink){between(a->red, b->red, rest), between(a->green, b->green, rest),
                          between(a->blue, b->blue, rest)};
}

/* Of one that has no radius: in halves of a pixel of the picture. */
static int32_t least_radius(size_t objects) {
    const int32_t halves = objects <= 100 ? 10 : objects <= 2000 ? 6 : objects <= 20000 ? 4 : 3;
    return halves * FP3_VIEW_FINE * FP3_VIEW_PART / 2;
}

static void draw_balls(fp3_view_picture *p, size_t first) {
    const fp3_view_recording *r = p->page->recording;
    const fp3_view_axes *axes = p->page->axes;
    const int has_own = axes->radius_of != FP3_VIEW_NO_COLUMN;
    for (size_t at = first; at < first + r->objects; at++) {
        double size;
        if (!is_there(p, at))
            continue;
        const fp3_view_place place = see(p, at, &size);
        double radius = has_own ? (double)r->columns[axes->radius_of].values[at] : axes->radius;
        radius = radius > 0 && isfinite(radius) ? radius * p->camera.scale[0] : 0;
        const double shown = floor(radius * size + 0.5);
        const int32_t least =
            axes->radius > 0 || has_own ? FP3_VIEW_PART : least_radius(r->objects);
        const int32_t parts = shown > least ? (int32_t)shown : least;
        const int32_t deep = (int32_t)floor(parts / size * fp3_view_camera_deep(&p->camera) + 0.5);
        fp3_view_raster_ball(&p->raster, place, parts, deep, colour_of(p->page, at));
    }
}

static void draw_links(fp3_view_picture *p, size_t first) {
    const fp3_view_recording *r = p->page->recording;
    for (size_t i = 0; i < r->relation_count; i++)
        for (size_t k = 0; k < r->relations[i].count; k++) {
            const size_t a = first + r->relations[i].pairs[2 * k];
            const size_t b = first + r->relations[i].pairs[2 * k + 1];
            double size;
            if (is_there(p, a) && is_there(p, b))
                fp3_view_raster_line(
                    &p->raster, see(p, a, &size), see(p, b, &size),
                    p->page->fields->colour == FP3_VIEW_NO_COLUMN ? ink : colour_of(p->page, a),
                    141);
        }
}

/* From the first snapshot to this one, with gaps where it is not there. */
static void draw_trails(fp3_view_picture *p, size_t snapshot) {
    const size_t objects = p->page->recording->objects;
    for (size_t i = 0; i < objects && objects <= TRAILS_MOST; i++)
        for (size_t n = 1; n <= snapshot; n++) {
            const size_t a = (n - 1) * objects + i, b = n * objects + i;
            double size;
            if (is_there(p, a) && is_there(p, b))
                fp3_view_raster_line(&p->raster, see(p, a, &size), see(p, b, &size), ink, 180);
        }
}

/* ---- bodies ---- */

static fp3_view_place see_point(const fp3_view_picture *p, const double x[2], double *size) {
    const double point[FP3_VIEW_AXES] = {fp3_view_camera_world(&p->camera, 0, x[0]),
                                         fp3_view_camera_world(&p->camera, 1, x[1])};
    return fp3_view_camera_see(&p->camera, point, size);
}

/* What a pixel of the picture is as a length of the recording. */
static double pixel_of(const fp3_view_picture *p) {
    const double none[2] = {0};
    double size;
    (void)see_point(p, none, &size);
    return FP3_VIEW_FINE * FP3_VIEW_PART / (size * p->camera.scale[0]);
}

static fp3_view_ink mix(fp3_view_ink a, fp3_view_ink b, uint32_t share) {
    return (fp3_view_ink){between(a.red, b.red, share), between(a.green, b.green, share),
                          between(a.blue, b.blue, share)};
}

/* Static bodies are grey, sensors pale, and those that sleep paler than those that are awake. */
static fp3_view_ink body_ink(const fp3_view_picture *p, const fp3_view_shape *shape, size_t at) {
    const fp3_view_page *page = p->page;
    const size_t asleep = page->axes->asleep;
    const fp3_view_ink full = shape->type == 2 ? none : colour_of(page, at);
    const int sleeps = shape->type != 2 && asleep != FP3_VIEW_NO_COLUMN &&
                       page->recording->columns[asleep].values[at] < 0;
    return mix(full, back, SHARE_MOST / 10 * (shape->is_sensor ? 8u : sleeps ? 6u : 3u));
}

/* A line, twice as wide as a length. */
static void draw_bar(fp3_view_picture *p, const double a[2], const double b[2], double half,
                     fp3_view_ink of) {
    const double way[2] = {b[0] - a[0], b[1] - a[1]};
    const double length = sqrt(way[0] * way[0] + way[1] * way[1]);
    const double x = length > 0 ? half * way[1] / length : 0;
    const double y = length > 0 ? half * way[0] / length : 0;
    const double at[4][2] = {
        {a[0] - x, a[1] + y}, {a[0] + x, a[1] - y}, {b[0] + x, b[1] - y}, {b[0] - x, b[1] + y}};
    fp3_view_place corners[4];
    double size;
    for (int i = 0; i < 4; i++)
        corners[i] = see_point(p, at[i], &size);
    fp3_view_raster_area(&p->raster, corners, 4, 0, of, of);
}

static void draw_shape(fp3_view_picture *p, const fp3_view_shape *shape, size_t first,
                       double pixel) {
    const fp3_view_recording *r = p->page->recording;
    const size_t at = first + shape->object;
    double points[FP3_VIEW_WAYS + 1][2], size;
    fp3_view_place corners[FP3_VIEW_WAYS + 1];
    fp3_view_pose pose;
    if (!fp3_view_pose_of(r, p->page->axes, at, &pose))
        return;
    const unsigned count = fp3_view_outline(r, shape, pixel, points);
    const fp3_view_ink fill = body_ink(p, shape, at), rim = mix(fill, ink, SHARE_MOST / 2);
    for (unsigned i = 0; i < count; i++) {
        double x[2];
        fp3_view_pose_place(&pose, points[i], x);
        corners[i] = see_point(p, x, &size);
    }
    fp3_view_raster_area(&p->raster, corners, count, 5 * FP3_VIEW_PART / 2, fill, rim);
    if (shape->corners > 1)
        return;
    double middle[2], edge[2]; /* how far a circle is turned */
    fp3_view_pose_place(&pose, r->corners[shape->first], middle);
    fp3_view_pose_place(&pose, points[0], edge);
    draw_bar(p, middle, edge, pixel / 2, rim);
}

static void draw_dot(fp3_view_picture *p, const double x[2], double radius, fp3_view_ink of) {
    double size;
    fp3_view_place corners[12];
    for (unsigned i = 0; i < 12; i++) {
        double way[2];
        fp3_view_turned(30.0 * i, way);
        corners[i] =
            see_point(p, (const double[]){x[0] + radius * way[0], x[1] + radius * way[1]}, &size);
    }
    fp3_view_raster_area(&p->raster, corners, 12, 0, of, of);
}

static void draw_joint(fp3_view_picture *p, const fp3_view_joint *joint, size_t first,
                       double pixel) {
    const uint32_t ends[2] = {joint->a, joint->b};
    double x[2][2];
    for (int i = 0; i < 2; i++) {
        fp3_view_pose pose;
        if (!fp3_view_pose_of(p->page->recording, p->page->axes, first + ends[i], &pose))
            return;
        fp3_view_pose_place(&pose, joint->anchor[i], x[i]);
    }
    draw_bar(p, x[0], x[1], pixel, mark);
    for (int i = 0; i < 2; i++)
        draw_dot(p, x[i], 2.5 * pixel, mark);
}

/* A line is as long as the root of the force, so that small ones are seen beside large ones: the
 * largest of the recording has 60 pixels. */
static void draw_contact(fp3_view_picture *p, const fp3_view_contact *c, double most,
                         double pixel) {
    const double length = most > 0 && c->force > 0 ? 60 * pixel * sqrt(c->force / most) : 0;
    const double to[2] = {c->point[0] + length * c->normal[0], c->point[1] + length * c->normal[1]};
    draw_bar(p, c->point, to, pixel, touch);
    draw_dot(p, c->point, 2 * pixel, touch);
}

static void draw_bodies(fp3_view_picture *p, size_t snapshot) {
    const fp3_view_recording *r = p->page->recording;
    const size_t first = snapshot * r->objects;
    const double pixel = pixel_of(p);
    for (uint32_t others = 0; others < 2; others++) /* sensors are behind all others */
        for (size_t i = 0; i < r->shape_count; i++)
            if (others == !r->shapes[i].is_sensor)
                draw_shape(p, &r->shapes[i], first, pixel);
    for (size_t i = 0; i < r->joint_count; i++)
        if (snapshot < r->joints[i].snapshots)
            draw_joint(p, &r->joints[i], first, pixel);
    for (size_t i = 0; p->page->has_contacts && i < r->contact_count; i++)
        if (r->contacts[i].snapshot == snapshot)
            draw_contact(p, &r->contacts[i], r->force_most, pixel);
}

/* ---- walls ---- */

static void draw_edge(fp3_view_picture *p, const double from[3], const double to[3],
                      uint32_t cover) {
    double size;
    fp3_view_raster_line(&p->raster, fp3_view_camera_see(&p->camera, from, &size),
                         fp3_view_camera_see(&p->camera, to, &size), ink, cover);
}

/* The edges of a box by its two ends; those without a length are left out. */
static void draw_box(fp3_view_picture *p, double ends[2][3], uint32_t cover) {
    for (int k = 0; k < 3; k++)
        for (int corner = 0; corner < 4 && ends[0][k] < ends[1][k]; corner++) {
            double from[3], to[3];
            from[(k + 1) % 3] = to[(k + 1) % 3] = ends[corner & 1][(k + 1) % 3];
            from[(k + 2) % 3] = to[(k + 2) % 3] = ends[corner >> 1][(k + 2) % 3];
            from[k] = ends[0][k];
            to[k] = ends[1][k];
            draw_edge(p, from, to, cover);
        }
}

static void draw_walls(fp3_view_picture *p) {
    const fp3_view_page *page = p->page;
    double frame[2][3], box[2][3] = {{0}};
    for (unsigned k = 0; k < FP3_VIEW_AXES; k++) {
        frame[1][k] = p->camera.half[k];
        frame[0][k] = -frame[1][k];
        for (int end = 0; end < 2 && k < page->box_axes; end++)
            box[end][k] = fp3_view_camera_world(&p->camera, k, page->box[end][k]);
    }
    draw_box(p, frame, 77);
    if (page->box_axes)
        draw_box(p, box, 256);
    for (unsigned i = 0; i < page->plane_count; i++) {
        double wall[2][3];
        memcpy(wall, frame, sizeof wall);
        wall[0][page->planes[i].axis] = wall[1][page->planes[i].axis] =
            fp3_view_camera_world(&p->camera, page->planes[i].axis, page->planes[i].at);
        draw_box(p, wall, 230);
    }
}

/* ---- all of it ---- */

fp3_status fp3_view_picture_make(const fp3_view_page *page, const fp3_view_look *look,
                                 fp3_view_picture *picture, fp3_error *error) {
    *picture = (fp3_view_picture){.page = page,
                                  .camera = fp3_view_camera_of(page, look),
                                  .life = fp3_view_find(page->recording, "life"),
                                  .pixels = malloc((size_t)look->width * look->height * 3)};
    return picture->pixels
               ? fp3_view_raster_make(look->width, look->height, &picture->raster, error)
               : fp3_no_memory(error);
}

void fp3_view_picture_free(fp3_view_picture *picture) {
    fp3_view_raster_free(&picture->raster);
    free(picture->pixels);
    memset(picture, 0, sizeof *picture);
}

void fp3_view_picture_draw(fp3_view_picture *p, size_t snapshot) {
    const size_t first = snapshot * p->page->recording->objects;
    fp3_view_raster_clear(&p->raster, back);
    if (p->page->axes->has_shapes)
        draw_bodies(p, snapshot);
    else
        draw_balls(p, first);
    draw_links(p, first);
    if (!p->page->axes->has_shapes)
        draw_trails(p, snapshot);
    draw_walls(p);
    fp3_view_raster_take(&p->raster, p->pixels);
}
