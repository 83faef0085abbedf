/* SPDX-License-Identifier: Apache-2.0 */
/* solve2.c - see solve2.h. Compiled once for each kind of processor: FP3_SOLVER names the result.
 */
#include "solve2.h"

#include "lanes.h"

#include <stddef.h>
#include <string.h>

#ifndef FP3_SOLVER
#define FP3_SOLVER fp3_solver2_plain
#define FP3_SOLVER_NAME "x86-64" /* the least kind of a processor: others have no other */
#endif

#define JOIN(a, b) FP3_SHUFFLE(a, b, 0, 1, 2, 3, 4, 5, 6, 7)

/* Fours of eight bodies become three vectors of eight: of the fours' last numbers nothing is kept.
 */
FP3_WIDELY void bring(const fp3_four *from, const uint32_t of[FP3_WIDE], fp3_wide words[3]) {
    const fp3_wide m0 = JOIN(from[of[0]], from[of[4]]), m1 = JOIN(from[of[1]], from[of[5]]),
                   m2 = JOIN(from[of[2]], from[of[6]]), m3 = JOIN(from[of[3]], from[of[7]]);
    const fp3_wide low02 = FP3_LOW(m0, m2), low13 = FP3_LOW(m1, m3);
    words[0] = FP3_LOW(low02, low13);
    words[1] = FP3_HIGH(low02, low13);
    words[2] = FP3_LOW(FP3_HIGH(m0, m2), FP3_HIGH(m1, m3));
}

/* ... and back. has_base: what they do goes there, too. */
FP3_WIDELY void take_four(const fp3_work2 *work, int has_base, uint32_t body, fp3_four v) {
    if (body >= work->movable)
        return;
    if (has_base)
        work->base[body] += v - work->speed[body];
    work->speed[body] = v;
}
FP3_WIDELY void take(const fp3_work2 *work, int has_base, const uint32_t of[FP3_WIDE],
                     const fp3_wide words[3]) {
    const fp3_wide none = fp3_wide_all(0);
    const fp3_wide xy[2] = {FP3_LOW(words[0], words[1]), FP3_HIGH(words[0], words[1])};
    const fp3_wide w[2] = {FP3_LOW(words[2], none), FP3_HIGH(words[2], none)};
#pragma GCC unroll 2
    for (int i = 0; i < 2; i++) {
        const fp3_wide even = FP3_SHUFFLE(xy[i], w[i], 0, 1, 8, 9, 4, 5, 12, 13),
                       odd = FP3_SHUFFLE(xy[i], w[i], 2, 3, 10, 11, 6, 7, 14, 15);
        take_four(work, has_base, of[2 * i], FP3_SHUFFLE(even, even, 0, 1, 2, 3));
        take_four(work, has_base, of[2 * i + 1], FP3_SHUFFLE(odd, odd, 0, 1, 2, 3));
        take_four(work, has_base, of[2 * i + 4], FP3_SHUFFLE(even, even, 4, 5, 6, 7));
        take_four(work, has_base, of[2 * i + 5], FP3_SHUFFLE(odd, odd, 4, 5, 6, 7));
    }
}

/* ---- rows ---- */

/* The place of each word, as fp3_touch2 has it. */
enum {
    N_X,
    N_Y,
    ARM_X,
    ARM_Y,
    GAP,
    ARM_X2,
    ARM_Y2,
    GAP_2,
    COUNT,
    P_1,
    P_2,
    F_1,
    F_2,
    R,
    FROM_X,
    FROM_Y,
    FRICTION,
    BELT,
    ROLLING,
    RADIUS_A,
    RADIUS_B,
    MET = 24
};
#define IS_AT(word, member)                                                                        \
    _Static_assert((word) * sizeof(float) == offsetof(fp3_touch2, member), "order of fp3_touch2")
IS_AT(GAP_2, m.point[1].gap);
IS_AT(COUNT, m.count);
IS_AT(P_1, p);
IS_AT(R, r);
IS_AT(FROM_X, from);
IS_AT(RADIUS_B, radius_b);

FP3_WIDELY fp3_wide quotient(fp3_wide share, fp3_wide by) {
    return fp3_wide_choose((fp3_mask)(fp3_wide_all(0) < by), share / by, fp3_wide_all(0));
}

typedef struct {
    fp3_wide *arm_a, *arm_b, *across_a, *across_b, *along, *aside;
} point;

/* From an arm to what its row has: the arm across and along the normal, at both bodies, each to its
 * own surface; masses. */
