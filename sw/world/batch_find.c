/* SPDX-License-Identifier: Apache-2.0 */
/* batch_find.c - questions about where the objects of a batch are. */
#include "spots.h"

#include "base/host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

fp3_status fp3_batch_pairs(fp3_batch *batch, const char *of, double distance, size_t room,
                           uint32_t *a, uint32_t *b, size_t *count) {
    FP3_HOST;
    uint32_t *first, *second;
    *count = 0;
    if (!batch)
        return FP3_E_ARGUMENT;
    const fp3_status status = fp3_spots_pairs(batch, of, distance, &first, &second, count);
    const size_t given = *count < room ? *count : room;
    if (!status && given) {
        memcpy(a, first, given * sizeof *a);
        memcpy(b, second, given * sizeof *b);
    }
    free(first);
    free(second);
    return status;
}

/* ---- points ---- */

/* Squares of what is larger, or of a radius that is smaller, are no numbers of their own. */
#define MOST 0x1p500
#define LEAST 0x1p-500

static fp3_status check_points(const fp3_batch *b, const char *what, const double *points,
                               uint32_t dimensions, size_t count) {
    for (size_t i = 0; i < count * dimensions; i++)
        if (!(fabs(points[i]) <= MOST))
            return fp3_fail(b->error, FP3_E_ARGUMENT,
                            "%s %zu: found %g, expected a number from -2^500 to 2^500", what,
                            i / dimensions, points[i]);
    return FP3_OK;
}

static fp3_status check_radius(const fp3_batch *b, const char *what, size_t n, double radius) {
    return radius == 0 || (radius >= LEAST && radius <= MOST)
               ? FP3_OK
               : fp3_fail(b->error, FP3_E_ARGUMENT,
                          "%s %zu: the radius is %g, expected 0, or 2^-500 to 2^500", what, n,
                          radius);
}

fp3_status fp3_batch_within(fp3_batch *b, const char *of, const double *points, const double *radii,
                            size_t points_count, size_t room, uint32_t *which, uint32_t *objects,
                            size_t *count) {
    FP3_HOST;
    fp3_spots p;
    *count = 0;
    if (!b)
        return FP3_E_ARGUMENT;
    fp3_status status = fp3_spots_open(b, of, &p);
    if (!status)
        status = check_points(b, "point", points, p.dimensions, points_count);
    for (size_t n = 0; !status && n < points_count; n++)
        status = check_radius(b, "point", n, radii[n]);
    for (size_t n = 0; !status && n < points_count; n++)
        for (uint32_t i = 0; i < p.objects; i++) {
            if (!(fp3_spots_square(&p, &points[n * p.dimensions], i) < radii[n] * radii[n]))
                continue;
            if (*count < room) {
                which[*count] = (uint32_t)n;
                objects[*count] = i;
            }
            ++*count;
        }
    fp3_spots_close(&p);
    return status;
}

fp3_status fp3_batch_nearest(fp3_batch *b, const char *of, const double *points, size_t count,
                             uint32_t *objects, double *distances) {
    FP3_HOST;
    fp3_spots p;
    if (!b)
        return FP3_E_ARGUMENT;
    fp3_status status = fp3_spots_open(b, of, &p);
    if (!status)
        status = check_points(b, "point", points, p.dimensions, count);
    for (size_t n = 0; !status && n < count; n++) {
        double least = INFINITY;
        objects[n] = FP3_NOBODY;
        for (uint32_t i = 0; i < p.objects; i++) {
            const double square = fp3_spots_square(&p, &points[n * p.dimensions], i);
            objects[n] = square < least ? i : objects[n];
            least = square < least ? square : least;
        }
        distances[n] = sqrt(least);
    }
    fp3_spots_close(&p);
    return status;
}

/* ---- rays ---- */

static double dot(const double *a, const double *b, uint32_t dimensions) {
    double sum = 0;
    for (uint32_t k = 0; k < dimensions; k++)
        sum += a[k] * b[k];
    return sum;
}

