/* ranks_held.c - words of a rank's own objects while it has no engine: before lists say which objects these are, and when
 * other lists do. A board has one port, which two engines cannot have at the same time.
 */
#include "ranks_own.h"

#include "cells.h"

#include <stdlib.h>
#include <string.h>

void fp3_ranks_forget_held(fp3_ranked *self) {
    for (int reg = 0; reg < FP3_BANK_OBJECT_COUNT; reg++) {
        free(self->held[reg]);
        self->held[reg] = NULL;
    }
}

void fp3_ranks_close_own(fp3_ranked *self) {
    const fp3_bus_use bus = self->own ? fp3_engine_bus(self->own) : (fp3_bus_use){0};
    fp3_ranks_add_bus(&self->use.bus, &bus);
    fp3_engine_close(&self->own);
}

/* Registers that are 0 in all objects are not kept. */
fp3_status fp3_ranks_hold(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    const fp3_members *group = &engine->layout.groups[0];
    const uint32_t own = self->share[self->ranks->rank];
    fp3_status status = FP3_OK;
    for (uint32_t reg = 0;
         !status && self->own && reg < 1u << group->log2 && reg < engine->config->registers;
         reg++) {
        uint32_t *words = malloc((own + (size_t)1) * sizeof *words);
        if (!words)
            return fp3_fail(engine->def.error, FP3_E_SYSTEM, "out of memory");
        status = self->own->backend->read(
            self->own, (fp3_cells){FP3_CELLS_REGISTER, reg, self->first, own}, words);
        free(self->held[reg]);
        self->held[reg] = !status && fp3_ranks_is_any_set(words, own) ? words : NULL;
        if (!self->held[reg])
            free(words);
    }
    if (!status)
        fp3_ranks_close_own(self);
    return status;
}

fp3_status fp3_ranks_read_own(fp3_ranked *self, fp3_cells here, uint32_t *words) {
    if (!here.count)
        return FP3_OK;
    if (self->own)
        return self->own->backend->read(self->own, here, words);
    const uint32_t *held = self->held[here.number];
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
    uint32_t **held = &self->held[here.number];
    if (!*held && !(*held = calloc(self->share[self->ranks->rank], sizeof **held)))
        return fp3_fail(self->def.error, FP3_E_SYSTEM, "out of memory");
    memcpy(*held + (here.first - self->first), words, here.count * sizeof *words);
    return FP3_OK;
}
