/* SPDX-License-Identifier: Apache-2.0 */
#include "collide3.h"

#include "axes3.h"
#include "clip3.h"
#include "distance3.h"

#include <stddef.h>

#define FARTHEST 1e16f /* the square of how far apart two bodies may be */
#define PARALLEL 0.01f /* of the square of a sine: edges that touch in two points */

typedef struct {
    const fp3_shape3 *a, *b;
    fp3_turn3 of_a, of_b; /* a's turn; b's frame in a's */
    float reach, radii;
    float slack;       /* lengths that do not count */
    int is_face_alone; /* nothing but one face of a */
    fp3_manifold3 *to;
} pair;

/* Of points in a's frame those within reach; writes the manifold. */
static void finish(const pair *p, fp3_point3 normal, uint32_t count, fp3_touch3 *touch) {
    uint32_t left = 0;
    for (uint32_t i = 0; i < count; i++)
        if (touch[i].gap <= p->reach)
            touch[left++] = touch[i];
    if (left == 0)
        return;
    if (left > 1)
        fp3_reduce3(normal, &left, touch);
    p->to->normal = fp3_turned3(&p->of_a, normal);
    p->to->count = left;
    for (uint32_t i = 0; i < left; i++) {
        p->to->point[i].arm = fp3_turned3(&p->of_a, touch[i].at);
        p->to->point[i].gap = touch[i].gap;
    }
}

/* Midway between the surfaces around one point of each core. */
static fp3_touch3 between(const pair *p, fp3_point3 a, fp3_point3 b, fp3_point3 normal, float gap) {
    const fp3_point3 on_a = fp3_along3(a, p->a->radius, normal);
    const fp3_point3 on_b = fp3_along3(b, -p->b->radius, normal);
    return (fp3_touch3){fp3_times3(0.5f, fp3_add3(on_a, on_b)), gap - p->radii};
}

static fp3_point3 square_to(fp3_point3 e) {
    const float x = fabsf(e.x), y = fabsf(e.y), z = fabsf(e.z);
    const fp3_point3 axis = y <= x && y <= z ? (fp3_point3){0, 1, 0}
                            : x <= z         ? (fp3_point3){1, 0, 0}
                                             : (fp3_point3){0, 0, 1};
    const fp3_point3 n = fp3_cross3(e, fp3_cross3(axis, e));
    const float size = fp3_size3(n);
    return size > 0 ? fp3_times3(1 / size, n) : (fp3_point3){0, 1, 0};
}

/* Two edges that are nearly parallel, along the stretch that they have in common. */
static uint32_t two_points(const pair *p, const fp3_axis3 *e, fp3_point3 normal,
                           fp3_touch3 touch[2]) {
    const float aa = fp3_dot3(e->along_a, e->along_a), bb = fp3_dot3(e->along_b, e->along_b);
    const float ab = fp3_dot3(e->along_a, e->along_b);
    const fp3_point3 across = fp3_cross3(e->along_a, e->along_b);
    if (!(fp3_dot3(across, across) < PARALLEL * aa * bb))
        return 0;
    const float first = fp3_dot3(e->along_a, fp3_subtract3(e->from_b, e->from_a)) / aa;
    const float last = first + ab / aa;
    const float low = first < last ? first : last, high = first < last ? last : first;
    const float from = low > 0 ? low : 0, until = high < 1 ? high : 1;
    if (!(until > from && (until - from) * (until - from) * aa > p->slack * p->slack))
        return 0;
    for (uint32_t i = 0; i < 2; i++) {
        const float s = i ? until : from;
        float t = (s - first) / (last - first);
        t = t > 0 ? (t < 1 ? t : 1) : 0;
        const fp3_point3 on_a = fp3_along3(e->from_a, s, e->along_a);
        const fp3_point3 on_b = fp3_along3(e->from_b, t, e->along_b);
        touch[i] = between(p, on_a, on_b, normal, fp3_dot3(normal, fp3_subtract3(on_b, on_a)));
    }
    return 2;
}

