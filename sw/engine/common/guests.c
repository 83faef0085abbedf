/* SPDX-License-Identifier: Apache-2.0 */
/* guests.c - objects of other engines, which neighbours read here. */
#include "backend.h"

#include <stdlib.h>

void fp3_engine_set_exchange(fp3_engine *engine, const fp3_exchange *exchange) {
    engine->exchange = *exchange;
}

fp3_status fp3_engine_exchange_begin(fp3_engine *engine) {
    const fp3_exchange *e = &engine->exchange;
    return e->begin ? e->begin(e->user, engine) : FP3_OK;
}

fp3_status fp3_engine_exchange_end(fp3_engine *engine) {
    const fp3_exchange *e = &engine->exchange;
    return e->end ? e->end(e->user, engine) : FP3_OK;
}

fp3_status fp3_engine_exchange(fp3_engine *engine) {
    const fp3_status status = fp3_engine_exchange_begin(engine);
    return status ? status : fp3_engine_exchange_end(engine);
}

static int by_number(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

fp3_status fp3_engine_set_numbers(fp3_engine *engine, const uint32_t *numbers) {
    fp3_members *group = &engine->layout.groups[0];
    uint64_t *pairs = malloc((group->rows + (size_t)1) * sizeof *pairs);
    uint32_t *order = malloc((group->rows + (size_t)1) * sizeof *order);
    if (!pairs || !order) {
        free(pairs);
        free(order);
        return fp3_no_memory(engine->def.error);
    }
    for (uint32_t i = 0; i < group->rows; i++)
        pairs[i] = (uint64_t)numbers[i] << 32 | i;
    qsort(pairs, group->rows, sizeof *pairs, by_number);
    for (uint32_t i = 0; i < group->rows; i++)
        order[i] = (uint32_t)pairs[i];
    free(pairs);
    fp3_lists_take_order(&group->lists, order);
    return engine->backend->connect ? engine->backend->connect(engine, group, NULL) : FP3_OK;
}

fp3_status fp3_engine_gather(fp3_engine *engine, uint32_t reg, const uint32_t *objects,
                             size_t count, uint32_t *words) {
    fp3_status status = FP3_OK;
    if (engine->backend->gather)
        engine->backend->gather(engine, reg, objects, count, words);
    for (size_t i = 0; !status && !engine->backend->gather && i < count; i++)
        status = engine->backend->read(engine, (fp3_cells){FP3_CELLS_REGISTER, reg, objects[i], 1},
                                       &words[i]);
    return status;
}
