/* SPDX-License-Identifier: Apache-2.0 */
#include "axes3.h"

#define PARALLEL 1e-6f /* of the square of a sine */

/* b's corners, normals in a's frame. */
typedef struct {
    fp3_point3 corner[FP3_CORNERS3], normal[FP3_FACES3];
} placed;

static float highest(uint32_t count, const fp3_point3 *corner, fp3_point3 n) {
    float most = fp3_dot3(n, corner[0]);
    for (uint32_t i = 1; i < count; i++) {
        const float h = fp3_dot3(n, corner[i]);
        most = h > most ? h : most;
    }
    return most;
}

static float lowest(uint32_t count, const fp3_point3 *corner, fp3_point3 n) {
    float least = fp3_dot3(n, corner[0]);
    for (uint32_t i = 1; i < count; i++) {
        const float h = fp3_dot3(n, corner[i]);
        least = h < least ? h : least;
    }
    return least;
}

/* What a face of one is away from the other's corners; the faces' planes are in their own frame. */
static int faces_of_a(const fp3_shape3 *a, uint32_t count, const fp3_point3 *corner, float limit,
                      fp3_axis3 *axis) {
    for (uint32_t f = 0; f < a->faces; f++) {
        const float gap = lowest(count, corner, a->normal[f]) - a->offset[f];
        if (gap > limit)
            return 0;
        if (axis->kind == FP3_APART3 || gap > axis->gap)
            *axis =
                (fp3_axis3){.kind = FP3_FACE_OF_A3, .face = f, .gap = gap, .normal = a->normal[f]};
    }
    return 1;
}

static int faces_of_b(const fp3_shape3 *a, const fp3_shape3 *b, const fp3_turn3 *of_b,
                      const placed *p, float limit, float slack, fp3_axis3 *axis) {
    float least = axis->kind == FP3_APART3 ? -INFINITY : axis->gap + slack;
    for (uint32_t f = 0; f < b->faces; f++) {
        const float offset = b->offset[f] + fp3_dot3(p->normal[f], of_b->at);
        const float gap = lowest(a->count, a->corner, p->normal[f]) - offset;
        if (gap > limit)
            return 0;
        if (gap > least) {
            least = gap;
            *axis = (fp3_axis3){.kind = FP3_FACE_OF_B3,
                                .face = f,
                                .gap = gap,
                                .normal = fp3_times3(-1.0f, p->normal[f])};
        }
    }
    return 1;
}

/* Where an arc from the normal on an edge's left to that on its right crosses the circle square to
 * another edge e: +1 or -1, and 0 where it does not. `of_e`: e . each normal. */
static float crossing(const fp3_shape3 *s, const float *of_e, uint32_t half) {
    const float left = of_e[s->face[half]], right = of_e[s->face[half + 1]];
    return left * right < 0 ? (left > 0 ? 1.0f : -1.0f) : 0;
}

static float crossing_of(const fp3_shape3 *s, uint32_t half, fp3_point3 e) {
    const float left = fp3_dot3(e, s->normal[s->face[half]]);
    const float right = fp3_dot3(e, s->normal[s->face[half + 1]]);
    return left * right < 0 ? (left > 0 ? 1.0f : -1.0f) : 0;
}

/* One pair of edges, whose directions cross at s (ea x eb); 0: the cores are farther apart than the
 * limit. That a gap is the gap is seen by all corners: edges may be nearly parallel. */
static int pair(const fp3_shape3 *a, const fp3_shape3 *b, const placed *p, const fp3_axis3 *e,
                float s, float limit, float *least, fp3_axis3 *axis) {
    fp3_point3 w = fp3_cross3(e->along_a, e->along_b);
    const float square = fp3_dot3(w, w);
    if (!(square > PARALLEL * fp3_dot3(e->along_a, e->along_a) * fp3_dot3(e->along_b, e->along_b)))
        return 1;
    w = fp3_times3(s / sqrtf(square), w);
    if (!(fp3_dot3(w, fp3_subtract3(e->from_b, e->from_a)) > *least))
        return 1;
    const float gap = lowest(b->count, p->corner, w) - highest(a->count, a->corner, w);
    if (gap > limit)
        return 0;
    if (gap > *least) {
        *least = gap;
        *axis = *e;
        axis->gap = gap;
        axis->normal = w;
    }
    return 1;
}

