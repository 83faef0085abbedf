/* count.c - objects are asked once, then the host counts along. */
#include "count.h"

#include "checks.h"
#include "life.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

static fp3_status no_count(fp3_engine *engine, size_t object, float n) {
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "object %zu: '" FP3_NAME_STEPS "' is %.9g, expected a whole number from -%d to "
                    "%d: that far FP32 counts",
                    object, (double)n, FP3_STEPS_LIMIT, FP3_STEPS_LIMIT);
}

static fp3_status read_count(fp3_engine *engine, const fp3_members *group, size_t object,
                             int64_t *count) {
    uint32_t bits = 0;
    float n;
    fp3_status status = engine->backend->read(engine, object, (uint32_t)group->counter, &bits);
    memcpy(&n, &bits, sizeof n);
    if (!status && !(fabsf(n) <= FP3_STEPS_LIMIT && floorf(n) == n))
        return no_count(engine, object, n);
    *count = status ? 0 : (int64_t)n;
    return status;
}

static fp3_status ask(fp3_engine *engine, fp3_members *group) {
    fp3_status status = FP3_OK;
    group->counted = -FP3_STEPS_LIMIT;
    for (size_t i = group->first; !status && i < group->first + group->objects; i++) {
        int64_t n = 0;
        status = read_count(engine, group, i, &n);
        group->counted = n > group->counted ? n : group->counted;
    }
    return status;
}

static fp3_status ask_all(fp3_engine *engine) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && !engine->is_counted && i < engine->layout.count; i++)
        if (engine->layout.groups[i].counter >= 0)
            status = ask(engine, &engine->layout.groups[i]);
    engine->is_counted = !status;
    return status;
}

static fp3_status check(fp3_engine *engine, uint32_t group, int64_t counted, uint32_t steps) {
    if (counted + steps <= FP3_STEPS_LIMIT)
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "%s%" PRIu32 " steps from '" FP3_NAME_STEPS "' = %" PRId64
                    " on: the program counts its steps in FP32, which ends at %d (a longer step h "
                    "reaches a later time)",
                    fp3_engine_prefix(group, engine->layout.count).text, steps, counted,
                    FP3_STEPS_LIMIT);
}

/* Each object makes the steps that it lives to see. */
static fp3_status check_lives(fp3_engine *engine, uint32_t number, uint32_t steps) {
    const fp3_members *group = &engine->layout.groups[number];
    fp3_status status = FP3_OK;
    for (size_t i = group->first; !status && i < group->first + group->objects; i++) {
        const uint32_t lives = fp3_life_steps(engine, i, steps);
        int64_t n = 0;
        status = read_count(engine, group, i, &n);
        if (!status && lives)
            status = check(engine, number, n, lives);
    }
    return status;
}

fp3_status fp3_engine_check_count(fp3_engine *engine, uint32_t steps) {
    fp3_status status = steps && !engine->lives ? ask_all(engine) : FP3_OK;
    for (uint32_t i = 0; !status && steps && i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        if (group->counter >= 0)
            status = engine->lives ? check_lives(engine, i, steps)
                                   : check(engine, i, group->counted, steps);
    }
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