/* Points and segments. */
static void segments(const pair *p) {
    fp3_axis3 e = {.from_a = p->a->corner[0], .from_b = fp3_placed3(&p->of_b, p->b->corner[0])};
    const int is_a = p->a->count == 2, is_b = p->b->count == 2;
    float s = 0, t = 0;
    if (is_a)
        e.along_a = fp3_subtract3(p->a->corner[1], e.from_a);
    if (is_b)
        e.along_b = fp3_subtract3(fp3_placed3(&p->of_b, p->b->corner[1]), e.from_b);
    const fp3_point3 r = fp3_subtract3(e.from_b, e.from_a);
    if (is_a && is_b)
        fp3_closest_of_edges3(e.from_a, e.along_a, e.from_b, e.along_b, &s, &t);
    else if (is_a)
        s = fp3_dot3(e.along_a, r) / fp3_dot3(e.along_a, e.along_a);
    else if (is_b)
        t = -fp3_dot3(e.along_b, r) / fp3_dot3(e.along_b, e.along_b);
    s = s > 0 ? (s < 1 ? s : 1) : 0;
    t = t > 0 ? (t < 1 ? t : 1) : 0;
    const fp3_point3 on_a = fp3_along3(e.from_a, s, e.along_a);
    const fp3_point3 on_b = fp3_along3(e.from_b, t, e.along_b);
    const fp3_point3 apart = fp3_subtract3(on_b, on_a);
    float gap = fp3_size3(apart);
    if (gap - p->radii > p->reach)
        return;
    fp3_point3 normal;
    if (gap > (is_a || is_b ? 3e-7f * (p->a->extent + p->b->extent) : 0) && gap > 1e-15f) {
        normal = fp3_times3(1 / gap, apart);
    } else { /* no direction leads from one to the other */
        const fp3_point3 across = fp3_cross3(e.along_a, e.along_b);
        const float size = fp3_dot3(across, across);
        gap = 0;
        if (size > 1e-6f * fp3_dot3(e.along_a, e.along_a) * fp3_dot3(e.along_b, e.along_b))
            normal = fp3_times3(1 / sqrtf(size), across);
        else
            normal = square_to(is_a ? e.along_a : e.along_b);
    }
    fp3_touch3 touch[2] = {between(p, on_a, on_b, normal, gap)};
    const uint32_t two = is_a && is_b ? two_points(p, &e, normal, touch) : 0;
    finish(p, normal, two ? two : 1, touch);
}

static uint32_t face_towards(const fp3_shape3 *s, fp3_point3 d) {
    uint32_t best = 0;
    float most = fp3_dot3(s->normal[0], d);
    for (uint32_t f = 1; f < s->faces; f++) {
        const float h = fp3_dot3(s->normal[f], d);
        if (h > most) {
            most = h;
            best = f;
        }
    }
    return best;
}

/* A face's corners in a's frame (turn NULL: they are so already), or all, where there is none. */
static void side_of(const fp3_shape3 *s, const fp3_turn3 *turn, uint32_t face, fp3_side3 *side) {
    side->count = 0;
    uint32_t half = s->faces ? s->first[face] : 0;
    for (uint32_t i = 0; i < s->count; i++) {
        const fp3_point3 c = s->corner[s->faces ? s->from[half] : i];
        side->corner[side->count++] = turn ? fp3_placed3(turn, c) : c;
        half = s->next[half];
        if (s->faces && half == s->first[face])
            break;
    }
}

static fp3_point3 farthest(const fp3_shape3 *s, const fp3_turn3 *turn, fp3_point3 d) {
    const fp3_point3 own = turn ? fp3_unturned3(turn, d) : d;
    uint32_t best = 0;
    for (uint32_t i = 1; i < s->count; i++)
        if (fp3_dot3(own, s->corner[i]) > fp3_dot3(own, s->corner[best]))
            best = i;
    return turn ? fp3_placed3(turn, s->corner[best]) : s->corner[best];
}

