/* SPDX-License-Identifier: Apache-2.0 */
/* count.c - objects are asked once, then the host counts along. */
#include "count.h"

#include "cells.h"
#include "checks.h"
#include "life.h"
#include "machine/format.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#define BLOCK 512 /* objects that are asked at once */

/* What counts, in messages. */
static const char *who(const fp3_engine *engine) {
    return fp3_format_counts(engine->config) == FP3_STEPS_LIMIT ? "FP32" : engine->config->name;
}

static fp3_status no_count(fp3_engine *engine, size_t object, float n) {
    const int64_t limit = fp3_format_counts(engine->config);
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "object %zu: '" FP3_NAME_STEPS "' is %.9g, expected a whole number from "
                    "-%" PRId64 " to %" PRId64 ": that far %s counts",
                    object, (double)n, limit, limit, who(engine));
}

static fp3_status check(fp3_engine *engine, uint32_t group, int64_t counted, uint32_t steps) {
    const int64_t limit = fp3_format_counts(engine->config);
    if (counted + steps <= limit)
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "%s%" PRIu32 " steps from '" FP3_NAME_STEPS "' = %" PRId64
                    " on: the program counts its steps in %s, which ends at %" PRId64
                    " (a longer step h reaches a later time)",
                    fp3_engine_prefix(group, engine->layout.count).text, steps, counted,
                    who(engine), limit);
}

/* Each object makes the steps that it lives to see. */
static fp3_status note(fp3_engine *engine, uint32_t number, size_t object, float n,
                       uint32_t steps) {
    fp3_members *group = &engine->layout.groups[number];
    const uint32_t lives = fp3_life_steps(engine, object, steps);
    const float off = fp3_format_is_float(engine->config) ? 0 : (float)FP3_FORMAT_OFF;
    const float whole = rintf(n);
    if (!(fabsf(whole) <= (float)fp3_format_counts(engine->config) && fabsf(n - whole) <= off))
        return no_count(engine, object, n);
    group->counted = (int64_t)whole > group->counted ? (int64_t)whole : group->counted;
    return fp3_lives_vary(engine) && lives ? check(engine, number, (int64_t)whole, lives) : FP3_OK;
}

static fp3_status ask(fp3_engine *engine, uint32_t number, uint32_t steps) {
    fp3_members *group = &engine->layout.groups[number];
    const size_t end = (size_t)group->first + group->objects;
    uint32_t n[BLOCK];
    fp3_status status = FP3_OK;
    group->counted = -FP3_STEPS_LIMIT;
    for (size_t first = group->first; !status && first < end; first += BLOCK) {
        const fp3_cells cells = fp3_cells_of(group, (uint32_t)group->counter, first, BLOCK);
        status = engine->backend->read(engine, cells, n);
        for (size_t i = 0; !status && i < cells.count; i++)
            status = note(engine, number, first + i, fp3_format_value(engine->config, n[i]), steps);
    }
    return status;
}

fp3_status fp3_engine_check_count(fp3_engine *engine, uint32_t steps) {
    const int has_lives = fp3_lives_vary(engine);
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
        if (group->counter >= 0 && (group->program.slept >= 0 || group->rest >= 0))
            engine->is_counted = 0;
    }
}
