/* SPDX-License-Identifier: Apache-2.0 */
#include "distance3.h"

#define ROUNDS 40
#define CLOSE 1e-6f /* of a square: what is not worth another round */

typedef struct {
    fp3_point3 a, b, apart; /* apart: b - a */
    uint8_t ia, ib;
} corner;

typedef struct {
    uint32_t count;
    corner of[4];
    float weight[4];
} simplex;

typedef struct {
    uint32_t count, of[3];
    float weight[3];
    float square; /* of the distance from 0 */
} nearest;

static float held(float x) { return x > 0 ? (x < 1 ? x : 1) : 0; }

void fp3_closest_of_edges3(fp3_point3 from_a, fp3_point3 along_a, fp3_point3 from_b,
                           fp3_point3 along_b, float *s, float *t) {
    const fp3_point3 r = fp3_subtract3(from_b, from_a);
    const float a = fp3_dot3(along_a, along_a), b = fp3_dot3(along_b, along_b);
    const float ab = fp3_dot3(along_a, along_b);
    const float ra = fp3_dot3(along_a, r), rb = fp3_dot3(along_b, r);
    const float square = a * b - ab * ab;
    *s = square > 1e-6f * (a * b) ? held((ra * b - rb * ab) / square) : held(ra / a);
    *t = held((ab * *s - rb) / b);
    *s = held((ab * *t + ra) / a);
}

static nearest of_one(const simplex *x, uint32_t i) {
    return (nearest){1, {i}, {1}, fp3_dot3(x->of[i].apart, x->of[i].apart)};
}

static float square_at(const simplex *x, const nearest *n) {
    fp3_point3 p = fp3_times3(n->weight[0], x->of[n->of[0]].apart);
    for (uint32_t i = 1; i < n->count; i++)
        p = fp3_along3(p, n->weight[i], x->of[n->of[i]].apart);
    return fp3_dot3(p, p);
}

static nearest of_two(const simplex *x, uint32_t i, uint32_t j) {
    const fp3_point3 p = x->of[i].apart, q = x->of[j].apart, e = fp3_subtract3(q, p);
    const float along = -fp3_dot3(p, e), square = fp3_dot3(e, e);
    if (!(along > 0))
        return of_one(x, i);
    if (!(along < square))
        return of_one(x, j);
    nearest n = {2, {i, j}, {1 - along / square, along / square}, 0};
    n.square = square_at(x, &n);
    return n;
}

static nearest closer(nearest a, nearest b) { return b.square < a.square ? b : a; }

/* The inside of a triangle if 0 is before it, else the best of its sides. */
static nearest of_three(const simplex *x, uint32_t i, uint32_t j, uint32_t k) {
    const fp3_point3 p = x->of[i].apart, q = x->of[j].apart, r = x->of[k].apart;
    const fp3_point3 u = fp3_subtract3(q, p), v = fp3_subtract3(r, p), w = fp3_subtract3(r, q);
    const fp3_point3 n = fp3_cross3(u, v);
    const float square = fp3_dot3(n, n);
    /* Twice the areas of the triangles with 0's foot instead of one corner. */
    const float of_p = fp3_dot3(n, fp3_cross3(q, w)), of_q = -fp3_dot3(n, fp3_cross3(p, v));
    const float of_r = fp3_dot3(n, fp3_cross3(p, u));
    if (square > 0 && of_p > 0 && of_q > 0 && of_r > 0) {
        const float whole = of_p + of_q + of_r;
        nearest in = {3, {i, j, k}, {of_p / whole, of_q / whole, of_r / whole}, 0};
        const float high = fp3_dot3(n, p);
        in.square = high * (high / square);
        return in;
    }
    return closer(closer(of_two(x, i, j), of_two(x, i, k)), of_two(x, j, k));
}

/* The faces that 0 is in front of; 4 in `count`, with `inside`: it is within the tetrahedron. */
static nearest of_four(const simplex *x, float inside[4]) {
    static const uint8_t FACE[4][4] = {{0, 1, 2, 3}, {0, 3, 1, 2}, {0, 2, 3, 1}, {1, 3, 2, 0}};
    nearest best = {4, {0}, {0}, INFINITY};
    for (uint32_t f = 0; f < 4; f++) {
        const fp3_point3 p = x->of[FACE[f][0]].apart, q = x->of[FACE[f][1]].apart;
        const fp3_point3 r = x->of[FACE[f][2]].apart, o = x->of[FACE[f][3]].apart;
        const fp3_point3 n = fp3_cross3(fp3_subtract3(q, p), fp3_subtract3(r, p));
        const float other = fp3_dot3(n, fp3_subtract3(o, p)), here = -fp3_dot3(n, p);
        /* of the volume, that between 0 and this face belongs to the corner opposite to it */
        inside[FACE[f][3]] = here / other;
        if (!(other > 0 ? here > 0 : other < 0 && here < 0))
            best = closer(best, of_three(x, FACE[f][0], FACE[f][1], FACE[f][2]));
    }
    return best;
}

