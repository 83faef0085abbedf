/* SPDX-License-Identifier: Apache-2.0 */
/* collide2.c - see collide2.h. All is computed in a's axes, from a's position. */
#include "bodies/shapes/collide2.h"

#include "bodies/shapes/near2.h"

/* Sines of angles between edges of a chain and normals that count as none. */
static const float STRAIGHT = 0x1p-20f;

/* What a manifold is made of. All is computed in a's axes, from a point start that a has. */
typedef struct {
    const fp3_pose2 *pose; /* a's */
    fp3_point2 start;
    float reach;
    fp3_manifold2 *made;
} task;

/* A polygon, the radius around it and one of its edges. */
typedef struct {
    const fp3_core2 *core;
    float radius;
    uint32_t edge;
} side;

/* The edge that the normal is of, and the other's that faces it. */
typedef struct {
    const side *of, *other;
    uint32_t facing;
    int is_b; /* it is b's: the manifold's normal is against it */
} reference;

static reference refer(const side *a, const side *b, int is_b) {
    const side *const of = is_b ? b : a, *const other = is_b ? a : b;
    const fp3_point2 normal = fp3_at2(&of->core->normal, of->edge);
    return (reference){of, other, fp3_facing2(other->core, normal), is_b};
}

/* Without a branch: which of a manifold's points there are, no processor foresees. */
static inline void put(const task *t, fp3_point2 middle, float gap, int is_kept) {
    fp3_manifold2 *const made = t->made;
    made->point[made->count].arm = fp3_turn2(t->pose, fp3_add2(t->start, middle));
    made->point[made->count].gap = gap;
    made->count += (uint32_t)is_kept;
}

static fp3_point2 times(fp3_point2 a, float by) { return (fp3_point2){a.x * by, a.y * by}; }

/* Two corners, or discs: one point between them. */
static void round_off(const task *t, fp3_point2 a, fp3_point2 b, float radius_a, float radius_b) {
    const fp3_point2 way = fp3_subtract2(b, a);
    const float distance = sqrtf(fp3_dot2(way, way)), gap = distance - (radius_a + radius_b);
    if (gap > t->reach)
        return;
    const fp3_point2 n = distance > 1e-15f ? times(way, 1 / distance) : (fp3_point2){0, 1};
    t->made->normal = fp3_turn2(t->pose, n);
    put(t, fp3_along2(a, radius_a + 0.5f * gap, n), gap, 1);
}

/* The facing edge, cut where the edge ends. slack: how far beside the edge a part may be; where
 * nothing is left within it there is no point. Everything runs along the manifold's tangent,
 * against which b's own edges run. */
static void cut(const task *t, const reference *r, float slack) {
    const fp3_core2 *const of = r->of->core, *const other = r->other->core;
    const uint32_t edge[2] = {r->of->edge, fp3_end2(of, r->of->edge)};
    const uint32_t facing[2] = {fp3_end2(other, r->facing), r->facing};
    const uint32_t is_b = (uint32_t)r->is_b;
    const fp3_point2 n = fp3_at2(&of->normal, edge[0]), normal = times(n, is_b ? -1 : 1);
    const fp3_point2 along = {-normal.y, normal.x};
    const fp3_point2 from = fp3_at2(&of->corner, edge[is_b]);
    const fp3_point2 to = fp3_at2(&of->corner, edge[!is_b]);
    const fp3_point2 first = fp3_at2(&other->corner, facing[is_b]);
    const fp3_point2 last = fp3_at2(&other->corner, facing[!is_b]);
    const float length = fp3_dot2(along, fp3_subtract2(to, from));
    const float low = fp3_dot2(along, fp3_subtract2(first, from));
    const float high = fp3_dot2(along, fp3_subtract2(last, from)), span = high - low;
    if (high < -slack || low > length + slack)
        return;
    const float inverse = span > 1e-12f ? 1 / span : 0, below = -low, over = high - length;
    float begin = (below > 0 ? below : 0) * inverse, end = (over > 0 ? over : 0) * inverse;
    begin = begin < 1 ? begin : 1;
    end = end < 1 ? end : 1;
    const fp3_point2 way = fp3_subtract2(last, first);
    const fp3_point2 p = fp3_along2(first, begin, way), q = fp3_along2(last, -end, way);
    const float above_p = fp3_dot2(n, fp3_subtract2(p, from));
    const float above_q = fp3_dot2(n, fp3_subtract2(q, from));
    const float both = r->of->radius + r->other->radius;
    const float lean = 0.5f * (r->of->radius - r->other->radius);
    /* One point where nothing is left between two: the deeper one. */
    const int is_two = (other->count > 1) & (begin + end < 1), is_q = above_q < above_p;
    t->made->normal = fp3_turn2(t->pose, normal);
    put(t, fp3_along2(p, lean - 0.5f * above_p, n), above_p - both,
        (above_p - both <= t->reach) & (is_two | !is_q));
    put(t, fp3_along2(q, lean - 0.5f * above_q, n), above_q - both,
        (above_q - both <= t->reach) & (is_two | is_q));
}

