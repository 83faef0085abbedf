/* SPDX-License-Identifier: Apache-2.0 */
/* solid.c - see solid.h. Below all is seen from the eye: to the right, up, and away. */
#include "solid.h"

#include <math.h>
#include <string.h>

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* a + s b */
static void along(const double a[3], double s, const double b[3], double to[3]) {
    for (int k = 0; k < 3; k++)
        to[k] = a[k] + s * b[k];
}

/* Of a normal of length 1: from 128 to 256, as raster.c has it for balls. */
static uint32_t light_of(const double normal[3]) {
    const double towards = (-5 * normal[0] + 8 * normal[1] - 10 * normal[2]) / 14;
    return towards > 0 ? (uint32_t)(128 + 128 * (towards < 1 ? towards : 1)) : 128;
}

/* ---- faces ---- */

/* What is not too near to the eye; at most one corner more. */
static unsigned clip(const double (*from)[3], unsigned count, uint64_t rims, double near,
                     double (*to)[3], uint64_t *left) {
    unsigned made = 0;
    *left = 0;
    for (unsigned i = 0; i < count; i++) {
        const double *a = from[i], *b = from[i + 1 < count ? i + 1 : 0];
        double way[3];
        if (a[2] >= near) {
            memcpy(to[made], a, sizeof to[made]);
            *left |= (rims >> i & 1) << made++;
        }
        if ((a[2] >= near) == (b[2] >= near))
            continue;
        along(b, -1, a, way);
        along(a, (near - a[2]) / way[2], way, to[made]);
        *left |= b[2] >= near ? (rims >> i & 1) << made : 0;
        made++;
    }
    return made;
}

/* 0: it is seen from inside, or from its side. */
static int find_normal(const double (*corners)[3], double normal[3]) {
    double u[3], v[3];
    along(corners[1], -1, corners[0], u);
    along(corners[2], -1, corners[0], v);
    for (int k = 0; k < 3; k++) /* away is against the third axis */
        normal[k] = u[(k + 2) % 3] * v[(k + 1) % 3] - u[(k + 1) % 3] * v[(k + 2) % 3];
    const double size = sqrt(dot(normal, normal));
    if (!(size > 0))
        return 0;
    along((const double[3]){0, 0, 0}, 1 / size, normal, normal);
    return dot(normal, corners[0]) < 0;
}

static fp3_view_slope slope_of(const fp3_view_camera *c, const double point[3],
                               const double normal[3]) {
    const double deep = fp3_view_camera_deep(c), x = normal[0] / c->zoom, y = normal[1] / c->zoom;
    return (fp3_view_slope){
        .first = -c->nearest * deep,
        .rest = dot(normal, point) * deep,
        .one = normal[2] - (x * c->width - y * c->height) * FP3_VIEW_PART / 2,
        .right = x,
        .down = -y,
    };
}

void fp3_view_solid_face(fp3_view_raster *raster, const fp3_view_camera *camera,
                         const double (*corners)[3], unsigned count, const fp3_view_paint *paint) {
    double seen[FP3_VIEW_AREA_MOST][3], left[FP3_VIEW_AREA_MOST + 1][3], normal[3];
    fp3_view_place places[FP3_VIEW_AREA_MOST + 1];
    fp3_view_paint lit = *paint;
    if (count > FP3_VIEW_AREA_MOST)
        return;
    for (unsigned i = 0; i < count; i++)
        fp3_view_camera_eye(camera, corners[i], seen[i]);
    if (!find_normal((const double(*)[3])seen, normal))
        return;
    count = clip((const double(*)[3])seen, count, paint->rims, FP3_VIEW_NEAR * camera->distance,
                 left, &lit.rims);
    for (unsigned i = 0; i < count; i++)
        places[i] = fp3_view_camera_place(camera, left[i]);
    const fp3_view_slope slope = slope_of(camera, seen[0], normal);
    lit.ink = fp3_view_lit(paint->ink, light_of(normal));
    fp3_view_raster_area(raster, places, count, &slope, &lit);
}

/* ---- round bodies ---- */

typedef struct {
    double ends[2][3], way[3]; /* from end to end */
    double length, radius;     /* length: squared */
    double near;
    double sectors[2][3];
} tube;

/* Where a ray from the eye enters a ball, in lengths of the ray; infinite: nowhere. */
static double enter(const double ray[3], const double middle[3], double radius) {
    const double size = dot(ray, ray), towards = dot(ray, middle);
    const double left = towards * towards - size * (dot(middle, middle) - radius * radius);
    return left >= 0 && size > 0 ? (towards - sqrt(left)) / size : INFINITY;
}