static nearest of_simplex(simplex *x) {
    return x->count == 1   ? of_one(x, 0)
           : x->count == 2 ? of_two(x, 0, 1)
           : x->count == 3 ? of_three(x, 0, 1, 2)
                           : of_four(x, x->weight);
}

static uint8_t farthest(uint32_t count, const fp3_point3 *of, fp3_point3 d) {
    uint8_t best = 0;
    float most = fp3_dot3(d, of[0]);
    for (uint32_t i = 1; i < count; i++) {
        const float h = fp3_dot3(d, of[i]);
        if (h > most) {
            most = h;
            best = (uint8_t)i;
        }
    }
    return best;
}

/* The corners farthest along d: of a in its direction, of b against it. */
static corner towards(const fp3_shape3 *a, const fp3_shape3 *b, const fp3_turn3 *of_b,
                      fp3_point3 d) {
    corner c = {.ia = farthest(a->count, a->corner, d),
                .ib = farthest(b->count, b->corner, fp3_unturned3(of_b, fp3_times3(-1.0f, d)))};
    c.a = a->corner[c.ia];
    c.b = fp3_placed3(of_b, b->corner[c.ib]);
    c.apart = fp3_subtract3(c.b, c.a);
    return c;
}

static int has(const simplex *x, const corner *c) {
    for (uint32_t i = 0; i < x->count; i++)
        if (x->of[i].ia == c->ia && x->of[i].ib == c->ib)
            return 1;
    return 0;
}

static void keep(simplex *x, const nearest *n) {
    simplex left = {.count = n->count};
    for (uint32_t i = 0; i < n->count; i++) {
        left.of[i] = x->of[n->of[i]];
        left.weight[i] = n->weight[i];
    }
    *x = left;
}

static void points(const simplex *x, fp3_closest3 *to) {
    to->a = fp3_times3(x->weight[0], x->of[0].a);
    to->b = fp3_times3(x->weight[0], x->of[0].b);
    for (uint32_t i = 1; i < x->count; i++) {
        to->a = fp3_along3(to->a, x->weight[i], x->of[i].a);
        to->b = fp3_along3(to->b, x->weight[i], x->of[i].b);
    }
}

static void meet(fp3_closest3 *to) {
    to->normal = (fp3_point3){0, 0, 0};
    to->distance = to->least = 0;
}

/* The normal of a closest point within a triangle, that the difference of close points would have
 * lost to rounding. */
static fp3_point3 direction(const simplex *x, const fp3_closest3 *to) {
    const fp3_point3 v = fp3_subtract3(to->b, to->a);
    if (x->count != 3)
        return v;
    const fp3_point3 n = fp3_cross3(fp3_subtract3(x->of[1].apart, x->of[0].apart),
                                    fp3_subtract3(x->of[2].apart, x->of[0].apart));
    const float high = fp3_dot3(n, x->of[0].apart), square = fp3_dot3(n, n);
    return square > 0 ? fp3_times3(high / square, n) : v;
}

void fp3_distance3(const fp3_shape3 *a, const fp3_shape3 *b, const fp3_turn3 *of_b,
                   fp3_closest3 *to) {
    const fp3_point3 start = fp3_subtract3(fp3_placed3(of_b, b->middle), a->middle);
    simplex x = {.count = 1, .of = {towards(a, b, of_b, start)}, .weight = {1}};
    const float size = (a->extent + b->extent) * 3e-7f;
    float square = fp3_dot3(x.of[0].apart, x.of[0].apart);
    fp3_point3 v = x.of[0].apart;
    to->least = 0;
    points(&x, to);
    for (to->rounds = 1; to->rounds < ROUNDS; to->rounds++) {
        if (!(square > size * size))
            break;
        /* v is from a to b: a's corner farthest along it, b's farthest against it. */
        const corner c = towards(a, b, of_b, v);
        const float high = fp3_dot3(v, c.apart);
        if (has(&x, &c) || square - high <= CLOSE * square)
            break;
        simplex y = x;
        y.of[y.count++] = c;
        const nearest n = of_simplex(&y);
        if (n.count == 4) {
            points(&y, to);
            meet(to);
            return;
        }
        if (!(n.square < square))
            break;
        keep(&y, &n);
        x = y;
        points(&x, to);
        v = direction(&x, to);
        square = fp3_dot3(v, v);
    }
    to->distance = sqrtf(square);
    if (!(square > size * size)) {
        meet(to);
        return;
    }
    to->normal = fp3_times3(1.0f / to->distance, v);
    const corner c = towards(a, b, of_b, to->normal);
    const float least = fp3_dot3(to->normal, c.apart);
    to->least = least > 0 ? least : 0;
}
