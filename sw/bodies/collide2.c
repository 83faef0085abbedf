/* SPDX-License-Identifier: Apache-2.0 */
/* collide2.c - see collide2.h. All is computed in a's axes, from a's position. */
#include "bodies/collide2.h"

#include "bodies/near2.h"

/* Sines of angles between edges of a chain and normals that count as none. */
static const float STRAIGHT = 0x1p-20f;

/* Which edge the normal is of, and which of the other faces it. */
typedef struct {
    const fp3_core2 *of, *other;
    uint32_t edge, facing;
    float radius_of, radius;
    int is_b; /* it is b's: the manifold's normal is against it */
} reference;

static void put(fp3_manifold2 *made, fp3_point2 middle, float gap) {
    made->point[made->count].arm = middle;
    made->point[made->count].gap = gap;
    made->count++;
}

/* Two corners, or discs: one point between them. The normal stays as it is where both are one. */
static void round_off(fp3_point2 a, fp3_point2 b, float radius_a, float radius_b, float reach,
                      fp3_manifold2 *made) {
    const fp3_point2 way = fp3_subtract2(b, a);
    const float distance = sqrtf(fp3_dot2(way, way)), gap = distance - (radius_a + radius_b);
    if (gap > reach)
        return;
    if (distance > 1e-15f) {
        const float inverse = 1 / distance;
        made->normal = (fp3_point2){way.x * inverse, way.y * inverse};
    }
    put(made, fp3_along2(a, radius_a + 0.5f * gap, made->normal), gap);
}

/* The facing edge, cut where the edge ends. slack: how far beside the edge a part may be; where
 * nothing is left within it there is no point. */
static void cut(const reference *r, float reach, float slack, fp3_manifold2 *made) {
    const fp3_point2 n = r->of->normal[r->edge], t = {-n.y, n.x};
    const fp3_point2 from = r->of->corner[r->edge];
    const fp3_point2 to = r->of->corner[fp3_end2(r->of, r->edge)];
    const fp3_point2 first = r->other->corner[fp3_end2(r->other, r->facing)];
    const fp3_point2 last = r->other->corner[r->facing];
    const float length = fp3_dot2(t, fp3_subtract2(to, from));
    const float low = fp3_dot2(t, fp3_subtract2(first, from));
    const float high = fp3_dot2(t, fp3_subtract2(last, from)), span = high - low;
    if (high < -slack || low > length + slack)
        return;
    const float inverse = span > 1e-12f ? 1 / span : 0;
    float begin = (low < 0 ? -low : 0) * inverse;
    float end = (high > length ? high - length : 0) * inverse;
    begin = begin < 1 ? begin : 1;
    end = end < 1 ? end : 1;
    const fp3_point2 way = fp3_subtract2(last, first);
    const fp3_point2 p[2] = {fp3_along2(first, begin, way), fp3_along2(last, -end, way)};
    float above[2];
    for (unsigned k = 0; k < 2; k++)
        above[k] = fp3_dot2(n, fp3_subtract2(p[k], from));
    const float both = r->radius_of + r->radius, lean = 0.5f * (r->radius_of - r->radius);
    /* One point where nothing is left between two: the deeper one. */
    const int is_one = r->other->count == 1 || begin + end >= 1;
    const unsigned deeper = above[1] < above[0];
    made->normal = r->is_b ? (fp3_point2){-n.x, -n.y} : n;
    for (unsigned k = 0; k < 2; k++) { /* b's edges run against the tangent */
        const unsigned which = r->is_b ? 1 - k : k;
        const float gap = above[which] - both;
        if (gap <= reach && (!is_one || which == deeper))
            put(made, fp3_along2(p[which], lean - 0.5f * above[which], n), gap);
    }
}

static void to_world(const fp3_pose2 *pose, fp3_manifold2 *made) {
    made->normal = fp3_turn2(pose, made->normal);
    for (uint32_t k = 0; k < made->count; k++)
        made->point[k].arm = fp3_turn2(pose, made->point[k].arm);
}

/* Where nothing of the facing edge is above the edge and near enough, as rounding may have it: its
 * lower end. */