static double least(double a, double b) { return a < b ? a : b; }

/* The nearest of both balls, and of the tube between: seen along it, it is a disc. */
static double meet(const tube *t, const double ray[3]) {
    double across[3], side[3], found = enter(ray, t->ends[0], t->radius);
    if (t->length <= 0)
        return found;
    found = least(found, enter(ray, t->ends[1], t->radius));
    along(ray, -dot(ray, t->way) / t->length, t->way, across);
    along(t->ends[0], -dot(t->ends[0], t->way) / t->length, t->way, side);
    const double at = enter(across, side, t->radius);
    const double up = at * dot(ray, t->way) - dot(t->ends[0], t->way);
    return up >= 0 && up <= t->length ? least(found, at) : found;
}

static void put(fp3_view_raster *raster, const fp3_view_camera *c, const tube *t, int32_t column,
                int32_t row, const fp3_view_paint *paint) {
    const double half = FP3_VIEW_PART / 2.0, x = column * FP3_VIEW_PART + half;
    const double y = row * FP3_VIEW_PART + half, zoom = c->zoom;
    const double ray[3] = {(x - c->width * half) / zoom, (c->height * half - y) / zoom, 1};
    const double away = meet(t, ray);
    double middle[3], normal[3];
    if (!(away >= t->near && away < INFINITY))
        return;
    along((const double[3]){0, 0, 0}, away, ray, normal);
    along(normal, -1, t->ends[0], middle);
    const double up = t->length > 0 ? dot(middle, t->way) / t->length : 0;
    along(t->ends[0], up < 0 ? 0 : up > 1 ? 1 : up, t->way, middle);
    along(normal, -1, middle, normal);
    along((const double[3]){0, 0, 0}, 1 / t->radius, normal, normal);
    uint32_t light = light_of(normal);
    if (dot(normal, t->sectors[0]) * dot(normal, t->sectors[1]) > 0)
        light = light * 13 / 16;
    fp3_view_raster_put(raster, column, row, (away - c->nearest) * fp3_view_camera_deep(c),
                        fp3_view_lit(paint->ink, light), paint->cover);
}

/* From where to where a ball may be seen along an axis of the picture, as parts of its distance. */
static void widen(const double middle[3], int axis, const tube *t, double ends[2]) {
    const double r = t->radius, far = middle[2] + r;
    const double near = fmax(middle[2] - r, t->near);
    const double low = middle[axis] - r, high = middle[axis] + r;
    ends[0] = fmin(ends[0], low / (low < 0 ? near : far));
    ends[1] = fmax(ends[1], high / (high < 0 ? far : near));
}

static int32_t pixel(double at, int32_t size) {
    const double column = floor(at / FP3_VIEW_PART);
    return column > 0 ? column < size ? (int32_t)column : size : 0;
}

void fp3_view_solid_round(fp3_view_raster *raster, const fp3_view_camera *c,
                          const double ends[2][3], double radius, const double (*sectors)[3],
                          const fp3_view_paint *paint) {
    tube t = {.radius = radius, .near = FP3_VIEW_NEAR * c->distance};
    double seen[2][2] = {{INFINITY, -INFINITY}, {INFINITY, -INFINITY}};
    for (int i = 0; i < 2; i++) {
        fp3_view_camera_eye(c, ends[i], t.ends[i]);
        if (t.ends[i][2] + radius <= t.near)
            return;
        for (int axis = 0; axis < 2; axis++)
            widen(t.ends[i], axis, &t, seen[axis]);
        for (int k = 0; k < 3 && sectors; k++)
            t.sectors[i][k] = dot(sectors[i], k == 0 ? c->right : k == 1 ? c->up : c->back);
        t.sectors[i][2] = -t.sectors[i][2];
    }
    along(t.ends[1], -1, t.ends[0], t.way);
    t.length = dot(t.way, t.way);
    const double x = c->width * FP3_VIEW_PART / 2, y = c->height * FP3_VIEW_PART / 2;
    const int32_t left = pixel(x + seen[0][0] * c->zoom, raster->width);
    const int32_t right = pixel(x + seen[0][1] * c->zoom + FP3_VIEW_PART, raster->width);
    const int32_t above = pixel(y - seen[1][1] * c->zoom, raster->height);
    const int32_t below = pixel(y - seen[1][0] * c->zoom + FP3_VIEW_PART, raster->height);
    for (int32_t row = above; row < below; row++)
        for (int32_t column = left; column < right; column++)
            put(raster, c, &t, column, row, paint);
}
