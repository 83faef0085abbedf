/* SPDX-License-Identifier: Apache-2.0 */
/* query2.c - see query2.h. */
#include "bodies/shapes/query2.h"

#include "bodies/shapes/near2.h"

enum { ROUNDS = 64 };

/* ---- how far apart ---- */

/* The points of two cores, in a's axes, and the gap between the cores. */
static fp3_apart2 between(fp3_point2 a, fp3_point2 b, float gap, fp3_point2 normal) {
    return (fp3_apart2){.gap = gap, .normal = normal, .arm_a = a, .arm_b = b};
}

/* normal: where both are in one place. */
static fp3_apart2 between_corners(fp3_point2 a, fp3_point2 b, fp3_point2 normal) {
    const fp3_point2 way = fp3_subtract2(b, a);
    const float distance = sqrtf(fp3_dot2(way, way));
    if (!(distance > 1e-15f))
        return between(a, b, distance, normal);
    const float inverse = 1 / distance;
    return between(a, b, distance, (fp3_point2){way.x * inverse, way.y * inverse});
}

static fp3_apart2 turned_around(fp3_apart2 r) {
    return between(r.arm_b, r.arm_a, r.gap, (fp3_point2){-r.normal.x, -r.normal.y});
}

/* of has the edge with the largest gap. */
static fp3_apart2 between_edges(const fp3_core2 *of, uint32_t edge, float gap,
                                const fp3_core2 *other, float alike) {
    const fp3_point2 n = fp3_at2(&of->normal, edge), from = fp3_at2(&of->corner, edge);
    const uint32_t facing = fp3_facing2(other, n);
    const fp3_pair2 pair = fp3_nearest2(of, edge, other, facing);
    if (pair.is_corner && (gap > 0 || (gap > -alike && pair.square > alike * alike)))
        return between_corners(pair.a, pair.b, n);
    if (gap > 0)
        return between(pair.a, pair.b, sqrtf(pair.square), pair.normal);
    const fp3_point2 p = fp3_at2(&other->corner, facing);
    const fp3_point2 q = fp3_at2(&other->corner, fp3_end2(other, facing));
    const float above_p = fp3_dot2(n, fp3_subtract2(p, from));
    const float above_q = fp3_dot2(n, fp3_subtract2(q, from));
    const fp3_point2 deepest = above_p < above_q ? p : q;
    return between(fp3_along2(deepest, -gap, n), deepest, gap, n);
}

static fp3_apart2 between_cores(const fp3_shape2 *a, const fp3_shape2 *b, const fp3_pose2 *seen) {
    if (a->core.count == 1 && b->core.count == 1)
        return between_corners(fp3_at2(&a->core.corner, 0),
                               fp3_place2(seen, fp3_at2(&b->core.corner, 0)), (fp3_point2){0, 1});
    fp3_core2 placed;
    fp3_place_core2(&b->core, seen, &placed);
    uint32_t edge_a, edge_b;
    const float gap_a = fp3_widest2(&a->core, &placed, &edge_a);
    const float gap_b = fp3_widest2(&placed, &a->core, &edge_b);
    const float alike = FP3_ALIKE2 * (a->extent + b->extent);
    return gap_b > gap_a ? turned_around(between_edges(&placed, edge_b, gap_b, &a->core, alike))
                         : between_edges(&a->core, edge_a, gap_a, &placed, alike);
}

int fp3_separation2(const fp3_shape2 *a, const fp3_pose2 *pose_a, const fp3_shape2 *b,
                    const fp3_pose2 *pose_b, fp3_apart2 *made) {
    fp3_pose2 seen;
    float square;
    if (!fp3_seen2(pose_a, pose_b, &seen, &square))
        return 0;
    const fp3_apart2 r = between_cores(a, b, &seen);
    made->gap = r.gap - (a->radius + b->radius);
    made->normal = fp3_turn2(pose_a, r.normal);
    made->arm_a = fp3_turn2(pose_a, fp3_along2(r.arm_a, a->radius, r.normal));
    made->arm_b = fp3_turn2(pose_a, fp3_along2(r.arm_b, -b->radius, r.normal));
    return 1;
}

