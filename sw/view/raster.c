/* SPDX-License-Identifier: Apache-2.0 */
/* raster.c - see raster.h. */
#include "raster.h"

#include <stdlib.h>
#include <string.h>

fp3_status fp3_view_raster_make(uint32_t width, uint32_t height, fp3_view_raster *raster,
                                fp3_error *error) {
    const size_t count = (size_t)width * height * FP3_VIEW_FINE * FP3_VIEW_FINE;
    *raster = (fp3_view_raster){.width = (int32_t)width * FP3_VIEW_FINE,
                                .height = (int32_t)height * FP3_VIEW_FINE,
                                .pixels = malloc(count * sizeof *raster->pixels),
                                .depths = malloc(count * sizeof *raster->depths),
                                .veils = malloc(count * sizeof *raster->veils)};
    return raster->pixels && raster->depths && raster->veils ? FP3_OK : fp3_no_memory(error);
}

void fp3_view_raster_free(fp3_view_raster *raster) {
    free(raster->pixels);
    free(raster->depths);
    free(raster->veils);
    memset(raster, 0, sizeof *raster);
}

void fp3_view_raster_clear(fp3_view_raster *r, fp3_view_ink ink) {
    const size_t count = (size_t)r->width * (size_t)r->height;
    for (size_t i = 0; i < count; i++) {
        r->pixels[i] = ink;
        r->depths[i] = INT32_MAX;
        r->veils[i] = 0;
    }
    r->veil = 0;
}

/* ---- balls ---- */

/* The largest whole number whose square is not above x. */
static uint32_t root(uint64_t x) {
    uint64_t found = 0;
    for (uint64_t bit = UINT64_C(1) << 62; bit; bit >>= 2)
        if (x >= found + bit) {
            x -= found + bit;
            found = (found >> 1) + bit;
        } else {
            found >>= 1;
        }
    return (uint32_t)found;
}

static uint8_t lit(uint8_t colour, uint32_t light) { return (uint8_t)((colour * light) >> 8); }

fp3_view_ink fp3_view_lit(fp3_view_ink ink, uint32_t light) {
    return (fp3_view_ink){lit(ink.red, light), lit(ink.green, light), lit(ink.blue, light)};
}

/* From 128 where the light does not come to 256: its way is (-5, 8, 10)/14, to the left, up, to the
 * eye. */
static uint32_t light_of(int64_t x, int64_t y, int64_t z, int64_t radius) {
    const int64_t towards = -5 * x - 8 * y + 10 * z;
    return towards > 0 ? (uint32_t)(128 + 128 * towards / (14 * radius)) : 128;
}

static void put_ball(fp3_view_raster *r, fp3_view_place at, int32_t radius, int32_t deep,
                     fp3_view_ink ink, int32_t column, int32_t row) {
    const int64_t x = (int64_t)column * FP3_VIEW_PART + FP3_VIEW_PART / 2 - at.x;
    const int64_t y = (int64_t)row * FP3_VIEW_PART + FP3_VIEW_PART / 2 - at.y;
    const int64_t left = (int64_t)radius * radius - x * x - y * y;
    if (left < 0)
        return;
    const int64_t z = root((uint64_t)left);
    const int32_t depth = at.depth - (int32_t)(z * deep / radius);
    const size_t i = (size_t)row * (size_t)r->width + (size_t)column;
    if (depth >= r->depths[i])
        return;
    const uint32_t light = light_of(x, y, z, radius);
    r->depths[i] = depth;
    r->pixels[i] = fp3_view_lit(ink, light);
}

static int32_t clamp(int64_t value, int32_t least, int32_t most) {
    return value < least ? least : value > most ? most : (int32_t)value;
}

void fp3_view_raster_ball(fp3_view_raster *r, fp3_view_place at, int32_t radius, int32_t deep,
                          fp3_view_ink ink) {
    const int64_t reach = (int64_t)radius + FP3_VIEW_PART;
    if (radius < 1 || at.x + reach < 0 || at.y + reach < 0 ||
        at.x - reach > (int64_t)r->width * FP3_VIEW_PART ||
        at.y - reach > (int64_t)r->height * FP3_VIEW_PART)
        return;
    const int32_t left = clamp((at.x - reach) / FP3_VIEW_PART, 0, r->width - 1);
    const int32_t right = clamp((at.x + reach) / FP3_VIEW_PART, 0, r->width - 1);
    const int32_t above = clamp((at.y - reach) / FP3_VIEW_PART, 0, r->height - 1);
    const int32_t below = clamp((at.y + reach) / FP3_VIEW_PART, 0, r->height - 1);
    for (int32_t row = above; row <= below; row++)
        for (int32_t column = left; column <= right; column++)
            put_ball(r, at, radius, deep, ink, column, row);
}