FP3_WIDELY void prepare_point(const fp3_contact2_row *row, fp3_wide ax, fp3_wide ay, fp3_wide gap,
                              const fp3_wide *met, fp3_wide is_there, point p) {
    const fp3_wide half = fp3_wide_all(0.5f) * gap;
    const fp3_wide bx = ax - met[FROM_X], by = ay - met[FROM_Y];
    const fp3_wide nx = row->n_x, ny = row->n_y;
    const fp3_wide an = ax * ny - ay * nx, bn = bx * ny - by * nx;
    const fp3_wide at = ax * nx + ay * ny - half, bt = bx * nx + by * ny + half;
    const fp3_wide mass = row->ma + row->mb;
    *p.arm_a = an;
    *p.arm_b = bn;
    *p.across_a = at;
    *p.across_b = bt;
    *p.along = quotient(is_there, mass + row->ia * an * an + row->ib * bn * bn);
    *p.aside = quotient(is_there, mass + row->ia * at * at + row->ib * bt * bt);
}

FP3_WIDELY void prepare_row(const fp3_wide met[MET], fp3_contact2_row *r) {
    const fp3_mask count = (fp3_mask)met[COUNT], is_two = (fp3_mask)(count == 2);
    r->n_x = met[N_X];
    r->n_y = met[N_Y];
    prepare_point(r, met[ARM_X], met[ARM_Y], met[GAP], met,
                  fp3_wide_lt(fp3_wide_all(0), __builtin_convertvector(count, fp3_wide)),
                  (point){&r->a1, &r->b1, &r->c1, &r->e1, &r->j1, &r->k1});
    prepare_point(r, fp3_wide_choose(is_two, met[ARM_X2], met[ARM_X]),
                  fp3_wide_choose(is_two, met[ARM_Y2], met[ARM_Y]), met[GAP_2], met,
                  (fp3_wide)(is_two & (fp3_mask)fp3_wide_all(1)),
                  (point){&r->a2, &r->b2, &r->c2, &r->e2, &r->j2, &r->k2});
    r->gap1 = met[GAP];
    r->gap2 = fp3_wide_choose(is_two, met[GAP_2], met[GAP]);
    r->jr = quotient(fp3_wide_all(1), r->ia + r->ib);
    r->mu = met[FRICTION];
    r->belt = met[BELT];
    r->reach = met[ROLLING];
    r->p1 = met[P_1];
    r->p2 = met[P_2];
    r->f1 = met[F_1];
    r->f2 = met[F_2];
    r->r = met[R];
    r->ra = met[RADIUS_A];
    r->rb = met[RADIUS_B];
    r->top1 = r->top2 = fp3_wide_all(0);
}

/* Of the contacts of a block; `none` where there is none. */
FP3_WIDELY void touches(const fp3_making2 *making, const uint32_t *at, fp3_touch2 *none,
                        fp3_touch2 *of[FP3_WIDE]) {
    for (int lane = 0; lane < FP3_WIDE; lane++)
        of[lane] = at[lane] == UINT32_MAX ? none : &making->touch[making->of[at[lane]]];
}

/* How fast the points of both bodies come together where they are nearest. */
FP3_WIDELY fp3_wide approach(const fp3_work2 *work, const fp3_ends2 *ends,
                             const fp3_wide met[MET]) {
    const fp3_mask is_second =
        (fp3_mask)((fp3_mask)met[COUNT] == 2) & (fp3_mask)(met[GAP_2] < met[GAP]);
    const fp3_wide ax = fp3_wide_choose(is_second, met[ARM_X2], met[ARM_X]),
                   ay = fp3_wide_choose(is_second, met[ARM_Y2], met[ARM_Y]);
    const fp3_wide bx = ax - met[FROM_X], by = ay - met[FROM_Y];
    fp3_wide x[3], y[3];
    bring(work->speed, ends->a, x);
    bring(work->speed, ends->b, y);
    const fp3_wide ux = (y[0] - y[2] * by) - (x[0] - x[2] * ay);
    const fp3_wide uy = (y[1] + y[2] * bx) - (x[1] + x[2] * ax);
    return -(ux * met[N_X] + uy * met[N_Y]);
}

