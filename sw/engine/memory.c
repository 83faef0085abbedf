/* memory.c - see memory.h. */
#include "memory.h"

#include "driver.h"

#include "gen/registers.h"
#include <string.h>

typedef struct {
    uint32_t address, data;
} request;

/* To all schedulers of a group: to all that there are in one transfer. */
static fp3_status put_group(fp3_engine *engine, uint32_t number, uint32_t address, uint32_t data) {
    const fp3_members *group = &engine->layout.groups[number];
    fp3_status status = FP3_OK;
    if (engine->layout.count == 1)
        return fp3_driver_put(engine, fp3_driver_of_all(engine, address), data);
    for (uint32_t i = 0; !status && i < group->scheduler_count; i++)
        status = fp3_driver_put(engine, fp3_driver_of(group->schedulers[i], address), data);
    return status;
}

static fp3_status load_group(fp3_engine *engine, uint32_t number) {
    const fp3_members *group = &engine->layout.groups[number];
    const fp3_code *p = &group->program;
    const request shape[] = {{FP3_ADDR_STEP, p->step},
                             {FP3_ADDR_LAST, p->last},
                             {FP3_ADDR_SIZE, p->count},
                             {FP3_ADDR_RECORD, group->log2}};
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < p->count; i++)
        status = put_group(engine, number, FP3_ADDR_WINDOW_PROGRAM + 4 * i, p->code[i]);
    for (size_t i = 0; !status && i < (engine->config->interleave ? 4 : 3); i++)
        status = put_group(engine, number, shape[i].address, shape[i].data);
    return status;
}

fp3_status fp3_memory_load(fp3_engine *engine) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < engine->layout.count; i++)
        status = load_group(engine, i);
    return status;
}

static uint32_t in_space(uint32_t scheduler, uint32_t space, uint32_t word) {
    return fp3_driver_of(scheduler, space << FP3_ADDRESS_SPACE_LO | word << FP3_ADDRESS_WORD_LO);
}

static fp3_where where(const fp3_engine *engine, size_t object) {
    return fp3_layout_where(&engine->layout, engine->config, object);
}

static uint32_t cell_address(const fp3_engine *engine, size_t object, uint32_t reg) {
    const fp3_where at = where(engine, object);
    const uint32_t record = at.row << fp3_layout_group_of(&engine->layout, object)->log2;
    return in_space(at.scheduler, FP3_SPACE_OBJECTS,
                    at.lane * engine->config->store_words + record + reg);
}

static uint32_t status_address(const fp3_engine *engine, size_t object) {
    const fp3_where at = where(engine, object);
    return in_space(at.scheduler, FP3_SPACE_STATUS, at.lane * engine->config->store_words + at.row);
}

fp3_status fp3_memory_write(fp3_engine *engine, size_t object, uint32_t reg, uint32_t bits) {
    return fp3_driver_put(engine, cell_address(engine, object, reg), bits);
}

fp3_status fp3_memory_read(fp3_engine *engine, size_t object, uint32_t reg, uint32_t *bits) {
    return fp3_driver_get(engine, cell_address(engine, object, reg), bits);
}

fp3_status fp3_memory_read_column(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                                  float *values) {
    uint32_t addresses[FP3_BUS_WORDS], bits[FP3_BUS_WORDS];
    fp3_status status = FP3_OK;
    for (size_t begin = 0; !status && begin < count; begin += FP3_BUS_WORDS) {
        const size_t now = count - begin < FP3_BUS_WORDS ? count - begin : FP3_BUS_WORDS;
        for (size_t i = 0; i < now; i++)
            addresses[i] = cell_address(engine, first + begin + i, reg);
        status = fp3_driver_get_all(engine, addresses, bits, (uint32_t)now);
        if (!status)
            memcpy(&values[begin], bits, now * sizeof *values);
    }
    return status;
}

fp3_status fp3_memory_write_shared(fp3_engine *engine, uint32_t group, uint32_t index,
                                   uint32_t bits) {
    return put_group(engine, group, FP3_ADDR_WINDOW_CONSTANTS + 4 * index, bits);
}

fp3_status fp3_memory_read_shared(fp3_engine *engine, uint32_t group, uint32_t index,
                                  uint32_t *bits) {
    const uint32_t scheduler = engine->layout.groups[group].schedulers[0];
    return fp3_driver_get(engine, fp3_driver_of(scheduler, FP3_ADDR_WINDOW_CONSTANTS + 4 * index),
                          bits);
}

fp3_status fp3_memory_write_status(fp3_engine *engine, size_t object, uint32_t word) {
    return fp3_driver_put(engine, status_address(engine, object), word);
}

fp3_status fp3_memory_read_status(fp3_engine *engine, size_t object, uint32_t *word) {
    return fp3_driver_get(engine, status_address(engine, object), word);
}

fp3_status fp3_memory_clear(fp3_engine *engine) {
    const fp3_config *config = engine->config;
    fp3_status status = FP3_OK;
    for (size_t i = 0; i < engine->objects; i++) {
        const uint32_t log2 = fp3_layout_group_of(&engine->layout, i)->log2;
        const uint32_t words = config->interleave ? 1u << log2 : config->registers;
        for (uint32_t reg = 0; !status && reg < words; reg++)
            status = fp3_memory_write(engine, i, reg, 0);
    }
    for (size_t i = 0; !status && config->status && i < engine->objects; i++)
        status = fp3_memory_write_status(engine, i, 0);
    for (uint32_t group = 0; group < engine->layout.count; group++)
        for (uint32_t index = 0; !status && index < config->registers; index++)
            status = fp3_memory_write_shared(engine, group, index, 0);
    return status;
}

/* With sleep the numbers of a lane's objects, in the order of their rows; without, how many. */
fp3_status fp3_memory_list(fp3_engine *engine) {
    const fp3_config *config = engine->config;
    const fp3_layout *layout = &engine->layout;
    fp3_status status = FP3_OK;
    for (uint32_t scheduler = 0; scheduler < fp3_config_schedulers(config); scheduler++)
        for (uint32_t lane = 0; !status && lane < config->lanes; lane++)
            status = fp3_driver_put(
                engine, fp3_driver_of(scheduler, FP3_ADDR_WINDOW_AWAKE + 4 * lane),
                config->sleep ? 0 : fp3_layout_rows(layout, config, scheduler, lane));
    for (uint32_t i = 0; !status && config->sleep && i < engine->objects; i++) {
        const fp3_where at = where(engine, i);
        if (fp3_engine_is_awake(engine, i))
            status = fp3_driver_put(
                engine, fp3_driver_of(at.scheduler, FP3_ADDR_WINDOW_WAKE + 4 * at.lane), at.row);
    }
    return status;
}
