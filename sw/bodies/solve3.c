/* SPDX-License-Identifier: Apache-2.0 */
/* solve3.c - see solve3.h. Compiled once for each kind of processor: FP3_SOLVER names the result.
 */
#include "solve3.h"

#include "lanes.h"

#ifndef FP3_SOLVER
#define FP3_SOLVER fp3_solver3_plain
#define FP3_SOLVER_NAME "x86-64" /* the least kind of a processor: others have no other */
#endif

/* ---- rows ---- */

typedef struct {
    fp3_wide x, y, z;
} wide3;

FP3_WIDELY wide3 cross(wide3 a, wide3 b) {
    return (wide3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
FP3_WIDELY fp3_wide dot(wide3 a, wide3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/* An inverse inertia by its diagonal and the rest. */
typedef struct {
    wide3 i, o;
} tensor;

FP3_WIDELY wide3 times(tensor t, wide3 v) {
    return (wide3){t.i.x * v.x + t.o.x * v.y + t.o.y * v.z, t.o.x * v.x + t.i.y * v.y + t.o.z * v.z,
                   t.o.y * v.x + t.o.z * v.y + t.i.z * v.z};
}

FP3_WIDELY fp3_wide quotient(fp3_wide share, fp3_wide by) {
    return fp3_wide_choose((fp3_mask)(fp3_wide_all(0) < by), share / by, fp3_wide_all(0));
}

FP3_WIDELY fp3_wide larger(fp3_wide a, fp3_wide b) {
    return fp3_wide_choose((fp3_mask)(a < b), b, a);
}

#define VECTOR(row, name) ((wide3){(row)->name##_x, (row)->name##_y, (row)->name##_z})

typedef struct {
    fp3_wide mass; /* the sum of both inverse masses */
    tensor a, b;
} pair;

/* What an impulse along y at both arms changes of the speed along x. */
FP3_WIDELY fp3_wide answer(const pair *p, wide3 xa, wide3 xb, wide3 ya, wide3 yb) {
    return dot(xa, times(p->a, ya)) + dot(xb, times(p->b, yb));
}

static void prepare_friction(fp3_contact3_row *r, const pair *p) {
    const wide3 n = VECTOR(r, n), d = VECTOR(r, d), s = cross(n, d);
    const wide3 c = VECTOR(r, c), e = VECTOR(r, e);
    const wide3 cd = cross(c, d), ed = cross(e, d), cs = cross(c, s), es = cross(e, s);
    const fp3_wide k11 = p->mass + answer(p, cd, ed, cd, ed), k12 = answer(p, cd, ed, cs, es),
                   k22 = p->mass + answer(p, cs, es, cs, es);
    const fp3_wide det = k11 * k22 - k12 * k12;
    r->k11 = quotient(k22, det);
    r->k12 = quotient(fp3_wide_all(0) - k12, det);
    r->k22 = quotient(k11, det);
    r->kt = quotient(fp3_wide_all(1), answer(p, n, n, n, n));
    /* The largest sum of a row is no less than the largest inertia's inverse. */
    const tensor both = {{p->a.i.x + p->b.i.x, p->a.i.y + p->b.i.y, p->a.i.z + p->b.i.z},
                         {p->a.o.x + p->b.o.x, p->a.o.y + p->b.o.y, p->a.o.z + p->b.o.z}};
    const fp3_wide xy = fp3_wide_abs(both.o.x), xz = fp3_wide_abs(both.o.y),
                   yz = fp3_wide_abs(both.o.z);
    r->kr = quotient(fp3_wide_all(1),
                     larger(both.i.x + xy + xz, larger(both.i.y + xy + yz, both.i.z + xz + yz)));
}

static void prepare(const fp3_work2 *work, uint32_t first, uint32_t end) {
    for (uint32_t i = first; i < end; i++) {
        fp3_contact3_row *r = (fp3_contact3_row *)work->row + i;
        const pair p = {
            r->ma + r->mb, {VECTOR(r, ia), VECTOR(r, oa)}, {VECTOR(r, ib), VECTOR(r, ob)}};
        const wide3 n = VECTOR(r, n);
        for (int k = 0; k < FP3_POINTS3; k++) {
            fp3_contact3_point *point = &r->point[k];
            const wide3 ca = cross(VECTOR(point, a), n), cb = cross(VECTOR(point, b), n);
            point->j = quotient(point->j, p.mass + answer(&p, ca, cb, ca, cb));
        }
        prepare_friction(r, &p);
    }
}

/* ---- passes ---- */

/* The words of both bodies: FP3_BODY3_WORDS. */
typedef struct {
    fp3_wide a[16], b[16];
} both;

FP3_WIDELY void bring_speeds(const fp3_work2 *work, const uint32_t of[FP3_WIDE],
                             fp3_wide words[8]) {
    fp3_lanes_bring(work->speed, FP3_FOURS3, of, words);
    fp3_lanes_bring(work->speed + 1, FP3_FOURS3, of, words + 4);
}

/* has_base: what they do goes there, too. */
FP3_WIDELY void take_speeds(const fp3_work2 *work, int has_base, const uint32_t of[FP3_WIDE],
                            const fp3_wide words[8]) {
    fp3_four to[2][FP3_WIDE];
    fp3_lanes_make(words, fp3_wide_all(0), to[0]);
    fp3_lanes_make(words + 4, fp3_wide_all(0), to[1]);
#pragma GCC unroll 8
    for (int lane = 0; lane < FP3_WIDE; lane++) {
        if (of[lane] >= work->movable)
            continue;
#pragma GCC unroll 2
        for (uint32_t k = 0; k < 2; k++) {
            const uint32_t at = FP3_FOURS3 * of[lane] + k;
            if (has_base)
                work->base[at] += to[k][lane] - work->speed[at];
            work->speed[at] = to[k][lane];
        }
    }
}

FP3_WIDELY void give(const float shared[FP3_SHARED], fp3_wide given[FP3_SHARED]) {
#pragma GCC unroll 8
    for (int i = 0; i < FP3_SHARED; i++)
        given[i] = fp3_wide_all(shared[i]);
}

static void pass(const fp3_work2 *given_work, const uint8_t *points, uint32_t first, uint32_t end,
                 const float shared[FP3_SHARED], int is_rolling, int has_moved) {
    const fp3_work2 work = *given_work;
    fp3_wide given[FP3_SHARED];
    const int has_friction = fp3_has_friction3(shared);
    give(shared, given);
    for (uint32_t i = first; i < end; i++) {
        fp3_contact3_row *row = (fp3_contact3_row *)work.row + i;
        both of;
        bring_speeds(&work, work.ends[i].a, of.a);
        bring_speeds(&work, work.ends[i].b, of.b);
        for (uint32_t k = 0; has_moved && k < points[i]; k++)
            fp3_law_gap3(row, &row->point[k], of.a, of.b, given);
        if (is_rolling && has_friction)
            fp3_law_roll3(row, of.a, of.b, given);
        for (uint32_t k = 0; k < points[i]; k++)
            fp3_law_push3(row, &row->point[k], of.a, of.b, given);
        if (has_friction)
            fp3_law_rub3(row, of.a, of.b, given);
        take_speeds(&work, 0, work.ends[i].a, of.a);
        take_speeds(&work, 0, work.ends[i].b, of.b);
    }
}

#define JOINT(name)                                                                                \
    static void pass_##name(const fp3_work2 *work, uint32_t first, uint32_t end,                   \
                            const float shared[FP3_SHARED]) {                                      \
        fp3_wide given[FP3_SHARED];                                                                \
        both of;                                                                                   \
        give(shared, given);                                                                       \
        for (uint32_t i = first; i < end; i++) {                                                   \
            bring_speeds(work, work->ends[i].a, of.a);                                             \
            bring_speeds(work, work->ends[i].b, of.b);                                             \
            fp3_law_##name((fp3_##name##_row *)work->row + i, of.a, of.b, given);                  \
            take_speeds(work, 1, work->ends[i].a, of.a);                                           \
            take_speeds(work, 1, work->ends[i].b, of.b);                                           \
        }                                                                                          \
    }
JOINT(pin3)
JOINT(spin3)
JOINT(line3)
JOINT(twist3)

static void turn(const fp3_work2 *work, uint32_t first, uint32_t end,
                 const float shared[FP3_SHARED]) {
    fp3_wide given[FP3_SHARED], words[16];
    fp3_four to[FP3_WIDE];
    fp3_four *way = work->way;
    give(shared, given);
    for (uint32_t i = first; i < end; i++) {
        const uint32_t *of = work->ends[i].a;
        bring_speeds(work, of, words);
        fp3_lanes_bring(way, FP3_FOURS3, of, words + 8);
        fp3_lanes_bring(way + 1, FP3_FOURS3, of, words + 12);
        fp3_law_turn3((fp3_turning3_row *)work->row + i, words, words, given);
        take_speeds(work, 1, of, words);
        fp3_lanes_make(words + 8, words[11], to);
        for (int lane = 0; lane < FP3_WIDE; lane++)
            way[FP3_FOURS3 * of[lane]] = to[lane];
        fp3_lanes_make(words + 12, fp3_wide_all(0), to);
        for (int lane = 0; lane < FP3_WIDE; lane++)
            way[FP3_FOURS3 * of[lane] + 1] = to[lane];
    }
}

extern const fp3_solver3 FP3_SOLVER;
const fp3_solver3 FP3_SOLVER = {
    FP3_SOLVER_NAME, prepare, pass, {pass_pin3, pass_spin3, pass_line3, pass_twist3}, turn};
