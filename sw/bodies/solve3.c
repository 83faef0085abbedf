/* SPDX-License-Identifier: Apache-2.0 */
/* solve3.c - see solve3.h. Compiled once for each kind of processor: FP3_SOLVER names the result.
 */
#include "solve3.h"

#include "lanes.h"

#include <stddef.h>
#include <string.h>

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
FP3_WIDELY wide3 add(wide3 a, wide3 b) { return (wide3){a.x + b.x, a.y + b.y, a.z + b.z}; }
FP3_WIDELY wide3 along(wide3 a, fp3_wide s, wide3 d) {
    return (wide3){a.x + s * d.x, a.y + s * d.y, a.z + s * d.z};
}

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
#define PUT(row, name, v)                                                                          \
    do {                                                                                           \
        (row)->name##_x = (v).x;                                                                   \
        (row)->name##_y = (v).y;                                                                   \
        (row)->name##_z = (v).z;                                                                   \
    } while (0)

/* The place of each word, as fp3_patch3 has it. */
enum {
    N,
    COUNT = 3,
    ARM = 4,
    GAP = 7,
    P = 20,
    TWIST = 24,
    F,
    ROLL = 28,
    TOP = 31,
    FROM,
    FRICTION = 35,
    ROLLING,
    RADIUS_A,
    RADIUS_B,
    MET = 40
};
#define IS_AT(word, member)                                                                        \
    _Static_assert((word) * sizeof(float) == offsetof(fp3_patch3, member), "order of fp3_patch3")
IS_AT(N, m.normal);
IS_AT(COUNT, m.count);
IS_AT(ARM, m.point[0].arm);
IS_AT(GAP, m.point[0].gap);
IS_AT(ARM + 4, m.point[1].arm);
IS_AT(P, p);
IS_AT(TWIST, twist);
IS_AT(F, f);
IS_AT(ROLL, roll);
IS_AT(TOP, top);
IS_AT(FROM, from);
IS_AT(RADIUS_B, radius_b);
#define MET3(met, word) ((wide3){(met)[word], (met)[(word) + 1], (met)[(word) + 2]})

/* A tangent that hardly turns while the normal hardly does: square to the axis on which the normal
 * is smallest. */
FP3_WIDELY wide3 tangent(wide3 n) {
    const fp3_wide x = fp3_wide_abs(n.x), y = fp3_wide_abs(n.y), z = fp3_wide_abs(n.z),
                   none = fp3_wide_all(0);
    const fp3_mask is_x = (fp3_mask)(x <= y) & (fp3_mask)(x <= z),
                   is_y = ~is_x & (fp3_mask)(y <= z);
    const wide3 d = {
        fp3_wide_choose(is_x, none, fp3_wide_choose(is_y, none - n.z, n.y)),
        fp3_wide_choose(is_x, n.z, fp3_wide_choose(is_y, none, none - n.x)),
        fp3_wide_choose(is_x, none - n.y, fp3_wide_choose(is_y, n.x, none)),
    };
    const fp3_wide share = fp3_wide_all(1) / fp3_wide_sqrt(dot(d, d));
    return (wide3){share * d.x, share * d.y, share * d.z};
}

/* What a unit of an impulse turns both bodies by: a force at the middle, by its torques at them. */
typedef struct {
    wide3 a, b, own_a, own_b; /* own: torques; others: spins that these give */
} effect;

FP3_WIDELY effect effect_of(const tensor *a, const tensor *b, wide3 at_a, wide3 at_b) {
    return (effect){times(*a, at_a), times(*b, at_b), at_a, at_b};
}
FP3_WIDELY fp3_wide answer(const effect *x, const effect *y) {
    return dot(x->a, y->own_a) + dot(x->b, y->own_b);
}

/* What impulses of a row answer with, where its arms and its bodies' inertias are now. `along_n`
 * and others: effects of an impulse along n, and of torques about -s and d. */
