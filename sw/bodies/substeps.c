/* SPDX-License-Identifier: Apache-2.0 */
/* substeps.c - the substeps of a step, as a list of what several threads do together.
 *
 * Rows of a colour share no body that moves, so their order does not count: each thread has some.
 */
#include "guess.h"
#include "heavy.h"
#include "passing.h"

#include <stdlib.h>
#include <string.h>

#define LEAST_PASSED 8  /* blocks: two, of sixteen contacts, take 150 ns */
#define LEAST_PASSED3 4 /* in space: one takes 150 ns */
#define NEIGHBOURS 6    /* blocks */
#define LEAST_MOVED 128 /* bodies: 3 ns each, but who has their rows should have them */
#define LEAST_MOVED3 32 /* in space: 30 ns */

enum { WARM = FP3_WARM_WAY, PUSH = FP3_PUSH_WAY, MEND = FP3_MEND_WAY, WAYS = FP3_WAYS };

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

static int have_turned(const fp3_bodies *bodies, uint32_t i) {
    return fp3_block_has_turned(bodies, i) || fp3_block_has_turned(bodies, i + 1);
}

static void pass_turned(const fp3_passing *p, uint32_t first, uint32_t end) {
    const fp3_bodies *bodies = p->all->bodies;
    const fp3_solver2 *solver = bodies->solver;
    for (uint32_t i = first; i < end; i += 2) {
        if (!have_turned(bodies, i)) {
            p->pass(&p->work, i, i + 2, p->shared);
            continue;
        }
        solver->law[FP3_LAW_gap2](&p->work, i, i + 2, p->shared);
        solver->renew(&p->work, bodies->heft, i, i + 2);
        solver->law[FP3_LAW_contact2](&p->work, i, i + 2, p->shared);
    }
}

/* Of colours and threads: fp3_law_rows.cut. Neighbours of other threads are at both ends. */
static void pass_some(void *of, uint32_t from, uint32_t to) {
    const fp3_passing *p = of;
    const uint32_t first = p->cut[from], end = p->cut[to];
    if (to - from < p->all->bodies->cuts && end - first > 2 * NEIGHBOURS) {
        fetch(&p->work, first, first + NEIGHBOURS);
        fetch(&p->work, end - NEIGHBOURS, end);
    }
    if (p->has_moved && p->all->bodies->has_turned)
        pass_turned(p, first, end);
    else
        p->pass(&p->work, first, end, p->shared);
}

static void pass_by_engine(void *of, uint32_t from, uint32_t to) {
    const fp3_passing *p = of;
    const fp3_bodies *bodies = p->all->bodies;
    fp3_laws *laws = bodies->laws;
    fp3_status *status = &p->all->status;
    const uint32_t first = p->cut[from], end = p->cut[to];
    if (!*status && p->has_moved)
        *status = fp3_laws_run(laws, FP3_LAW_gap2, &p->work, first, end, 0, p->shared);
    for (uint32_t i = first; !*status && p->has_moved && bodies->has_turned && i < end; i += 2)
        if (have_turned(bodies, i))
            bodies->solver->renew(&p->work, bodies->heft, i, i + 2);
    if (!*status)
        *status = fp3_laws_run(laws, p->law, &p->work, first, end, 0, p->shared);
}

/* Of threads: their slots. */
static void speed(fp3_bodies *b, uint32_t from, uint32_t to, int is_first) {
    const uint32_t first = b->cut[from], end = to < b->cuts ? b->cut[to] : b->movable;
    const uint32_t fours = b->space ? FP3_FOURS3 : 1, at = fours * first;
    if (first >= end)
        return;
    if (!is_first)
        fp3_forget_turned(b, first, end);
    b->solver->speed(b->speed + at, b->base + at, b->pull + at, fours * (end - first), is_first);
}
static void speed_first(void *of, uint32_t from, uint32_t to) { speed(of, from, to, 1); }
static void speed_later(void *of, uint32_t from, uint32_t to) { speed(of, from, to, 0); }

