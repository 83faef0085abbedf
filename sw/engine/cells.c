/* cells.c - registers and constants, by number and by name. */
#include "cells.h"
#include "checks.h"
#include "origin.h"

#include <inttypes.h>
#include <string.h>

static fp3_status check_cell(fp3_engine *engine, size_t first, size_t count, uint32_t reg) {
    fp3_status status = fp3_engine_check_objects(engine, first, count);
    if (!status)
        status = fp3_engine_check_range(engine, "register", reg, 1, engine->config->registers);
    for (uint32_t i = 0; !status && i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        const int is_asked =
            first < (size_t)group->first + group->objects && first + count > group->first;
        if (is_asked && reg >> group->log2)
            status =
                fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                         "register %" PRIu32 ": the store of configuration '%s' has room for %u "
                         "registers of each of %" PRIu32 " objects",
                         reg, engine->config->name, 1u << group->log2, group->objects);
    }
    return status;
}

fp3_status fp3_engine_write_cell(fp3_engine *engine, size_t object, uint32_t reg, uint32_t bits) {
    const int slept = fp3_engine_slept_of(engine, object);
    if (slept >= 0 && reg == (uint32_t)slept) {
        engine->slept[object] = bits;
        engine->is_listed = 0;
    }
    if (fp3_engine_counter_of(engine, object) == (int)reg)
        engine->is_counted = 0;
    engine->is_touched = 1;
    fp3_origin_write(engine, object, reg, bits);
    return engine->backend->write(engine, object, reg, bits);
}

fp3_status fp3_engine_write(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                            const float *values) {
    fp3_status status = check_cell(engine, first, count, reg);
    for (size_t i = 0; !status && i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        status = fp3_engine_write_cell(engine, first + i, reg, bits);
    }
    return status;
}

fp3_status fp3_engine_read(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                           float *values) {
    fp3_status status = check_cell(engine, first, count, reg);
    if (!status && engine->backend->read_column)
        return engine->backend->read_column(engine, first, count, reg, values);
    for (size_t i = 0; !status && i < count; i++) {
        uint32_t bits = 0;
        if (!(status = engine->backend->read(engine, first + i, reg, &bits)))
            memcpy(&values[i], &bits, sizeof bits);
    }
    return status;
}

static fp3_status check_shared(fp3_engine *engine, size_t group, uint32_t first, size_t count) {
    if (group >= engine->layout.count)
        return fp3_fail(engine->def.error, FP3_E_ARGUMENT, "group %zu: there are %" PRIu32, group,
                        engine->layout.count);
    return fp3_engine_check_range(engine, "shared constant", first, count,
                                  engine->config->registers);
}

fp3_status fp3_engine_write_shared_of(fp3_engine *engine, size_t group, uint32_t first,
                                      size_t count, const float *values) {
    fp3_status status = check_shared(engine, group, first, count);
    for (uint32_t i = 0; !status && i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        engine->is_touched = 1;
        fp3_origin_write_shared(engine, (uint32_t)group, first + i, bits);
        status = engine->backend->write_shared(engine, (uint32_t)group, first + i, bits);
    }
    return status;
}

fp3_status fp3_engine_read_shared_of(fp3_engine *engine, size_t group, uint32_t first, size_t count,
                                     float *values) {
    fp3_status status = check_shared(engine, group, first, count);
    for (uint32_t i = 0; !status && i < count; i++) {
        uint32_t bits = 0;
        if (!(status = engine->backend->read_shared(engine, (uint32_t)group, first + i, &bits)))
            memcpy(&values[i], &bits, sizeof bits);
    }
    return status;
}

fp3_status fp3_engine_write_shared(fp3_engine *engine, uint32_t first, size_t count,
                                   const float *values) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < engine->layout.count; i++)
        status = fp3_engine_write_shared_of(engine, i, first, count, values);
    return status;
}

fp3_status fp3_engine_read_shared(fp3_engine *engine, uint32_t first, size_t count, float *values) {
    return fp3_engine_read_shared_of(engine, 0, first, count, values);
}

static fp3_status no_name(fp3_engine *engine, const char *name) {
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT, "the program has no parameter '%s'", name);
}

static fp3_status set_symbol(fp3_engine *engine, uint32_t number, const fp3_symbol *symbol,
                             float value) {
    const fp3_members *group = &engine->layout.groups[number];
    fp3_status status = FP3_OK;
    if (symbol->symbol_class == FP3_SYMBOL_SHARED)
        return fp3_engine_write_shared_of(engine, number, symbol->index, 1, &value);
    for (size_t i = 0; !status && i < group->objects; i++)
        status = fp3_engine_write(engine, group->first + i, 1, symbol->index, &value);
    return status;
}

fp3_status fp3_engine_set(fp3_engine *engine, const char *name, float value) {
    int is_found = 0;
    fp3_status status = fp3_engine_check_loaded(engine);
    for (uint32_t i = 0; !status && i < engine->layout.count; i++) {
        const fp3_symbol *symbol =
            fp3_image_find(engine->layout.groups[i].image, name, FP3_CLASSES_HOST);
        if (symbol)
            status = set_symbol(engine, i, symbol, value);
        is_found |= symbol != NULL;
    }
    return status || is_found ? status : no_name(engine, name);
}

fp3_status fp3_engine_get(fp3_engine *engine, size_t object, const char *name, float *value) {
    fp3_status status = fp3_engine_check_loaded(engine);
    if (status)
        return status;
    const fp3_members *group = fp3_layout_group_of(&engine->layout, object);
    const fp3_symbol *symbol =
        fp3_image_find(group->image, name, FP3_CLASSES_OBJECT | FP3_CLASSES_SHARED);
    if (!symbol)
        return no_name(engine, name);
    if (FP3_CLASS(symbol->symbol_class) & FP3_CLASSES_SHARED)
        return fp3_engine_read_shared_of(engine, (size_t)(group - engine->layout.groups),
                                         symbol->index, 1, value);
    return fp3_engine_read(engine, object, 1, symbol->index, value);
}