FP3_WIDELY void answer_points(fp3_contact3_row *r, const effect *n, const effect *x,
                              const effect *y) {
    const fp3_wide nn = r->ma + r->mb + answer(n, n), nx = answer(n, x), ny = answer(n, y),
                   xx = answer(x, x), xy = answer(x, y), yy = answer(y, y);
#pragma GCC unroll 4
    for (int k = 0; k < FP3_POINTS3; k++) {
        fp3_contact3_point *to = &r->point[k];
        const fp3_wide px = to->x, py = to->y;
        const fp3_mask is_there = (fp3_mask)(fp3_wide_all(0) < to->j);
        to->g = nn + px * nx + py * ny;
        to->gt_x = nx + px * xx + py * xy;
        to->gt_y = ny + px * xy + py * yy;
        to->j = quotient((fp3_wide)(is_there & (fp3_mask)fp3_wide_all(1)),
                         to->g + px * to->gt_x + py * to->gt_y);
    }
}

FP3_WIDELY void answer_row(fp3_contact3_row *r, const tensor *a, const tensor *b) {
    const fp3_wide none = fp3_wide_all(0), one = fp3_wide_all(1);
    const wide3 n = VECTOR(r, n), d = VECTOR(r, d), s = cross(n, d), c = VECTOR(r, c),
                e = VECTOR(r, e);
    const effect along_n = effect_of(a, b, cross(c, n), cross(e, n)),
                 along_d = effect_of(a, b, cross(c, d), cross(e, d)),
                 along_s = effect_of(a, b, cross(c, s), cross(e, s));
    const wide3 back = {none - s.x, none - s.y, none - s.z};
    const effect of_x = effect_of(a, b, back, back), of_y = effect_of(a, b, d, d),
                 about_n = effect_of(a, b, n, n);
    PUT(r, ia, a->i);
    PUT(r, oa, a->o);
    PUT(r, ib, b->i);
    PUT(r, ob, b->o);
    answer_points(r, &along_n, &of_x, &of_y);
    r->hq_x = answer(&along_n, &along_d);
    r->hq_y = answer(&along_n, &along_s);
    r->hx_x = answer(&of_x, &along_d);
    r->hx_y = answer(&of_x, &along_s);
    r->hy_x = answer(&of_y, &along_d);
    r->hy_y = answer(&of_y, &along_s);
    r->hn_x = answer(&about_n, &along_d);
    r->hn_y = answer(&about_n, &along_s);
    r->hs = answer(&along_n, &about_n);
    r->hl_x = answer(&of_x, &about_n);
    r->hl_y = answer(&of_y, &about_n);
    const fp3_wide mass = r->ma + r->mb, k11 = mass + answer(&along_d, &along_d),
                   k12 = answer(&along_d, &along_s), k22 = mass + answer(&along_s, &along_s),
                   det = k11 * k22 - k12 * k12;
    r->k11 = quotient(k22, det);
    r->k12 = quotient(none - k12, det);
    r->k22 = quotient(k11, det);
    r->kt = quotient(one, answer(&about_n, &about_n));
    /* The largest sum of a row is no less than the largest inertia's inverse. */
    const tensor both = {add(a->i, b->i), add(a->o, b->o)};
    const fp3_wide xy = fp3_wide_abs(both.o.x), xz = fp3_wide_abs(both.o.y),
                   yz = fp3_wide_abs(both.o.z);
    const fp3_wide kr =
        quotient(one, larger(both.i.x + xy + xz, larger(both.i.y + xy + yz, both.i.z + xz + yz)));
    /* What does not resist gives nothing, whoever rolls beside it. */
    r->kr = fp3_wide_choose((fp3_mask)(r->reach > 0), kr, none);
}

