/* SPDX-License-Identifier: Apache-2.0 */
/* hull3.c - a polyhedron from up to 32 points: a face is a set of points with all others behind it.
 *
 * Each three points make a plane; if no point is before it, the points near it are a face, as a set
 * of bits. Sets with three points in common are one face. So the result depends on where the points
 * are and hardly on their order, and points of one plane need no merging of triangles. 32 points
 * take 5,000 planes, some 0.3 ms.
 */
#include "bodies/shapes/shape3.h"

#include <string.h>

#define SLACK (1.0 / 65536) /* of the size: what counts as being in a plane */
#define ROOM 256

typedef struct {
    double x, y, z;
} place;

typedef struct {
    uint32_t count;
    place point[FP3_CORNERS3];
    double slack;
    uint32_t faces;
    uint32_t set[ROOM];
    place normal[ROOM];
} hull;

static place minus(place a, place b) { return (place){a.x - b.x, a.y - b.y, a.z - b.z}; }
static double dot(place a, place b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static double size(place a) { return sqrt(dot(a, a)); }
static place cross(place a, place b) {
    return (place){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static unsigned bits(uint32_t set) {
    unsigned n = 0;
    for (; set; set &= set - 1)
        n++;
    return n;
}

/* The normal of three points, or 0 if one is near the line of the others. */
static int normal_of(const hull *h, uint32_t i, uint32_t j, uint32_t k, place *n) {
    const place u = minus(h->point[j], h->point[i]), v = minus(h->point[k], h->point[i]);
    *n = cross(u, v);
    const double area = size(*n), a = size(u), b = size(v), c = size(minus(u, v));
    const double longest = a > b ? (a > c ? a : c) : (b > c ? b : c);
    if (area <= 2 * h->slack * longest)
        return 0;
    *n = (place){n->x / area, n->y / area, n->z / area};
    return 1;
}

/* The points near the plane; 0 if some are before it and some behind it. *n then points outwards.
 */
static uint32_t set_of(const hull *h, uint32_t i, place *n) {
    uint32_t near = 0;
    int before = 0, behind = 0;
    for (uint32_t p = 0; p < h->count; p++) {
        const double d = dot(*n, minus(h->point[p], h->point[i]));
        if (d > h->slack)
            before = 1;
        else if (d < -h->slack)
            behind = 1;
        else
            near |= UINT32_C(1) << p;
    }
    if (before == behind) /* through the inside, or all points are flat */
        return 0;
    if (before)
        *n = (place){-n->x, -n->y, -n->z};
    return near;
}

/* Whether a set spans a plane: faces that meet may have a line of points in common. */
static int is_wide(const hull *h, uint32_t set) {
    place n;
    if (bits(set) < 3)
        return 0;
    for (uint32_t i = 0; i < h->count; i++)
        for (uint32_t j = i + 1; set >> i & 1 && j < h->count; j++)
            for (uint32_t k = j + 1; set >> j & 1 && k < h->count; k++)
                if (set >> k & 1 && normal_of(h, i, j, k, &n))
                    return 1;
    return 0;
}

static int add(hull *h, uint32_t set, place n) {
    for (uint32_t f = 0; f < h->faces; f++)
        if (dot(h->normal[f], n) > 0 && is_wide(h, h->set[f] & set)) {
            h->set[f] |= set;
            return 1;
        }
    if (h->faces == ROOM)
        return 0;
    h->set[h->faces] = set;
    h->normal[h->faces++] = n;
    return 1;
}

static int find_faces(hull *h) {
    h->faces = 0;
    for (uint32_t i = 0; i < h->count; i++)
        for (uint32_t j = i + 1; j < h->count; j++)
            for (uint32_t k = j + 1; k < h->count; k++) {
                place n;
                const uint32_t set = normal_of(h, i, j, k, &n) ? set_of(h, i, &n) : 0;
                if (bits(set) >= 3 && !add(h, set, n))
                    return 0;
            }
    return h->faces >= 4 && h->faces <= FP3_FACES3;
}

/* From corner to corner around a face, anticlockwise: the next is that with all others left of it.
 * A point within the slack of a side is no corner. 0: there is no such loop. */
static uint32_t loop_of(const hull *h, uint32_t f, uint8_t *loop) {
    const uint32_t set = h->set[f];
    const place n = h->normal[f];
    uint32_t start = FP3_CORNERS3;
    const place one = fabs(n.x) < 0.6 ? (place){1, 0, 0} : (place){0, 1, 0}, u = cross(n, one);
    for (uint32_t p = 0; p < h->count; p++)
        if (set >> p & 1 &&
            (start == FP3_CORNERS3 || dot(u, h->point[p]) < dot(u, h->point[start])))
            start = p;
    uint32_t length = 0, at = start;
    do {
        if (length == FP3_CORNERS3)
            return 0;
        loop[length++] = (uint8_t)at;
        uint32_t best = FP3_CORNERS3;
        for (uint32_t p = 0; p < h->count; p++) {
            if (!(set >> p & 1) || p == at)
                continue;
            if (best == FP3_CORNERS3) {
                best = p;
                continue;
            }
            const place to = minus(h->point[best], h->point[at]),
                        v = minus(h->point[p], h->point[at]);
            const double right = -dot(n, cross(to, v)), far = size(to), other = size(v);
            const double slack = h->slack * (far > other ? far : other);
            if (right > slack || (right >= -slack && dot(to, v) > 0 && other > far))
                best = p;
        }
        if (best == FP3_CORNERS3)
            return 0;
        at = best;
    } while (at != start);
    return length;
}

/* Leaves out what is not a corner of three faces or more. How many are left out. */
static uint32_t thin(hull *h, uint32_t *kept, uint32_t faces, uint8_t (*loop)[FP3_CORNERS3],
                     const uint8_t *length) {
    unsigned times[FP3_CORNERS3] = {0};
    uint32_t left = 0;
    for (uint32_t f = 0; f < faces; f++)
        for (uint32_t i = 0; i < length[f]; i++)
            times[loop[f][i]]++;
    for (uint32_t p = 0; p < h->count; p++)
        if (times[p] >= 3) {
            h->point[left] = h->point[p];
            kept[left++] = kept[p];
        }
    const uint32_t out = h->count - left;
    h->count = left;
    return out;
}

/* 1: the shape's faces are whole. */
static int try(hull *h, uint32_t *kept, const fp3_point3 *point, fp3_shape3 *made) {
    uint8_t loop[FP3_FACES3][FP3_CORNERS3], length[FP3_FACES3];
    do {
        if (h->count < 4 || !find_faces(h))
            return 0;
        for (uint32_t f = 0; f < h->faces; f++) {
            length[f] = (uint8_t)loop_of(h, f, loop[f]);
            if (length[f] < 3)
                return 0;
        }
    } while (thin(h, kept, h->faces, loop, length));
    made->count = h->count;
    for (uint32_t i = 0; i < h->count; i++)
        made->corner[i] = point[kept[i]];
    return fp3_shape3_close(made, h->faces, loop, length);
}

/* Points of their own: of those that are too close the first one stays. */
static double spread(uint32_t count, const fp3_point3 *point, hull *h, uint32_t *kept) {
    double wide = 0;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = 0; j < i; j++) {
            const fp3_point3 *p = &point[i], *q = &point[j];
            const double d =
                size((place){(double)p->x - q->x, (double)p->y - q->y, (double)p->z - q->z});
            wide = d > wide ? d : wide;
        }
    h->slack = SLACK * wide;
    h->count = 0;
    for (uint32_t i = 0; i < count; i++) {
        const place p = {point[i].x, point[i].y, point[i].z};
        uint32_t j = 0;
        while (j < h->count && size(minus(p, h->point[j])) > 4 * h->slack)
            j++;
        if (j < h->count)
            continue;
        kept[h->count] = i;
        h->point[h->count++] = p;
    }
    return wide;
}

fp3_status fp3_hull3(uint32_t count, const fp3_point3 *point, float radius, fp3_shape3 *shape,
                     fp3_error *error) {
    if (count < 4 || count > FP3_CORNERS3)
        return fp3_fail(error, FP3_E_ARGUMENT, "a hull needs from 4 to %d points, not %u",
                        FP3_CORNERS3, count);
    if (!fp3_shape3_takes(count, point, radius))
        return fp3_fail(
            error, FP3_E_ARGUMENT,
            "a shape's numbers must be finite and at most 1e6, its radius not negative");
    hull h;
    uint32_t kept[FP3_CORNERS3];
    const double wide = spread(count, point, &h, kept);
    double far = 0;
    for (uint32_t i = 0; i < count; i++) {
        const double d = size((place){point[i].x, point[i].y, point[i].z});
        far = d > far ? d : far;
    }
    fp3_shape3 made;
    memset(&made, 0, sizeof made);
    made.radius = radius;
    if (wide < 1e-6 || wide < 1e-4 * far || !try(&h, kept, point, &made))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "the %u points make no hull: they are flat, or too close", count);
    *shape = made;
    return FP3_OK;
}
