/* luggage.c - what objects and groups hold, while a load moves them to other places. */
#include "luggage.h"

#include <stdlib.h>

/* Words of an object: its registers, then its status. */
static size_t packed(const fp3_engine *engine) { return engine->config->registers + 1; }

static uint32_t visible(const fp3_engine *engine, const fp3_members *group) {
    const uint32_t words = 1u << group->log2;
    return words < engine->config->registers ? words : engine->config->registers;
}

/* Between the luggage and where things are now. */
static fp3_status move_objects(fp3_engine *engine, fp3_luggage *l, int is_write) {
    const fp3_backend *backend = engine->backend;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < engine->objects; i++) {
        uint32_t *words = &l->objects[i * packed(engine)], *word = &words[packed(engine) - 1];
        const uint32_t registers = visible(engine, fp3_layout_group_of(&engine->layout, i));
        for (uint32_t reg = 0; !status && reg < registers; reg++)
            status = is_write ? backend->write(engine, i, reg, words[reg])
                              : backend->read(engine, i, reg, &words[reg]);
        if (!status && engine->config->status)
            status = is_write ? backend->write_status(engine, i, *word)
                              : backend->read_status(engine, i, word);
    }
    return status;
}

static fp3_status move_constants(fp3_engine *engine, fp3_luggage *l, int is_write) {
    const fp3_backend *backend = engine->backend;
    const uint32_t count = engine->config->registers;
    fp3_status status = FP3_OK;
    for (uint32_t group = 0; !status && group < engine->layout.count; group++)
        for (uint32_t i = 0; !status && i < count; i++) {
            uint32_t *word = &l->constants[group * count + i];
            status = is_write ? backend->write_shared(engine, group, i, *word)
                              : backend->read_shared(engine, group, i, word);
        }
    return status;
}

static fp3_status move(fp3_engine *engine, fp3_luggage *l, int is_write) {
    fp3_status status = move_objects(engine, l, is_write);
    return status ? status : move_constants(engine, l, is_write);
}

fp3_status fp3_luggage_pack(fp3_engine *engine, fp3_luggage *l) {
    const size_t constants =
        (size_t)fp3_config_schedulers(engine->config) * engine->config->registers;
    l->objects = calloc(engine->objects * packed(engine), sizeof *l->objects);
    l->constants = calloc(constants, sizeof *l->constants);
    if (!l->objects || !l->constants)
        return fp3_fail(engine->def.error, FP3_E_SYSTEM, "out of memory");
    return move(engine, l, 0);
}

fp3_status fp3_luggage_unpack(fp3_engine *engine, fp3_luggage *l) { return move(engine, l, 1); }

void fp3_luggage_free(fp3_luggage *l) {
    free(l->objects);
    free(l->constants);
    *l = (fp3_luggage){0};
}
