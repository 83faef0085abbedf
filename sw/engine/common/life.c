/* SPDX-License-Identifier: Apache-2.0 */
/* life.c - see life.h. */
#include "life.h"

#include "cells.h"
#include "checks.h"
#include "living.h"
#include "origin.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

uint32_t fp3_life_steps(const fp3_engine *engine, size_t object, uint32_t steps) {
    if (engine->lives.removed && engine->lives.removed[object] & FP3_REMOVED_NOW)
        return 0;
    if (!engine->lives.list)
        return steps;
    const fp3_life *life = &engine->lives.list[object];
    const uint64_t end = engine->made + steps;
    const uint64_t from = life->born > engine->made ? life->born : engine->made;
    const uint64_t to = life->gone < end ? life->gone : end;
    return to > from ? (uint32_t)(to - from) : 0;
}

/* The next step after which an object is born or gone. */
static void find_change(fp3_engine *engine) {
    engine->lives.change = FP3_FOREVER;
    engine->lives.is_any = 0;
    for (size_t i = 0; i < engine->objects; i++) {
        const fp3_life always = {0, FP3_FOREVER};
        const fp3_life *life = engine->lives.list ? &engine->lives.list[i] : &always;
        const uint64_t change = engine->made < life->born ? life->born : life->gone;
        if (engine->made < change && change < engine->lives.change)
            engine->lives.change = change;
        engine->lives.is_any |= fp3_engine_life(engine, i) == FP3_ALIVE;
    }
}

uint32_t fp3_life_part(fp3_engine *engine, uint32_t steps, int *is_any) {
    *is_any = 1;
    if (!fp3_lives_vary(engine))
        return steps;
    if (engine->made >= engine->lives.change) {
        engine->sleepers.is_listed = 0;
        find_change(engine);
    }
    *is_any = engine->lives.is_any;
    if (engine->lives.removed && *is_any)
        return 1;
    return engine->lives.change - engine->made < steps
               ? (uint32_t)(engine->lives.change - engine->made)
               : steps;
}

/* ---- a load ---- */

fp3_status fp3_life_begin(fp3_engine *engine) {
    int is_any = 0;
    fp3_life_forget(engine);
    for (uint32_t i = 0; i < engine->layout.count; i++)
        is_any |= engine->layout.groups[i].removed >= 0;
    if (is_any)
        engine->lives.removed = calloc(engine->objects, sizeof *engine->lives.removed);
    return !is_any || engine->lives.removed ? FP3_OK : fp3_no_memory(engine->def.error);
}

/* ---- lifetimes ---- */

static fp3_status make_room(fp3_engine *engine) {
    engine->lives.list = malloc(engine->objects * sizeof *engine->lives.list);
    if (!engine->lives.list)
        return fp3_no_memory(engine->def.error);
    for (uint32_t i = 0; i < engine->objects; i++)
        engine->lives.list[i] = (fp3_life){0, FP3_FOREVER};
    return FP3_OK;
}

/* Hardware visits as many objects of each lane as the host says: those that see each other are put
 * in order for it, the living in front. */
static int sees_others(const fp3_engine *engine, size_t first, size_t count) {
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        const int is_of_group =
            first < group->first + (size_t)group->rows && first + count > group->first;
        if (is_of_group && !group->lists.shape.is_any)
            return 0;
    }
    return 1;
}

static fp3_status check(fp3_engine *engine, size_t first, size_t count, uint64_t born,
                        uint64_t gone) {
    fp3_status status = fp3_engine_check_loaded(engine);
    if (!status)
        status = fp3_engine_check_objects(engine, first, count);
    if (!status && gone <= born)
        status = fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                          "gone after step %" PRIu64 ": expected a step after %" PRIu64
                          ", that of the birth",
                          gone, born);
    if (!status && engine->config->interleave && !engine->config->sleep &&
        !fp3_layout_is_joined(&engine->layout) && !sees_others(engine, first, count))
        status = fp3_fail(engine->def.error, FP3_E_PROGRAM,
                          "configuration '%s' has no sleep: all its objects make all steps",
                          engine->config->name);
    return status;
}

static fp3_status live(fp3_engine *engine, size_t first, size_t count, uint64_t born,
                       uint64_t gone) {
    fp3_status status = FP3_OK;
    if (!engine->lives.list && (born || gone != FP3_FOREVER))
        status = make_room(engine);
    if (status || !engine->lives.list)
        return status;
    for (size_t i = first; i < first + count; i++)
        engine->lives.list[i] = (fp3_life){born, gone};
    engine->origin->is_complete = 0; /* the run could not be made again */
    engine->lives.change = 0;
    engine->sleepers.is_listed = 0;
    return FP3_OK;
}

