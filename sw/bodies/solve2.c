/* SPDX-License-Identifier: Apache-2.0 */
/* solve2.c - see solve2.h. Compiled once for each kind of processor: FP3_SOLVER names the result.
 */
#include "solve2.h"

#ifndef FP3_SOLVER
#define FP3_SOLVER fp3_solver2_plain
#define FP3_SOLVER_NAME "plain"
#endif

#define SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)

/* Rows become columns. */
FP3_WIDELY void transpose(fp3_wide m[8]) {
    fp3_wide s[8], t[8];
    for (int i = 0; i < 8; i += 2) {
        s[i] = SHUFFLE(m[i], m[i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
        s[i + 1] = SHUFFLE(m[i], m[i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
    }
    for (int i = 0; i < 8; i += 4)
        for (int j = 0; j < 2; j++) {
            t[i + 2 * j] = SHUFFLE(s[i + j], s[i + j + 2], 0, 1, 8, 9, 4, 5, 12, 13);
            t[i + 2 * j + 1] = SHUFFLE(s[i + j], s[i + j + 2], 2, 3, 10, 11, 6, 7, 14, 15);
        }
    for (int i = 0; i < 4; i++) {
        m[i] = SHUFFLE(t[i], t[i + 4], 0, 1, 2, 3, 8, 9, 10, 11);
        m[i + 4] = SHUFFLE(t[i], t[i + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
}

FP3_WIDELY void bring(const fp3_work2 *work, const uint32_t of[FP3_WIDE], fp3_wide words[8]) {
    for (int lane = 0; lane < FP3_WIDE; lane++)
        words[lane] = work->body[of[lane]];
    transpose(words);
}

FP3_WIDELY void take(const fp3_work2 *work, const uint32_t of[FP3_WIDE], fp3_wide words[8]) {
    transpose(words);
    for (int lane = 0; lane < FP3_WIDE; lane++)
        if (of[lane] < work->movable) {
            if (work->base)
                work->base[of[lane]] += words[lane] - work->body[of[lane]];
            work->body[of[lane]] = words[lane];
        }
}

/* ---- rows ---- */

FP3_WIDELY fp3_wide quotient(fp3_wide share, fp3_wide by) {
    return fp3_wide_choose((fp3_mask)(fp3_wide_all(0) < by), share / by, fp3_wide_all(0));
}

typedef struct {
    fp3_wide *arm_a, *arm_b, *across_a, *across_b, *along, *aside, *out;
} point;

FP3_WIDELY void prepare_point(const fp3_contact2_row *row, point p, const fp3_wide *a,
                              const fp3_wide *b, fp3_wide bounce) {
    const fp3_wide ax = *p.arm_a, ay = *p.across_a, bx = *p.arm_b, by = *p.across_b;
    const fp3_wide nx = row->n_x, ny = row->n_y, is_there = *p.along;
    const fp3_wide an = ax * ny - ay * nx, bn = bx * ny - by * nx;
    const fp3_wide at = ax * nx + ay * ny, bt = bx * nx + by * ny;
    const fp3_wide mass = a[6] + b[6];
    *p.arm_a = an;
    *p.arm_b = bn;
    *p.across_a = at;
    *p.across_b = bt;
    *p.along = quotient(is_there, mass + a[7] * an * an + b[7] * bn * bn);
    *p.aside = quotient(is_there, mass + a[7] * at * at + b[7] * bt * bt);
    const fp3_wide rise = (b[0] - a[0]) * nx + (b[1] - a[1]) * ny + bn * b[2] - an * a[2];
    *p.out = fp3_wide_choose((fp3_mask)(rise < -bounce), -*p.out * rise, fp3_wide_all(0));
}

static void prepare(const fp3_work2 *work, uint32_t first, uint32_t end, float bounce) {
    for (uint32_t i = first; i < end; i++) {
        fp3_wide a[8], b[8];
        fp3_contact2_row *r = (fp3_contact2_row *)work->row + i;
        bring(work, work->ends[i].a, a);
        bring(work, work->ends[i].b, b);
        prepare_point(r, (point){&r->a1, &r->b1, &r->c1, &r->e1, &r->j1, &r->k1, &r->out1}, a, b,
                      fp3_wide_all(bounce));
        prepare_point(r, (point){&r->a2, &r->b2, &r->c2, &r->e2, &r->j2, &r->k2, &r->out2}, a, b,
                      fp3_wide_all(bounce));
        r->jr = quotient(fp3_wide_all(1), a[7] + b[7]);
    }
}

/* ---- passes ---- */

#define X(name, type)                                                                              \
    static void pass_##name(const fp3_work2 *work, uint32_t first, uint32_t end,                   \
                            const float shared[FP3_SHARED]) {                                      \
        fp3_wide given[FP3_SHARED];                                                                \
        for (int i = 0; i < FP3_SHARED; i++)                                                       \
            given[i] = fp3_wide_all(shared[i]);                                                    \
        for (uint32_t i = first; i < end; i++) {                                                   \
            fp3_wide a[8], b[8];                                                                   \
            bring(work, work->ends[i].a, a);                                                       \
            bring(work, work->ends[i].b, b);                                                       \
            fp3_law_##name((fp3_##type##_row *)work->row + i, a, b, given);                        \
            take(work, work->ends[i].a, a);                                                        \
            take(work, work->ends[i].b, b);                                                        \
        }                                                                                          \
    }
FP3_LAWS2(X)
#undef X

/* ---- bodies ---- */

static const fp3_mask is_speed = {-1, -1, -1, 0, 0, 0, 0, 0};
static const fp3_mask is_place = {0, 0, 0, -1, -1, -1, 0, 0};

static void speed(fp3_moving2 *body, fp3_moving2 *base, const fp3_pull2 *pull, uint32_t count,
                  int is_first) {
    for (uint32_t i = 0; i < count; i++) {
        const fp3_wide given = body[i] - base[i];
        const fp3_wide own = (body[i] + pull[i].pull) * pull[i].damp;
        base[i] = own;
        body[i] = fp3_wide_choose(is_speed, is_first ? own : (fp3_wide)(own + given), body[i]);
    }
}

static void place(fp3_moving2 *body, uint32_t count, float h) {
    for (uint32_t i = 0; i < count; i++) {
        const fp3_wide v = SHUFFLE(body[i], body[i], 0, 0, 0, 0, 1, 2, 0, 0);
        body[i] = fp3_wide_choose(is_place, body[i] + fp3_wide_all(h) * v, body[i]);
    }
}

#define X(name, type) pass_##name,
extern const fp3_solver2 FP3_SOLVER;
const fp3_solver2 FP3_SOLVER = {FP3_SOLVER_NAME, prepare, {FP3_LAWS2(X)}, speed, place};
