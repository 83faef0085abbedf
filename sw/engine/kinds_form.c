/* SPDX-License-Identifier: Apache-2.0 */
/* kinds_form.c - an engine for each group: its objects that live, those that make steps in front,
 * and guests behind them. */
#include "kinds_inside.h"

#include <stdlib.h>
#include <string.h>

/* Objects are told by their numbers in all groups. */
static void tell_retirement(void *user, const fp3_retirement *retirement) {
    const struct fp3_kinds_teller *t = user;
    fp3_retirement told = *retirement;
    told.object = t->who[retirement->object];
    t->engine->def.retire(t->engine->def.retire_user, &told);
}

/* Where guests stand: group by group, behind the own objects. */
static void place_guests(const fp3_kinds *self, fp3_kind_engine *k) {
    k->rows = k->living;
    for (uint32_t i = 0; i < FP3_JOINED_MAX; i++)
        k->base[i] = FP3_NO_OBJECT_ROW;
    for (uint32_t i = 0; i < k->word_count; i++) {
        const uint32_t from = k->words[i].from;
        k->words[i].is_brought = 0;
        if (k->base[from] != FP3_NO_OBJECT_ROW)
            continue;
        k->base[from] = k->rows;
        k->rows += self->kinds[from].living;
    }
}

/* Those at this stage get the next rows of their group's engine. */
static uint32_t place_those(fp3_kinds *self, const fp3_members *group, int stage, uint32_t row) {
    for (uint32_t n = group->first; n < group->first + group->objects; n++)
        if (self->stage[n] == stage) {
            self->place[n] = row;
            self->who[group->first + row++] = n;
        }
    return row;
}

/* Those that make steps stand in front, as fp3_engine_use needs them. */
void fp3_kinds_place(fp3_kinds *self, const fp3_layout *layout) {
    for (uint32_t i = 0; i < layout->count; i++) {
        const fp3_members *group = &layout->groups[i];
        fp3_kind_engine *k = &self->kinds[i];
        for (uint32_t n = group->first; n < group->first + group->objects; n++)
            self->place[n] = FP3_NO_OBJECT_ROW;
        k->awake = place_those(self, group, FP3_STAGE_AWAKE, 0);
        k->living = place_those(self, group, FP3_STAGE_ASLEEP, k->awake);
    }
    for (uint32_t i = 0; i < layout->count; i++)
        place_guests(self, &self->kinds[i]);
}

/* Rows are in another order than objects where some sleep: sums still go by numbers. */
static fp3_status tell_numbers(const fp3_kinds *self, const fp3_layout *layout, fp3_kind_engine *k,
                               const fp3_members *own) {
    uint32_t *numbers = malloc((k->rows + (size_t)1) * sizeof *numbers);
    if (!numbers)
        return fp3_no_memory(k->own->def.error);
    for (uint32_t n = 0; n < k->living; n++)
        numbers[n] = self->who[own->first + n] - own->first;
    for (uint32_t i = 0; i < layout->count; i++) {
        uint32_t before = own->objects; /* guests of a group follow those of another, as in rows */
        for (uint32_t j = 0; j < layout->count; j++)
            before += k->base[j] < k->base[i] ? layout->groups[j].objects : 0;
        for (uint32_t n = 0; k->base[i] != FP3_NO_OBJECT_ROW && n < self->kinds[i].living; n++)
            numbers[k->base[i] + n] =
                before + self->who[layout->groups[i].first + n] - layout->groups[i].first;
    }
    const fp3_status status = fp3_engine_set_numbers(k->own, numbers);
    free(numbers);
    return status;
}

