/* SPDX-License-Identifier: Apache-2.0 */
/* camera.c - see camera.h. */
#include "camera.h"

#include "outline.h"
#include "turned.h"

#include <math.h>
#include <string.h>

#define TANGENT 0.31529878887983855 /* of half the field of view, 17.5 degrees, as in the page */
#define ROOM_FLAT 1.28              /* around what is seen, for names and numbers; as in the page */
#define ROOM 1.04

/* ---- the world ---- */

static void widen(double ends[2], double value) {
    ends[0] = value < ends[0] ? value : ends[0];
    ends[1] = value > ends[1] ? value : ends[1];
}

static double largest_radius(const fp3_view_page *page) {
    const fp3_view_recording *r = page->recording;
    if (page->axes->radius_of == FP3_VIEW_NO_COLUMN)
        return page->axes->radius;
    const fp3_view_scale range =
        fp3_view_scale_of(r->columns[page->axes->radius_of].values, r->snapshots * r->objects, 1);
    return range.most > 0 ? range.most : 0;
}

static void find_ends(const fp3_view_page *page, unsigned k, double ends[2]) {
    const fp3_view_recording *r = page->recording;
    const double reach = largest_radius(page);
    if (page->seen_axes) {
        memcpy(ends, page->seen[k], sizeof page->seen[k]);
        return;
    }
    const fp3_view_scale range =
        fp3_view_scale_of(r->columns[page->axes->columns[k]].values, r->snapshots * r->objects, 1);
    ends[0] = range.least - reach;
    ends[1] = range.most + reach;
    if (page->axes->has_shapes)
        fp3_view_outline_ends(r, page->axes, k, ends);
    for (unsigned end = 0; end < 2 && page->box_axes; end++)
        widen(ends, page->box[end][k]);
    for (unsigned i = 0; i < page->plane_count; i++)
        if (page->planes[i].axis == k)
            widen(ends, page->planes[i].at);
}

static void find_world(const fp3_view_page *page, fp3_view_camera *c) {
    static const double shape[FP3_VIEW_AXES] = {3.2, 2, 2}; /* of axes in different units */
    double width[FP3_VIEW_AXES] = {0}, widest = 0;
    for (unsigned k = 0; k < page->axes->count; k++) {
        double ends[2];
        find_ends(page, k, ends);
        c->middle[k] = (ends[0] + ends[1]) / 2;
        width[k] = ends[1] - ends[0];
        widest = width[k] > widest ? width[k] : widest;
    }
    for (unsigned k = 0; k < FP3_VIEW_AXES; k++) {
        const double own = width[k] > 0 ? shape[k] / width[k] : 1;
        c->scale[k] = page->axes->has_one_scale ? (widest > 0 ? 2 / widest : 1) : own;
        c->half[k] = width[k] * c->scale[k] / 2;
    }
}

/* ---- the eye ---- */

static void turn(fp3_view_camera *c, const fp3_view_page *page, double azimuth, double elevation) {
    double a[2], e[2];
    fp3_view_turned(azimuth, a);
    fp3_view_turned(elevation, e);
    const double ca = a[0], sa = a[1], ce = e[0], se = e[1];
    const double right[3] = {ca, 0, -sa}, back[3] = {sa * ce, se, ca * ce};
    const double up[3] = {-sa * se, ce, -ca * se};
    const double *const from[] = {right, up, back};
    double *const to[] = {c->right, c->up, c->back};
    for (int i = 0; i < 3; i++) {
        const int is_z = page->up == 2 && !c->is_flat;
        to[i][0] = from[i][0];
        to[i][1] = is_z ? -from[i][2] : from[i][1];
        to[i][2] = is_z ? from[i][1] : from[i][2];
    }
}

fp3_view_camera fp3_view_camera_of(const fp3_view_page *page, const fp3_view_look *look) {
    fp3_view_camera c = {.is_flat = page->axes->count < 3};
    const double aspect = (double)look->width / look->height;
    find_world(page, &c);
    turn(&c, page, c.is_flat ? 0 : look->azimuth, c.is_flat ? 0 : look->elevation);
    const double *h = c.half, least = 1e-6;
    double round = sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
    round = round > least ? round : least;
    double high = h[1] > h[0] / aspect ? h[1] : h[0] / aspect;
    high = high > least ? high * ROOM_FLAT : least;
    if (!c.is_flat)
        high = round / (aspect < 1 ? aspect : 1) * ROOM;
    c.distance = high / TANGENT;
    c.nearest = c.distance - round;
    c.depth = 2 * round;
    c.width = (double)look->width * FP3_VIEW_FINE;
    c.height = (double)look->height * FP3_VIEW_FINE;
    c.zoom = (c.is_flat ? 1 / high : 1 / TANGENT) * c.height / 2 * FP3_VIEW_PART;
    return c;
}

/* ---- seeing ---- */

double fp3_view_camera_world(const fp3_view_camera *c, unsigned axis, double value) {
    return (value - c->middle[axis]) * c->scale[axis];
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* What is far outside of the picture is not drawn, and must not overflow. */
static int32_t whole(double x) { return (int32_t)floor(fmin(fmax(x, -1e9), 1e9) + 0.5); }

double fp3_view_camera_deep(const fp3_view_camera *c) { return FP3_VIEW_DEPTH_MOST / c->depth; }

void fp3_view_camera_eye(const fp3_view_camera *c, const double point[3], double eye[3]) {
    eye[0] = dot(c->right, point);
    eye[1] = dot(c->up, point);
    eye[2] = c->distance - dot(c->back, point);
}

int fp3_view_camera_cut(const fp3_view_camera *c, const double world[2][3], double ends[2][3]) {
    double away[2], eye[3];
    for (int i = 0; i < 2; i++) {
        fp3_view_camera_eye(c, world[i], eye);
        away[i] = c->is_flat ? 0 : eye[2] - FP3_VIEW_NEAR * c->distance;
    }
    if (away[0] < 0 && away[1] < 0)
        return 0;
    const int cut = away[0] < 0 ? 0 : away[1] < 0 ? 1 : -1;
    for (int k = 0; k < 3 && cut >= 0; k++)
        ends[cut][k] += (ends[!cut][k] - ends[cut][k]) * (away[cut] / (away[cut] - away[!cut]));
    return 1;
}

fp3_view_place fp3_view_camera_place(const fp3_view_camera *c, const double eye[3]) {
    const double size = c->zoom / (c->is_flat ? 1 : eye[2]);
    return (fp3_view_place){
        whole(c->width * FP3_VIEW_PART / 2 + eye[0] * size),
        whole(c->height * FP3_VIEW_PART / 2 - eye[1] * size),
        whole((eye[2] - c->nearest) * fp3_view_camera_deep(c)),
    };
}

fp3_view_place fp3_view_camera_see(const fp3_view_camera *c, const double point[3], double *size) {
    double eye[3];
    fp3_view_camera_eye(c, point, eye);
    *size = c->zoom / (c->is_flat ? 1 : eye[2]);
    return fp3_view_camera_place(c, eye);
}
