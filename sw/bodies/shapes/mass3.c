/* SPDX-License-Identifier: Apache-2.0 */
/* mass3.c - a rounded polyhedron is its core, a prism on each face, a part of a cylinder along each
 * edge, and a part of a ball at each corner. The round parts are cut into tetrahedra that are made
 * larger until their volume is right. */
#include "mass3.h"

#include <string.h>

#define PI 3.14159265358979323846
#define DEEP 4 /* halvings of each arc */

typedef struct {
    double x, y, z;
} place;

/* Volume, and integrals of x and of x x, about a point that the caller chose. */
typedef struct {
    double volume, first[3], second[6];
} sums;

static place plus(place a, place b) { return (place){a.x + b.x, a.y + b.y, a.z + b.z}; }
static place minus(place a, place b) { return (place){a.x - b.x, a.y - b.y, a.z - b.z}; }
static place times(double s, place a) { return (place){s * a.x, s * a.y, s * a.z}; }
static double dot(place a, place b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static place cross(place a, place b) {
    return (place){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static place unit(place a) { return times(1 / sqrt(dot(a, a)), a); }

static void tetrahedron(sums *s, place a, place b, place c, place d) {
    const double volume = fabs(dot(minus(b, a), cross(minus(c, a), minus(d, a)))) / 6;
    const place t = plus(plus(a, b), plus(c, d));
    const double sum[3] = {t.x, t.y, t.z};
    const double p[4][3] = {{a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}, {d.x, d.y, d.z}};
    static const int ROW[6] = {0, 1, 2, 0, 0, 1}, COLUMN[6] = {0, 1, 2, 1, 2, 2};
    s->volume += volume;
    for (int i = 0; i < 3; i++)
        s->first[i] += volume / 4 * sum[i];
    for (int k = 0; k < 6; k++) {
        const int i = ROW[k], j = COLUMN[k];
        double own = sum[i] * sum[j];
        for (int n = 0; n < 4; n++)
            own += p[n][i] * p[n][j];
        s->second[k] += volume / 20 * own;
    }
}

/* A triangle and the same one, shifted. */
static void prism(sums *s, place a, place b, place c, place shift) {
    const place d = plus(a, shift), e = plus(b, shift), f = plus(c, shift);
    tetrahedron(s, a, b, c, f);
    tetrahedron(s, a, b, e, f);
    tetrahedron(s, a, d, e, f);
}

/* Of a cylinder around the edge from `at`, what is between two directions square to it. */
static void sector(sums *s, place at, place along, double radius, place u, place v, int deep) {
    if (deep == 0) {
        const place n = cross(u, v);
        const double sine2 = dot(n, n); /* angle : sine, and its root */
        const double ratio = 1 + sine2 / 6 + 3 * sine2 * sine2 / 40;
        const double r = radius * sqrt(ratio);
        prism(s, at, plus(at, times(r, u)), plus(at, times(r, v)), along);
        return;
    }
    const place middle = unit(plus(u, v));
    sector(s, at, along, radius, u, middle, deep - 1);
    sector(s, at, along, radius, middle, v, deep - 1);
}

/* Of a ball, what is between three directions. */
static void cone(sums *s, place at, double radius, place u, place v, place w, int deep) {
    if (deep == 0) {
        const double det = fabs(dot(u, cross(v, w)));
        if (!(det > 0))
            return;
        const double t = det / (1 + dot(u, v) + dot(v, w) + dot(w, u)); /* tan of half the angle */
        const double e = 4 * (t - t * t * t / 3 + t * t * t * t * t / 5) / det - 1;
        const double r = radius * (1 + e / 3 - e * e / 9 + 5 * e * e * e / 81);
        tetrahedron(s, at, plus(at, times(r, u)), plus(at, times(r, v)), plus(at, times(r, w)));
        return;
    }
    const place a = unit(plus(v, w)), b = unit(plus(w, u)), c = unit(plus(u, v));
    cone(s, at, radius, u, c, b, deep - 1);
    cone(s, at, radius, c, v, a, deep - 1);
    cone(s, at, radius, b, a, w, deep - 1);
    cone(s, at, radius, a, b, c, deep - 1);
}

static place corner_of(const fp3_shape3 *shape, uint32_t i) {
    const fp3_point3 p = shape->corner[i], o = shape->middle;
    return (place){(double)p.x - o.x, (double)p.y - o.y, (double)p.z - o.z};
}

static place normal_of(const fp3_shape3 *shape, uint32_t f) {
    const fp3_point3 n = shape->normal[f];
    return unit((place){n.x, n.y, n.z});
}

/* Midway between the normals beside an edge. */
static place outwards(const fp3_shape3 *shape, uint32_t half) {
    const place u = normal_of(shape, shape->face[half]),
                v = normal_of(shape, shape->face[half ^ 1]);
    const place e =
        minus(corner_of(shape, shape->from[half ^ 1]), corner_of(shape, shape->from[half]));
    const place sum = plus(u, v);
    return dot(sum, sum) > 1e-12 ? unit(sum) : unit(cross(e, u));
}

static void round_corners(sums *s, const fp3_shape3 *shape) {
    place middle[FP3_CORNERS3] = {{0, 0, 0}};
    for (uint32_t h = 0; h < shape->halves; h++)
        middle[shape->from[h]] = plus(middle[shape->from[h]], outwards(shape, h & ~1u));
    for (uint32_t h = 0; h < shape->halves; h++) {
        const uint32_t i = shape->from[h];
        const place o = unit(middle[i]), m = outwards(shape, h & ~1u);
        for (uint32_t side = 0; side < 2; side++)
            cone(s, corner_of(shape, i), shape->radius, o, m,
                 normal_of(shape, shape->face[h ^ side]), DEEP);
    }
}

static void polyhedron(sums *s, const fp3_shape3 *shape) {
    const double r = shape->radius;
    for (uint32_t f = 0; f < shape->faces; f++) {
        const uint32_t start = shape->first[f];
        const place a = corner_of(shape, shape->from[start]);
        const place out = times(r, normal_of(shape, f));
        for (uint32_t h = shape->next[start]; shape->next[h] != start; h = shape->next[h]) {
            const place b = corner_of(shape, shape->from[h]);
            const place c = corner_of(shape, shape->from[shape->next[h]]);
            if (shape->faces > 2)
                tetrahedron(s, (place){0, 0, 0}, a, b, c);
            if (r > 0)
                prism(s, a, b, c, out);
        }
    }
    for (uint32_t h = 0; r > 0 && h < shape->halves; h += 2) {
        const place a = corner_of(shape, shape->from[h]), b = corner_of(shape, shape->from[h + 1]);
        const place m = outwards(shape, h);
        for (uint32_t side = 0; side < 2; side++)
            sector(s, a, minus(b, a), r, normal_of(shape, shape->face[h ^ side]), m, DEEP);
    }
    if (r > 0)
        round_corners(s, shape);
}

/* A ball, or a cylinder with two halves of one. */
static void capsule(sums *s, const fp3_shape3 *shape) {
    const double r = shape->radius, ball = 4 * PI / 3 * r * r * r;
    const place a = corner_of(shape, 0), b = corner_of(shape, shape->count - 1), e = minus(b, a);
    const double length = sqrt(dot(e, e)), tube = PI * r * r * length;
    const place u = length > 0 ? times(1 / length, e) : (place){0, 0, 0};
    const double d[3] = {u.x, u.y, u.z};
    static const int ROW[6] = {0, 1, 2, 0, 0, 1}, COLUMN[6] = {0, 1, 2, 1, 2, 2};
    /* Across and along: the halves' centres of mass are 3/8 r beyond the ends. */
    const double across = ball * r * r / 5 + tube * r * r / 4;
    const double along =
        ball * (r * r / 5 + length * r * 3 / 8 + length * length / 4) + tube * length * length / 12;
    s->volume = ball + tube;
    for (int k = 0; k < 6; k++)
        s->second[k] = (k < 3 ? across : 0) + (along - across) * d[ROW[k]] * d[COLUMN[k]];
}

fp3_mass3 fp3_weigh3(const fp3_shape3 *shape, double density) {
    static const int ROW[6] = {0, 1, 2, 0, 0, 1}, COLUMN[6] = {0, 1, 2, 1, 2, 2};
    const double o[3] = {shape->middle.x, shape->middle.y, shape->middle.z};
    fp3_mass3 mass = {.centre = {o[0], o[1], o[2]}};
    double c[3], at[6]; /* the centre from the middle; second moments about the centre */
    sums s;
    memset(&s, 0, sizeof s);
    if (shape->count <= 2)
        capsule(&s, shape);
    else
        polyhedron(&s, shape);
    mass.mass = density * s.volume;
    for (int i = 0; i < 3; i++) {
        c[i] = s.volume > 0 ? s.first[i] / s.volume : 0;
        mass.centre[i] += c[i];
    }
    for (int k = 0; k < 6; k++)
        at[k] = density * (s.second[k] - s.volume * c[ROW[k]] * c[COLUMN[k]]);
    for (int k = 0; k < 3; k++) {
        mass.inertia[k] = at[(k + 1) % 3] + at[(k + 2) % 3];
        mass.inertia[k + 3] = -at[k + 3];
    }
    return mass;
}

static void shift(const fp3_mass3 *m, const double to[3], double inertia[6]) {
    const double x = m->centre[0] - to[0], y = m->centre[1] - to[1], z = m->centre[2] - to[2];
    const double own[6] = {y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z};
    for (int k = 0; k < 6; k++)
        inertia[k] += m->inertia[k] + m->mass * own[k];
}

fp3_mass3 fp3_weigh_together3(const fp3_mass3 *parts, size_t count) {
    fp3_mass3 all = {0};
    for (size_t i = 0; i < count; i++) {
        all.mass += parts[i].mass;
        for (int k = 0; k < 3; k++)
            all.centre[k] += parts[i].mass * parts[i].centre[k];
    }
    for (int k = 0; k < 3; k++)
        all.centre[k] = all.mass > 0 ? all.centre[k] / all.mass : 0;
    for (size_t i = 0; i < count; i++)
        shift(&parts[i], all.centre, all.inertia);
    return all;
}

/* A turn in the plane of axes i and j that makes their product 0. */
static void turn(double m[3][3], double axes[3][3], int i, int j) {
    if (m[i][j] == 0)
        return;
    const double half = (m[j][j] - m[i][i]) / (2 * m[i][j]);
    const double t = (half < 0 ? -1 : 1) / (fabs(half) + sqrt(half * half + 1));
    const double c = 1 / sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < 3; k++) {
        const double a = m[k][i], b = m[k][j];
        m[k][i] = c * a - s * b;
        m[k][j] = s * a + c * b;
    }
    for (int k = 0; k < 3; k++) {
        const double a = m[i][k], b = m[j][k], u = axes[k][i], v = axes[k][j];
        m[i][k] = c * a - s * b;
        m[j][k] = s * a + c * b;
        axes[k][i] = c * u - s * v;
        axes[k][j] = s * u + c * v;
    }
    m[i][j] = m[j][i] = 0;
}

static void quaternion(double a[3][3], double q[4]) {
    const double trace = a[0][0] + a[1][1] + a[2][2];
    int k = 0;
    for (int i = 1; i < 3; i++)
        k = a[i][i] > a[k][k] ? i : k;
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    if (trace > a[k][k]) {
        q[0] = 1 + trace;
        for (int i = 0; i < 3; i++)
            q[i + 1] = a[(i + 2) % 3][(i + 1) % 3] - a[(i + 1) % 3][(i + 2) % 3];
    } else {
        q[0] = a[m][l] - a[l][m];
        q[k + 1] = 1 + a[k][k] - a[l][l] - a[m][m];
        q[l + 1] = a[l][k] + a[k][l];
        q[m + 1] = a[m][k] + a[k][m];
    }
    const double size = sqrt((q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]));
    for (int i = 3; i >= 0; i--)
        q[i] = (q[0] < 0 ? -q[i] : q[i]) / size;
}

void fp3_axes_of_mass3(const fp3_mass3 *mass, double moment[3], double q[4]) {
    const double *i = mass->inertia;
    double m[3][3] = {{i[0], i[3], i[4]}, {i[3], i[1], i[5]}, {i[4], i[5], i[2]}};
    double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    /* Off the diagonal what is left falls with the third power; 16 rounds are more than enough. */
    for (int round = 0; round < 16; round++) {
        turn(m, axes, 0, 1);
        turn(m, axes, 0, 2);
        turn(m, axes, 1, 2);
    }
    for (int k = 0; k < 3; k++)
        moment[k] = m[k][k];
    quaternion(axes, q);
}
