/* SPDX-License-Identifier: Apache-2.0 */
/* solve2.c - see solve2.h. Compiled once for each kind of processor: FP3_SOLVER names the result.
 */
#include "solve2.h"

#ifndef FP3_SOLVER
#define FP3_SOLVER fp3_solver2_plain
#define FP3_SOLVER_NAME "x86-64" /* the least kind of a processor: others have no other */
#endif

#define SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)

/* Fours of eight bodies become four vectors of eight, of which the last one is nothing. */
FP3_WIDELY void bring(const fp3_four *from, const uint32_t of[FP3_WIDE], fp3_wide words[4]) {
    fp3_wide m[4], s[4];
    for (int i = 0; i < 4; i++)
        m[i] = SHUFFLE(from[of[i]], from[of[i + 4]], 0, 1, 2, 3, 4, 5, 6, 7);
    for (int i = 0; i < 2; i++) {
        s[i] = SHUFFLE(m[i], m[i + 2], 0, 8, 1, 9, 4, 12, 5, 13);
        s[i + 2] = SHUFFLE(m[i], m[i + 2], 2, 10, 3, 11, 6, 14, 7, 15);
    }
    for (int i = 0; i < 2; i++) {
        words[2 * i] = SHUFFLE(s[2 * i], s[2 * i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
        words[2 * i + 1] = SHUFFLE(s[2 * i], s[2 * i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
    }
}

FP3_WIDELY void take(const fp3_work2 *work, const uint32_t of[FP3_WIDE], const fp3_wide words[3]) {
    const fp3_wide none = fp3_wide_all(0);
    const fp3_wide xy[2] = {SHUFFLE(words[0], words[1], 0, 8, 1, 9, 4, 12, 5, 13),
                            SHUFFLE(words[0], words[1], 2, 10, 3, 11, 6, 14, 7, 15)};
    const fp3_wide w[2] = {SHUFFLE(words[2], none, 0, 8, 1, 9, 4, 12, 5, 13),
                           SHUFFLE(words[2], none, 2, 10, 3, 11, 6, 14, 7, 15)};
    for (int i = 0; i < 2; i++) {
        const fp3_wide even = SHUFFLE(xy[i], w[i], 0, 1, 8, 9, 4, 5, 12, 13),
                       odd = SHUFFLE(xy[i], w[i], 2, 3, 10, 11, 6, 7, 14, 15);
        const fp3_four v[4] = {SHUFFLE(even, even, 0, 1, 2, 3), SHUFFLE(odd, odd, 0, 1, 2, 3),
                               SHUFFLE(even, even, 4, 5, 6, 7), SHUFFLE(odd, odd, 4, 5, 6, 7)};
        for (int k = 0; k < 4; k++) {
            const uint32_t body = of[2 * i + (k & 1) + 2 * (k & 2)];
            if (body >= work->movable)
                continue;
            if (work->base)
                work->base[body] += v[k] - work->speed[body];
            work->speed[body] = v[k];
        }
    }
}

/* ---- rows ---- */

FP3_WIDELY fp3_wide quotient(fp3_wide share, fp3_wide by) {
    return fp3_wide_choose((fp3_mask)(fp3_wide_all(0) < by), share / by, fp3_wide_all(0));
}

typedef struct {
    fp3_wide *arm_a, *arm_b, *across_a, *across_b, *along, *aside;
} point;

FP3_WIDELY void prepare_point(const fp3_contact2_row *row, point p) {
    const fp3_wide ax = *p.arm_a, ay = *p.across_a, bx = *p.arm_b, by = *p.across_b;
    const fp3_wide nx = row->n_x, ny = row->n_y, is_there = *p.along;
    const fp3_wide an = ax * ny - ay * nx, bn = bx * ny - by * nx;
    const fp3_wide at = ax * nx + ay * ny, bt = bx * nx + by * ny;
    const fp3_wide mass = row->ma + row->mb;
    *p.arm_a = an;
    *p.arm_b = bn;
    *p.across_a = at;
    *p.across_b = bt;
    *p.along = quotient(is_there, mass + row->ia * an * an + row->ib * bn * bn);
    *p.aside = quotient(is_there, mass + row->ia * at * at + row->ib * bt * bt);
}

static void prepare(const fp3_work2 *work, uint32_t first, uint32_t end) {
    for (uint32_t i = first; i < end; i++) {
        fp3_contact2_row *r = (fp3_contact2_row *)work->row + i;
        prepare_point(r, (point){&r->a1, &r->b1, &r->c1, &r->e1, &r->j1, &r->k1});
        prepare_point(r, (point){&r->a2, &r->b2, &r->c2, &r->e2, &r->j2, &r->k2});
        r->jr = quotient(fp3_wide_all(1), r->ia + r->ib);
    }
}

/* ---- passes ---- */

/* The words of both bodies: speeds, then ways. */
typedef struct {
    fp3_wide a[7], b[7];
} both;

FP3_WIDELY void bring_both(const fp3_work2 *work, uint32_t i, int has_speed, int has_way,
                           both *to) {
    if (has_way) {
        bring(work->way, work->ends[i].a, to->a + 3);
        bring(work->way, work->ends[i].b, to->b + 3);
    }
    if (has_speed) {
        fp3_wide a[4], b[4];
        bring(work->speed, work->ends[i].a, a);
        bring(work->speed, work->ends[i].b, b);
        for (int k = 0; k < 3; k++) {
            to->a[k] = a[k];
            to->b[k] = b[k];
        }
    }
}

FP3_WIDELY void take_both(const fp3_work2 *work, uint32_t i, const both *from) {
    take(work, work->ends[i].a, from->a);
    take(work, work->ends[i].b, from->b);
}

FP3_WIDELY void give(const float shared[FP3_SHARED], fp3_wide given[FP3_SHARED]) {
    for (int i = 0; i < FP3_SHARED; i++)
        given[i] = fp3_wide_all(shared[i]);
}

#define X(name, type, has_speed, has_way)                                                          \
    static void pass_##name(const fp3_work2 *work, uint32_t first, uint32_t end,                   \
                            const float shared[FP3_SHARED]) {                                      \
        fp3_wide given[FP3_SHARED];                                                                \
        both of = {0};                                                                             \
        give(shared, given);                                                                       \
        for (uint32_t i = first; i < end; i++) {                                                   \
            bring_both(work, i, has_speed, has_way, &of);                                          \
            fp3_law_##name((fp3_##type##_row *)work->row + i, of.a, of.b, given);                  \
            if (has_speed)                                                                         \
                take_both(work, i, &of);                                                           \
        }                                                                                          \
    }
FP3_LAWS2(X)
#undef X

static void moved(const fp3_work2 *work, uint32_t first, uint32_t end,
                  const float shared[FP3_SHARED]) {
    fp3_wide given[FP3_SHARED];
    both of;
    give(shared, given);
    for (uint32_t i = first; i < end; i++) {
        fp3_contact2_row *row = (fp3_contact2_row *)work->row + i;
        bring_both(work, i, 1, 0, &of);
        fp3_law_gap2(row, of.a, of.b, given);
        fp3_law_contact2(row, of.a, of.b, given);
        take_both(work, i, &of);
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

#define X(name, type, has_speed, has_way) pass_##name,
extern const fp3_solver2 FP3_SOLVER;
const fp3_solver2 FP3_SOLVER = {FP3_SOLVER_NAME, prepare, {FP3_LAWS2(X)}, moved, speed, place};
