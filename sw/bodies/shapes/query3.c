/* SPDX-License-Identifier: Apache-2.0 */
#include "query3.h"

#include "collide3.h"
#include "distance3.h"

#define ROUNDS 64
#define FARTHEST 1e16f
#define FINEST 0x1p-17f

static int are_good(const fp3_pose3 *a, const fp3_pose3 *b) {
    const fp3_point3 way = fp3_subtract3(b->at, a->at);
    return fp3_turn3_is_good(a->q) && fp3_turn3_is_good(b->q) && fp3_dot3(way, way) <= FARTHEST;
}

int fp3_separation3(const fp3_shape3 *a, const fp3_pose3 *pose_a, const fp3_shape3 *b,
                    const fp3_pose3 *pose_b, fp3_apart3 *made) {
    if (!are_good(pose_a, pose_b))
        return 0;
    const float least = 1e-5f * (a->extent + b->extent);
    const fp3_turn3 of_a = fp3_turn_of3(pose_a->q), of_b = fp3_between3(pose_a, &of_a, pose_b);
    fp3_closest3 c;
    fp3_distance3(a, b, &of_b, &c);
    fp3_point3 on_a = fp3_turned3(&of_a, c.a), on_b = fp3_turned3(&of_a, c.b);
    made->normal = fp3_turned3(&of_a, c.normal);
    made->gap = c.distance - (a->radius + b->radius);
    if (c.distance > least) {
        on_a = fp3_along3(on_a, a->radius, made->normal);
        on_b = fp3_along3(on_b, -b->radius, made->normal);
    } else {
        fp3_manifold3 m;
        fp3_collide3(a, pose_a, b, pose_b, 100 * least, &m);
        uint32_t best = 0;
        for (uint32_t i = 1; i < m.count; i++)
            best = m.point[i].gap < m.point[best].gap ? i : best;
        if (m.count) {
            made->normal = m.normal;
            made->gap = m.point[best].gap;
            on_a = fp3_along3(m.point[best].arm, -0.5f * made->gap, m.normal);
            on_b = fp3_along3(m.point[best].arm, 0.5f * made->gap, m.normal);
        }
    }
    made->arm_a = on_a;
    made->arm_b = on_b;
    return 1;
}

int fp3_overlap3(const fp3_shape3 *a, const fp3_pose3 *pose_a, const fp3_shape3 *b,
                 const fp3_pose3 *pose_b) {
    if (!are_good(pose_a, pose_b))
        return 0;
    const fp3_turn3 of_a = fp3_turn_of3(pose_a->q), of_b = fp3_between3(pose_a, &of_a, pose_b);
    fp3_closest3 c;
    fp3_distance3(a, b, &of_b, &c);
    return c.distance <= a->radius + b->radius;
}

/* A turn on its way; `rate` is the most that a point at distance 1 moves while the fraction goes
 * from 0 to 1: along a chord of length c the angle grows by at most 2 c / sqrt(1 - c c / 4). */
typedef struct {
    float from[4], change[4], rate;
} turning;

static turning turning_of(const fp3_sweep3 *sweep) {
    const float *p = sweep->from.q, *q = sweep->to.q;
    const float own = 1 / sqrtf(fp3_square_of_turn3(p));
    const float dot = (p[0] * q[0] + p[1] * q[1]) + (p[2] * q[2] + p[3] * q[3]);
    const float other = (dot < 0 ? -1.0f : 1.0f) / sqrtf(fp3_square_of_turn3(q));
    turning t;
    for (uint32_t i = 0; i < 4; i++) {
        t.from[i] = own * p[i];
        t.change[i] = other * q[i] - t.from[i];
    }
    const float square = fp3_square_of_turn3(t.change);
    t.rate = square > 1e-12f ? 2.0001f * sqrtf(square / (1 - 0.25f * square)) : 0;
    return t;
}

static void turn_at(const turning *t, float fraction, float q[4]) {
    for (uint32_t i = 0; i < 4; i++)
        q[i] = t->rate > 0 ? t->from[i] + fraction * t->change[i] : t->from[i];
}

typedef struct {
    const fp3_shape3 *a, *b;
    turning turn_a, turn_b;
    fp3_point3 start, way; /* of b as seen from a, in the world's axes */
    float slop, turns;     /* turns: the most that a corner moves by turning */
} motion;

static int advance(const motion *m, fp3_hit3 *hit) {
    const float radii = m->a->radius + m->b->radius;
    float fraction = 0;
    for (uint32_t round = 0;; round++) {
        fp3_pose3 pose_a = {{0, 0, 0}, {1, 0, 0, 0}}, pose_b = {.at = {0, 0, 0}};
        turn_at(&m->turn_a, fraction, pose_a.q);
        turn_at(&m->turn_b, fraction, pose_b.q);
        pose_b.at = fp3_along3(m->start, fraction, m->way);
        const fp3_turn3 of_a = fp3_turn_of3(pose_a.q);
        const fp3_turn3 of_b = fp3_between3(&pose_a, &of_a, &pose_b);
        fp3_closest3 c;
        fp3_distance3(m->a, m->b, &of_b, &c);
        const fp3_point3 normal = fp3_turned3(&of_a, c.normal);
        const float gap = c.distance - radii, closing = m->turns - fp3_dot3(normal, m->way);
        if (gap <= m->slop || round == ROUNDS) {
            hit->fraction = fraction;
            hit->normal = normal;
            hit->arm = fp3_turned3(&of_a, fp3_along3(c.a, m->a->radius, c.normal));
            return 1;
        }
        const float room = c.least - radii - 0.5f * m->slop;
        if (!(closing > 0))
            return 0;
        const float step = (room > 0.25f * m->slop ? room : 0.25f * m->slop) / closing;
        if (!(fraction + step < 1))
            return 0;
        fraction += step;
    }
}