/* Where nothing of the facing edge is above the edge and near enough, as rounding may have it: its
 * lower end. */
static void cut_or_end(const task *t, const reference *r) {
    cut(t, r, FLT_MAX);
    if (t->made->count)
        return;
    const fp3_core2 *const of = r->of->core, *const other = r->other->core;
    const fp3_point2 n = fp3_at2(&of->normal, r->of->edge);
    const fp3_point2 from = fp3_at2(&of->corner, r->of->edge);
    const fp3_point2 p = fp3_at2(&other->corner, r->facing);
    const fp3_point2 q = fp3_at2(&other->corner, fp3_end2(other, r->facing));
    const float high = fp3_dot2(n, fp3_subtract2(p, from));
    const float low = fp3_dot2(n, fp3_subtract2(q, from)), above = high < low ? high : low;
    const float lean = 0.5f * (r->of->radius - r->other->radius);
    put(t, fp3_along2(high < low ? p : q, lean - 0.5f * above, n),
        above - (r->of->radius + r->other->radius), 1);
}

/* The nearest corners of two cores that are apart, a's first. 0: they are not corners, or nearer
 * than alike. */
static int are_corners(const side *a, const side *b, int is_b, float alike, fp3_pair2 *pair) {
    const reference r = refer(a, b, is_b);
    const fp3_pair2 found = fp3_nearest2(r.of->core, r.of->edge, r.other->core, r.facing);
    *pair = found;
    if (r.is_b) {
        pair->a = found.b;
        pair->b = found.a;
    }
    return found.is_corner && found.square > alike * alike;
}

static void collide_polygons(const task *t, const fp3_shape2 *a, const fp3_shape2 *b,
                             const fp3_pose2 *seen) {
    fp3_core2 placed;
    fp3_place_core2(&b->core, seen, &placed);
    const float limit = a->radius + b->radius + t->reach,
                alike = FP3_ALIKE2 * (a->extent + b->extent);
    side of_a = {.core = &a->core, .radius = a->radius};
    side of_b = {.core = &placed, .radius = b->radius};
    const float gap_a = fp3_widest2(of_a.core, of_b.core, &of_a.edge);
    if (gap_a > limit)
        return;
    const float gap_b = fp3_widest2(of_b.core, of_a.core, &of_b.edge);
    if (gap_b > limit)
        return;
    fp3_pair2 pair;
    if ((gap_a > -alike || gap_b > -alike) &&
        are_corners(&of_a, &of_b, gap_b > gap_a, alike, &pair)) {
        round_off(t, pair.a, pair.b, a->radius, b->radius);
        return;
    }
    const reference r = refer(&of_a, &of_b, gap_b > gap_a + alike);
    cut_or_end(t, &r);
}

