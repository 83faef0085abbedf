/* life.c - see life.h. */
#include "life.h"

#include "checks.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

uint32_t fp3_life_steps(const fp3_engine *engine, size_t object, uint32_t steps) {
    if (!engine->lives)
        return steps;
    const fp3_life *life = &engine->lives[object];
    const uint64_t end = engine->made + steps;
    const uint64_t from = life->born > engine->made ? life->born : engine->made;
    const uint64_t to = life->gone < end ? life->gone : end;
    return to > from ? (uint32_t)(to - from) : 0;
}

/* The next step after which somebody is born or gone. */
static void find_change(fp3_engine *engine) {
    engine->change = FP3_FOREVER;
    engine->is_any_alive = 0;
    for (size_t i = 0; i < engine->objects; i++) {
        const fp3_life *life = &engine->lives[i];
        const uint64_t change = engine->made < life->born ? life->born : life->gone;
        if (engine->made < change && change < engine->change)
            engine->change = change;
        engine->is_any_alive |= life->born <= engine->made && engine->made < life->gone;
    }
}

uint32_t fp3_life_part(fp3_engine *engine, uint32_t steps, int *is_any) {
    *is_any = 1;
    if (!engine->lives)
        return steps;
    if (engine->made >= engine->change) {
        engine->is_listed = 0;
        find_change(engine);
    }
    *is_any = engine->is_any_alive;
    return engine->change - engine->made < steps ? (uint32_t)(engine->change - engine->made)
                                                 : steps;
}

/* ---- lifetimes ---- */

static fp3_status make_room(fp3_engine *engine) {
    const uint32_t schedulers = fp3_config_schedulers(engine->config);
    engine->lives = malloc(engine->objects * sizeof *engine->lives);
    engine->sums = calloc(schedulers, sizeof *engine->sums);
    if (!engine->lives || !engine->sums) {
        fp3_life_forget(engine);
        return fp3_fail(engine->def.error, FP3_E_SYSTEM, "out of memory");
    }
    for (uint32_t i = 0; i < engine->objects; i++)
        engine->lives[i] = (fp3_life){0, FP3_FOREVER};
    return FP3_OK;
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
    if (!status && engine->config->interleave && !engine->config->sleep)
        status = fp3_fail(engine->def.error, FP3_E_PROGRAM,
                          "configuration '%s' has no sleep: all its objects make all steps",
                          engine->config->name);
    return status;
}

fp3_status fp3_engine_live(fp3_engine *engine, size_t first, size_t count, uint64_t born,
                           uint64_t gone) {
    fp3_status status = check(engine, first, count, born, gone);
    if (!status && !engine->lives && (born || gone != FP3_FOREVER))
        status = make_room(engine);
    if (status || !engine->lives)
        return status;
    for (size_t i = first; i < first + count; i++)
        engine->lives[i] = (fp3_life){born, gone};
    engine->change = 0;
    engine->is_listed = 0;
    return FP3_OK;
}

fp3_status fp3_life_copy(const fp3_engine *engine, fp3_engine *to) {
    fp3_status status = engine->lives ? make_room(to) : FP3_OK;
    if (!status && engine->lives)
        memcpy(to->lives, engine->lives, to->objects * sizeof *to->lives);
    return status;
}

void fp3_life_forget(fp3_engine *engine) {
    free(engine->lives);
    free(engine->sums);
    engine->lives = NULL;
    engine->sums = NULL;
    engine->change = 0;
}

/* ---- counters ---- */

void fp3_life_add_counters(fp3_engine *engine) {
    for (uint32_t s = 0; engine->sums && s < fp3_config_schedulers(engine->config); s++)
        for (int i = 0; i < FP3_COUNTER_COUNT; i++)
            engine->sums[s][i] += engine->counters[s][i];
}

void fp3_life_take_counters(fp3_engine *engine) {
    const size_t size = fp3_config_schedulers(engine->config) * sizeof *engine->counters;
    if (!engine->sums)
        return;
    memcpy(engine->counters, engine->sums, size);
    memset(engine->sums, 0, size);
}