/* An edge that lies square to a direction, with nothing farther along it; 0: there is none. */
static int edge_towards(const fp3_shape3 *s, const fp3_turn3 *turn, fp3_point3 d, fp3_point3 *from,
                        fp3_point3 *along) {
    const fp3_point3 own = turn ? fp3_unturned3(turn, d) : d;
    float top = -INFINITY, best = -INFINITY;
    uint32_t found = s->halves;
    for (uint32_t i = 0; i < s->count; i++) {
        const float h = fp3_dot3(own, s->corner[i]);
        top = h > top ? h : top;
    }
    for (uint32_t h = 0; h < s->halves; h += 2) {
        const fp3_point3 a = s->corner[s->from[h]], b = s->corner[s->from[h + 1]];
        const float ha = fp3_dot3(own, a), hb = fp3_dot3(own, b);
        const float length = 0.02f * fp3_size3(fp3_subtract3(b, a));
        if (ha >= top - length && hb >= top - length && ha + hb > best) {
            best = ha + hb;
            found = h;
        }
    }
    if (found == s->halves)
        return 0;
    fp3_point3 a = s->corner[s->from[found]], b = s->corner[s->from[found + 1]];
    if (turn) {
        a = fp3_placed3(turn, a);
        b = fp3_placed3(turn, b);
    }
    *from = a;
    *along = fp3_subtract3(b, a);
    return 1;
}

/* Where no axis tells the distance: a corner before a corner or an edge, or an edge beside one. */
static void corners(const pair *p, const fp3_axis3 *axis) {
    fp3_closest3 c;
    fp3_distance3(p->a, p->b, &p->of_b, &c);
    if (c.distance - p->radii > p->reach)
        return;
    const int is_near = !(c.distance > 1e-5f * (p->a->extent + p->b->extent));
    const fp3_point3 normal = is_near ? axis->normal : c.normal;
    fp3_touch3 touch[2] = {between(p, c.a, c.b, normal, is_near ? axis->gap : c.distance)};
    fp3_axis3 e = {.kind = FP3_EDGES3};
    uint32_t two = 0;
    if (edge_towards(p->a, NULL, normal, &e.from_a, &e.along_a) &&
        edge_towards(p->b, &p->of_b, fp3_times3(-1.0f, normal), &e.from_b, &e.along_b))
        two = two_points(p, &e, normal, touch);
    finish(p, normal, two ? two : 1, touch);
}

static void edges(const pair *p, const fp3_axis3 *axis) {
    float s, t;
    fp3_closest_of_edges3(axis->from_a, axis->along_a, axis->from_b, axis->along_b, &s, &t);
    const fp3_point3 on_a = fp3_along3(axis->from_a, s, axis->along_a);
    const fp3_point3 on_b = fp3_along3(axis->from_b, t, axis->along_b);
    const fp3_point3 apart = fp3_subtract3(on_b, on_a);
    if (axis->gap > p->slack &&
        fp3_dot3(apart, apart) > axis->gap * axis->gap + p->slack * p->slack) {
        corners(p, axis);
        return;
    }
    fp3_touch3 touch = between(p, on_a, on_b, axis->normal, axis->gap);
    finish(p, axis->normal, 1, &touch);
}

/* A point of the other core before a face, as a contact. */
static fp3_touch3 before(const pair *p, const fp3_axis3 *axis, fp3_point3 at, float height) {
    const float own = axis->kind == FP3_FACE_OF_A3 ? -height : height;
    const float mid = 0.5f * (own + (p->a->radius - p->b->radius));
    return (fp3_touch3){fp3_along3(at, mid, axis->normal), height - p->radii};
}

