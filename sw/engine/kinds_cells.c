/* SPDX-License-Identifier: Apache-2.0 */
/* kinds_cells.c - what objects of several groups hold. */
#include "kinds_inside.h"

#include "engine/common/cells.h"

#include <string.h>

#define HALVES 2 /* of a store: what one phase reads, and what it writes */

void fp3_kinds_count_bus(fp3_engine *engine) {
    const fp3_kinds *self = fp3_kinds_of(engine);
    engine->bus = self->bus_before;
    for (uint32_t i = 0; i < self->count; i++) {
        const fp3_engine *own = self->kinds[i].own;
        engine->bus.transfers += own ? own->bus.transfers : 0;
        engine->bus.cycles += own ? own->bus.cycles : 0;
    }
}

/* ---- words: of objects that live from the engine of their group, of others as they were held ----
 */

static uint32_t *held_at(const fp3_engine *engine, fp3_cells cells, size_t object) {
    const size_t column = cells.kind == FP3_CELLS_STATUS ? engine->config->registers : cells.number;
    return &fp3_kinds_of(engine)->held[column * engine->objects + object];
}

/* From `object` on, before `end`: how many that make steps follow each other in rows, or are held.
 */
static uint32_t run_of(const fp3_kinds *self, uint32_t object, uint32_t end) {
    const int is_awake = self->stage[object] == FP3_STAGE_AWAKE;
    uint32_t n = 1;
    while (object + n < end && is_awake == (self->stage[object + n] == FP3_STAGE_AWAKE) &&
           (!is_awake || self->place[object + n] == self->place[object] + n))
        n++;
    return n;
}

/* Objects that follow each other in a group. */
static fp3_status access_group(fp3_engine *engine, uint32_t number, fp3_cells cells, char *words,
                               int is_write) {
    const fp3_kinds *self = fp3_kinds_of(engine);
    fp3_engine *own = self->kinds[number].own;
    const uint32_t begin = (uint32_t)cells.first, end = begin + (uint32_t)cells.count;
    fp3_status status = FP3_OK;
    for (uint32_t object = begin, n; !status && object < end; object += n) {
        n = run_of(self, object, end);
        char *at = words + (object - begin) * sizeof(uint32_t);
        fp3_cells here = {cells.kind, cells.number, self->place[object], n};
        if (self->stage[object] != FP3_STAGE_AWAKE)
            memcpy(is_write ? (char *)held_at(engine, cells, object) : at,
                   is_write ? at : (char *)held_at(engine, cells, object), n * sizeof(uint32_t));
        else
            status = is_write ? fp3_cells_write(own, here, at) : own->backend->read(own, here, at);
    }
    return status;
}

static fp3_status access_constants(fp3_engine *engine, fp3_cells cells, void *words, int is_write) {
    const fp3_kinds *self = fp3_kinds_of(engine);
    fp3_engine *own = self->kinds[cells.number].own;
    uint32_t *here = &self->constants[cells.number * engine->config->registers + cells.first];
    memcpy(is_write ? (void *)here : words, is_write ? words : (void *)here,
           cells.count * sizeof *here);
    cells.number = 0;
    return is_write && own ? fp3_cells_write(own, cells, words) : FP3_OK;
}

static fp3_status access_cells(fp3_engine *engine, fp3_cells cells, void *words, int is_write) {
    fp3_status status = FP3_OK;
    if (cells.kind == FP3_CELLS_CONSTANT)
        return access_constants(engine, cells, words, is_write);
    for (uint32_t i = 0; !status && i < engine->layout.count; i++) {
        fp3_cells here =
            fp3_cells_of(&engine->layout.groups[i], cells.number, cells.first, cells.count);
        here.kind = cells.kind;
        if (here.count)
            status = access_group(engine, i, here,
                                  (char *)words + (here.first - cells.first) * sizeof(uint32_t),
                                  is_write);
    }
    fp3_kinds_count_bus(engine);
    return status;
}

fp3_status fp3_kinds_read(fp3_engine *engine, fp3_cells cells, void *words) {
    return access_cells(engine, cells, words, 0);
}

/* Guests get it in the next round. */
fp3_status fp3_kinds_put(fp3_engine *engine, fp3_cells cells, const void *words) {
    fp3_kinds *self = fp3_kinds_of(engine);
    for (uint32_t i = 0; i < self->count; i++)
        for (uint32_t k = 0; k < self->kinds[i].word_count; k++)
            self->kinds[i].words[k].is_brought = 0;
    self->fresh = HALVES;
    return access_cells(engine, cells, (void *)(uintptr_t)words, 1);
}
