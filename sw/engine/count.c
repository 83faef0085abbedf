/* count.c - objects are asked once, then the host counts along. */
#include "count.h"

#include "cells.h"
#include "checks.h"
#include "life.h"
#include "machine/storage.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#define BLOCK 512 /* objects that are asked at once */

static fp3_status no_count(fp3_engine *engine, size_t object, float n) {
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "object %zu: '" FP3_NAME_STEPS "' is %.9g, expected a whole number from -%d to "
                    "%d: that far FP32 counts",
                    object, (double)n, FP3_STEPS_LIMIT, FP3_STEPS_LIMIT);
}

/* How far records and FP32 count. */
static int64_t limit_of(const fp3_engine *engine) { return fp3_storage_counts(engine->config); }

static fp3_status check(fp3_engine *engine, uint32_t group, int64_t counted, uint32_t steps) {
    if (counted + steps <= limit_of(engine))
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "%s%" PRIu32 " steps from '" FP3_NAME_STEPS "' = %" PRId64
                    " on: the program counts its steps in %s, which ends at %" PRId64
                    " (a longer step h reaches a later time)",
                    fp3_engine_prefix(group, engine->layout.count).text, steps, counted,
                    engine->config->storage ? fp3_storage_name(engine->config) : "FP32",
                    limit_of(engine));
}

/* Each object makes the steps that it lives to see. */
static fp3_status note(fp3_engine *engine, uint32_t number, size_t object, float n,
                       uint32_t steps) {
    fp3_members *group = &engine->layout.groups[number];
    const uint32_t lives = fp3_life_steps(engine, object, steps);
    if (!(fabsf(n) <= FP3_STEPS_LIMIT && floorf(n) == n))
        return no_count(engine, object, n);
    group->counted = (int64_t)n > group->counted ? (int64_t)n : group->counted;
    return engine->lives.list && lives ? check(engine, number, (int64_t)n, lives) : FP3_OK;
}

static fp3_status ask(fp3_engine *engine, uint32_t number, uint32_t steps) {
    fp3_members *group = &engine->layout.groups[number];
    const size_t end = (size_t)group->first + group->objects;
    float n[BLOCK];
    fp3_status status = FP3_OK;
    group->counted = -FP3_STEPS_LIMIT;
    for (size_t first = group->first; !status && first < end; first += BLOCK) {
        const fp3_cells cells = fp3_cells_of(group, (uint32_t)group->counter, first, BLOCK);
        status = engine->backend->read(engine, cells, n);
        for (size_t i = 0; !status && i < cells.count; i++)
            status = note(engine, number, first + i, n[i], steps);
    }
    return status;
}

fp3_status fp3_engine_check_count(fp3_engine *engine, uint32_t steps) {
    const int has_lives = engine->lives.list != NULL;
    fp3_status status = FP3_OK;
    if (!steps)
        return FP3_OK;
    for (uint32_t i = 0; !status && (has_lives || !engine->is_counted) && i < engine->layout.count;
         i++)
        if (engine->layout.groups[i].counter >= 0)
            status = ask(engine, i, steps);
    engine->is_counted = !status && !has_lives;
    for (uint32_t i = 0; !status && !has_lives && i < engine->layout.count; i++)
        if (engine->layout.groups[i].counter >= 0)
            status = check(engine, i, engine->layout.groups[i].counted, steps);
    return status;
}

/* Objects that fall asleep stop counting: those are asked again. */
void fp3_engine_count(fp3_engine *engine, uint32_t steps) {
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        fp3_members *group = &engine->layout.groups[i];
        group->counted += steps;
        if (group->counter >= 0 && group->program.slept >= 0)
            engine->is_counted = 0;
    }
}