/* Points by where they are from the middle, along both tangents. */
FP3_WIDELY void prepare_points(fp3_contact3_row *r, const fp3_wide met[MET], wide3 middle) {
    const wide3 d = VECTOR(r, d), s = cross(VECTOR(r, n), d);
    const fp3_mask count = (fp3_mask)met[COUNT];
    fp3_wide sum = fp3_wide_all(0);
#pragma GCC unroll 4
    for (int k = 0; k < FP3_POINTS3; k++) {
        fp3_contact3_point *to = &r->point[k];
        const fp3_mask is_there = (fp3_mask)(count > k);
        const wide3 arm = along(MET3(met, ARM + 4 * k), fp3_wide_all(-1), middle);
        const fp3_wide none = fp3_wide_all(0), px = fp3_wide_choose(is_there, dot(arm, d), none),
                       py = fp3_wide_choose(is_there, dot(arm, s), none);
        to->x = px;
        to->y = py;
        to->gap = fp3_wide_choose(is_there, met[GAP + 4 * k], none);
        to->j = fp3_wide_choose(is_there, fp3_wide_all(1), none);
        to->p = fp3_wide_choose(is_there, met[P + k], none);
        to->top = none;
        sum += fp3_wide_sqrt(px * px + py * py);
    }
    r->radius = quotient(sum, __builtin_convertvector(count, fp3_wide));
    r->total = (r->point[0].p + r->point[1].p) + (r->point[2].p + r->point[3].p);
}

FP3_WIDELY void prepare_row(const fp3_wide met[MET], const tensor *a, const tensor *b,
                            fp3_contact3_row *r) {
    const wide3 n = MET3(met, N), d = tangent(n), s = cross(n, d), f = MET3(met, F),
                l = MET3(met, ROLL);
    const fp3_mask count = (fp3_mask)met[COUNT];
    const fp3_wide none = fp3_wide_all(0), one = fp3_wide_all(1);
    wide3 middle = {none, none, none};
    fp3_wide gap = none;
#pragma GCC unroll 4
    for (int k = 0; k < FP3_POINTS3; k++) {
        const fp3_mask is_there = (fp3_mask)(count > k);
        middle = add(middle, (wide3){fp3_wide_choose(is_there, met[ARM + 4 * k], none),
                                     fp3_wide_choose(is_there, met[ARM + 4 * k + 1], none),
                                     fp3_wide_choose(is_there, met[ARM + 4 * k + 2], none)});
        gap += fp3_wide_choose(is_there, met[GAP + 4 * k], none);
    }
    const fp3_wide share = quotient(one, __builtin_convertvector(count, fp3_wide)),
                   half = fp3_wide_all(0.5f) * share * gap;
    middle = (wide3){share * middle.x, share * middle.y, share * middle.z};
    /* Each to its own surface: with the arm of the middle itself a ball that is still far away
     * would be rubbed at the end of a lever. */
    const wide3 c = along(middle, none - half, n),
                e = along(along(middle, half, n), fp3_wide_all(-1), MET3(met, FROM));
    PUT(r, n, n);
    PUT(r, d, d);
    PUT(r, c, c);
    PUT(r, e, e);
    prepare_points(r, met, middle);
    r->f1 = dot(f, d);
    r->f2 = dot(f, s);
    r->ft = met[TWIST];
    r->mu = met[FRICTION];
    r->reach = met[ROLLING];
    r->ra = met[RADIUS_A];
    r->rb = met[RADIUS_B];
    const wide3 roll = along(l, none - dot(l, n), n);
    PUT(r, l, roll);
    r->s1 = r->s2 = r->lift = r->slope_x = r->slope_y = none;
    answer_row(r, a, b);
}

/* Of a body: 1/mass, xx, yy, zz; xy, xz, yz of its inverse inertia, and whether it has turned far.
 */
FP3_WIDELY tensor bring_heft(const fp3_making3 *making, const uint32_t of[FP3_WIDE], fp3_wide *mass,
                             fp3_wide *turned) {
    fp3_wide heft[8];
    fp3_lanes_bring(making->heft, FP3_FOURS3, of, heft);
    fp3_lanes_bring(making->heft + 1, FP3_FOURS3, of, heft + 4);
    *mass = heft[0];
    *turned += heft[7];
    return (tensor){{heft[1], heft[2], heft[3]}, {heft[4], heft[5], heft[6]}};
}