static void cut_or_end(const reference *r, float reach, fp3_manifold2 *made) {
    cut(r, reach, FLT_MAX, made);
    if (made->count)
        return;
    const fp3_point2 n = r->of->normal[r->edge], from = r->of->corner[r->edge];
    const fp3_point2 p = r->other->corner[r->facing];
    const fp3_point2 q = r->other->corner[fp3_end2(r->other, r->facing)];
    const float high = fp3_dot2(n, fp3_subtract2(p, from));
    const float low = fp3_dot2(n, fp3_subtract2(q, from));
    const float above = high < low ? high : low;
    put(made, fp3_along2(high < low ? p : q, 0.5f * (r->radius_of - r->radius) - 0.5f * above, n),
        above - (r->radius_of + r->radius));
}

static reference refer(const fp3_core2 *a, uint32_t edge_a, float radius_a, const fp3_core2 *b,
                       uint32_t edge_b, float radius_b, int is_b) {
    if (is_b)
        return (reference){b, a, edge_b, fp3_facing2(a, b->normal[edge_b]), radius_b, radius_a, 1};
    return (reference){a, b, edge_a, fp3_facing2(b, a->normal[edge_a]), radius_a, radius_b, 0};
}

static void collide_polygons(const fp3_shape2 *a, const fp3_shape2 *b, const fp3_pose2 *seen,
                             float reach, fp3_manifold2 *made) {
    fp3_placed2 placed;
    fp3_put2(b, seen, &placed);
    const fp3_core2 core_a = fp3_core2_of(a), *const core_b = &placed.core;
    const float limit = a->radius + b->radius + reach, alike = FP3_ALIKE2 * (a->extent + b->extent);
    uint32_t edge_a, edge_b;
    const float gap_a = fp3_widest2(&core_a, core_b, &edge_a);
    if (gap_a > limit)
        return;
    const float gap_b = fp3_widest2(core_b, &core_a, &edge_b);
    if (gap_b > limit)
        return;
    if (gap_a > -alike || gap_b > -alike) {
        const reference r =
            refer(&core_a, edge_a, a->radius, core_b, edge_b, b->radius, gap_b > gap_a);
        const fp3_pair2 pair = fp3_nearest2(r.of, r.edge, r.other, r.facing);
        if (pair.is_corner && pair.square > alike * alike) {
            round_off(r.is_b ? pair.b : pair.a, r.is_b ? pair.a : pair.b, a->radius, b->radius,
                      reach, made);
            return;
        }
    }
    const reference r =
        refer(&core_a, edge_a, a->radius, core_b, edge_b, b->radius, gap_b > gap_a + alike);
    cut_or_end(&r, reach, made);
}

void fp3_collide2(const fp3_shape2 *a, const fp3_pose2 *pose_a, const fp3_shape2 *b,
                  const fp3_pose2 *pose_b, float reach, fp3_manifold2 *made) {
    fp3_pose2 seen;
    *made = (fp3_manifold2){.normal = {0, 1}};
    if (!fp3_seen2(pose_a, pose_b, &seen))
        return;
    const float far = a->extent + b->extent + reach;
    if (fp3_dot2(seen.at, seen.at) > far * far)
        return;
    if (a->count == 1 && b->count == 1)
        round_off(a->corner[0], fp3_place2(&seen, b->corner[0]), a->radius, b->radius, reach, made);
    else
        collide_polygons(a, b, &seen, reach, made);
    to_world(pose_a, made);
}

/* ---- an edge of a chain ---- */

/* Whose a normal at an end of an edge is. */
typedef enum {
    IS_FACE,   /* the ground is straight or hollow there: the edge's own normal is to be taken */
    IS_CORNER, /* that of the corner, nearer to this edge's than to its neighbour's */
    IS_OTHER   /* another edge's */
} owner;

typedef struct {
    fp3_point2 normal[3]; /* of the edge before, this and the next */
    uint32_t ends;
} ground;

static owner whose(const ground *g, fp3_point2 normal) {
    const fp3_point2 own = g->normal[1];
    const int is_end = fp3_cross2(own, normal) > 0;
    const fp3_point2 next = g->normal[is_end ? 2 : 0];
    const float turn = is_end ? fp3_cross2(own, next) : fp3_cross2(next, own);
    if (!(turn > STRAIGHT))
        return IS_FACE;
    const float inside = is_end ? fp3_cross2(normal, next) : fp3_cross2(next, normal);
    if (inside < -STRAIGHT)
        return IS_OTHER;
    if (g->ends & (is_end ? FP3_LINK2_LAST : FP3_LINK2_FIRST))
        return IS_CORNER;
    const float mine = fp3_dot2(own, normal), theirs = fp3_dot2(next, normal);
    return mine > theirs || (is_end && mine == theirs) ? IS_CORNER : IS_OTHER;
}

