/* SPDX-License-Identifier: Apache-2.0 */
/* kinds_run.c - steps that groups make together. */
#include "kinds_inside.h"

#include "engine/common/origin.h"

#include "gen/registers.h"

#include <stdlib.h>
#include <string.h>

/* What objects of a group hold that sleep, behind the words of those that are awake. */
static void add_held(const fp3_engine *engine, uint32_t group, uint32_t reg, uint32_t *words) {
    const fp3_kinds *self = fp3_kinds_of(engine);
    const uint32_t *who = fp3_kinds_who(engine, group);
    for (uint32_t i = self->kinds[group].awake; i < self->kinds[group].living; i++)
        words[i] = self->held[(size_t)reg * engine->objects + who[i]];
}

/* Those that sleep are as guests among those that do not: a phase does not store their words. */
static fp3_status bring_sleepers(fp3_engine *engine, uint32_t number) {
    fp3_kinds *self = fp3_kinds_of(engine);
    const fp3_kind_engine *k = &self->kinds[number];
    const fp3_lists *lists = &engine->layout.groups[number].lists;
    uint64_t seen = lists->shape.is_any ? lists->shape.published : 0;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < lists->shape.list_count; i++)
        if (lists->lists[i].is_near)
            seen |= fp3_near_registers(&lists->lists[i].near, 0);
    for (uint32_t reg = 0; !status && reg < FP3_BANK_OBJECT_COUNT; reg++) {
        const fp3_cells here = {FP3_CELLS_REGISTER, reg, k->awake, k->living - k->awake};
        if (!(seen >> reg & 1))
            continue;
        add_held(engine, number, reg, self->words);
        status = k->own->backend->write(k->own, here, self->words + k->awake);
    }
    return status;
}

/* The objects of a group, as they are now, become guests of this kind. */
static fp3_status bring(fp3_engine *engine, fp3_kind_engine *k, fp3_foreign_word *f) {
    fp3_kinds *self = fp3_kinds_of(engine);
    const uint32_t awake = self->kinds[f->from].awake, registers = engine->config->registers;
    const uint32_t count = self->fresh || f->is_shared ? self->kinds[f->from].living : awake;
    fp3_engine *from = self->kinds[f->from].own;
    const fp3_cells theirs = {FP3_CELLS_REGISTER, f->of, 0, awake},
                    here = {FP3_CELLS_REGISTER, f->reg, k->base[f->from], count};
    fp3_status status = FP3_OK;
    if (!count)
        return FP3_OK;
    for (uint32_t i = 0; f->is_shared && i < count; i++)
        self->words[i] = self->constants[f->from * registers + f->of];
    if (!f->is_shared && theirs.count)
        status = from->backend->read(from, theirs, self->words);
    if (!f->is_shared && self->fresh)
        add_held(engine, f->from, f->of, self->words);
    if (!status)
        status = k->own->backend->write(k->own, here, self->words);
    f->is_brought = !status && !f->is_stored;
    return status;
}

static fp3_status bring_all(fp3_engine *engine, uint32_t phase) {
    fp3_kinds *self = fp3_kinds_of(engine);
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < self->count; i++) {
        fp3_kind_engine *k = &self->kinds[i];
        if (!status && self->fresh && k->awake && k->awake < k->living && phase < k->phases)
            status = bring_sleepers(engine, i);
        for (uint32_t w = 0; !status && k->awake && phase < k->phases && w < k->word_count; w++)
            if (!k->words[w].is_brought)
                status = bring(engine, k, &k->words[w]);
    }
    return status;
}

/* As if one machine took the kinds in turn. */
static void add_counters(const fp3_engine *engine, const fp3_engine *own) {
    for (uint32_t s = 0; s < fp3_config_schedulers(engine->config); s++)
        for (int i = 0; i < FP3_COUNTER_COUNT; i++)
            engine->counters[s][i] += own->counters[s][i];
}

