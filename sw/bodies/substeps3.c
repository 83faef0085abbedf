/* SPDX-License-Identifier: Apache-2.0 */
/* substeps3.c - what threads do in a substep in space (passing.h). */
#include "passing.h"

#include <string.h>

/* ---- contacts ---- */

/* Blocks of bodies that have turned so far in this step that they would answer otherwise. */
static void mark_turned(const fp3_bodies *bodies, uint32_t first, uint32_t end) {
    const fp3_space *s = bodies->space;
    for (uint32_t i = first; i < end; i++) {
        const fp3_ends2 *ends = &s->contacts.ends[i];
        float has = 0;
        for (int lane = 0; lane < FP3_WIDE; lane++)
            has += bodies->heft[2 * ends->a[lane] + 1][3] + bodies->heft[2 * ends->b[lane] + 1][3];
        if (has > 0)
            s->points[i] |= FP3_HAS_TURNED;
    }
}

void fp3_space_pass(void *of, uint32_t from, uint32_t to) {
    const fp3_passing *p = of;
    const fp3_bodies *bodies = p->all->bodies;
    const fp3_space *s = bodies->space;
    const uint32_t first = p->cut[from], end = p->cut[to];
    if (p->has_moved && bodies->has_turned)
        mark_turned(bodies, first, end);
    s->solver->pass(&p->work, &s->making, first, end, p->shared, s->is_rolling, p->has_moved);
}

/* As the solver has it, law by law: points while blocks of the colour have them. */
static fp3_status run_pass(const fp3_bodies *bodies, const fp3_work2 *work, uint32_t first,
                           uint32_t end, const float shared[FP3_SHARED], int has_moved) {
    fp3_laws *laws = bodies->laws;
    const int has_friction = fp3_has_friction3(shared);
    const fp3_making3 *making = &bodies->space->making;
    fp3_status status = FP3_OK;
    for (uint32_t i = first; !status && i < end; i++) {
        const uint32_t points = making->points[i] & ~(uint32_t)FP3_HAS_TURNED;
        if (has_moved)
            status = fp3_laws_run(laws, FP3_LAW_gap3, work, i, i + 1, 0, shared);
        if (!status && has_moved && making->points[i] & FP3_HAS_TURNED)
            bodies->space->solver->renew(work, making, i);
        if (!status && has_friction && bodies->space->is_rolling)
            status = fp3_laws_run(laws, FP3_LAW_roll3, work, i, i + 1, 0, shared);
        if (!status)
            status = fp3_laws_run(laws, FP3_LAW_meet3, work, i, i + 1, 0, shared);
        for (uint32_t k = 0; !status && k < points; k++)
            status = fp3_laws_run(laws, FP3_LAW_push3, work, i, i + 1, k, shared);
        if (!status && has_friction)
            status = fp3_laws_run(laws, FP3_LAW_rub3, work, i, i + 1, 0, shared);
        if (!status)
            status = fp3_laws_run(laws, FP3_LAW_give3, work, i, i + 1, 0, shared);
    }
    return status;
}

fp3_status fp3_space_give(const fp3_passing *p, uint32_t block) {
    const fp3_bodies *bodies = p->all->bodies;
    const fp3_space *s = bodies->space;
    if (bodies->laws)
        return run_pass(bodies, &p->work, block, block + 1, p->shared, 0);
    s->solver->pass(&p->work, &s->making, block, block + 1, p->shared, s->is_rolling, 0);
    return FP3_OK;
}

void fp3_space_pass_by_engine(void *of, uint32_t from, uint32_t to) {
    const fp3_passing *p = of;
    const fp3_bodies *bodies = p->all->bodies;
    const uint32_t first = p->cut[from], end = p->cut[to];
    if (p->has_moved && bodies->has_turned)
        mark_turned(bodies, first, end);
    if (!p->all->status)
        p->all->status = run_pass(bodies, &p->work, first, end, p->shared, p->has_moved);
}

/* ---- bodies ---- */

/* Slots from .. end - 1, which begin with a block of eight. */
static void turn(const fp3_bodies *bodies, uint32_t from, uint32_t end) {
    const fp3_space *s = bodies->space;
    fp3_substeps *all = bodies->substeps;
    const fp3_work2 work = {bodies->speed, bodies->way, bodies->base,
                            bodies->slots, s->turning,  s->turning_ends};
    const uint32_t first = from / FP3_WIDE, last = (end + FP3_WIDE - 1) / FP3_WIDE;
    if (!bodies->laws)
        s->solver->turn(&work, first, last, all->shared[FP3_MEND_WAY]);
    else if (!all->status)
        all->status = fp3_laws_run(bodies->laws, FP3_LAW_turn3, &work, first, last, 0,
                                   all->shared[FP3_MEND_WAY]);
}

void fp3_space_place(void *of, uint32_t from, uint32_t to) {
    fp3_bodies *bodies = of;
    const uint32_t first = bodies->cut[from], end = bodies->cut[to];
    const float h = (float)(bodies->def.h / bodies->def.substeps);
    if (first == end)
        return;
    for (uint32_t k = first; k < end; k++)
        bodies->way[2 * k] += h * bodies->speed[2 * k] - bodies->pull[2 * k].drop;
    turn(bodies, first, end);
    fp3_space_find_turned(bodies, first, end < bodies->movable ? end : bodies->movable);
}
