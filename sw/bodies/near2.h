/* SPDX-License-Identifier: Apache-2.0 */
/* near2.h - the parts of two convex polygons in the plane that are nearest to each other.
 *
 * Let f(n) be the gap between two polygons along a direction n. Where f is positive it has one
 * peak, the direction between the nearest points, and falls on both sides. So of each polygon the
 * edge with the largest f is next to the peak, and the nearest points are on the edge with the
 * largest f of both and on the edge of the other that faces it. (A segment has two edges, one each
 * way; the largest f is then at least 0 if they are apart.) A point has no edge. */
#ifndef FP3_BODIES_NEAR2_H
#define FP3_BODIES_NEAR2_H

#include "bodies/shape2.h"

#include <float.h>
#include <math.h>

/* Cores nearer than this, in parts of the extents, count as touching: the direction between points
 * has no more digits then. */
#define FP3_ALIKE2 0x1p-16f

typedef struct {
    uint32_t count;
    const fp3_point2 *corner, *normal;
} fp3_core2;

typedef struct {
    fp3_core2 core;
    fp3_point2 corner[FP3_CORNERS2], normal[FP3_CORNERS2];
} fp3_placed2;

/* Where b is, as seen from a. 0: nowhere, as one of them is not finite or no turn, or they are too
 * far apart for squares of distances. */
static inline int fp3_seen2(const fp3_pose2 *a, const fp3_pose2 *b, fp3_pose2 *seen) {
    const fp3_point2 way = fp3_subtract2(b->at, a->at);
    if (!(fabsf(way.x) + fabsf(way.y) <= 1e15f) ||
        !(fabsf(a->c) + fabsf(a->s) + (fabsf(b->c) + fabsf(b->s)) <= 4))
        return 0;
    seen->at = fp3_turn_back2(a, way);
    seen->c = a->c * b->c + a->s * b->s;
    seen->s = a->c * b->s - a->s * b->c;
    return 1;
}

static inline fp3_core2 fp3_core2_of(const fp3_shape2 *shape) {
    return (fp3_core2){shape->count, shape->corner, shape->normal};
}

static inline void fp3_put2(const fp3_shape2 *shape, const fp3_pose2 *pose, fp3_placed2 *placed) {
    for (uint32_t i = 0; i < shape->count; i++) {
        placed->corner[i] = fp3_place2(pose, shape->corner[i]);
        placed->normal[i] = fp3_turn2(pose, shape->normal[i]);
    }
    placed->core = (fp3_core2){shape->count, placed->corner, placed->normal};
}

/* The gap along an edge's normal. */
static inline float fp3_gap2(const fp3_core2 *a, uint32_t edge, const fp3_core2 *b) {
    const fp3_point2 from = a->corner[edge], normal = a->normal[edge];
    float least = fp3_dot2(normal, fp3_subtract2(b->corner[0], from));
    for (uint32_t k = 1; k < b->count; k++) {
        const float gap = fp3_dot2(normal, fp3_subtract2(b->corner[k], from));
        least = gap < least ? gap : least;
    }
    return least;
}

/* The first edge of a with the largest gap, and that gap. */
static inline float fp3_widest2(const fp3_core2 *a, const fp3_core2 *b, uint32_t *edge) {
    float most = -FLT_MAX;
    *edge = 0;
    for (uint32_t i = 0; i < a->count && a->count > 1; i++) {
        const float gap = fp3_gap2(a, i, b);
        *edge = gap > most ? i : *edge;
        most = gap > most ? gap : most;
    }
    return most;
}

/* The first edge that faces a normal best. */
static inline uint32_t fp3_facing2(const fp3_core2 *a, fp3_point2 normal) {
    uint32_t edge = 0;
    float least = FLT_MAX;
    for (uint32_t i = 0; i < a->count && a->count > 1; i++) {
        const float along = fp3_dot2(normal, a->normal[i]);
        edge = along < least ? i : edge;
        least = along < least ? along : least;
    }
    return edge;
}

static inline uint32_t fp3_end2(const fp3_core2 *a, uint32_t edge) {
    return edge + 1 < a->count ? edge + 1 : 0;
}

/* The nearest points of two edges. */
typedef struct {
    float square;  /* of their distance */
    int is_corner; /* both are corners; otherwise one is on an edge, along whose normal the other is
                    */
    fp3_point2 a, b; /* set where corners are */
} fp3_pair2;

/* Of a corner and an edge, if they are nearer than what is known. */
static inline void fp3_nearer2(fp3_point2 corner, const fp3_core2 *a, uint32_t edge, int is_swapped,
                               fp3_pair2 *pair) {
    const fp3_point2 from = a->corner[edge], to = a->corner[fp3_end2(a, edge)];
    const fp3_point2 n = a->normal[edge], t = {-n.y, n.x}, way = fp3_subtract2(corner, from);
    const float at = fp3_dot2(t, way), length = fp3_dot2(t, fp3_subtract2(to, from));
    const int is_out = at < 0 || at > length;
    const fp3_point2 end = at < 0 ? from : to, out = fp3_subtract2(corner, end);
    const float along = fp3_dot2(n, way), square = is_out ? fp3_dot2(out, out) : along * along;
    if (square < pair->square)
        *pair = (fp3_pair2){square, is_out, is_swapped ? corner : end, is_swapped ? end : corner};
}

/* a has an edge; b may be a point. */
static inline fp3_pair2 fp3_nearest2(const fp3_core2 *a, uint32_t i, const fp3_core2 *b,
                                     uint32_t k) {
    fp3_pair2 pair = {.square = FLT_MAX};
    fp3_nearer2(b->corner[k], a, i, 0, &pair);
    if (b->count > 1) {
        fp3_nearer2(b->corner[fp3_end2(b, k)], a, i, 0, &pair);
        fp3_nearer2(a->corner[i], b, k, 1, &pair);
        fp3_nearer2(a->corner[fp3_end2(a, i)], b, k, 1, &pair);
    }
    return pair;
}

#endif