static fp3_status make_round(fp3_engine *engine, uint32_t phase, fp3_stats *stats) {
    fp3_kinds *self = fp3_kinds_of(engine);
    fp3_status status = fp3_kinds_compare(engine, phase);
    if (!status)
        status = bring_all(engine, phase);
    for (uint32_t i = 0; !status && i < self->count; i++) {
        fp3_kind_engine *k = &self->kinds[i];
        if (!k->awake || phase >= k->phases)
            continue;
        status = fp3_engine_make_phase(k->own, phase, stats);
        if (!engine->backend->is_uncounted)
            add_counters(engine, k->own);
    }
    return status;
}

static fp3_status make_step(fp3_engine *engine, uint32_t clock, fp3_stats *stats) {
    fp3_kinds *self = fp3_kinds_of(engine);
    uint32_t phases = 0;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < self->count; i++) {
        if (self->kinds[i].own)
            self->kinds[i].own->clock = clock;
        phases = self->kinds[i].phases > phases ? self->kinds[i].phases : phases;
    }
    for (uint32_t phase = 0; !status && phase < phases; phase++)
        status = make_round(engine, phase, stats);
    self->fresh -= self->fresh != 0;
    return status;
}

/* A register of the objects of which it was known. */
static fp3_status undo_register(fp3_engine *engine, const fp3_members *group, uint32_t reg) {
    const fp3_origin *o = engine->origin;
    const size_t end = (size_t)group->first + group->objects;
    fp3_status status = FP3_OK;
    for (size_t first = group->first, last; !status && first < end; first = last + 1) {
        for (last = first; last < end && o->began[last] >> reg & 1; last++)
            ;
        if (last > first)
            status =
                fp3_kinds_put(engine, (fp3_cells){FP3_CELLS_REGISTER, reg, first, last - first},
                              &o->registers[reg * engine->objects + first]);
    }
    return status;
}

/* A run that does not come to its end leaves all objects as they were, and who sleeps is what their
 * words say. */
static fp3_status undo(fp3_engine *engine) {
    fp3_rest *rest = &fp3_kinds_of(engine)->rest;
    fp3_status status = FP3_OK;
    if (rest->is_any)
        memset(rest->told, 1, engine->objects);
    for (uint32_t i = 0; i < engine->layout.count; i++)
        for (uint32_t reg = 0; !status && reg < 1u << engine->layout.groups[i].log2; reg++)
            status = undo_register(engine, &engine->layout.groups[i], reg);
    if (!status)
        status = fp3_origin_remember(engine, NULL, &engine->layout, engine->def.error);
    for (uint32_t i = 0; !status && i < engine->layout.count; i++)
        status = fp3_kinds_connect(engine, &engine->layout.groups[i], NULL);
    return status;
}

/* ---- who failed ---- */

/* The object, 1 + its number in all groups, that is in a row of a kind's engine, 1 + the row. */
static uint32_t number_of(const fp3_engine *engine, uint32_t own, uint32_t partner) {
    const fp3_kinds *self = fp3_kinds_of(engine);
    const fp3_kind_engine *k = &self->kinds[own];
    if (!partner || partner <= k->living)
        return partner ? fp3_kinds_who(engine, own)[partner - 1] + 1 : 0;
    for (uint32_t i = 0; i < self->count; i++)
        if (k->base[i] != FP3_NO_OBJECT_ROW && partner > k->base[i] &&
            partner - k->base[i] <= self->kinds[i].living)
            return fp3_kinds_who(engine, i)[partner - k->base[i] - 1] + 1;
    return 0;
}

/* The engine of a kind notes what its objects raise, row by row. */
static fp3_status watch(fp3_engine *engine, uint32_t number) {
    const fp3_members *group = &engine->layout.groups[number];
    fp3_kind_engine *k = &fp3_kinds_of(engine)->kinds[number];
    const uint32_t *who = fp3_kinds_who(engine, number);
    if (!engine->watched || !k->own)
        return FP3_OK;
    fp3_members *own = &k->own->layout.groups[0];
    k->own->watched = malloc((k->living + (size_t)1) * sizeof *k->own->watched);
    if (!k->own->watched)
        return fp3_no_memory(engine->def.error);
    for (uint32_t i = 0; i < k->living; i++)
        k->own->watched[i] = engine->watched[who[i]];
    k->own->began = engine->began;
    own->is_ahead = group->is_ahead; /* of the same words */
    own->live = group->live;
    return FP3_OK;
}