static void prepare(const fp3_work2 *work, const fp3_making2 *making, uint32_t first,
                    uint32_t end) {
    const fp3_softness *soft = making->softness;
    for (uint32_t i = first; i < end; i++) {
        const fp3_ends2 *ends = &work->ends[i];
        const uint32_t *at = &making->at[i * FP3_WIDE];
        fp3_touch2 none = {.approach = 0}, *of[FP3_WIDE];
        fp3_wide met[MET], heft[3];
        fp3_mask a, b;
        fp3_contact2_row *r = (fp3_contact2_row *)work->row + i;
        touches(making, at, &none, of);
#pragma GCC unroll 3
        for (uint32_t k = 0; k < MET; k += 8) {
            fp3_wide x[8];
#pragma GCC unroll 8
            for (int lane = 0; lane < FP3_WIDE; lane++)
                memcpy(&x[lane], (const float *)(const void *)of[lane] + k, sizeof x[lane]);
            fp3_lanes_flip(x, met + k);
        }
        bring(making->heft, ends->a, heft);
        r->ma = heft[0];
        r->ia = heft[1];
        bring(making->heft, ends->b, heft);
        r->mb = heft[0];
        r->ib = heft[1];
        memcpy(&a, ends->a, sizeof a);
        memcpy(&b, ends->b, sizeof b);
        const fp3_mask most = (fp3_mask){0} + ((int)work->movable - 1),
                       is_held = (fp3_mask)(a > most) | (fp3_mask)(b > most);
        r->rate = fp3_wide_choose(is_held, fp3_wide_all(soft[1].rate), fp3_wide_all(soft[0].rate));
        r->soft = fp3_wide_choose(is_held, fp3_wide_all(soft[1].soft), fp3_wide_all(soft[0].soft));
        r->fade = fp3_wide_choose(is_held, fp3_wide_all(soft[1].fade), fp3_wide_all(soft[0].fade));
        prepare_row(met, r);
        const fp3_wide speed = approach(work, ends, met);
        for (int lane = 0; lane < FP3_WIDE; lane++)
            of[lane]->approach = speed[lane];
    }
}

/* A row that is not finite is forgotten: else it would never heal. */
static void keep(const fp3_work2 *work, const fp3_making2 *making, uint32_t first, uint32_t end) {
    for (uint32_t i = first; i < end; i++) {
        const fp3_contact2_row *r = (const fp3_contact2_row *)work->row + i;
        const fp3_wide all = r->p1 + r->f1 + r->p2 + r->f2 + r->r;
        const fp3_mask is_finite = (fp3_mask)(all - all == 0);
        const fp3_wide given[6] = {r->p1, r->p2, r->f1, r->f2, r->r, r->top1 + r->top2};
        fp3_touch2 none, *of[FP3_WIDE];
        fp3_wide x[8], words[8];
#pragma GCC unroll 8
        for (int k = 0; k < 8; k++)
            x[k] = k < 5   ? fp3_wide_choose(is_finite, given[k], fp3_wide_all(0))
                   : k < 6 ? given[k]
                           : fp3_wide_all(0);
        fp3_lanes_flip(x, words);
        touches(making, &making->at[i * FP3_WIDE], &none, of);
        for (int lane = 0; lane < FP3_WIDE; lane++) {
            memcpy((char *)of[lane] + offsetof(fp3_touch2, p), &words[lane], 5 * sizeof(float));
            of[lane]->top += words[lane][5];
        }
    }
}

/* ---- passes ---- */

/* Of two blocks, the words of both bodies: speeds, then ways. */
typedef struct {
    fp3_wide a[2][6], b[2][6];
} both;

FP3_WIDELY void bring_both(const fp3_work2 *work, uint32_t i, int has_way, both *to) {
    const fp3_ends2 *ends = &work->ends[i];
    /* cppcheck-suppress uninitvar ; bring writes it */
    FP3_BOTH(bring(work->speed, ends[k].a, to->a[k]));
    FP3_BOTH(bring(work->speed, ends[k].b, to->b[k]));
    if (has_way) {
        FP3_BOTH(bring(work->way, ends[k].a, to->a[k] + 3));
        FP3_BOTH(bring(work->way, ends[k].b, to->b[k] + 3));
    }
}

FP3_WIDELY void take_both(const fp3_work2 *work, int has_base, uint32_t i, const both *from) {
    const fp3_ends2 *ends = &work->ends[i];
    FP3_BOTH(take(work, has_base, ends[k].a, from->a[k]);
             take(work, has_base, ends[k].b, from->b[k]));
}

FP3_WIDELY void give(const float shared[FP3_SHARED], fp3_wide given[FP3_SHARED]) {
#pragma GCC unroll 8
    for (int i = 0; i < FP3_SHARED; i++)
        given[i] = fp3_wide_all(shared[i]);
}

/* Joints are who reads ways. What only guesses (FP3_WARM), or never does, is compiled as that: half
 * of a law is left out. */
#define X(name, type, has_speed, has_way, is_of_point, integrator)                                 \
    FP3_WIDELY void pass_##name##_of(const fp3_work2 *work, uint32_t first, uint32_t end,          \
                                     fp3_wide given[FP3_SHARED], float is_warm) {                  \
        given[FP3_WARM] = fp3_wide_all(is_warm);                                                   \
        for (uint32_t i = first; i < end; i += 2) {                                                \
            both of;                                                                               \
            bring_both(work, i, has_way, &of);                                                     \
            fp3_law_##name((fp3_##type##_row *)work->row + i, of.a, of.b, given);                  \
            take_both(work, has_way, i, &of);                                                      \
        }                                                                                          \
    }                                                                                              \
    static void pass_##name(const fp3_work2 *given_work, uint32_t first, uint32_t end,             \
                            const float shared[FP3_SHARED]) {                                      \
        const fp3_work2 work = *given_work;                                                        \
        fp3_wide given[FP3_SHARED];                                                                \
        give(shared, given);                                                                       \
        if (has_way && shared[FP3_WARM] != 0)                                                      \
            pass_##name##_of(&work, first, end, given, 1);                                         \
        else                                                                                       \
            pass_##name##_of(&work, first, end, given, 0);                                         \
    }
