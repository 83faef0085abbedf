/* SPDX-License-Identifier: Apache-2.0 */
/* substeps.c - the substeps of a step in a plane, as a list of what several threads do together.
 *
 * Rows of a colour share no body that moves, so their order does not count: each thread has some.
 */
#include "heavy.h"
#include "own.h"

#include <stdlib.h>
#include <string.h>

#define LEAST_PASSED 4  /* two blocks each: sixteen contacts take 150 ns */
#define NEIGHBOURS 6    /* blocks */
#define LEAST_MOVED 128 /* bodies: 3 ns each, but who has their rows should have them */

/* What a pass is for. */
enum { WARM, PUSH, MEND, WAYS };

/* A pass over the rows of a law. */
typedef struct {
    fp3_work2 work;
    void (*pass)(const fp3_work2 *, uint32_t first, uint32_t end, const float shared[FP3_SHARED]);
    const float *shared;
    const uint32_t *cut;
    fp3_law law;
    fp3_substeps *all;
} passing;

struct fp3_substeps {
    float shared[WAYS][FP3_SHARED];
    passing pass[WAYS][FP3_JOINT_LAWS + 1]; /* the last ones are those over contacts */
    fp3_bodies *bodies;
    fp3_status status; /* of the engine that executes laws */
};

/* ---- what threads do ---- */

/* Bodies of rows that another thread may have written: all at once, they come in the time of one.
 */
static void fetch(const fp3_work2 *work, uint32_t first, uint32_t end) {
    for (uint32_t i = first; i < end; i++)
        for (uint32_t lane = 0; lane < FP3_WIDE; lane++) {
            __builtin_prefetch(&work->speed[work->ends[i].a[lane]], 1);
            __builtin_prefetch(&work->speed[work->ends[i].b[lane]], 1);
        }
}

/* Of colours and threads: fp3_law_rows.cut. Neighbours of other threads are at both ends. */
static void pass_some(void *of, uint32_t from, uint32_t to) {
    const passing *p = of;
    const uint32_t first = 2 * p->cut[from], end = 2 * p->cut[to];
    if (to - from < p->all->bodies->cuts && end - first > 2 * NEIGHBOURS) {
        fetch(&p->work, first, first + NEIGHBOURS);
        fetch(&p->work, end - NEIGHBOURS, end);
    }
    p->pass(&p->work, 2 * p->cut[from], 2 * p->cut[to], p->shared);
}

/* gap2 goes before contact2, wherever bodies have moved. */
static void pass_by_engine(void *of, uint32_t from, uint32_t to) {
    const passing *p = of;
    fp3_laws *laws = p->all->bodies->laws;
    fp3_status *status = &p->all->status;
    const uint32_t first = 2 * p->cut[from], end = 2 * p->cut[to];
    if (!*status)
        *status = fp3_laws_run(laws, p->law, &p->work, first, end, 0, p->shared);
    if (!*status && p->law == FP3_LAW_gap2)
        *status = fp3_laws_run(laws, FP3_LAW_contact2, &p->work, first, end, 0, p->shared);
}

/* Of threads: their slots. */
static void speed(const fp3_bodies *b, uint32_t from, uint32_t to, int is_first) {
    const uint32_t first = b->cut[from], end = to < b->cuts ? b->cut[to] : b->movable;
    if (first < end)
        b->solver->speed(b->speed + first, b->base + first, b->pull + first, end - first, is_first);
}
static void speed_first(void *of, uint32_t from, uint32_t to) { speed(of, from, to, 1); }
static void speed_later(void *of, uint32_t from, uint32_t to) { speed(of, from, to, 0); }

static void place(void *of, uint32_t from, uint32_t to) {
    const fp3_bodies *b = of;
    const double h = b->def.h / b->def.substeps;
    const uint32_t first = b->cut[from];
    b->solver->place(b->speed + first, b->way + first, b->pull + first, b->cut[to] - first,
                     (float)h);
}

static void forget_heavy(void *of, uint32_t from, uint32_t to) {
    (void)from;
    (void)to;
    fp3_heavy_forget(of);
}
/* push: fp3_heavy_solve. */
static void solve_heavy(void *of, uint32_t push, uint32_t to) {
    fp3_bodies *bodies = of;
    (void)to;
    if (!bodies->substeps->status)
        bodies->substeps->status = fp3_heavy_solve(bodies, (int)push);
}

/* ---- the list ---- */

static const fp3_law_rows *rows_of(const fp3_bodies *bodies, int i) {
    return i == FP3_JOINT_LAWS ? &bodies->contacts : &bodies->joined[i];
}