/* Where a ray of direction `way`, which has the length 1, meets a ball; NaN: nowhere. */
static double meet(const fp3_spots *p, const double *from, const double *way, size_t object,
                   double radius) {
    double to[3] = {0}, beside[3] = {0};
    for (uint32_t k = 0; k < p->dimensions; k++)
        to[k] = (double)p->x[k][object] - from[k];
    const double along = dot(to, way, p->dimensions);
    for (uint32_t k = 0; k < p->dimensions; k++)
        beside[k] = to[k] - along * way[k];
    const double miss = dot(beside, beside, p->dimensions), square = radius * radius;
    if (dot(to, to, p->dimensions) <= square)
        return 0;
    return along >= 0 && miss <= square ? along - sqrt(square - miss) : NAN;
}

static void shoot(const fp3_spots *p, const fp3_rays *rays, size_t n, const float *radii,
                  uint32_t *object, double *distance) {
    const double *from = &rays->origins[n * p->dimensions],
                 *given = &rays->directions[n * p->dimensions];
    const double length = sqrt(dot(given, given, p->dimensions));
    double way[3] = {0};
    for (uint32_t k = 0; k < p->dimensions; k++)
        way[k] = given[k] / length;
    *object = FP3_NOBODY;
    *distance = INFINITY;
    for (uint32_t i = 0; i < p->objects; i++) {
        const double at = meet(p, from, way, i, radii ? (double)radii[i] : rays->radius);
        if (at < *distance && !(rays->length > 0 && at > rays->length)) {
            *object = i;
            *distance = at;
        }
    }
}

static fp3_status check_rays(const fp3_batch *b, const fp3_spots *p, const fp3_rays *rays) {
    fp3_status status = check_points(b, "ray", rays->origins, p->dimensions, rays->count);
    if (!status)
        status = check_points(b, "ray", rays->directions, p->dimensions, rays->count);
    for (size_t n = 0; !status && n < rays->count; n++) {
        const double *way = &rays->directions[n * p->dimensions];
        const double square = dot(way, way, p->dimensions);
        if (!(square >= 0x1p-900 && square <= 0x1p900))
            status = fp3_fail(b->error, FP3_E_ARGUMENT,
                              "ray %zu: its direction has the length %g, expected 2^-450 to 2^450",
                              n, sqrt(square));
    }
    if (!status && !(rays->length >= 0 && rays->length < INFINITY))
        status =
            fp3_fail(b->error, FP3_E_ARGUMENT,
                     "rays have the length %g, expected a finite number, 0 or above", rays->length);
    return status || rays->radius_of ? status : check_radius(b, "ray", 0, rays->radius);
}

static fp3_status read_radii(fp3_batch *b, const fp3_rays *rays, float **radii) {
    if (!rays->radius_of)
        return FP3_OK;
    *radii = malloc((b->objects + 1) * sizeof **radii);
    fp3_status status =
        *radii ? fp3_fields_read(b->fields, rays->radius_of, 0, b->objects, *radii, NULL, b->error)
               : fp3_no_memory(b->error);
    for (size_t i = 0; !status && i < b->objects; i++)
        if (b->births.lives[i])
            status = check_radius(b, "object", i, (double)(*radii)[i]);
    return status;
}

fp3_status fp3_batch_ray(fp3_batch *b, const char *of, const fp3_rays *rays, uint32_t *objects,
                         double *distances) {
    FP3_HOST;
    fp3_spots p;
    float *radii = NULL;
    if (!b)
        return FP3_E_ARGUMENT;
    fp3_status status = fp3_spots_open(b, of, &p);
    if (!status)
        status = check_rays(b, &p, rays);
    if (!status)
        status = read_radii(b, rays, &radii);
    for (size_t n = 0; !status && n < rays->count; n++)
        shoot(&p, rays, n, radii, &objects[n], &distances[n]);
    free(radii);
    fp3_spots_close(&p);
    return status;
}