static void watch_no_more(fp3_engine *engine, uint32_t number) {
    fp3_engine *own = fp3_kinds_of(engine)->kinds[number].own;
    const uint32_t *who = fp3_kinds_who(engine, number);
    if (!engine->watched || !own || !own->watched)
        return;
    for (uint32_t i = 0; i < fp3_kinds_of(engine)->kinds[number].living; i++) {
        const uint32_t before = engine->watched[who[i]].partner;
        fp3_watched *to = &engine->watched[who[i]];
        *to = own->watched[i];
        to->partner = before ? before : number_of(engine, number, to->partner);
    }
    own->layout.groups[0].is_ahead = NULL;
    free(own->watched);
    own->watched = NULL;
}

/* Notes who makes no step now; 1: nobody makes any of those that are left. */
static int skip_sleepers(fp3_engine *engine, uint32_t left) {
    const fp3_kinds *self = fp3_kinds_of(engine);
    int is_awake = 0;
    for (uint32_t i = 0; i < self->count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        is_awake |= self->kinds[i].awake && (!group->visit || group->visit->stored);
    }
    for (uint32_t i = 0; i < self->count; i++)
        engine->layout.groups[i].slept +=
            (uint64_t)(self->kinds[i].living - self->kinds[i].awake) * (is_awake ? 1 : left);
    return !is_awake;
}

/* After a step: others may sleep from now on. */
static fp3_status look_who_rests(fp3_engine *engine, uint32_t number) {
    const fp3_kinds *self = fp3_kinds_of(engine);
    uint8_t *stage = malloc(engine->objects + (size_t)1);
    int is_new = 0;
    if (!stage)
        return fp3_no_memory(engine->def.error);
    memcpy(stage, self->stage, engine->objects);
    fp3_status status = fp3_rest_compare(engine);
    if (!status)
        status = fp3_rest_look(engine, number, stage, &is_new);
    if (!status && is_new) {
        for (uint32_t i = 0; i < self->count; i++)
            watch_no_more(engine, i);
        status = fp3_kinds_take_memories(engine);
        if (!status)
            status = fp3_kinds_form(engine, stage);
        for (uint32_t i = 0; !status && i < self->count; i++)
            status = watch(engine, i);
    }
    free(stage);
    return status;
}

fp3_status fp3_kinds_run(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    const uint32_t count = fp3_kinds_of(engine)->count;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < count; i++)
        engine->layout.groups[i].slept = 0;
    if (fp3_kinds_of(engine)->rest.is_any)
        status = fp3_rest_compare(engine);
    for (uint32_t i = 0; !status && i < count; i++)
        status = watch(engine, i);
    for (uint32_t step = 0; !status && step < steps; step++) {
        if (skip_sleepers(engine, steps - step))
            break;
        status = make_step(engine, engine->clock + step, stats);
        if (!status && fp3_kinds_of(engine)->rest.is_any)
            status = look_who_rests(engine, engine->clock + step + 1);
        fp3_engine_tell(engine, (uint64_t)(engine->expected * (step + 1) / steps));
    }
    for (uint32_t i = 0; i < count; i++)
        watch_no_more(engine, i);
    if (!status)
        status = fp3_kinds_take_memories(engine);
    stats->schedulers = 1;
    fp3_kinds_count_bus(engine);
    if (!status) {
        fp3_kinds_of(engine)->rest.clock = (uint64_t)engine->clock + steps;
        return FP3_OK;
    }
    const fp3_error why = engine->def.error ? *engine->def.error : (fp3_error){.text = ""};
    const fp3_status undone = undo(engine);
    if (!undone && engine->def.error)
        *engine->def.error = why;
    return undone ? undone : status;
}