fp3_status fp3_engine_live(fp3_engine *engine, size_t first, size_t count, uint64_t born,
                           uint64_t gone) {
    fp3_status status = check(engine, first, count, born, gone);
    return status ? status : live(engine, first, count, born, gone);
}

/* ---- births and ends between runs ---- */

fp3_status fp3_engine_can_bury(fp3_engine *engine) {
    return check(engine, 0, engine->objects, 0, FP3_FOREVER);
}

fp3_status fp3_engine_bear(fp3_engine *engine, size_t first, size_t count) {
    return live(engine, first, count, 0, FP3_FOREVER);
}

fp3_status fp3_engine_unborn(fp3_engine *engine, size_t first, size_t count) {
    return live(engine, first, count, FP3_FOREVER - 1, FP3_FOREVER);
}

/* Those that stay live as before. */
static fp3_status end_lives(fp3_engine *engine, const uint8_t *stays) {
    fp3_status status = FP3_OK;
    for (size_t i = 0, end; !status && i < engine->objects; i = end) {
        for (end = i + 1; end < engine->objects && !stays[end] == !stays[i]; end++)
            ;
        if (!stays[i])
            status = fp3_engine_unborn(engine, i, end - i);
    }
    return status;
}

fp3_status fp3_engine_bury(fp3_engine *engine, const uint8_t *stays) {
    fp3_status status = end_lives(engine, stays);
    if (!status && engine->layout.groups[0].rest >= 0)
        status = engine->backend->list(engine); /* whoever leaned on them wakes */
    return status ? status : fp3_living_forget(engine, stays);
}

/* The registers that a visit leaves, and the status: as before the first write. */
fp3_status fp3_engine_wipe(fp3_engine *engine, size_t first, size_t count) {
    const fp3_members *group = fp3_layout_group_of(&engine->layout, first);
    const uint64_t kept = group->visit ? group->visit->kept : UINT64_MAX;
    fp3_status status = FP3_OK;
    for (uint32_t reg = 0; !status && reg < engine->config->registers; reg++)
        if (kept >> reg & 1 && !(reg >> group->log2))
            status = fp3_cells_fill(engine, (fp3_cells){FP3_CELLS_REGISTER, reg, first, count}, 0);
    return status || !engine->config->status
               ? status
               : fp3_cells_fill(engine, (fp3_cells){FP3_CELLS_STATUS, 0, first, count}, 0);
}

int fp3_life_took_part(const fp3_engine *engine, size_t object) {
    const fp3_life *life = engine->lives.list ? &engine->lives.list[object] : NULL;
    if (engine->lives.removed && engine->lives.removed[object] & FP3_REMOVED_BEFORE)
        return 0;
    return !life || (life->born <= engine->made && life->gone > engine->origin->made);
}

void fp3_engine_life_of(const fp3_engine *engine, size_t object, uint64_t *born, uint64_t *gone) {
    const fp3_life always = {0, FP3_FOREVER};
    const fp3_life *life = engine->lives.list ? &engine->lives.list[object] : &always;
    *born = life->born;
    *gone = life->gone;
}

void fp3_engine_resume(fp3_engine *engine, uint64_t made) {
    engine->made = made;
    engine->clock = (uint32_t)made;
    engine->lives.change = 0;
    engine->sleepers.is_listed = engine->sleepers.is_known = engine->is_counted = 0;
}

fp3_status fp3_life_copy(const fp3_engine *engine, fp3_engine *to) {
    fp3_status status = engine->lives.list ? make_room(to) : FP3_OK;
    if (!status && engine->lives.list)
        memcpy(to->lives.list, engine->lives.list, to->objects * sizeof *to->lives.list);
    return status;
}

void fp3_life_forget(fp3_engine *engine) {
    free(engine->lives.list);
    free(engine->lives.removed);
    engine->lives = (fp3_lives){0};
}

void fp3_engine_use(fp3_engine *engine, size_t first, size_t count) {
    fp3_members_use(&engine->layout.groups[0], (uint32_t)first, (uint32_t)count);
    engine->sleepers.is_listed = engine->sleepers.is_known = engine->is_counted = 0;
    engine->origin->is_complete = 0;
}