void fp3_collide2(const fp3_shape2 *a, const fp3_pose2 *pose_a, const fp3_shape2 *b,
                  const fp3_pose2 *pose_b, float reach, fp3_manifold2 *made) {
    fp3_pose2 seen;
    *made = (fp3_manifold2){.normal = {0, 1}};
    float square;
    if (!fp3_seen2(pose_a, pose_b, &seen, &square))
        return;
    const float far = a->extent + b->extent + reach;
    if (square > far * far)
        return;
    const task t = {.pose = pose_a, .reach = reach, .made = made};
    if (a->core.count == 1 && b->core.count == 1)
        round_off(&t, fp3_at2(&a->core.corner, 0), fp3_place2(&seen, fp3_at2(&b->core.corner, 0)),
                  a->radius, b->radius);
    else
        collide_polygons(&t, a, b, &seen);
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
        const float gap = fp3_gaps2(b, k & ~3u, a)[k & 3];
        if (gap <= least)
            continue;
        const owner of = whose(g, times(fp3_at2(&b->normal, k), -1));
        if (of == IS_FACE)
            continue;
        least = gap;
        *edge = k;
        found = of;
    }
    return found;
}

static void collide_link(const task *t, const fp3_core2 *a, float radius, const ground *g,
                         const fp3_shape2 *b, const fp3_pose2 *seen, float alike) {
    fp3_core2 placed;
    fp3_place_core2(&b->core, seen, &placed);
    const side of_a = {.core = a, .radius = radius};
    side of_b = {.core = &placed, .radius = b->radius};
    const float gap_a = fp3_gaps2(a, 0, &placed)[0], gap_b = fp3_widest2(&placed, a, &of_b.edge);
    const float limit = radius + b->radius + t->reach;
    if (gap_a > limit || gap_b > limit)
        return;
    fp3_pair2 pair;
    if ((gap_a > -alike || gap_b > -alike) &&
        are_corners(&of_a, &of_b, gap_b > gap_a, alike, &pair)) {
        const owner of = whose(g, times(fp3_subtract2(pair.b, pair.a), 1 / sqrtf(pair.square)));
        if (of == IS_CORNER)
            round_off(t, pair.a, pair.b, radius, b->radius);
        if (of != IS_FACE)
            return;
    }
    const owner of = choose(g, a, &placed, gap_a + alike, &of_b.edge);
    if (of == IS_OTHER)
        return;
    const reference r = refer(&of_a, &of_b, of == IS_CORNER);
    const fp3_point2 normal = times(fp3_at2(&r.of->core->normal, r.of->edge), r.is_b ? -1 : 1);
    const fp3_point2 corner = fp3_at2(&a->corner, fp3_cross2(g->normal[1], normal) > 0);
    if (fp3_dot2(normal, fp3_subtract2(fp3_place2(seen, b->middle), corner)) >= 0)
        cut(t, &r, alike);
}

void fp3_collide_link2(const fp3_link2 *a, const fp3_pose2 *pose_a, const fp3_shape2 *b,
                       const fp3_pose2 *pose_b, float reach, fp3_manifold2 *made) {
    fp3_pose2 seen;
    fp3_point2 way[3];
    float length[3], square;
    *made = (fp3_manifold2){.normal = {0, 1}};
    if (!fp3_seen2(pose_a, pose_b, &seen, &square))
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
    /* From the edge's first corner: what is far along the chain loses no digits. */
    const fp3_point2 start = a->corner[1], to = way[1], n = g.normal[1];
    seen.at = fp3_subtract2(seen.at, start);
    fp3_core2 core = {.count = 2};
    for (unsigned k = 0; k < 4; k++) {
        core.corner.x[k] = k ? to.x : 0;
        core.corner.y[k] = k ? to.y : 0;
        core.normal.x[k] = k ? -n.x : n.x;
        core.normal.y[k] = k ? -n.y : n.y;
    }
    /* Both edges at a joint lose digits of b's place, each its own: no hole may be left. */
    const float alike = FP3_ALIKE2 * (length[1] + b->extent) +
                        0x1p-22f * (fabsf(start.x) + fabsf(start.y) + length[1]);
    const task t = {.pose = pose_a, .start = start, .reach = reach, .made = made};
    collide_link(&t, &core, a->radius, &g, b, &seen, alike);
}
