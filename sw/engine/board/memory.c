/* SPDX-License-Identifier: Apache-2.0 */
/* memory.c - see memory.h. */
#include "memory.h"

#include "driver.h"

#include "gen/registers.h"
#include <stdlib.h>
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
        status = fp3_driver_put(engine, fp3_driver_of(engine, group->schedulers[i], address), data);
    return status;
}

static fp3_status put_program(fp3_engine *engine, uint32_t number, const uint32_t *code,
                              uint32_t step, uint32_t last, uint32_t size) {
    const request shape[] = {{FP3_ADDR_STEP, step}, {FP3_ADDR_LAST, last}, {FP3_ADDR_SIZE, size}};
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < size; i++)
        status = put_group(engine, number, FP3_ADDR_WINDOW_PROGRAM + 4 * i, code[i]);
    for (size_t i = 0; !status && i < sizeof shape / sizeof *shape; i++)
        status = put_group(engine, number, shape[i].address, shape[i].data);
    return status;
}

fp3_status fp3_memory_load_phase(fp3_engine *engine, uint32_t first, uint32_t end) {
    fp3_driver *self = engine->self;
    const fp3_code *p = &engine->layout.groups[0].program;
    self->first = first;
    return put_program(engine, 0, p->code + first, 0, end - first, end - first);
}

fp3_status fp3_memory_load_words(fp3_engine *engine, const uint32_t *code, uint32_t count) {
    ((fp3_driver *)engine->self)->first = 0;
    return put_program(engine, 0, code, 0, count, count);
}

static fp3_status load_group(fp3_engine *engine, uint32_t number) {
    const fp3_members *group = &engine->layout.groups[number];
    const fp3_code *p = &group->program;
    fp3_status status = put_program(engine, number, p->code, p->step, p->last, p->count);
    if (!status && engine->config->interleave)
        status = put_group(engine, number, FP3_ADDR_RECORD, group->log2);
    /* Also that there are none: with them a run has one step in each visit, or does not start. */
    const uint64_t published = fp3_layout_published(group);
    if (!status && engine->config->neighbours)
        status = put_group(engine, number, FP3_ADDR_PUBLISHED, (uint32_t)published);
    if (!status && engine->config->neighbours)
        status = put_group(engine, number, FP3_ADDR_PUBLISHED_MORE, (uint32_t)(published >> 32));
    if (!status && engine->config->storage && engine->config->sleep)
        status = put_group(engine, number, FP3_ADDR_WHOLE,
                           p->slept < 0 ? FP3_BANK_OBJECT_COUNT : (uint32_t)p->slept);
    return status;
}

/* Which objects they have: rows follow each other round all lanes of the group. */
static fp3_status number_objects(fp3_engine *engine, uint32_t number) {
    const fp3_members *group = &engine->layout.groups[number];
    const uint32_t lanes = engine->config->lanes;
    fp3_status status = put_group(engine, number, FP3_ADDR_STRIDE, group->columns);
    for (uint32_t i = 0; !status && i < group->scheduler_count; i++)
        status = fp3_driver_put(engine, fp3_driver_of(engine, group->schedulers[i], FP3_ADDR_FIRST),
                                group->first + i * lanes);
    return status;
}

fp3_status fp3_memory_load(fp3_engine *engine) {
    fp3_driver *self = engine->self;
    fp3_status status = FP3_OK;
    self->first = 0;
    for (uint32_t i = 0; !status && i < engine->layout.count; i++)
        status = load_group(engine, i);
    for (uint32_t i = 0; !status && engine->config->storage && i < engine->layout.count; i++)
        status = number_objects(engine, i);
    return status;
}

static uint32_t in_space(const fp3_engine *engine, uint32_t scheduler, uint32_t space,
                         uint32_t word) {
    return fp3_driver_of(engine, scheduler, FP3_ADDRESS_IN(engine->config->space_bit, space, word));
}

static fp3_where where(const fp3_engine *engine, size_t object) {
    return fp3_layout_where(&engine->layout, engine->config, object);
}

static uint32_t cell_address(const fp3_engine *engine, size_t object, uint32_t reg) {
    const fp3_driver *self = engine->self;
    const fp3_members *group = fp3_layout_group_of(&engine->layout, object);
    const fp3_where at = where(engine, object);
    const uint32_t record = at.row << group->log2, store = engine->config->store_words;
    const int is_upper = self->is_upper && fp3_layout_published(group) >> reg & 1;
    return in_space(engine, at.scheduler, FP3_SPACE_OBJECTS,
                    at.lane * store + record + reg + (is_upper ? store / 2 : 0));
}

static uint32_t status_address(const fp3_engine *engine, size_t object) {
    const fp3_where at = where(engine, object);
    return in_space(engine, at.scheduler, FP3_SPACE_STATUS,
                    at.lane * engine->config->store_words + at.row);
}

