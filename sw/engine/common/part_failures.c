/* SPDX-License-Identifier: Apache-2.0 */
/* part_failures.c - see part_failures.h. */
#include "part_failures.h"

#include <stdlib.h>

static uint64_t later(uint64_t step, uint32_t began) {
    return step == FP3_NEVER ? FP3_NEVER : step + began;
}

/* Of an object: the first exception and the first stray state of all parts; whether it is astray at
 * the end only the last part says. */
static void merge(fp3_watched *all, const fp3_watched *part) {
    if (all->raised == FP3_NEVER) {
        all->raised = part->raised;
        all->flags = part->flags;
        all->partner = part->partner;
    }
    if (all->strayed == FP3_NEVER) {
        all->strayed = part->strayed;
        all->reg = part->reg;
        all->bits = part->bits;
    }
    all->is_astray = part->is_astray;
}

/* Both are in the order of objects. */
static size_t merge_all(const fp3_engine *engine, const fp3_failed *part, size_t count,
                        fp3_failed *to) {
    const fp3_failed *all = engine->failures.list;
    size_t made = 0;
    for (size_t i = 0, k = 0; i < engine->failures.count || k < count; made++) {
        const int is_old =
            i < engine->failures.count && (k == count || all[i].object <= part[k].object);
        const int is_new = k < count && (!is_old || all[i].object == part[k].object);
        to[made] = is_old ? all[i] : part[k];
        if (is_old && is_new)
            merge(&to[made].watched, &part[k].watched);
        else if (is_old)
            to[made].watched.is_astray = 0;
        i += (size_t)is_old;
        k += (size_t)is_new;
    }
    return made;
}

/* An object whose state strayed on the way, and came back without an exception, has not failed, and
 * neither has one that was removed before. */
static size_t leave_out(const fp3_engine *engine, fp3_failed *list, size_t count) {
    const uint8_t *removed = engine->lives.removed;
    size_t left = 0;
    for (size_t i = 0; i < count; i++) {
        const fp3_watched *w = &list[i].watched;
        const int has_raised = engine->config->flags && w->raised != FP3_NEVER;
        const int is_left = !removed || !(removed[list[i].object] & FP3_REMOVED_BEFORE);
        if (is_left && (w->is_astray || has_raised))
            list[left++] = list[i];
    }
    return left;
}

fp3_status fp3_part_failures_add(fp3_engine *engine, uint32_t began) {
    fp3_failed *part = NULL;
    size_t count = 0;
    fp3_status status = engine->backend->failures(engine, &part, &count);
    fp3_failed *all = status ? NULL : calloc(engine->failures.count + count + 1, sizeof *all);
    if (!status && !all)
        status = fp3_no_memory(engine->def.error);
    for (size_t i = 0; !status && i < count; i++) {
        part[i].watched.raised = later(part[i].watched.raised, began);
        part[i].watched.strayed = later(part[i].watched.strayed, began);
    }
    if (!status) {
        engine->failures.count = leave_out(engine, all, merge_all(engine, part, count, all));
        free(engine->failures.list);
        engine->failures.list = all;
    }
    free(part);
    return status;
}
