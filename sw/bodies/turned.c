/* SPDX-License-Identifier: Apache-2.0 */
/* turned.c - bodies that have turned far in a step (passing.h).
 *
 * A substep begins with what contacts gave in the last one, which bodies have kept; passes take it
 * back at arms that have turned since. Where that would be other than what was given, a body would
 * get energy: such a body gets it from its rows, as they are now, which are made anew in each
 * substep, masses and all.
 */
#include "passing.h"

#include <string.h>

/* Where a body of mass m and inertia i has turned by t rad in this step, an arm of length r may
 * answer an impulse by 1 + m r^2/i t^2 times what its row says, which was made when the step began;
 * from 2 on a push back is more than the push. */
#define TURNED 0.25f

/* Several threads may find one. */
void fp3_find_turned(fp3_bodies *bodies, uint32_t first, uint32_t end) {
    int has = 0;
    for (uint32_t k = first; k < end; k++) {
        const float turn = bodies->way[k][2];
        if (!(turn * turn * bodies->heft[k][3] > TURNED))
            continue;
        bodies->heft[k][2] = 1;
        has = 1;
    }
    if (has)
        __atomic_store_n(&bodies->has_turned, 1, __ATOMIC_RELAXED);
}

static int is_turned(const fp3_bodies *bodies, uint32_t slot) {
    return bodies->space ? bodies->heft[FP3_FOURS3 * slot + 1][3] > 0 : bodies->heft[slot][2] > 0;
}

int fp3_block_has_turned(const fp3_bodies *bodies, uint32_t block) {
    const fp3_ends2 *ends = &bodies->contacts.ends[block];
    float has = 0;
    for (int lane = 0; lane < FP3_WIDE; lane++)
        has += bodies->heft[ends->a[lane]][2] + bodies->heft[ends->b[lane]][2];
    return has > 0;
}

void fp3_forget_turned(fp3_bodies *bodies, uint32_t first, uint32_t end) {
    const uint32_t fours = bodies->space ? FP3_FOURS3 : 1;
    for (uint32_t k = first; k < end && bodies->has_turned; k++)
        if (is_turned(bodies, k))
            memcpy(&bodies->base[fours * k], &bodies->speed[fours * k],
                   fours * sizeof *bodies->base);
}

/* In a plane two blocks at a time. */
static fp3_status give_plane(const fp3_passing *p) {
    const fp3_bodies *bodies = p->all->bodies;
    const uint32_t end =
        bodies->contacts.count ? bodies->contacts.colours.first[bodies->contacts.colours.count] : 0;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < end; i += 2) {
        if (!fp3_block_has_turned(bodies, i) && !fp3_block_has_turned(bodies, i + 1))
            continue;
        if (bodies->laws)
            status = fp3_laws_run(bodies->laws, p->law, &p->work, i, i + 2, 0, p->shared);
        else
            p->pass(&p->work, i, i + 2, p->shared);
    }
    return status;
}

static fp3_status give_space(const fp3_passing *p) {
    const fp3_space *s = p->all->bodies->space;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < s->contacts.blocks; i++)
        if (s->points[i] & FP3_HAS_TURNED)
            status = fp3_space_give(p, i);
    return status;
}

static fp3_status give_again(fp3_bodies *bodies, const fp3_passing *p) {
    const uint32_t fours = bodies->space ? FP3_FOURS3 : 1;
    const size_t count = fours * (size_t)bodies->movable;
    fp3_status status = fp3_bodies_room((void **)&bodies->before, &bodies->before_room,
                                        sizeof *bodies->before, count, bodies->error);
    if (status)
        return status;
    memcpy(bodies->before, bodies->speed, count * sizeof *bodies->before);
    status = bodies->space ? give_space(p) : give_plane(p);
    for (uint32_t k = 0; k < count; k++)
        if (!is_turned(bodies, k / fours))
            bodies->speed[k] = bodies->before[k];
    return status;
}

void fp3_give_again(void *of, uint32_t from, uint32_t to) {
    fp3_bodies *bodies = of;
    fp3_substeps *all = bodies->substeps;
    (void)from;
    (void)to;
    if (!all->status && bodies->has_turned)
        all->status = give_again(bodies, &all->pass[FP3_WARM_WAY][FP3_JOINT_LAWS]);
}