/* Of the contacts of a block; `none` where there is none. */
FP3_WIDELY void patches(const fp3_making3 *making, const uint32_t *at, fp3_patch3 *none,
                        fp3_patch3 *of[FP3_WIDE]) {
    for (int lane = 0; lane < FP3_WIDE; lane++)
        of[lane] = at[lane] == UINT32_MAX ? none : &making->patch[making->of[at[lane]]];
}

/* A block's patches are anywhere: those of the next one come while this one is made. */
FP3_WIDELY void fetch(const fp3_making3 *making, const uint32_t *at) {
    for (int lane = 0; at && lane < FP3_WIDE; lane++)
        if (at[lane] != UINT32_MAX)
            for (uint32_t line = 0; line < MET * sizeof(float); line += 64)
                __builtin_prefetch((const char *)&making->patch[making->of[at[lane]]] + line);
}

static void prepare(const fp3_work2 *work, const fp3_making3 *making, uint32_t first,
                    uint32_t end) {
    const fp3_softness *soft = making->softness;
    for (uint32_t i = first; i < end; i++) {
        const fp3_ends2 *ends = &work->ends[i];
        fp3_patch3 none = {.m.normal = {0, 1, 0}}, *of[FP3_WIDE];
        fp3_wide met[MET];
        fp3_mask a, b;
        fp3_contact3_row *r = (fp3_contact3_row *)work->row + i;
        uint32_t points = 0;
        patches(making, &making->at[i * FP3_WIDE], &none, of);
        fetch(making, i + 1 < end ? &making->at[(i + 1) * FP3_WIDE] : NULL);
#pragma GCC unroll 5
        for (uint32_t k = 0; k < MET; k += 8) {
            fp3_wide x[8];
#pragma GCC unroll 8
            for (int lane = 0; lane < FP3_WIDE; lane++)
                memcpy(&x[lane], (const float *)(const void *)of[lane] + k, sizeof x[lane]);
            fp3_lanes_flip(x, met + k);
        }
        for (int lane = 0; lane < FP3_WIDE; lane++)
            points = of[lane]->m.count > points ? of[lane]->m.count : points;
        making->points[i] = (uint8_t)points;
        fp3_wide turned = fp3_wide_all(0);
        const tensor heft_a = bring_heft(making, ends->a, &r->ma, &turned),
                     heft_b = bring_heft(making, ends->b, &r->mb, &turned);
        memcpy(&a, ends->a, sizeof a);
        memcpy(&b, ends->b, sizeof b);
        const fp3_mask most = (fp3_mask){0} + ((int)work->movable - 1),
                       is_held = (fp3_mask)(a > most) | (fp3_mask)(b > most);
        r->rate = fp3_wide_choose(is_held, fp3_wide_all(soft[1].rate), fp3_wide_all(soft[0].rate));
        r->soft = fp3_wide_choose(is_held, fp3_wide_all(soft[1].soft), fp3_wide_all(soft[0].soft));
        r->fade = fp3_wide_choose(is_held, fp3_wide_all(soft[1].fade), fp3_wide_all(soft[0].fade));
        prepare_row(met, &heft_a, &heft_b, r);
    }
}

/* Contacts of the block whose bodies have not turned far stay as they are: who stands beside whom
 * in a block must not count. */
FP3_WIDELY void renew_row(const fp3_making3 *making, const fp3_ends2 *ends, fp3_contact3_row *r) {
    fp3_contact3_row now = *r;
    fp3_wide *to = (fp3_wide *)r, turned = fp3_wide_all(0);
    const fp3_wide *from = (const fp3_wide *)&now;
    const tensor a = bring_heft(making, ends->a, &now.ma, &turned),
                 b = bring_heft(making, ends->b, &now.mb, &turned);
    answer_row(&now, &a, &b);
    for (size_t k = 0; k < sizeof now / sizeof *to; k++)
        to[k] = fp3_wide_choose((fp3_mask)(fp3_wide_all(0) < turned), from[k], to[k]);
}