static void faces(const pair *p, const fp3_axis3 *axis) {
    const int is_a = axis->kind == FP3_FACE_OF_A3;
    const fp3_point3 away = fp3_times3(-1.0f, axis->normal);
    const fp3_point3 out = is_a ? axis->normal : away, in = is_a ? away : axis->normal;
    const fp3_shape3 *other = is_a ? p->b : p->a;
    const fp3_turn3 *turn = is_a ? &p->of_b : NULL;
    fp3_side3 face, side;
    side_of(is_a ? p->a : p->b, is_a ? NULL : &p->of_b, axis->face, &face);
    side_of(other, turn,
            other->faces ? face_towards(other, turn ? fp3_unturned3(turn, in) : in) : 0, &side);
    fp3_clip3(&face, out, p->slack, &side);
    fp3_touch3 touch[FP3_CLIPPED3 + 1];
    float least = INFINITY;
    uint32_t count = 0;
    for (uint32_t i = 0; i < side.count; i++) {
        /* About the normal from a to b, as the manifold's order is. */
        const fp3_point3 at = side.corner[is_a ? side.count - 1 - i : i];
        const float height = fp3_dot3(out, fp3_subtract3(at, face.corner[0]));
        least = height < least ? height : least;
        touch[count++] = before(p, axis, at, height);
    }
    if (least > axis->gap + p->slack) {
        /* The corner in front is not of the side that looks here. */
        side = (fp3_side3){.count = 1, .corner = {farthest(other, turn, in)}};
        fp3_clip3(&face, out, axis->gap > p->slack ? p->slack : 4 * p->slack, &side);
        if (side.count)
            touch[count++] = before(p, axis, side.corner[0], axis->gap);
        else if (!p->is_face_alone && (axis->gap > p->slack || count == 0)) {
            corners(p, axis);
            return;
        }
    }
    finish(p, axis->normal, count, touch);
}

static void balls(const pair *p, const fp3_pose3 *pose_a, const fp3_pose3 *pose_b,
                  fp3_point3 apart) {
    const fp3_point3 ca = p->a->corner[0], cb = p->b->corner[0];
    fp3_point3 on_a = {0, 0, 0};
    if (ca.x != 0 || ca.y != 0 || ca.z != 0) {
        const fp3_turn3 turn = fp3_turn_of3(pose_a->q);
        on_a = fp3_turned3(&turn, ca);
        apart = fp3_subtract3(apart, on_a);
    }
    if (cb.x != 0 || cb.y != 0 || cb.z != 0) {
        const fp3_turn3 turn = fp3_turn_of3(pose_b->q);
        apart = fp3_add3(apart, fp3_turned3(&turn, cb));
    }
    const float square = fp3_dot3(apart, apart), distance = sqrtf(square);
    const float gap = distance - p->radii;
    if (gap > p->reach)
        return;
    const int has_way = square > 1e-30f;
    p->to->normal = has_way ? fp3_times3(1 / distance, apart) : (fp3_point3){0, 1, 0};
    p->to->count = 1;
    p->to->point[0].arm = fp3_along3(on_a, p->a->radius + 0.5f * gap, p->to->normal);
    p->to->point[0].gap = gap;
}

/* Whether two shapes may be within reach; *p for them. */
static int begin(const fp3_shape3 *a, const fp3_pose3 *pose_a, const fp3_shape3 *b,
                 const fp3_pose3 *pose_b, float reach, fp3_manifold3 *to, pair *p) {
    const fp3_point3 apart = fp3_subtract3(pose_b->at, pose_a->at);
    const float square = fp3_dot3(apart, apart), most = (a->extent + b->extent) + reach;
    to->count = 0;
    to->normal = (fp3_point3){0, 0, 0};
    if (!(square <= most * most) || !(most >= 0) || !(square <= FARTHEST) ||
        !fp3_turn3_is_good(pose_a->q) || !fp3_turn3_is_good(pose_b->q))
        return 0;
    p->a = a;
    p->b = b;
    p->reach = reach;
    p->radii = a->radius + b->radius;
    p->to = to;
    p->is_face_alone = 0;
    if (a->count == 1 && b->count == 1) {
        balls(p, pose_a, pose_b, apart);
        return 0;
    }
    p->of_a = fp3_turn_of3(pose_a->q);
    p->of_b = fp3_between3(pose_a, &p->of_a, pose_b);
    p->slack =
        1e-4f * (a->extent < b->extent ? a->extent : b->extent) + 5e-7f * (a->extent + b->extent);
    return 1;
}

