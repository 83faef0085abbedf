/* SPDX-License-Identifier: Apache-2.0 */
/* held.c - words of a rank's own objects while it has no engine: before lists say which objects
 * these are, and when other lists do. A board has one port, which two engines cannot have at the
 * same time.
 */
#include "engine/common/cells.h"
#include "inside.h"
#include "use.h"

#include <stdlib.h>
#include <string.h>

fp3_status fp3_ranks_no_memory(fp3_engine *engine) { return fp3_no_memory(engine->def.error); }

/* FNV-1a, a word at a time: it finds another scene, not one that was made to have the same hash. */
void fp3_ranks_note(fp3_ranked *self, const void *words, size_t count) {
    const char *of = words;
    for (size_t i = 0; i < count; i++) {
        uint32_t word; /* whatever these bytes are elsewhere */
        memcpy(&word, of + i * sizeof word, sizeof word);
        self->given = (self->given ^ word) * 0x100000001b3u;
    }
}

void fp3_ranks_forget_held(fp3_ranked *self) {
    for (int i = 0; i < FP3_HELD; i++) {
        free(self->held[i]);
        self->held[i] = NULL;
    }
}

void fp3_ranks_close_own(fp3_ranked *self) {
    const fp3_bus_use bus = self->own ? fp3_engine_bus(self->own) : (fp3_bus_use){0};
    fp3_ranks_add_bus(&self->use.bus, &bus);
    fp3_engine_close(&self->own);
}

static uint32_t **place_of(fp3_ranked *self, fp3_cells cells) {
    return &self->held[cells.kind == FP3_CELLS_STATUS ? FP3_BANK_OBJECT_COUNT : cells.number];
}

/* What is 0 in all objects is not kept. */
static fp3_status hold_cells(fp3_engine *engine, fp3_cells cells) {
    fp3_ranked *self = engine->self;
    cells.first = self->first;
    cells.count = self->share[fp3_ranks_here(self)];
    uint32_t *words = malloc((cells.count + 1) * sizeof *words), **held = place_of(self, cells);
    if (!words)
        return fp3_ranks_no_memory(engine);
    const fp3_status status = self->own->backend->read(self->own, cells, words);
    free(*held);
    *held = !status && fp3_ranks_is_any_set(words, cells.count) ? words : NULL;
    if (!*held)
        free(words);
    return status;
}

fp3_status fp3_ranks_hold(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    const fp3_members *group = &engine->layout.groups[0];
    const uint32_t registers = engine->config->registers;
    fp3_status status = FP3_OK;
    for (uint32_t reg = 0; !status && self->own && reg < 1u << group->log2 && reg < registers;
         reg++)
        status = hold_cells(engine, (fp3_cells){.kind = FP3_CELLS_REGISTER, .number = reg});
    if (!status && self->own && engine->config->status)
        status = hold_cells(engine, (fp3_cells){.kind = FP3_CELLS_STATUS});
    if (!status)
        fp3_ranks_close_own(self);
    return status;
}

fp3_status fp3_ranks_read_own(fp3_ranked *self, fp3_cells here, uint32_t *words) {
    if (!here.count)
        return FP3_OK;
    if (self->own)
        return self->own->backend->read(self->own, here, words);
    const uint32_t *held = *place_of(self, here);
    if (held)
        memcpy(words, held + (here.first - self->first), here.count * sizeof *words);
    else
        memset(words, 0, here.count * sizeof *words);
    return FP3_OK;
}

fp3_status fp3_ranks_write_own(fp3_ranked *self, fp3_cells here, const uint32_t *words) {
    if (!here.count)
        return FP3_OK;
    if (self->own)
        return fp3_cells_write(self->own, here, words);
    uint32_t **held = place_of(self, here);
    if (!*held && !(*held = calloc(self->share[self->ranks->rank], sizeof **held)))
        return fp3_no_memory(self->def.error);
    memcpy(*held + (here.first - self->first), words, here.count * sizeof *words);
    return FP3_OK;
}