int fp3_overlap2(const fp3_shape2 *a, const fp3_pose2 *pose_a, const fp3_shape2 *b,
                 const fp3_pose2 *pose_b) {
    fp3_apart2 apart;
    return fp3_separation2(a, pose_a, b, pose_b, &apart) && apart.gap <= 0;
}

/* ---- rays ---- */

/* A ray in the shape's axes, and what it has met so far. */
typedef struct {
    fp3_point2 from, way;
    float square, slack; /* of the way; how far beside an edge's end is on it */
    fp3_hit2 *hit;
    int is_hit;
} ray;

static void meet(ray *r, float fraction, fp3_point2 normal) {
    if (!(fraction >= 0 && fraction <= 1) || (r->is_hit && fraction >= r->hit->fraction))
        return;
    r->is_hit = 1;
    r->hit->fraction = fraction;
    r->hit->normal = normal;
}

static void meet_edge(ray *r, const fp3_core2 *core, uint32_t edge, float radius) {
    const fp3_point2 n = fp3_at2(&core->normal, edge), t = {-n.y, n.x};
    const fp3_point2 start = fp3_at2(&core->corner, edge);
    const fp3_point2 end = fp3_at2(&core->corner, fp3_end2(core, edge));
    const fp3_point2 way = fp3_subtract2(r->from, start);
    const float above = fp3_dot2(n, way) - radius, closing = -fp3_dot2(n, r->way);
    if (!(closing > 0) || above < 0 || above > closing)
        return;
    const float fraction = above / closing;
    const float at = fp3_dot2(t, fp3_along2(way, fraction, r->way));
    if (at >= -r->slack && at <= fp3_dot2(t, fp3_subtract2(end, start)) + r->slack)
        meet(r, fraction, n);
}

/* From the place where the ray is nearest to the corner: nothing cancels however far it begins. */
static void meet_corner(ray *r, fp3_point2 corner, float radius) {
    const fp3_point2 away = fp3_subtract2(r->from, corner);
    const float nearest = -fp3_dot2(away, r->way) / r->square;
    const fp3_point2 there = fp3_along2(away, nearest, r->way);
    const float left = radius * radius - fp3_dot2(there, there);
    if (!(left >= 0))
        return;
    const float back = sqrtf(left / r->square);
    const fp3_point2 at = fp3_along2(there, -back, r->way); /* its length is the radius */
    const float inverse = 1 / sqrtf(fp3_dot2(at, at));
    meet(r, nearest - back, (fp3_point2){at.x * inverse, at.y * inverse});
}

int fp3_ray2(const fp3_shape2 *shape, const fp3_pose2 *pose, fp3_point2 from, fp3_point2 way,
             fp3_hit2 *hit) {
    const fp3_pose2 start = {from, 1, 0}, end = {fp3_add2(from, way), 1, 0};
    const fp3_shape2 point = {.core.count = 1};
    fp3_pose2 seen, last;
    float square;
    fp3_hit2 found = {0};
    if (!fp3_seen2(pose, &start, &seen, &square) || !fp3_seen2(pose, &end, &last, &square))
        return 0;
    const float reached = fabsf(seen.at.x) + fabsf(seen.at.y) + fabsf(way.x) + fabsf(way.y);
    ray r = {.from = seen.at, .way = fp3_turn_back2(pose, way), .hit = &found};
    r.square = fp3_dot2(r.way, r.way);
    r.slack = 0x1p-22f * (shape->extent + reached);
    const float length = sqrtf(r.square);
    if (between_cores(shape, &point, &seen).gap <= shape->radius) {
        const float inverse = length > 1e-15f ? -1 / length : 0;
        *hit = (fp3_hit2){0, {way.x * inverse, way.y * inverse}, fp3_turn2(pose, seen.at)};
        return 1;
    }
    if (!(length > 1e-15f))
        return 0;
    for (uint32_t i = 0; i < shape->core.count; i++) {
        if (shape->core.count > 1)
            meet_edge(&r, &shape->core, i, shape->radius);
        if (shape->radius > 0)
            meet_corner(&r, fp3_at2(&shape->core.corner, i), shape->radius);
    }
    if (!r.is_hit)
        return 0;
    found.arm = fp3_turn2(pose, fp3_along2(r.from, found.fraction, r.way));
    found.normal = fp3_turn2(pose, found.normal);
    *hit = found;
    return 1;
}