static void renew(const fp3_work2 *work, const fp3_making3 *making, uint32_t i) {
    renew_row(making, &work->ends[i], (fp3_contact3_row *)work->row + i);
}

/* A row that is not finite is forgotten: else it would never heal. */
static void keep(const fp3_work2 *work, const fp3_making3 *making, uint32_t first, uint32_t end) {
    for (uint32_t i = first; i < end; i++) {
        const fp3_contact3_row *r = (const fp3_contact3_row *)work->row + i;
        const wide3 n = VECTOR(r, n), d = VECTOR(r, d), s = cross(n, d);
        const wide3 f = {r->f1 * d.x + r->f2 * s.x, r->f1 * d.y + r->f2 * s.y,
                         r->f1 * d.z + r->f2 * s.z};
        const fp3_wide top =
            (r->point[0].top + r->point[1].top) + (r->point[2].top + r->point[3].top);
        const fp3_wide given[12] = {r->point[0].p, r->point[1].p, r->point[2].p, r->point[3].p,
                                    r->ft,         f.x,           f.y,           f.z,
                                    r->l_x,        r->l_y,        r->l_z,        top};
        fp3_wide sum = given[0];
#pragma GCC unroll 11
        for (int k = 1; k < 12; k++)
            sum += given[k];
        const fp3_mask is_finite = (fp3_mask)(sum - sum == 0);
        fp3_patch3 none, *of[FP3_WIDE];
        fp3_wide x[8], words[16];
#pragma GCC unroll 2
        for (int half = 0; half < 2; half++) {
#pragma GCC unroll 8
            for (int k = 0; k < 8; k++)
                x[k] = 8 * half + k < 12
                           ? fp3_wide_choose(is_finite, given[8 * half + k], fp3_wide_all(0))
                           : fp3_wide_all(0);
            fp3_lanes_flip(x, words + 8 * half);
        }
        patches(making, &making->at[i * FP3_WIDE], &none, of);
        for (int lane = 0; lane < FP3_WIDE; lane++) {
            memcpy((float *)(void *)of[lane] + P, &words[lane], 8 * sizeof(float));
            memcpy((float *)(void *)of[lane] + ROLL, &words[lane + 8], 4 * sizeof(float));
        }
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

static void pass(const fp3_work2 *given_work, const fp3_making3 *making, uint32_t first,
                 uint32_t end, const float shared[FP3_SHARED], int is_rolling, int has_moved) {
    const fp3_work2 work = *given_work;
    const uint8_t *points = making->points;
    fp3_wide given[FP3_SHARED];
    const int has_friction = fp3_has_friction3(shared);
    give(shared, given);
    for (uint32_t i = first; i < end; i++) {
        fp3_contact3_row *row = (fp3_contact3_row *)work.row + i;
        both of;
        bring_speeds(&work, work.ends[i].a, of.a);
        bring_speeds(&work, work.ends[i].b, of.b);
        if (has_moved)
            fp3_law_gap3(row, of.a, of.b, given);
        if (has_moved && points[i] & FP3_HAS_TURNED)
            renew_row(making, &work.ends[i], row);
        if (is_rolling && has_friction)
            fp3_law_roll3(row, of.a, of.b, given);
        fp3_law_meet3(row, of.a, of.b, given);
        for (uint32_t k = 0; k < (points[i] & ~FP3_HAS_TURNED); k++)
            fp3_law_push3(row, &row->point[k], of.a, of.b, given);
        if (has_friction)
            fp3_law_rub3(row, of.a, of.b, given);
        fp3_law_give3(row, of.a, of.b, given);
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
const fp3_solver3 FP3_SOLVER = {FP3_SOLVER_NAME,
                                prepare,
                                renew,
                                keep,
                                pass,
                                {pass_pin3, pass_spin3, pass_line3, pass_twist3},
                                turn};