static passing passing_of(fp3_bodies *bodies, int way, int i) {
    fp3_substeps *all = bodies->substeps;
    const fp3_law_rows *rows = rows_of(bodies, i);
    const int is_joint = i < FP3_JOINT_LAWS;
    const fp3_law law = is_joint      ? (fp3_law)(FP3_LAW_twist2 + i)
                        : way == WARM ? FP3_LAW_warm2
                        : way == PUSH ? FP3_LAW_contact2
                                      : FP3_LAW_gap2;
    return (passing){.work = {bodies->speed, bodies->way, is_joint ? bodies->base : NULL,
                              bodies->movable, rows->row, rows->ends},
                     .pass = law == FP3_LAW_gap2 ? bodies->solver->moved : bodies->solver->law[law],
                     .shared = all->shared[way],
                     .cut = rows->cut,
                     .law = law,
                     .all = all};
}

static void add_pass(fp3_bodies *bodies, int way, int i) {
    const fp3_law_rows *rows = rows_of(bodies, i);
    for (uint32_t k = 0; rows->count && k < rows->colours.count; k++) {
        const uint32_t *cut = &rows->cut[k * bodies->cuts];
        const uint32_t pairs = cut[bodies->cuts] - cut[0];
        fp3_laps_add(&bodies->laps, bodies->laws ? pass_by_engine : pass_some,
                     &bodies->substeps->pass[way][i], k * bodies->cuts, (k + 1) * bodies->cuts,
                     fp3_threads_parts(bodies->crew, pairs, LEAST_PASSED));
    }
}

static void add_bodies(fp3_bodies *bodies, void (*part)(void *of, uint32_t from, uint32_t to)) {
    fp3_laps_add(&bodies->laps, part, bodies, 0, bodies->cuts,
                 fp3_threads_parts(bodies->crew, bodies->movable, LEAST_MOVED));
}

static void add_joints(fp3_bodies *bodies, int way) {
    for (int i = 0; i < FP3_JOINT_LAWS; i++)
        add_pass(bodies, way, i);
}

/* Joints first: contacts have the last word. Heavy sets, whose rows passes leave alone, follow
 * where passes find how gaps are now. */
static void add_all(fp3_bodies *bodies, int way) {
    const int has_sets = bodies->heavy->sets > 0;
    if (has_sets && way == PUSH)
        fp3_laps_add(&bodies->laps, solve_heavy, bodies, 1, 2, 1);
    add_joints(bodies, way);
    add_pass(bodies, way, FP3_JOINT_LAWS);
    if (has_sets && way == MEND)
        fp3_laps_add(&bodies->laps, solve_heavy, bodies, 0, 1, 1);
}

/* Arms of joints turn within a step, so joints give their impulses anew in each substep; contacts
 * give what bodies have kept of the last one. */
static void add_substep(fp3_bodies *bodies, int is_first) {
    add_bodies(bodies, is_first ? speed_first : speed_later);
    if (is_first)
        add_pass(bodies, WARM, FP3_JOINT_LAWS);
    if (!is_first && bodies->heavy->sets)
        fp3_laps_add(&bodies->laps, forget_heavy, bodies, 0, 1, 1);
    add_joints(bodies, WARM);
    add_all(bodies, PUSH);
    add_bodies(bodies, place);
    add_all(bodies, MEND);
}

static int is_same(const passing *a, const passing *b) {
    return a->work.speed == b->work.speed && a->work.way == b->work.way &&
           a->work.base == b->work.base && a->work.movable == b->work.movable &&
           a->work.row == b->work.row && a->work.ends == b->work.ends && a->pass == b->pass &&
           a->cut == b->cut;
}

/* What is as it was is not written: other threads have it. */
static void fill(fp3_bodies *bodies, double h) {
    fp3_substeps *all = bodies->substeps;
    const float inverse = (float)(1 / h), least = (float)-bodies->def.push;
    const float shared[WAYS][FP3_SHARED] = {[WARM] = {1, inverse, least, 1, (float)h},
                                            [PUSH] = {1, inverse, least, 0, (float)h},
                                            [MEND] = {0, inverse, least, 0, (float)h}};
    if (memcmp(all->shared, shared, sizeof shared) != 0)
        memcpy(all->shared, shared, sizeof shared);
    for (int way = 0; way < WAYS; way++)
        for (int i = 0; i <= FP3_JOINT_LAWS; i++) {
            const passing made = passing_of(bodies, way, i);
            passing *to = &all->pass[way][i];
            if (!is_same(to, &made))
                *to = made;
        }
}

fp3_status fp3_substeps_make(fp3_bodies *bodies) {
    bodies->substeps = calloc(1, sizeof *bodies->substeps);
    if (!bodies->substeps)
        return fp3_no_memory(bodies->error);
    bodies->substeps->bodies = bodies;
    return FP3_OK;
}

fp3_status fp3_substeps_do(fp3_bodies *bodies, double h) {
    fill(bodies, h);
    bodies->substeps->status = FP3_OK;
    fp3_laps_begin(&bodies->laps, bodies->crew);
    for (uint32_t i = 0; i < bodies->def.substeps; i++)
        add_substep(bodies, i == 0);
    const fp3_status status = fp3_laps_do(&bodies->laps);
    fp3_heavy_end(bodies);
    return status ? status : bodies->substeps->status;
}