/* A segment has no faces: its arc is the whole circle. */
static int edges(const fp3_shape3 *a, const fp3_shape3 *b, const placed *p, float limit,
                 float slack, fp3_axis3 *axis) {
    float least = axis->kind == FP3_APART3 ? -INFINITY : axis->gap + slack;
    float of_a[FP3_FACES3];
    fp3_axis3 e = {.kind = FP3_EDGES3};
    for (uint32_t i = 0; i < a->halves; i += 2) {
        e.from_a = a->corner[a->from[i]];
        e.along_a = fp3_subtract3(a->corner[a->from[i + 1]], e.from_a);
        for (uint32_t f = 0; f < b->faces; f++)
            of_a[f] = fp3_dot3(e.along_a, p->normal[f]);
        for (uint32_t j = 0; j < b->halves; j += 2) {
            float s = b->faces ? crossing(b, of_a, j) : 1.0f;
            if (s == 0)
                continue;
            e.from_b = p->corner[b->from[j]];
            e.along_b = fp3_subtract3(p->corner[b->from[j + 1]], e.from_b);
            if (a->faces) {
                const float own = crossing_of(a, i, e.along_b);
                if (b->faces ? own != s : own == 0)
                    continue;
                s = own;
            }
            if (!pair(a, b, p, &e, s, limit, &least, axis))
                return 0;
        }
    }
    return 1;
}

/* Two boxes. c[i][j]: a's axis i . b's axis j; t: from a's centre to b's, along a's axes. */
typedef struct {
    float c[3][3], size[3][3]; /* size: of c, without sign */
    float t[3];
    float ha[3], hb[3]; /* half sides */
} two;

static float signed_as(float x, float s) { return s < 0 ? -x : x; }

/* Half an edge of a box from its middle, and the middle: the edge along axis k that is farthest in
 * the direction whose parts along the axes are w. */
static void edge_of(const fp3_point3 axis[3], const float *half, uint32_t k, const float w[3],
                    fp3_point3 centre, fp3_point3 *from, fp3_point3 *along) {
    const uint32_t l = (k + 1) % 3, m = (k + 2) % 3;
    centre = fp3_along3(centre, signed_as(half[l], w[l]), axis[l]);
    centre = fp3_along3(centre, signed_as(half[m], w[m]), axis[m]);
    *from = fp3_along3(centre, -half[k], axis[k]);
    *along = fp3_times3(2.0f * half[k], axis[k]);
}

static int box_faces(const two *q, float limit, float slack, float tb[3], fp3_axis3 *axis) {
    float least = -INFINITY;
    for (uint32_t i = 0; i < 3; i++) {
        const float own =
            (q->hb[0] * q->size[i][0] + q->hb[1] * q->size[i][1]) + q->hb[2] * q->size[i][2];
        const float gap = fabsf(q->t[i]) - (q->ha[i] + own);
        if (gap > limit)
            return 0;
        if (gap > least) {
            least = axis->gap = gap;
            axis->kind = FP3_FACE_OF_A3;
            axis->face = 2 * i + (q->t[i] < 0);
        }
    }
    least += slack;
    for (uint32_t j = 0; j < 3; j++) {
        const float own =
            (q->ha[0] * q->size[0][j] + q->ha[1] * q->size[1][j]) + q->ha[2] * q->size[2][j];
        tb[j] = (q->t[0] * q->c[0][j] + q->t[1] * q->c[1][j]) + q->t[2] * q->c[2][j];
        const float gap = fabsf(tb[j]) - (q->hb[j] + own);
        if (gap > limit)
            return 0;
        if (gap > least) {
            least = axis->gap = gap;
            axis->kind = FP3_FACE_OF_B3;
            axis->face = 2 * j + (tb[j] >= 0);
        }
    }
    return 1;
}

/* In `found` the best pair, from 1, of 3 i + j. A gap is divided by the sine of the angle between
 * the edges only if that can make it better. */
static int box_edges(const two *q, float limit, float least, uint32_t *found, float *gap) {
    static const uint8_t NEXT[3] = {1, 2, 0}, LAST[3] = {2, 0, 1};
    *found = 0;
    for (uint32_t i = 0; i < 3; i++) {
        const uint32_t k = NEXT[i], l = LAST[i];
        for (uint32_t j = 0; j < 3; j++) {
            const float own =
                (q->ha[k] * q->size[l][j] + q->ha[l] * q->size[k][j]) +
                (q->hb[NEXT[j]] * q->size[i][LAST[j]] + q->hb[LAST[j]] * q->size[i][NEXT[j]]);
            const float raw = fabsf(q->t[l] * q->c[k][j] - q->t[k] * q->c[l][j]) - own;
            if (raw <= least && least <= 0)
                continue;
            const float square = q->c[k][j] * q->c[k][j] + q->c[l][j] * q->c[l][j];
            if (square < PARALLEL)
                continue;
            const float g = raw / sqrtf(square);
            if (g > limit)
                return 0;
            if (g > least) {
                least = *gap = g;
                *found = 3 * i + j + 1;
            }
        }
    }
    return 1;
}