static float core_extent(const fp3_shape3 *s) {
    float most = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        const float square = fp3_dot3(s->corner[i], s->corner[i]);
        most = square > most ? square : most;
    }
    return sqrtf(most);
}

int fp3_impact3(const fp3_shape3 *a, const fp3_sweep3 *sweep_a, const fp3_shape3 *b,
                const fp3_sweep3 *sweep_b, float slop, fp3_hit3 *hit) {
    const fp3_point3 own = fp3_subtract3(sweep_a->to.at, sweep_a->from.at);
    const fp3_point3 other = fp3_subtract3(sweep_b->to.at, sweep_b->from.at);
    if (!are_good(&sweep_a->from, &sweep_b->from) || !are_good(&sweep_a->from, &sweep_a->to) ||
        !are_good(&sweep_b->from, &sweep_b->to))
        return 0;
    motion m = {.a = a, .b = b, .turn_a = turning_of(sweep_a), .turn_b = turning_of(sweep_b)};
    m.start = fp3_subtract3(sweep_b->from.at, sweep_a->from.at);
    m.way = fp3_subtract3(other, own);
    m.turns = core_extent(a) * m.turn_a.rate + core_extent(b) * m.turn_b.rate;
    const float finest = FINEST * ((a->extent + b->extent) + fp3_size3(m.start) + fp3_size3(m.way));
    m.slop = slop > finest ? slop : finest;
    return advance(&m, hit);
}

int fp3_cast3(const fp3_shape3 *a, const fp3_pose3 *pose_a, const fp3_shape3 *b,
              const fp3_pose3 *pose_b, fp3_point3 way, float slop, fp3_hit3 *hit) {
    const fp3_sweep3 at_rest = {*pose_a, *pose_a};
    fp3_sweep3 moving = {*pose_b, *pose_b};
    moving.to.at = fp3_add3(pose_b->at, way);
    return fp3_impact3(a, &at_rest, b, &moving, slop, hit);
}

/* From and way in the shape's frame. 0: no; the normal is in the same frame. */
static int ray_on_faces(const fp3_shape3 *s, fp3_point3 from, fp3_point3 way, fp3_hit3 *hit) {
    float first = 0, last = 1;
    hit->normal = (fp3_point3){0, 0, 0};
    for (uint32_t f = 0; f < s->faces; f++) {
        const float height = fp3_dot3(s->normal[f], from) - s->offset[f];
        const float down = -fp3_dot3(s->normal[f], way);
        if (down == 0) {
            if (height > 0)
                return 0;
        } else if (down > 0) {
            if (height > first * down) {
                first = height / down;
                hit->normal = s->normal[f];
            }
        } else if (height > last * down) {
            last = height / down;
        }
        if (!(first <= last))
            return 0;
    }
    hit->fraction = first;
    return 1;
}

static int ray_on_ball(const fp3_shape3 *s, fp3_point3 from, fp3_point3 way, fp3_hit3 *hit) {
    const fp3_point3 r = fp3_subtract3(from, s->corner[0]);
    const float square = fp3_dot3(way, way), inside = s->radius * s->radius;
    hit->normal = (fp3_point3){0, 0, 0};
    hit->fraction = 0;
    if (fp3_dot3(r, r) <= inside)
        return 1;
    const float nearest = -fp3_dot3(r, way) / square;
    const fp3_point3 at = fp3_along3(r, nearest, way);
    const float half = (inside - fp3_dot3(at, at)) / square;
    if (!(half >= 0))
        return 0;
    hit->fraction = nearest - sqrtf(half);
    const fp3_point3 out = fp3_along3(r, hit->fraction, way);
    const float size = fp3_size3(out);
    if (size > 0)
        hit->normal = fp3_times3(1 / size, out);
    return hit->fraction >= 0 && hit->fraction <= 1;
}

int fp3_ray3(const fp3_shape3 *s, const fp3_pose3 *pose, fp3_point3 from, fp3_point3 way,
             fp3_hit3 *hit) {
    static const fp3_shape3 POINT = {.count = 1};
    const fp3_pose3 start = {from, {1, 0, 0, 0}};
    const float square = fp3_dot3(way, way), length = sqrtf(square);
    if (!are_good(pose, &start) || !(square <= FARTHEST))
        return 0;
    fp3_hit3 found = {.fraction = 0};
    const fp3_turn3 turn = fp3_turn_of3(pose->q);
    const fp3_point3 to = fp3_subtract3(from, pose->at);
    if (s->count == 1 || (s->radius == 0 && s->faces > 2)) {
        const fp3_point3 own = fp3_unturned3(&turn, to), along = fp3_unturned3(&turn, way);
        if (!(s->count == 1 ? ray_on_ball : ray_on_faces)(s, own, along, &found))
            return 0;
        found.normal = fp3_turned3(&turn, found.normal);
        found.arm = fp3_along3(to, found.fraction, way);
    } else {
        motion m = {.a = s, .b = &POINT, .start = to, .way = way};
        for (uint32_t i = 0; i < 4; i++) {
            m.turn_a.from[i] = pose->q[i];
            m.turn_b.from[i] = start.q[i];
        }
        m.slop = FINEST * (s->extent + (fp3_size3(to) + length));
        if (!advance(&m, &found))
            return 0;
        found.arm = fp3_along3(to, found.fraction, way);
        if (found.fraction == 0) /* within, or nearly */
            found.normal = (fp3_point3){0, 0, 0};
    }
    if (found.fraction == 0 && fp3_dot3(found.normal, found.normal) == 0 && length > 0)
        found.normal = fp3_times3(-1.0f / length, way);
    *hit = found;
    return 1;
}