/* b's edge with the largest gap above least, if no normal of the ground's face is to be taken for
 * it. IS_FACE: there is none. */
static owner choose(const ground *g, const fp3_core2 *a, const fp3_core2 *b, float least,
                    uint32_t *edge) {
    owner found = IS_FACE;
    for (uint32_t k = 0; k < b->count && b->count > 1; k++) {
        const float gap = fp3_gap2(b, k, a);
        if (gap <= least)
            continue;
        const owner of = whose(g, (fp3_point2){-b->normal[k].x, -b->normal[k].y});
        if (of == IS_FACE)
            continue;
        least = gap;
        *edge = k;
        found = of;
    }
    return found;
}

static void collide_link(const fp3_core2 *a, float radius, const ground *g, const fp3_shape2 *b,
                         const fp3_pose2 *seen, float reach, float alike, fp3_manifold2 *made) {
    fp3_placed2 placed;
    fp3_put2(b, seen, &placed);
    const fp3_core2 *const core_b = &placed.core;
    const float limit = radius + b->radius + reach, gap_a = fp3_gap2(a, 0, core_b);
    uint32_t edge_b;
    const float gap_b = fp3_widest2(core_b, a, &edge_b);
    if (gap_a > limit || gap_b > limit)
        return;
    reference r = refer(a, 0, radius, core_b, edge_b, b->radius, gap_b > gap_a);
    if (gap_a > -alike || gap_b > -alike) {
        const fp3_pair2 pair = fp3_nearest2(r.of, r.edge, r.other, r.facing);
        if (pair.is_corner && pair.square > alike * alike) {
            const fp3_point2 on_a = r.is_b ? pair.b : pair.a, on_b = r.is_b ? pair.a : pair.b;
            const fp3_point2 way = fp3_subtract2(on_b, on_a);
            const float inverse = 1 / sqrtf(pair.square);
            const owner of = whose(g, (fp3_point2){way.x * inverse, way.y * inverse});
            if (of == IS_CORNER)
                round_off(on_a, on_b, radius, b->radius, reach, made);
            if (of != IS_FACE)
                return;
        }
    }
    const owner of = choose(g, a, core_b, gap_a + alike, &edge_b);
    if (of == IS_OTHER)
        return;
    r = refer(a, 0, radius, core_b, edge_b, b->radius, of == IS_CORNER);
    const fp3_point2 n = r.of->normal[r.edge], normal = r.is_b ? (fp3_point2){-n.x, -n.y} : n;
    const fp3_point2 corner = a->corner[fp3_cross2(g->normal[1], normal) > 0];
    if (fp3_dot2(normal, fp3_subtract2(fp3_place2(seen, b->middle), corner)) < 0)
        return;
    cut(&r, reach, alike, made);
}

void fp3_collide_link2(const fp3_link2 *a, const fp3_pose2 *pose_a, const fp3_shape2 *b,
                       const fp3_pose2 *pose_b, float reach, fp3_manifold2 *made) {
    fp3_pose2 seen;
    fp3_point2 way[3];
    float length[3], extent = b->extent;
    *made = (fp3_manifold2){.normal = {0, 1}};
    if (!fp3_seen2(pose_a, pose_b, &seen))
        return;
    ground g = {.ends = a->ends};
    for (unsigned k = 0; k < 3; k++) {
        way[k] = fp3_subtract2(a->corner[k + 1], a->corner[k]);
        length[k] = sqrtf(fp3_dot2(way[k], way[k]));
    }
    if (!(length[1] > 0))
        return;
    for (unsigned k = 0; k < 3; k++) { /* an edge without length turns nothing */
        const unsigned of = length[k] > 0 ? k : 1;
        g.normal[k] = (fp3_point2){way[of].y / length[of], -way[of].x / length[of]};
    }
    const fp3_point2 normal[2] = {g.normal[1], {-g.normal[1].x, -g.normal[1].y}};
    const fp3_core2 core = {2, a->corner + 1, normal};
    for (unsigned k = 1; k < 3; k++) {
        const float x = fabsf(a->corner[k].x), y = fabsf(a->corner[k].y);
        extent += 0.5f * (x + y);
    }
    collide_link(&core, a->radius, &g, b, &seen, reach, FP3_ALIKE2 * extent, made);
    to_world(pose_a, made);
}
