/* SPDX-License-Identifier: Apache-2.0 */
/* object_status.c - flags of objects, and their sleep. */
#include "engine/common/cells.h"
#include "engine/common/checks.h"

#include "gen/registers.h"

#define BLOCK 512 /* objects that are asked at once */

static fp3_status read_slept(fp3_engine *engine, size_t first, size_t count,
                             fp3_object_status *to) {
    uint32_t words[BLOCK];
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        const fp3_cells cells = fp3_cells_of(group, (uint32_t)group->program.slept, first, count);
        if (group->program.slept < 0 || !cells.count)
            continue;
        status = engine->backend->read(engine, cells, words);
        for (size_t n = 0; !status && n < cells.count; n++)
            to[cells.first - first + n].slept = words[n];
    }
    return status;
}

static fp3_status read_block(fp3_engine *engine, size_t first, size_t count,
                             fp3_object_status *to) {
    uint32_t words[BLOCK] = {0};
    const fp3_cells cells = {FP3_CELLS_STATUS, 0, first, count};
    const fp3_status status =
        engine->config->status ? engine->backend->read(engine, cells, words) : FP3_OK;
    for (size_t i = 0; i < count; i++)
        to[i] = (fp3_object_status){.flags = words[i] & ((2u << FP3_STATUS_FLAGS_HI) - 1),
                                    .failed = words[i] >> FP3_STATUS_STEP_LO};
    return status ? status : read_slept(engine, first, count, to);
}

fp3_status fp3_engine_status(fp3_engine *engine, size_t first, size_t count,
                             fp3_object_status *status) {
    fp3_status result = fp3_engine_check_objects(engine, first, count);
    for (size_t done = 0; !result && done < count; done += BLOCK)
        result = read_block(engine, first + done, count - done < BLOCK ? count - done : BLOCK,
                            &status[done]);
    return result;
}

static fp3_status check_kept(fp3_engine *engine) {
    return engine->config->status ? FP3_OK
                                  : fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                                             "configuration '%s' keeps no status of its objects",
                                             engine->config->name);
}

fp3_status fp3_engine_read_status(fp3_engine *engine, uint32_t *words) {
    const fp3_status status = check_kept(engine);
    return status ? status
                  : engine->backend->read(
                        engine, (fp3_cells){FP3_CELLS_STATUS, 0, 0, engine->objects}, words);
}

fp3_status fp3_engine_write_status(fp3_engine *engine, const uint32_t *words) {
    const fp3_status status = check_kept(engine);
    return status ? status
                  : fp3_cells_write(engine, (fp3_cells){FP3_CELLS_STATUS, 0, 0, engine->objects},
                                    words);
}

fp3_status fp3_engine_clear_status(fp3_engine *engine, size_t first, size_t count) {
    fp3_status status = fp3_engine_check_objects(engine, first, count);
    if (!status)
        status = check_kept(engine);
    return status ? status
                  : fp3_cells_fill(engine, (fp3_cells){FP3_CELLS_STATUS, 0, first, count}, 0);
}

static fp3_status set_slept(fp3_engine *engine, size_t first, size_t count, uint32_t bits) {
    const fp3_layout *layout = &engine->layout;
    fp3_status status = fp3_engine_check_loaded(engine);
    if (!status)
        status = fp3_engine_check_objects(engine, first, count);
    for (uint32_t i = 0; !status && i < layout->count; i++) {
        const fp3_cells cells = fp3_cells_of(&layout->groups[i], 0, first, count);
        if (cells.count && layout->groups[i].program.slept < 0)
            status = fp3_fail(engine->def.error, FP3_E_PROGRAM,
                              "the program has no sleep: that of object %zu", cells.first);
    }
    for (uint32_t i = 0; !status && i < layout->count; i++) {
        const fp3_members *group = &layout->groups[i];
        const uint32_t slept = (uint32_t)group->program.slept;
        status = fp3_cells_fill(engine, fp3_cells_of(group, slept, first, count), bits);
    }
    return status;
}

fp3_status fp3_engine_wake(fp3_engine *engine, size_t first, size_t count) {
    return set_slept(engine, first, count, 0);
}

fp3_status fp3_engine_remove(fp3_engine *engine, size_t first, size_t count) {
    return set_slept(engine, first, count, FP3_REMOVED);
}
