/* SPDX-License-Identifier: Apache-2.0 */
/* events.c - which contacts began and ended. */
#include "own.h"

#include "base/host.h"

#include <stdatomic.h>
#include <stdlib.h>

#define SLOP 0.005 /* share of `size`: shapes nearer than this touch */

static fp3_contact contact_of(const fp3_bodies *bodies, const fp3_touch2 *t) {
    const fp3_attached *a = &bodies->shape[t->a], *b = &bodies->shape[t->b];
    return (fp3_contact){
        .body_a = fp3_bodies_handle(bodies, a->body),
        .body_b = fp3_bodies_handle(bodies, b->body),
        .shape_a = (uint64_t)a->generation << 32 | t->a,
        .shape_b = (uint64_t)b->generation << 32 | t->b,
        .point = {t->at[0], t->at[1], t->at[2]},
        .normal = {t->normal[0], t->normal[1], t->normal[2]},
        .speed = t->approach,
        .impulse = t->top,
    };
}

fp3_status fp3_contact_tell(fp3_bodies *bodies, fp3_contact_change change, const fp3_touch2 *t) {
    const uint32_t count = bodies->change_count[change];
    const fp3_status status =
        fp3_bodies_room((void **)&bodies->change[change], &bodies->change_room[change],
                        sizeof *bodies->change[change], count + 1u, bodies->error);
    if (status)
        return status;
    fp3_contact *to = &bodies->change[change][count];
    *to = contact_of(bodies, t);
    if (change == FP3_CONTACT_ENDED)
        to->speed = to->impulse = 0;
    bodies->change_count[change]++;
    return FP3_OK;
}

static int touches(const fp3_bodies *bodies, const fp3_touch2 *t) {
    const float slop = (float)(SLOP * bodies->def.size);
    int is = t->top > 0;
    for (uint32_t k = 0; k < t->m.count; k++)
        is |= t->m.point[k].gap < slop;
    return t->m.count && is;
}

/* By the numbers of both shapes. What is no pair any more is told when pairs are looked for, before
 * the others. */
static int by_shapes(const void *a, const void *b) {
    const fp3_contact *x = a, *y = b;
    const uint64_t s = (x->shape_a << 32) | (uint32_t)x->shape_b,
                   t = (y->shape_a << 32) | (uint32_t)y->shape_b;
    return (s > t) - (s < t);
}

typedef struct {
    const fp3_bodies *bodies;
    atomic_uint touching, changes;
} counting;

static void count_some(void *of, uint32_t from, uint32_t to) {
    counting *all = of;
    uint32_t touching = 0, changes = 0;
    for (uint32_t k = from; k < to; k++) {
        const fp3_touch2 *t = &all->bodies->touch[k];
        const int is_touching = touches(all->bodies, t);
        touching += (uint32_t)is_touching;
        changes += is_touching != t->is_touching;
    }
    atomic_fetch_add(&all->touching, touching);
    atomic_fetch_add(&all->changes, changes);
}

fp3_status fp3_contacts_tell(fp3_bodies *bodies) {
    fp3_status status = FP3_OK;
    counting all = {bodies, 0, 0};
    fp3_bodies_share(bodies, count_some, &all, bodies->touch_count, FP3_LEAST_PAIRS);
    bodies->touching = all.touching;
    for (uint32_t k = 0; !status && all.changes && k < bodies->touch_count; k++) {
        fp3_touch2 *t = &bodies->touch[k];
        const int is_touching = touches(bodies, t);
        if (is_touching == t->is_touching)
            continue;
        status = fp3_contact_tell(bodies, is_touching ? FP3_CONTACT_BEGAN : FP3_CONTACT_ENDED, t);
        if (!status && is_touching && t->approach > (float)bodies->def.bounce)
            status = fp3_contact_tell(bodies, FP3_CONTACT_HIT, t);
        if (!status)
            t->is_touching = is_touching;
    }
    if (bodies->change_count[FP3_CONTACT_ENDED] > bodies->ended_before)
        qsort(bodies->change[FP3_CONTACT_ENDED] + bodies->ended_before,
              bodies->change_count[FP3_CONTACT_ENDED] - bodies->ended_before, sizeof(fp3_contact),
              by_shapes);
    return status;
}

fp3_status fp3_bodies_changes(fp3_bodies *bodies, fp3_contact_change change,
                              const fp3_contact **list, size_t *count) {
    if (change < FP3_CONTACT_BEGAN || change > FP3_CONTACT_HIT)
        return fp3_fail(bodies->error, FP3_E_ARGUMENT, "there is no change %d of a contact",
                        (int)change);
    *list = bodies->change[change];
    *count = bodies->change_count[change];
    return FP3_OK;
}

fp3_status fp3_bodies_contacts(fp3_bodies *bodies, const fp3_contact **list, size_t *count) {
    FP3_HOST;
    size_t found = 0;
    const fp3_status status =
        fp3_bodies_room((void **)&bodies->now, &bodies->now_room, sizeof *bodies->now,
                        bodies->touch_count + 1u, bodies->error);
    for (uint32_t k = 0; !status && k < bodies->touch_count; k++)
        if (bodies->touch[k].is_touching)
            bodies->now[found++] = contact_of(bodies, &bodies->touch[k]);
    *list = bodies->now;
    *count = found;
    return status;
}
