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

#include "bodies/shapes/shape2.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Cores nearer than this, in parts of the extents, count as touching: the direction between points
 * has no more digits then. */
#define FP3_ALIKE2 0x1p-16f

/* Four numbers at once, in the same order each. */
typedef float fp3_four2 __attribute__((vector_size(16)));

static inline fp3_four2 fp3_load2(const float *from) {
    fp3_four2 four;
    memcpy(&four, from, sizeof four);
    return four;
}

static inline fp3_four2 fp3_least2(fp3_four2 a, fp3_four2 b) {
    fp3_four2 least = b;
    for (unsigned k = 0; k < 4; k++) /* compilers make one instruction of it */
        least[k] = a[k] < b[k] ? a[k] : b[k];
    return least;
}

/* Whether it is finite and about a turn. */
static inline int fp3_is_turn2(const fp3_pose2 *pose) {
    return fabsf(pose->c * pose->c + pose->s * pose->s - 1) <= 0.5f;
}

/* Where b is, as seen from a, and the square of how far. 0: nowhere, as one of them is not finite
 * or no turn, or they are too far apart for squares of distances. */
static inline int fp3_seen2(const fp3_pose2 *a, const fp3_pose2 *b, fp3_pose2 *seen,
                            float *square) {
    seen->at = fp3_turn_back2(a, fp3_subtract2(b->at, a->at));
    seen->c = a->c * b->c + a->s * b->s;
    seen->s = a->c * b->s - a->s * b->c;
    *square = fp3_dot2(seen->at, seen->at);
    return (*square <= 1e30f) & fp3_is_turn2(a) & fp3_is_turn2(b);
}

static inline void fp3_place_core2(const fp3_core2 *a, const fp3_pose2 *pose, fp3_core2 *core) {
    const float c = pose->c, s = pose->s;
    core->count = a->count;
    uint32_t i = 0;
    do {
        const fp3_four2 x = fp3_load2(a->corner.x + i), y = fp3_load2(a->corner.y + i);
        const fp3_four2 nx = fp3_load2(a->normal.x + i), ny = fp3_load2(a->normal.y + i);
        const fp3_four2 made[4] = {pose->at.x + (c * x - s * y), pose->at.y + (s * x + c * y),
                                   c * nx - s * ny, s * nx + c * ny};
        memcpy(core->corner.x + i, &made[0], sizeof *made);
        memcpy(core->corner.y + i, &made[1], sizeof *made);
        memcpy(core->normal.x + i, &made[2], sizeof *made);
        memcpy(core->normal.y + i, &made[3], sizeof *made);
        i += 4;
    } while (i < a->count);
}

/* The gaps along the normals of four edges. */
static inline fp3_four2 fp3_gaps2(const fp3_core2 *a, uint32_t edge, const fp3_core2 *b) {
    const fp3_four2 x = fp3_load2(a->corner.x + edge), y = fp3_load2(a->corner.y + edge);
    const fp3_four2 nx = fp3_load2(a->normal.x + edge), ny = fp3_load2(a->normal.y + edge);
    fp3_four2 least = nx * (b->corner.x[0] - x) + ny * (b->corner.y[0] - y);
    for (uint32_t k = 1; k < b->count; k++)
        least = fp3_least2(nx * (b->corner.x[k] - x) + ny * (b->corner.y[k] - y), least);
    return least;
}

/* The first of the largest, without a branch: which it is, no processor foresees. */
static inline void fp3_largest2(fp3_four2 v, uint32_t edge, float *most, uint32_t *best) {
    const float low = v[1] > v[0] ? v[1] : v[0], high = v[3] > v[2] ? v[3] : v[2];
    const float all = high > low ? high : low;
    const uint32_t not_0 = v[0] < all, not_1 = not_0 & (v[1] < all), not_2 = not_1 & (v[2] < all);
    if (all > *most) {
        *most = all;
        *best = edge + not_0 + not_1 + not_2;
    }
}

/* The first edge of a with the largest gap, and that gap. */
static inline float fp3_widest2(const fp3_core2 *a, const fp3_core2 *b, uint32_t *edge) {
    float most = -FLT_MAX;
    *edge = 0;
    for (uint32_t i = 0; i < a->count && a->count > 1; i += 4)
        fp3_largest2(fp3_gaps2(a, i, b), i, &most, edge);
    return most;
}

/* The first edge that faces a normal best. */
static inline uint32_t fp3_facing2(const fp3_core2 *a, fp3_point2 normal) {
    uint32_t edge = 0;
    float most = -FLT_MAX;
    for (uint32_t i = 0; i < a->count && a->count > 1; i += 4)
        fp3_largest2(-normal.x * fp3_load2(a->normal.x + i) - normal.y * fp3_load2(a->normal.y + i),
                     i, &most, &edge);
    return edge;
}

static inline uint32_t fp3_end2(const fp3_core2 *a, uint32_t edge) {
    return edge + 1 < a->count ? edge + 1 : 0;
}

/* The nearest points of two edges. */
typedef struct {
    float square;  /* of their distance */
    int is_corner; /* both are corners; otherwise one is on an edge, with this normal from a to b */
    fp3_point2 a, b, normal;
} fp3_pair2;

/* Of a corner and an edge of a, or of b if it is swapped, if they are nearer than what is known. */
static inline void fp3_nearer2(fp3_point2 corner, const fp3_core2 *a, uint32_t edge, int is_swapped,
                               fp3_pair2 *pair) {
    const fp3_point2 from = fp3_at2(&a->corner, edge), to = fp3_at2(&a->corner, fp3_end2(a, edge));
    const fp3_point2 n = fp3_at2(&a->normal, edge), t = {-n.y, n.x};
    const fp3_point2 way = fp3_subtract2(corner, from);
    const float at = fp3_dot2(t, way), length = fp3_dot2(t, fp3_subtract2(to, from));
    const int is_out = at < 0 || at > length;
    const fp3_point2 end = at < 0 ? from : to, out = fp3_subtract2(corner, end);
    const float along = fp3_dot2(n, way), square = is_out ? fp3_dot2(out, out) : along * along;
    if (square >= pair->square)
        return;
    const fp3_point2 foot = is_out ? end : fp3_along2(corner, -along, n), back = {-n.x, -n.y};
    *pair = is_swapped ? (fp3_pair2){square, is_out, corner, foot, back}
                       : (fp3_pair2){square, is_out, foot, corner, n};
}

/* a has an edge; b may be a point. */
static inline fp3_pair2 fp3_nearest2(const fp3_core2 *a, uint32_t i, const fp3_core2 *b,
                                     uint32_t k) {
    fp3_pair2 pair = {.square = FLT_MAX};
    fp3_nearer2(fp3_at2(&b->corner, k), a, i, 0, &pair);
    if (b->count > 1) {
        fp3_nearer2(fp3_at2(&b->corner, fp3_end2(b, k)), a, i, 0, &pair);
        fp3_nearer2(fp3_at2(&a->corner, i), b, k, 1, &pair);
        fp3_nearer2(fp3_at2(&a->corner, fp3_end2(a, i)), b, k, 1, &pair);
    }
    return pair;
}

#endif
