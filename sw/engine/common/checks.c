/* SPDX-License-Identifier: Apache-2.0 */
/* checks.c - what calls of fp3/engine.h check first, and what they ask about an object. */
#include "checks.h"

#include "machine/storage.h"

#include <inttypes.h>
#include <stdio.h>

fp3_status fp3_engine_check_range(fp3_engine *engine, const char *what, size_t first, size_t count,
                                  size_t has) {
    if (first <= has && count <= has - first)
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "%s %zu, count %zu: configuration '%s' has %zu", what, first, count,
                    engine->config->name, has);
}

fp3_status fp3_engine_check_objects(fp3_engine *engine, size_t first, size_t count) {
    if (first <= engine->objects && count <= engine->objects - first)
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "object %zu, count %zu: there are %" PRIu32 " objects", first, count,
                    engine->objects);
}

fp3_status fp3_engine_check_loaded(fp3_engine *engine) {
    return engine->layout.groups[0].image
               ? FP3_OK
               : fp3_fail(engine->def.error, FP3_E_ARGUMENT, "no program is loaded");
}

fp3_life_stage fp3_engine_life(const fp3_engine *engine, size_t object) {
    if (object >= engine->objects)
        return FP3_GONE;
    const fp3_life *life = engine->lives.list ? &engine->lives.list[object] : NULL;
    if (engine->lives.removed && engine->lives.removed[object] & FP3_REMOVED_NOW)
        return FP3_GONE;
    return !life || (life->born <= engine->made && engine->made < life->gone) ? FP3_ALIVE
           : engine->made < life->born                                        ? FP3_UNBORN
                                                                              : FP3_GONE;
}

int fp3_engine_is_awake(const fp3_engine *engine, size_t object) {
    const fp3_members *group = fp3_layout_group_of(&engine->layout, object);
    return object - fp3_members_begin(group) < group->objects &&
           fp3_engine_life(engine, object) == FP3_ALIVE &&
           (group->program.slept < 0 || engine->sleepers.slept[object] == 0);
}

uint64_t fp3_engine_states_of(const fp3_members *group) {
    uint64_t set = 0;
    for (uint32_t i = 0; i < group->image->symbol_count; i++)
        if (group->image->symbols[i].symbol_class == FP3_SYMBOL_STATE)
            set |= (uint64_t)1 << group->image->symbols[i].index;
    const int slept = fp3_image_slept(group->image);
    const uint32_t room = 1u << group->log2;
    if (slept >= 0)
        set &= ~((uint64_t)1 << slept);
    return room < 64 ? set & (((uint64_t)1 << room) - 1) : set;
}

uint32_t fp3_engine_seed(const fp3_engine *engine) {
    return engine->config->storage ? fp3_storage_seed(engine->def.seed) : 0;
}

fp3_prefix fp3_engine_prefix(size_t group, size_t count) {
    fp3_prefix p = {""};
    if (count > 1)
        snprintf(p.text, sizeof p.text, "group %zu: ", group);
    return p;
}

fp3_status fp3_engine_illegal(fp3_engine *engine, uint32_t group, uint32_t index) {
    const fp3_code *program = &engine->layout.groups[group].program;
    return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                    "%sword %" PRIu32 " is 0x%08" PRIx32 ", no instruction of configuration '%s'",
                    fp3_engine_prefix(group, engine->layout.count).text, index - program->in_front,
                    program->code[index], engine->config->name);
}

fp3_status fp3_engine_limit(fp3_engine *engine) {
    return fp3_fail(engine->def.error, FP3_E_LIMIT, "stopped at the limit of %" PRIu64 " cycles",
                    engine->def.cycle_limit);
}