static void place(void *of, uint32_t from, uint32_t to) {
    fp3_bodies *b = of;
    const double h = b->def.h / b->def.substeps;
    const uint32_t first = b->cut[from], end = b->cut[to] < b->movable ? b->cut[to] : b->movable;
    b->solver->place(b->speed + first, b->way + first, b->pull + first, b->cut[to] - first,
                     (float)h);
    fp3_find_turned(b, first, end);
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

static void note_guess(void *of, uint32_t from, uint32_t to) {
    (void)from;
    (void)to;
    fp3_guess_note(of);
}
static void check_guess(void *of, uint32_t from, uint32_t to) {
    (void)from;
    (void)to;
    fp3_guess_check(of);
}

/* ---- the list ---- */

/* How many threads have rows of a colour. */
static uint32_t parts_of(const fp3_bodies *bodies, const fp3_law_rows *rows, uint32_t colour) {
    const uint32_t *cut = &rows->cut[colour * bodies->cuts];
    return fp3_threads_parts(bodies->crew, cut[bodies->cuts] - cut[0],
                             bodies->space ? LEAST_PASSED3 : LEAST_PASSED);
}

static const fp3_law_rows *rows_of(const fp3_bodies *bodies, int i) {
    return i < FP3_JOINT_LAWS ? fp3_joint_rows(bodies, (uint32_t)i)
           : bodies->space    ? &bodies->space->contacts
                              : &bodies->contacts;
}

static fp3_passing passing_of(fp3_bodies *bodies, int way, int i) {
    fp3_substeps *all = bodies->substeps;
    const fp3_law_rows *rows = rows_of(bodies, i);
    const int is_joint = i < FP3_JOINT_LAWS;
    fp3_passing made = {.work = {bodies->speed, bodies->way, is_joint ? bodies->base : NULL,
                                 bodies->movable, rows->row, rows->ends},
                        .shared = all->shared[way],
                        .cut = rows->cut,
                        .has_moved = !is_joint && way == MEND,
                        .all = all};
    if (bodies->space) {
        made.law = FP3_LAW_pin3 + (uint32_t)i;
        made.pass = is_joint ? bodies->space->solver->joint[i] : NULL; /* fp3_space_pass */
        return made;
    }
    made.law = is_joint      ? FP3_LAW_twist2 + (uint32_t)i
               : way == WARM ? FP3_LAW_warm2
                             : FP3_LAW_contact2;
    made.pass = made.has_moved ? bodies->solver->moved : bodies->solver->law[made.law];
    return made;
}

/* What one thread does of several colours is one stage. */
static void add_pass(fp3_bodies *bodies, int way, int i) {
    const fp3_law_rows *rows = rows_of(bodies, i);
    const int is_own = bodies->space && i == FP3_JOINT_LAWS;
    const int may_run_on = !bodies->laws; /* an engine does a colour at once */
    void (*const part)(void *, uint32_t, uint32_t) =
        bodies->laws ? is_own ? fp3_space_pass_by_engine : pass_by_engine
        : is_own     ? fp3_space_pass
                     : pass_some;
    for (uint32_t k = 0, end; rows->count && k < rows->colours.count; k = end) {
        const uint32_t parts = parts_of(bodies, rows, k);
        end = k + 1;
        while (may_run_on && parts == 1 && end < rows->colours.count &&
               parts_of(bodies, rows, end) == 1)
            end++;
        fp3_laps_add(&bodies->laps, part, &bodies->substeps->pass[way][i], k * bodies->cuts,
                     end * bodies->cuts, parts);
    }
}

static void add_bodies(fp3_bodies *bodies, void (*part)(void *of, uint32_t from, uint32_t to)) {
    fp3_laps_add(&bodies->laps, part, bodies, 0, bodies->cuts,
                 fp3_threads_parts(bodies->crew, bodies->movable,
                                   bodies->space ? LEAST_MOVED3 : LEAST_MOVED));
}

/* Points last: they must not come apart. */
static void add_joints(fp3_bodies *bodies, int way) {
    for (int i = 0; i < FP3_JOINT_LAWS; i++)
        add_pass(bodies, way, bodies->space ? (i + 1) % FP3_JOINT_LAWS : i);
}

static int has_heavy_sets(const fp3_bodies *bodies) { return bodies->heavy->sets > 0; }

/* Joints first: contacts have the last word. Heavy sets, whose rows passes leave alone, follow
 * where passes find how gaps are now. */
static void add_all(fp3_bodies *bodies, int way) {
    const int has_sets = has_heavy_sets(bodies);
    if (has_sets && way == PUSH)
        fp3_laps_add(&bodies->laps, solve_heavy, bodies, 1, 2, 1);
    add_joints(bodies, way);
    add_pass(bodies, way, FP3_JOINT_LAWS);
    if (has_sets && way == MEND)
        fp3_laps_add(&bodies->laps, solve_heavy, bodies, 0, 1, 1);
}

/* Arms and masses of joints in space are made anew in each substep. */
static void add_stances(fp3_bodies *bodies) {
    fp3_laps_add(&bodies->laps, fp3_space_joints_stand_some, bodies, 0, bodies->joint_count,
                 fp3_threads_parts(bodies->crew, bodies->joint_count, FP3_LEAST_STANCES));
    fp3_laps_add(&bodies->laps, fp3_space_joints_fill_some, bodies, 0, bodies->cuts,
                 fp3_threads_parts(bodies->crew, bodies->joint_count, FP3_LEAST_STANCES));
}

/* Arms of joints turn within a step, so joints give their impulses anew in each substep; contacts
 * give what bodies have kept of the last one. */
static void add_substep(fp3_bodies *bodies, int is_first) {
    add_bodies(bodies, is_first ? speed_first : speed_later);
    if (is_first)
        add_pass(bodies, WARM, FP3_JOINT_LAWS);
    if (!is_first && has_heavy_sets(bodies))
        fp3_laps_add(&bodies->laps, forget_heavy, bodies, 0, 1, 1);
    if (!is_first)
        fp3_laps_add(&bodies->laps, fp3_give_again, bodies, 0, 1, 1);
    if (fp3_guess_has(bodies))
        fp3_laps_add(&bodies->laps, note_guess, bodies, 0, 1, 1);
    add_joints(bodies, WARM);
    if (fp3_guess_has(bodies))
        fp3_laps_add(&bodies->laps, check_guess, bodies, 0, 1, 1);
    add_all(bodies, PUSH);
    add_bodies(bodies, bodies->space ? fp3_space_place : place);
    if (bodies->space && bodies->joints)
        add_stances(bodies);
    add_all(bodies, MEND);
}

static int is_same(const fp3_passing *a, const fp3_passing *b) {
    return a->work.speed == b->work.speed && a->work.way == b->work.way &&
           a->work.base == b->work.base && a->work.movable == b->work.movable &&
           a->work.row == b->work.row && a->work.ends == b->work.ends && a->pass == b->pass &&
           a->cut == b->cut && a->law == b->law && a->has_moved == b->has_moved;
}

/* What is as it was is not written: other threads have it. */
static void fill(fp3_bodies *bodies, double h) {
    fp3_substeps *all = bodies->substeps;
    const float inverse = (float)(1 / h), least = (float)-bodies->def.push,
                far = FP3_FARTHEST * (float)bodies->def.size;
    const float shared[WAYS][FP3_SHARED] = {[WARM] = {1, inverse, least, 1, (float)h, far},
                                            [PUSH] = {1, inverse, least, 0, (float)h, far},
                                            [MEND] = {0, inverse, least, 0, (float)h, far}};
    if (memcmp(all->shared, shared, sizeof shared) != 0)
        memcpy(all->shared, shared, sizeof shared);
    for (int way = 0; way < WAYS; way++)
        for (int i = 0; i <= FP3_JOINT_LAWS; i++) {
            const fp3_passing made = passing_of(bodies, way, i);
            fp3_passing *to = &all->pass[way][i];
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
