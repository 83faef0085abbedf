/* SPDX-License-Identifier: Apache-2.0 */
/* worst.c - words that all objects compare between two phases. */
#include "backend.h"

#include <fp3/isa.h>
#include <stdlib.h>

#define SIGN 0x80000000u
#define INFINITE 0x7f800000u

uint64_t fp3_worst_key(uint32_t word) {
    const int is_nan = (word & ~SIGN) > INFINITE;
    const uint32_t rank = is_nan ? UINT32_MAX : word & SIGN ? ~word : word | SIGN;
    return (uint64_t)rank << 32 | word;
}

/* Of these objects, and of those of other ranks. */
static uint32_t worst_of(const fp3_engine *engine, const uint32_t *words, uint32_t count) {
    uint64_t worst = 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint64_t key = fp3_worst_key(words[i]);
        worst = key > worst ? key : worst;
    }
    if (engine->exchange.worst)
        worst = engine->exchange.worst(engine->exchange.user, worst);
    return (uint32_t)worst;
}

static fp3_status compare(fp3_engine *engine, const fp3_members *group, uint32_t reg,
                          uint32_t *words) {
    const uint32_t first = fp3_members_begin(group), count = fp3_members_end(group) - first;
    const fp3_cells cells = {FP3_CELLS_REGISTER, reg, first, count};
    fp3_status status = engine->backend->read(engine, cells, words);
    if (status)
        return status;
    const uint32_t worst = worst_of(engine, words, count);
    for (uint32_t i = 0; i < count; i++)
        words[i] = worst;
    return engine->backend->write(engine, cells, words);
}

fp3_status fp3_engine_compare(fp3_engine *engine, const fp3_members *group, uint32_t begin) {
    const uint64_t all = fp3_neighbourhood_compared(&group->lists.shape, &group->program, begin);
    if (!all || engine->only) /* of kinds, all objects of all of them are compared */
        return FP3_OK;
    uint32_t *words = malloc((group->objects + (size_t)1) * sizeof *words);
    fp3_status status = words ? FP3_OK : fp3_no_memory(engine->def.error);
    for (uint32_t reg = 0; !status && reg < FP3_BANK_OBJECT_COUNT; reg++)
        if (all >> reg & 1)
            status = compare(engine, group, reg, words);
    free(words);
    return status;
}
