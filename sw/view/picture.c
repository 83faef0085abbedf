/* SPDX-License-Identifier: Apache-2.0 */
/* picture.c - see picture.h. */
#include "picture.h"

#include "bodies.h"
#include "inks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TRAILS_MOST 8 /* objects; of more, trails hide each other */

/* ---- objects ---- */

static int is_there(const fp3_view_picture *p, size_t at) {
    const fp3_view_recording *r = p->page->recording;
    for (unsigned k = 0; k < p->page->axes->count; k++)
        if (!isfinite(r->columns[p->page->axes->columns[k]].values[at]))
            return 0;
    return p->life == FP3_VIEW_NO_COLUMN || r->columns[p->life].values[at] == 1;
}

static void find(const fp3_view_picture *p, size_t at, double point[FP3_VIEW_AXES]) {
    const fp3_view_recording *r = p->page->recording;
    for (unsigned k = 0; k < p->page->axes->count; k++)
        point[k] = fp3_view_camera_world(&p->camera, k,
                                         (double)r->columns[p->page->axes->columns[k]].values[at]);
}

static void draw_line(fp3_view_picture *p, double ends[2][FP3_VIEW_AXES], fp3_view_ink ink,
                      uint32_t cover) {
    double size;
    if (fp3_view_camera_cut(&p->camera, (const double(*)[3])ends, ends))
        fp3_view_raster_line(&p->raster, fp3_view_camera_see(&p->camera, ends[0], &size),
                             fp3_view_camera_see(&p->camera, ends[1], &size), ink, cover);
}

/* Between the places of two objects, or of one in two snapshots. */
static void draw_between(fp3_view_picture *p, size_t a, size_t b, fp3_view_ink ink,
                         uint32_t cover) {
    double ends[2][FP3_VIEW_AXES] = {{0}};
    if (!is_there(p, a) || !is_there(p, b))
        return;
    find(p, a, ends[0]);
    find(p, b, ends[1]);
    draw_line(p, ends, ink, cover);
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
        double size, ends[2][FP3_VIEW_AXES] = {{0}};
        if (!is_there(p, at))
            continue;
        find(p, at, ends[0]);
        find(p, at, ends[1]);
        if (!fp3_view_camera_cut(&p->camera, (const double(*)[3])ends, ends))
            continue;
        const fp3_view_place place = fp3_view_camera_see(&p->camera, ends[0], &size);
        double radius = has_own ? (double)r->columns[axes->radius_of].values[at] : axes->radius;
        radius = radius > 0 && isfinite(radius) ? radius * p->camera.scale[0] : 0;
        const double shown = floor(radius * size + 0.5);
        const int32_t least =
            axes->radius > 0 || has_own ? FP3_VIEW_PART : least_radius(r->objects);
        const int32_t parts = shown > least ? (int32_t)shown : least;
        const int32_t deep = (int32_t)floor(parts / size * fp3_view_camera_deep(&p->camera) + 0.5);
        fp3_view_raster_ball(&p->raster, place, parts, deep, fp3_view_ink_of(p->page, at));
    }
}

static void draw_links(fp3_view_picture *p, size_t first) {
    const fp3_view_recording *r = p->page->recording;
    for (size_t i = 0; i < r->relation_count; i++)
        for (size_t k = 0; k < r->relations[i].count; k++) {
            const size_t a = first + r->relations[i].pairs[2 * k];
            const size_t b = first + r->relations[i].pairs[2 * k + 1];
            draw_between(p, a, b,
                         p->page->fields->colour == FP3_VIEW_NO_COLUMN
                             ? fp3_view_ink_line
                             : fp3_view_ink_of(p->page, a),
                         141);
        }
}

/* From the first snapshot to this one, with gaps where it is not there. */
static void draw_trails(fp3_view_picture *p, size_t snapshot) {
    const size_t objects = p->page->recording->objects;
    for (size_t i = 0; i < objects && objects <= TRAILS_MOST; i++)
        for (size_t n = 1; n <= snapshot; n++)
            draw_between(p, (n - 1) * objects + i, n * objects + i, fp3_view_ink_line, 180);
}

/* ---- walls ---- */

/* The edges of a box by its two ends; those without a length are left out. */
static void draw_box(fp3_view_picture *p, double ends[2][3], uint32_t cover) {
    for (int k = 0; k < 3; k++)
        for (int corner = 0; corner < 4 && ends[0][k] < ends[1][k]; corner++) {
            double edge[2][3], *from = edge[0], *to = edge[1];
            from[(k + 1) % 3] = to[(k + 1) % 3] = ends[corner & 1][(k + 1) % 3];
            from[(k + 2) % 3] = to[(k + 2) % 3] = ends[corner >> 1][(k + 2) % 3];
            from[k] = ends[0][k];
            to[k] = ends[1][k];
            draw_line(p, edge, fp3_view_ink_line, cover);
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
    fp3_view_raster_clear(&p->raster, fp3_view_ink_back);
    if (p->page->axes->has_shapes)
        fp3_view_bodies_draw(p->page, &p->camera, &p->raster, snapshot);
    else
        draw_balls(p, first);
    draw_links(p, first);
    if (!p->page->axes->has_shapes)
        draw_trails(p, snapshot);
    draw_walls(p);
    fp3_view_raster_take(&p->raster, p->pixels);
}