void fp3_collide3(const fp3_shape3 *a, const fp3_pose3 *pose_a, const fp3_shape3 *b,
                  const fp3_pose3 *pose_b, float reach, fp3_manifold3 *to) {
    pair p;
    fp3_axis3 axis;
    if (!begin(a, pose_a, b, pose_b, reach, to, &p))
        return;
    if (a->count <= 2 && b->count <= 2) {
        segments(&p);
        return;
    }
    fp3_axes3(a, b, &p.of_b, p.reach + p.radii, &axis);
    if (axis.kind == FP3_EDGES3)
        edges(&p, &axis);
    else if (axis.kind != FP3_APART3)
        faces(&p, &axis);
}

void fp3_collide_face3(const fp3_shape3 *a, const fp3_pose3 *pose_a, uint32_t face,
                       const fp3_shape3 *b, const fp3_pose3 *pose_b, float reach,
                       fp3_manifold3 *to) {
    pair p;
    if (!begin(a, pose_a, b, pose_b, reach, to, &p))
        return;
    p.is_face_alone = 1;
    fp3_axis3 axis = {.kind = FP3_FACE_OF_A3, .face = face, .normal = a->normal[face]};
    const fp3_point3 deepest = farthest(b, &p.of_b, fp3_times3(-1.0f, axis.normal));
    axis.gap = fp3_dot3(axis.normal, deepest) - a->offset[face];
    faces(&p, &axis);
}

void fp3_collide_plane3(const fp3_plane3 *a, const fp3_pose3 *pose_a, const fp3_shape3 *b,
                        const fp3_pose3 *pose_b, float reach, fp3_manifold3 *to) {
    static const fp3_shape3 NOTHING = {0};
    pair p = {.a = &NOTHING, .b = b, .reach = reach, .radii = b->radius, .to = to};
    fp3_touch3 touch[FP3_CORNERS3];
    to->count = 0;
    to->normal = (fp3_point3){0, 0, 0};
    if (!fp3_pose3_is_good(pose_a) || !fp3_pose3_is_good(pose_b))
        return;
    p.of_a = fp3_turn_of3(pose_a->q);
    p.of_b = fp3_between3(pose_a, &p.of_a, pose_b);
    const float deep = fp3_dot3(a->normal, p.of_b.at) - a->offset;
    const fp3_point3 own = fp3_unturned3(&p.of_b, a->normal);
    if (!(deep >= -1e8f && deep <= 1e8f))
        return;
    for (uint32_t i = 0; i < b->count; i++) {
        const float height = deep + fp3_dot3(own, b->corner[i]);
        const float mid = -0.5f * (height + b->radius);
        touch[i] = (fp3_touch3){fp3_along3(fp3_placed3(&p.of_b, b->corner[i]), mid, a->normal),
                                height - b->radius};
    }
    finish(&p, a->normal, b->count, touch);
}

void fp3_match_manifold3(const fp3_manifold3 *old, const fp3_manifold3 *new_one, float near,
                         uint8_t from[4]) {
    uint8_t is_taken[4] = {0};
    for (uint32_t i = 0; i < 4; i++)
        from[i] = 4;
    for (uint32_t n = 0; n < new_one->count; n++) {
        float least = near * near;
        uint32_t best = 4, of = 4;
        for (uint32_t i = 0; i < new_one->count; i++)
            for (uint32_t k = 0; from[i] == 4 && k < old->count; k++) {
                const fp3_point3 d = fp3_subtract3(new_one->point[i].arm, old->point[k].arm);
                const float square = fp3_dot3(d, d);
                if (!is_taken[k] && (square < least || (square == least && best == 4))) {
                    least = square;
                    best = i;
                    of = k;
                }
            }
        if (best == 4)
            return;
        from[best] = (uint8_t)of;
        is_taken[of] = 1;
    }
}