/* ---- lines ---- */

static uint8_t mixed(uint8_t under, uint8_t over, uint32_t cover) {
    return (uint8_t)((under * (256 - cover) + over * cover) >> 8);
}

static fp3_view_ink over(fp3_view_ink under, fp3_view_ink ink, uint32_t cover) {
    return (fp3_view_ink){mixed(under.red, ink.red, cover), mixed(under.green, ink.green, cover),
                          mixed(under.blue, ink.blue, cover)};
}

static void put_line(fp3_view_raster *r, int64_t x, int64_t y, int64_t depth, fp3_view_ink ink,
                     uint32_t cover) {
    if (x < 0 || y < 0 || x >= r->width || y >= r->height)
        return;
    const size_t i = (size_t)y * (size_t)r->width + (size_t)x;
    fp3_view_ink *to = &r->pixels[i];
    if (depth > r->depths[i])
        return;
    *to = over(*to, ink, cover);
}

static int64_t size_of(int64_t x) { return x < 0 ? -x : x; }

/* A pixel for each step along the longer side. Lines hide nothing, so their order does not matter
 * for depth. */
void fp3_view_raster_line(fp3_view_raster *r, fp3_view_place from, fp3_view_place to,
                          fp3_view_ink ink, uint32_t cover) {
    const int64_t wide = (int64_t)to.x - from.x, high = (int64_t)to.y - from.y;
    const int64_t deep = (int64_t)to.depth - from.depth;
    const int64_t longer = size_of(wide) > size_of(high) ? size_of(wide) : size_of(high);
    const int64_t steps = longer / FP3_VIEW_PART + 1;
    for (int64_t i = 0; i <= steps; i++) {
        const int64_t x = from.x + wide * i / steps, y = from.y + high * i / steps;
        if (x >= 0 && y >= 0)
            put_line(r, x / FP3_VIEW_PART, y / FP3_VIEW_PART, from.depth + deep * i / steps, ink,
                     cover);
    }
}

/* ---- areas ---- */

/* An edge, turned such that the area is to its left. */
typedef struct {
    int64_t x, y, wide, high;
    int64_t within; /* of this and more a point's cross product is farther from it than the width */
    int is_short, has_rim;
} edge;

#define SHORT 48           /* parts of a pixel */
#define FARTHEST (1 << 24) /* parts of a pixel: farther away a picture has no pixel */
#define FARTHEST_DEPTH 1000000000

static unsigned find_edges(const fp3_view_place *corners, unsigned count,
                           const fp3_view_paint *paint, edge edges[FP3_VIEW_AREA_MOST]) {
    int64_t area = 0, x[FP3_VIEW_AREA_MOST], y[FP3_VIEW_AREA_MOST];
    unsigned made = 0;
    for (unsigned i = 0; i < count; i++) {
        x[i] = clamp(corners[i].x, -FARTHEST, FARTHEST);
        y[i] = clamp(corners[i].y, -FARTHEST, FARTHEST);
    }
    for (unsigned i = 0; i < count; i++) {
        const unsigned next = i + 1 < count ? i + 1 : 0;
        area += x[i] * y[next] - x[next] * y[i];
    }
    for (unsigned i = 0; i < count; i++) {
        const unsigned next = i + 1 < count ? i + 1 : 0;
        const int64_t wide = x[next] - x[i], high = y[next] - y[i];
        const int64_t length = root((uint64_t)(wide * wide + high * high));
        if (!length)
            continue;
        edges[made++] =
            (edge){area > 0 ? x[i] : x[next],  area > 0 ? y[i] : y[next], area > 0 ? wide : -wide,
                   area > 0 ? high : -high,    paint->width * length,     length < SHORT,
                   (int)(paint->rims >> i & 1)};
    }
    return made;
}