/* ---- what moves ---- */

/* The turn at a fraction: along the chord, made one again. */
static fp3_pose2 turn_at(const fp3_sweep2 *sweep, float fraction) {
    const float c = sweep->from.c + fraction * (sweep->to.c - sweep->from.c);
    const float s = sweep->from.s + fraction * (sweep->to.s - sweep->from.s);
    const float length = sqrtf(c * c + s * s);
    return (fp3_pose2){{0, 0}, c / length, s / length};
}

/* How fast a turn goes at most, in radians over the whole: its chord over the chord's distance from
 * the origin. -1: half a turn. */
static float fastest(const fp3_sweep2 *sweep) {
    const float c = sweep->to.c - sweep->from.c, s = sweep->to.s - sweep->from.s;
    const float quarter = 0.25f * (c * c + s * s), least = 1 - quarter;
    return least > 0x1p-20f ? 2 * sqrtf(quarter / least) * (1 + 0x1p-18f) : -1;
}

static float size_of(fp3_point2 p) { return fabsf(p.x) + fabsf(p.y); }

int fp3_impact2(const fp3_shape2 *a, const fp3_sweep2 *sweep_a, const fp3_shape2 *b,
                const fp3_sweep2 *sweep_b, float slop, fp3_hit2 *hit) {
    fp3_pose2 seen;
    float square;
    if (!fp3_seen2(&sweep_a->from, &sweep_b->from, &seen, &square) ||
        !fp3_seen2(&sweep_a->to, &sweep_b->to, &seen, &square))
        return 0;
    const fp3_point2 start = fp3_subtract2(sweep_b->from.at, sweep_a->from.at);
    const fp3_point2 way = fp3_subtract2(fp3_subtract2(sweep_b->to.at, sweep_a->to.at), start);
    const float turn_a = fastest(sweep_a), turn_b = fastest(sweep_b);
    if (turn_a < 0 || turn_b < 0)
        return 0;
    const float turning = turn_a * a->extent + turn_b * b->extent;
    const float least = 0x1p-18f * (a->extent + b->extent + size_of(start) + size_of(way));
    slop = slop > least ? slop : least;
    float fraction = 0;
    fp3_apart2 apart;
    for (unsigned round = 0;; round++) {
        const fp3_pose2 pose_a = turn_at(sweep_a, fraction);
        fp3_pose2 pose_b = turn_at(sweep_b, fraction);
        pose_b.at = fp3_along2(start, fraction, way);
        if (!fp3_separation2(a, &pose_a, b, &pose_b, &apart))
            return 0;
        if (apart.gap <= slop || round == ROUNDS)
            break;
        const float closing = turning - fp3_dot2(apart.normal, way), left = apart.gap - 0.5f * slop;
        if (closing * (1 - fraction) <= left)
            return 0;
        fraction += left / closing;
        fraction = fraction < 1 ? fraction : 1;
    }
    *hit = (fp3_hit2){fraction, apart.normal, apart.arm_a};
    return 1;
}

int fp3_cast2(const fp3_shape2 *a, const fp3_pose2 *pose_a, const fp3_shape2 *b,
              const fp3_pose2 *pose_b, fp3_point2 way, float slop, fp3_hit2 *hit) {
    /* From a's position: the end of a way through the world would lose digits there. */
    const fp3_pose2 here = {{0, 0}, pose_a->c, pose_a->s};
    const fp3_pose2 from = {fp3_subtract2(pose_b->at, pose_a->at), pose_b->c, pose_b->s};
    const fp3_pose2 to = {fp3_add2(from.at, way), pose_b->c, pose_b->s};
    return fp3_impact2(a, &(fp3_sweep2){here, here}, b, &(fp3_sweep2){from, to}, slop, hit);
}