FP3_LAWS2(X)
#undef X

static void moved(const fp3_work2 *given_work, uint32_t first, uint32_t end,
                  const float shared[FP3_SHARED]) {
    const fp3_work2 work = *given_work;
    fp3_wide given[FP3_SHARED];
    give(shared, given);
    for (uint32_t i = first; i < end; i += 2) {
        fp3_contact2_row *row = (fp3_contact2_row *)work.row + i;
        both of;
        bring_both(&work, i, 0, &of);
        fp3_law_gap2(row, of.a, of.b, given);
        fp3_law_contact2(row, of.a, of.b, given);
        take_both(&work, 0, i, &of);
    }
}

/* A point that does not count (0) stays one. */
FP3_WIDELY void renew_point(const fp3_contact2_row *r, fp3_mask is_turned, const fp3_wide arms[4],
                            fp3_wide *along, fp3_wide *aside) {
    const fp3_wide mass = r->ma + r->mb, is_there = fp3_wide_lt(fp3_wide_all(0), *along);
    const fp3_wide n = mass + r->ia * arms[0] * arms[0] + r->ib * arms[1] * arms[1],
                   t = mass + r->ia * arms[2] * arms[2] + r->ib * arms[3] * arms[3];
    *along = fp3_wide_choose(is_turned, quotient(is_there, n), *along);
    *aside = fp3_wide_choose(is_turned, quotient(is_there, t), *aside);
}

static void renew(const fp3_work2 *work, const fp3_four *heft, uint32_t first, uint32_t end) {
    for (uint32_t i = first; i < end; i++) {
        fp3_contact2_row *r = (fp3_contact2_row *)work->row + i;
        fp3_wide a[3], b[3];
        bring(heft, work->ends[i].a, a);
        bring(heft, work->ends[i].b, b);
        const fp3_mask is_turned = (fp3_mask)(fp3_wide_all(0) < a[2] + b[2]);
        const fp3_wide arms1[4] = {r->a1, r->b1, r->c1, r->e1},
                       arms2[4] = {r->a2, r->b2, r->c2, r->e2};
        renew_point(r, is_turned, arms1, &r->j1, &r->k1);
        renew_point(r, is_turned, arms2, &r->j2, &r->k2);
    }
}

/* ---- bodies ---- */

static void speed(fp3_four *speeds, fp3_four *base, const fp3_pull2 *pull, uint32_t count,
                  int is_first) {
    for (uint32_t i = 0; i < count; i++) {
        const fp3_four given = speeds[i] - base[i];
        const fp3_four own = (speeds[i] + pull[i].pull) * pull[i].damp;
        base[i] = own;
        speeds[i] = is_first ? own : (fp3_four)(own + given);
    }
}

static void place(const fp3_four *speeds, fp3_four *way, const fp3_pull2 *pull, uint32_t count,
                  float h) {
    for (uint32_t i = 0; i < count; i++)
        way[i] += h * speeds[i] - pull[i].drop;
}

static double all_of(fp3_masses x) { return (x[0] + x[1]) + (x[2] + x[3]); }

static void energy(const fp3_guessed *of, uint32_t first, uint32_t end, fp3_energy *to) {
    fp3_masses before = {0}, by_first = {0}, by_second = {0};
    for (uint32_t k = first; k < end; k++) {
        const fp3_masses v = __builtin_convertvector(of->before[of->fours * k], fp3_masses),
                         now = __builtin_convertvector(of->speed[of->fours * of->slot[k]],
                                                       fp3_masses),
                         by = now - v, moved = of->mass[k] * v;
        before += moved * v;
        by_first += moved * by;
        by_second += of->mass[k] * by * by;
    }
    *to = (fp3_energy){0.5 * all_of(before), all_of(by_first), 0.5 * all_of(by_second)};
}

#define X(name, type, has_speed, has_way, is_of_point, integrator) pass_##name,
extern const fp3_solver2 FP3_SOLVER;
const fp3_solver2 FP3_SOLVER = {FP3_SOLVER_NAME, prepare, keep,  {FP3_LAWS2(X)}, renew,
                                moved,           speed,   place, energy};
