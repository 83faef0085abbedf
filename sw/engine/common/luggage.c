/* SPDX-License-Identifier: Apache-2.0 */
/* luggage.c - what objects and groups hold, while a load moves them to other places. */
#include "luggage.h"

#include "machine/storage.h"
#include <stdlib.h>

/* Of records of 16 bits: a word that the program before kept whole may be none of that kind now. */
static void round_words(const fp3_engine *engine, fp3_cells cells, uint32_t *words) {
    const fp3_members *group = fp3_layout_group_of(&engine->layout, cells.first);
    uint32_t flags;
    for (size_t i = 0; i < cells.count && group->program.slept != (int)cells.number; i++)
        words[i] = fp3_stored(engine->config, words[i], NULL, &flags);
}

static fp3_status move(fp3_engine *engine, fp3_cells cells, uint32_t *words, int is_write) {
    if (is_write && cells.kind == FP3_CELLS_REGISTER && cells.count)
        round_words(engine, cells, words);
    return is_write ? engine->backend->write(engine, cells, words)
                    : engine->backend->read(engine, cells, words);
}

/* Between the luggage and where things are now. */
static fp3_status move_group(fp3_engine *engine, fp3_luggage *l, uint32_t number, int is_write) {
    const fp3_members *group = &engine->layout.groups[number];
    const uint32_t words = 1u << group->log2, count = engine->config->registers;
    const size_t objects = engine->objects;
    fp3_status status = FP3_OK;
    for (uint32_t reg = 0; !status && reg < words && reg < count; reg++)
        status = move(engine, (fp3_cells){FP3_CELLS_REGISTER, reg, group->first, group->objects},
                      &l->objects[reg * objects + group->first], is_write);
    if (!status && engine->config->status)
        status = move(engine, (fp3_cells){FP3_CELLS_STATUS, 0, group->first, group->objects},
                      &l->objects[count * objects + group->first], is_write);
    return status ? status
                  : move(engine, (fp3_cells){FP3_CELLS_CONSTANT, number, 0, count},
                         &l->constants[number * count], is_write);
}

static fp3_status move_all(fp3_engine *engine, fp3_luggage *l, int is_write) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < engine->layout.count; i++)
        status = move_group(engine, l, i, is_write);
    return status;
}

fp3_status fp3_luggage_pack(fp3_engine *engine, fp3_luggage *l) {
    const size_t registers = engine->config->registers;
    l->objects = calloc(engine->objects * (registers + 1), sizeof *l->objects);
    l->constants = calloc(fp3_layout_room(engine->config) * registers, sizeof *l->constants);
    if (!l->objects || !l->constants)
        return fp3_no_memory(engine->def.error);
    return move_all(engine, l, 0);
}

fp3_status fp3_luggage_unpack(fp3_engine *engine, fp3_luggage *l) { return move_all(engine, l, 1); }

void fp3_luggage_free(fp3_luggage *l) {
    free(l->objects);
    free(l->constants);
    *l = (fp3_luggage){0};
}