/* Of cell i. */
static uint32_t address_of(const fp3_engine *engine, fp3_cells cells, size_t i) {
    const size_t number = cells.first + i;
    if (cells.kind == FP3_CELLS_CONSTANT)
        return FP3_ADDR_WINDOW_CONSTANTS + 4 * (uint32_t)number;
    return cells.kind == FP3_CELLS_STATUS ? status_address(engine, number)
                                          : cell_address(engine, number, cells.number);
}

/* All schedulers of a group have its constants: the first is asked. */
fp3_status fp3_memory_read(fp3_engine *engine, fp3_cells cells, void *words) {
    uint32_t addresses[FP3_BUS_WORDS], bits[FP3_BUS_WORDS];
    const uint32_t scheduler =
        cells.kind == FP3_CELLS_CONSTANT ? engine->layout.groups[cells.number].schedulers[0] : 0;
    fp3_status status = FP3_OK;
    for (size_t begin = 0; !status && begin < cells.count; begin += FP3_BUS_WORDS) {
        const size_t left = cells.count - begin, now = left < FP3_BUS_WORDS ? left : FP3_BUS_WORDS;
        for (size_t i = 0; i < now; i++)
            addresses[i] = fp3_driver_of(engine, scheduler, address_of(engine, cells, begin + i));
        status = fp3_driver_get_all(engine, addresses, bits, (uint32_t)now);
        if (!status)
            memcpy((char *)words + begin * sizeof *bits, bits, now * sizeof *bits);
    }
    return status;
}

fp3_status fp3_memory_write(fp3_engine *engine, fp3_cells cells, const void *words) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < cells.count; i++) {
        const uint32_t address = address_of(engine, cells, i);
        uint32_t bits;
        memcpy(&bits, (const char *)words + i * sizeof bits, sizeof bits);
        status = cells.kind == FP3_CELLS_CONSTANT ? put_group(engine, cells.number, address, bits)
                                                  : fp3_driver_put(engine, address, bits);
    }
    return status;
}

fp3_status fp3_memory_clear(fp3_engine *engine) {
    const fp3_config *config = engine->config;
    fp3_status status = FP3_OK;
    for (size_t i = 0; i < engine->objects; i++) {
        const uint32_t log2 = fp3_layout_group_of(&engine->layout, i)->log2;
        const uint32_t words = config->interleave ? 1u << log2 : config->registers;
        for (uint32_t reg = 0; !status && reg < words; reg++)
            status = fp3_driver_put(engine, cell_address(engine, i, reg), 0);
    }
    for (size_t i = 0; !status && config->status && i < engine->objects; i++)
        status = fp3_driver_put(engine, status_address(engine, i), 0);
    for (uint32_t group = 0; group < engine->layout.count; group++)
        for (uint32_t index = 0; !status && index < config->registers; index++)
            status = put_group(engine, group, FP3_ADDR_WINDOW_CONSTANTS + 4 * index, 0);
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
                engine, fp3_driver_of(engine, scheduler, FP3_ADDR_WINDOW_AWAKE + 4 * lane),
                config->sleep ? 0 : fp3_layout_rows(layout, config, scheduler, lane));
    for (uint32_t i = 0; !status && config->sleep && i < engine->objects; i++) {
        const fp3_where at = where(engine, i);
        if (fp3_engine_is_awake(engine, i))
            status = fp3_driver_put(
                engine, fp3_driver_of(engine, at.scheduler, FP3_ADDR_WINDOW_WAKE + 4 * at.lane),
                at.row);
    }
    return status;
}

fp3_status fp3_memory_put_word(fp3_engine *engine, uint32_t lane, uint32_t word, uint32_t data) {
    return fp3_driver_put(
        engine, in_space(engine, 0, FP3_SPACE_OBJECTS, lane * engine->config->store_words + word),
        data);
}

fp3_status fp3_memory_get_words(fp3_engine *engine, uint32_t lane, uint32_t word, size_t count,
                                uint32_t *data) {
    uint32_t *addresses = malloc((count + 1) * sizeof *addresses);
    if (!addresses)
        return fp3_no_memory(engine->def.error);
    for (size_t i = 0; i < count; i++)
        addresses[i] = in_space(engine, 0, FP3_SPACE_OBJECTS,
                                lane * engine->config->store_words + word + (uint32_t)i);
    const fp3_status status = fp3_driver_get_all(engine, addresses, data, (uint32_t)count);
    free(addresses);
    return status;
}

fp3_status fp3_memory_put_copy(fp3_engine *engine, uint32_t word, uint32_t data) {
    return fp3_driver_put(engine, in_space(engine, 0, FP3_SPACE_COPIES, word), data);
}
