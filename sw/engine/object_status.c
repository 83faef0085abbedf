/* object_status.c - flags of objects, and their sleep. */
#include "cells.h"
#include "checks.h"

#include "gen/registers.h"

static fp3_status read_status(fp3_engine *engine, size_t object, fp3_object_status *status) {
    uint32_t word = 0;
    fp3_status result =
        engine->config->status ? engine->backend->read_status(engine, object, &word) : FP3_OK;
    *status = (fp3_object_status){.flags = word & ((2u << FP3_STATUS_FLAGS_HI) - 1),
                                  .failed = word >> FP3_STATUS_STEP_LO};
    const int slept = fp3_engine_slept_of(engine, object);
    if (!result && slept >= 0)
        result = engine->backend->read(engine, object, (uint32_t)slept, &status->slept);
    return result;
}

fp3_status fp3_engine_status(fp3_engine *engine, size_t first, size_t count,
                             fp3_object_status *status) {
    fp3_status result = fp3_engine_check_objects(engine, first, count);
    for (size_t i = 0; !result && i < count; i++)
        result = read_status(engine, first + i, &status[i]);
    return result;
}

fp3_status fp3_engine_clear_status(fp3_engine *engine, size_t first, size_t count) {
    fp3_status status = fp3_engine_check_objects(engine, first, count);
    if (!status && !engine->config->status)
        status =
            fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                     "configuration '%s' keeps no status of its objects", engine->config->name);
    for (size_t i = 0; !status && i < count; i++)
        status = engine->backend->write_status(engine, first + i, 0);
    return status;
}

static fp3_status set_slept(fp3_engine *engine, size_t first, size_t count, uint32_t bits) {
    fp3_status status = fp3_engine_check_loaded(engine);
    if (!status)
        status = fp3_engine_check_objects(engine, first, count);
    for (size_t i = 0; !status && i < count; i++)
        if (fp3_engine_slept_of(engine, first + i) < 0)
            status = fp3_fail(engine->def.error, FP3_E_PROGRAM,
                              "the program has no sleep: that of object %zu", first + i);
    for (size_t i = 0; !status && i < count; i++)
        status = fp3_engine_write_cell(engine, first + i,
                                       (uint32_t)fp3_engine_slept_of(engine, first + i), bits);
    return status;
}

fp3_status fp3_engine_wake(fp3_engine *engine, size_t first, size_t count) {
    return set_slept(engine, first, count, 0);
}

fp3_status fp3_engine_remove(fp3_engine *engine, size_t first, size_t count) {
    return set_slept(engine, first, count, FP3_REMOVED);
}