static void take_edges(const two *q, uint32_t i, uint32_t j, const fp3_point3 a_axis[3],
                       const fp3_point3 b_axis[3], fp3_point3 a_centre, fp3_point3 b_centre,
                       fp3_axis3 *axis) {
    const uint32_t k = (i + 1) % 3, l = (i + 2) % 3;
    const float square = q->c[k][j] * q->c[k][j] + q->c[l][j] * q->c[l][j];
    const float s = signed_as(1.0f / sqrtf(square), q->t[l] * q->c[k][j] - q->t[k] * q->c[l][j]);
    float w[3], v[3];
    w[i] = 0;
    w[k] = -s * q->c[l][j];
    w[l] = s * q->c[k][j];
    for (uint32_t n = 0; n < 3; n++)
        v[n] = -((w[0] * q->c[0][n] + w[1] * q->c[1][n]) + w[2] * q->c[2][n]);
    axis->normal =
        fp3_along3(fp3_along3(fp3_times3(w[0], a_axis[0]), w[1], a_axis[1]), w[2], a_axis[2]);
    edge_of(a_axis, q->ha, i, w, a_centre, &axis->from_a, &axis->along_a);
    edge_of(b_axis, q->hb, j, v, b_centre, &axis->from_b, &axis->along_b);
}

static void boxes(const fp3_shape3 *a, const fp3_shape3 *b, const fp3_turn3 *of_b, float limit,
                  float slack, fp3_axis3 *axis) {
    const fp3_point3 a_axis[3] = {a->normal[0], a->normal[2], a->normal[4]};
    fp3_point3 b_axis[3];
    for (uint32_t j = 0; j < 3; j++)
        b_axis[j] = b->box == FP3_STRAIGHT_BOX3
                        ? (fp3_point3){fp3_part3(of_b->row[0], j), fp3_part3(of_b->row[1], j),
                                       fp3_part3(of_b->row[2], j)}
                        : fp3_turned3(of_b, b->normal[2 * j]);
    const fp3_point3 b_centre = fp3_placed3(of_b, b->middle);
    const fp3_point3 t = fp3_subtract3(b_centre, a->middle);
    two q = {.ha = {a->half.x, a->half.y, a->half.z}, .hb = {b->half.x, b->half.y, b->half.z}};
    for (uint32_t i = 0; i < 3; i++) {
        const int is_straight = a->box == FP3_STRAIGHT_BOX3;
        q.t[i] = is_straight ? fp3_part3(t, i) : fp3_dot3(a_axis[i], t);
        for (uint32_t j = 0; j < 3; j++) {
            q.c[i][j] = is_straight ? fp3_part3(b_axis[j], i) : fp3_dot3(a_axis[i], b_axis[j]);
            q.size[i][j] = fabsf(q.c[i][j]);
        }
    }
    float tb[3], gap = 0;
    uint32_t found;
    if (!box_faces(&q, limit, slack, tb, axis) ||
        !box_edges(&q, limit, axis->gap + slack, &found, &gap)) {
        axis->kind = FP3_APART3;
    } else if (found) {
        axis->kind = FP3_EDGES3;
        axis->gap = gap;
        take_edges(&q, (found - 1) / 3, (found - 1) % 3, a_axis, b_axis, a->middle, b_centre, axis);
    } else {
        const uint32_t k = axis->face / 2, is_minus = axis->face & 1;
        const int is_a = axis->kind == FP3_FACE_OF_A3;
        axis->normal = fp3_times3(is_a == !is_minus ? 1.0f : -1.0f, is_a ? a_axis[k] : b_axis[k]);
    }
}

void fp3_axes3(const fp3_shape3 *a, const fp3_shape3 *b, const fp3_turn3 *of_b, float limit,
               fp3_axis3 *axis) {
    const float slack = fp3_axes3_slack(a, b);
    axis->kind = FP3_APART3;
    if (a->box && b->box) {
        boxes(a, b, of_b, limit, slack, axis);
        return;
    }
    placed p;
    for (uint32_t i = 0; i < b->count; i++)
        p.corner[i] = fp3_placed3(of_b, b->corner[i]);
    for (uint32_t f = 0; f < b->faces; f++)
        p.normal[f] = fp3_turned3(of_b, b->normal[f]);
    if (!faces_of_a(a, b->count, p.corner, limit, axis) ||
        !faces_of_b(a, b, of_b, &p, limit, slack, axis) || !edges(a, b, &p, limit, slack, axis))
        axis->kind = FP3_APART3;
}