/* The line of a short edge says little, since its ends are rounded: it is taken for a point. */
static int is_near(const edge *edges, unsigned count, int64_t width, int64_t x, int64_t y) {
    for (unsigned i = 0; i < count; i++) {
        const edge *e = &edges[i];
        const int64_t right = x - e->x, down = y - e->y;
        if (e->has_rim && (e->is_short ? right * right + down * down < width * width
                                       : e->wide * down - e->high * right < e->within))
            return 1;
    }
    return 0;
}

/* From where to where a row is within. Corners are rounded, so a small area may be a little hollow,
 * and only its ends are asked for. */
static int find_row(const edge *edges, unsigned count, int64_t y, int64_t *left, int64_t *right) {
    *left = INT64_MAX;
    *right = INT64_MIN;
    for (unsigned i = 0; i < count; i++) {
        const int64_t from = edges[i].y, to = from + edges[i].high;
        if (y < (from < to ? from : to) || y >= (from < to ? to : from))
            continue;
        const int64_t x = edges[i].x + edges[i].wide * (y - from) / edges[i].high;
        *left = x < *left ? x : *left;
        *right = x > *right ? x : *right;
    }
    return *left <= *right;
}

void fp3_view_raster_put(fp3_view_raster *r, int32_t column, int32_t row, double depth,
                         fp3_view_ink ink, uint32_t cover) {
    const size_t i = (size_t)row * (size_t)r->width + (size_t)column;
    const int32_t deep = depth < FARTHEST_DEPTH
                             ? depth > -FARTHEST_DEPTH ? (int32_t)depth : -FARTHEST_DEPTH
                             : FARTHEST_DEPTH;
    if (deep > r->depths[i] || (cover < 256 && r->veils[i] == r->veil))
        return;
    r->veils[i] = cover < 256 ? r->veil : r->veils[i];
    r->depths[i] = cover == 256 ? deep : r->depths[i];
    r->pixels[i] = cover == 256 ? ink : over(r->pixels[i], ink, cover);
}

void fp3_view_raster_area(fp3_view_raster *r, const fp3_view_place *corners, unsigned count,
                          const fp3_view_slope *slope, const fp3_view_paint *paint) {
    edge edges[FP3_VIEW_AREA_MOST];
    const int32_t half = FP3_VIEW_PART / 2;
    int64_t above = INT32_MAX, below = INT32_MIN, left, right;
    const unsigned made =
        count <= FP3_VIEW_AREA_MOST ? find_edges(corners, count, paint, edges) : 0;
    for (unsigned i = 0; i < made; i++) {
        above = edges[i].y < above ? edges[i].y : above;
        below = edges[i].y > below ? edges[i].y : below;
    }
    const int32_t last = clamp(below / FP3_VIEW_PART, -1, r->height - 1);
    for (int32_t row = clamp(above / FP3_VIEW_PART, 0, r->height); row <= last; row++) {
        const int64_t y = (int64_t)row * FP3_VIEW_PART + half;
        if (!find_row(edges, made, y, &left, &right) || right < half)
            continue;
        const int32_t end = clamp((right - half) / FP3_VIEW_PART, -1, r->width - 1);
        const int64_t begin = left > half ? (left - half + FP3_VIEW_PART - 1) / FP3_VIEW_PART : 0;
        for (int32_t column = clamp(begin, 0, r->width); column <= end; column++) {
            const int64_t x = (int64_t)column * FP3_VIEW_PART + half;
            const double away = slope->one + slope->right * (double)x + slope->down * (double)y;
            fp3_view_raster_put(r, column, row, slope->first + slope->rest / away,
                                is_near(edges, made, paint->width, x, y) ? paint->rim : paint->ink,
                                paint->cover);
        }
    }
}

/* ---- the picture ---- */

void fp3_view_raster_take(const fp3_view_raster *r, uint8_t *pixels) {
    const size_t width = (size_t)r->width;
    for (size_t y = 0; y < (size_t)r->height; y += FP3_VIEW_FINE)
        for (size_t x = 0; x < width; x += FP3_VIEW_FINE) {
            const fp3_view_ink *a = &r->pixels[y * width + x], *b = a + width;
            *pixels++ = (uint8_t)((a[0].red + a[1].red + b[0].red + b[1].red + 2) / 4);
            *pixels++ = (uint8_t)((a[0].green + a[1].green + b[0].green + b[1].green + 2) / 4);
            *pixels++ = (uint8_t)((a[0].blue + a[1].blue + b[0].blue + b[1].blue + 2) / 4);
        }
}