fp3_status fp3_kinds_open_one(fp3_engine *engine, fp3_kinds *self, const fp3_layout *layout,
                              uint32_t number) {
    const fp3_members *group = &layout->groups[number];
    fp3_kind_engine *k = &self->kinds[number];
    fp3_engine_def def = engine->def;
    if (!k->living)
        return FP3_OK;
    k->teller = (struct fp3_kinds_teller){engine, self->who + group->first};
    def.objects = k->rows;
    def.visit = 0;
    def.progress = NULL;
    def.retire = def.retire ? tell_retirement : NULL;
    def.retire_user = &k->teller;
    fp3_status status = fp3_engine_open_on(&def, engine->config, self->usual, NULL, &k->own);
    if (!status)
        status = self->load(k->own, group->image);
    if (!status)
        fp3_engine_use(k->own, 0, k->awake);
    if (!status && self->rest.is_any && group->lists.shape.is_any)
        status = tell_numbers(self, layout, k, group);
    return status;
}

/* ---- births and ends ---- */

/* What all objects hold. */
static fp3_status hold(fp3_engine *engine, uint32_t *to) {
    const uint32_t registers = engine->config->registers;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        for (uint32_t reg = 0; !status && reg < registers && reg < 1u << group->log2; reg++)
            status = fp3_kinds_read(
                engine, (fp3_cells){FP3_CELLS_REGISTER, reg, group->first, group->objects},
                &to[(size_t)reg * engine->objects + group->first]);
    }
    if (!status && engine->config->status)
        status = fp3_kinds_read(engine, (fp3_cells){FP3_CELLS_STATUS, 0, 0, engine->objects},
                                &to[(size_t)registers * engine->objects]);
    return status;
}

/* Those that live get what was held. */
static fp3_status give_back(fp3_engine *engine) {
    fp3_kinds *self = fp3_kinds_of(engine);
    const uint32_t registers = engine->config->registers;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        const uint32_t words = registers + (engine->config->status != 0);
        for (uint32_t reg = 0; !status && self->kinds[i].own && reg < words; reg++)
            if (reg >= registers || reg < 1u << group->log2)
                status = fp3_kinds_put(
                    engine,
                    (fp3_cells){reg < registers ? FP3_CELLS_REGISTER : FP3_CELLS_STATUS,
                                reg < registers ? reg : 0, group->first, group->objects},
                    &self->held[(size_t)reg * engine->objects + group->first]);
        if (!status && self->kinds[i].own)
            status = fp3_kinds_put(engine, (fp3_cells){FP3_CELLS_CONSTANT, i, 0, registers},
                                   &self->constants[i * registers]);
    }
    for (uint32_t i = 0; !status && i < engine->layout.count; i++)
        status = fp3_kinds_connect(engine, &engine->layout.groups[i], NULL);
    return status;
}

static void close_engines(fp3_kinds *self) {
    for (uint32_t i = 0; i < self->count; i++)
        fp3_engine_close(&self->kinds[i].own);
    free(self->place);
    free(self->who);
    free(self->held);
    free(self->stage);
}

fp3_status fp3_kinds_form(fp3_engine *engine, const uint8_t *stage) {
    fp3_kinds *self = fp3_kinds_of(engine);
    fp3_kinds other = *self;
    const size_t objects = engine->objects;
    other.place = malloc((objects + 1) * sizeof *other.place);
    other.who = malloc((objects + 1) * sizeof *other.who);
    other.stage = malloc(objects + 1);
    other.held = calloc((engine->config->registers + (size_t)1) * objects, sizeof *other.held);
    for (uint32_t i = 0; i < self->count; i++)
        other.kinds[i].own = NULL;
    fp3_status status = other.place && other.who && other.held && other.stage
                            ? hold(engine, other.held)
                            : fp3_no_memory(engine->def.error);
    const fp3_kinds old = *self;
    if (!status) {
        other.bus_before = engine->bus;
        *self = other; /* engines keep the addresses of what is in it */
        memcpy(self->stage, stage, objects);
        fp3_kinds_place(self, &engine->layout);
        for (uint32_t i = 0; !status && i < self->count; i++)
            status = fp3_kinds_open_one(engine, self, &engine->layout, i);
        if (!status)
            status = give_back(engine);
        other = *self;
    }
    fp3_kinds gone = status ? other : old;
    close_engines(&gone);
    if (status)
        *self = old;
    return status;
}
