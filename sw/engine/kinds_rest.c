/* SPDX-License-Identifier: Apache-2.0 */
/* kinds_rest.c - objects at rest fall asleep by islands, and wake.
 *
 * A program counts in its state `at_rest` for how long its object has been at rest: from 1 on the
 * object may sleep. An island is all objects that are linked or near each other, directly or by
 * others. All objects of an island fall asleep together, and wake together: `at_rest` is -1 while
 * one sleeps, and 0 when it wakes. What follows from numbers alone is the same on all engines, so
 * no list of an engine, which a skin makes longer, is asked.
 */
#include "kinds_islands.h"
#include "machine/format.h"

#include <stdlib.h>
#include <string.h>

#define EVERY 16u /* steps: then islands may fall asleep; one may wake after each step */

/* ---- opened ---- */

fp3_status fp3_rest_open(const fp3_engine *engine, const fp3_layout *layout, fp3_kinds *self) {
    fp3_rest *r = &self->rest;
    const size_t objects = engine->objects + (size_t)1;
    for (uint32_t i = 0; i < layout->count; i++)
        r->is_any |= layout->groups[i].rest >= 0;
    r->clock = UINT64_MAX;
    if (!r->is_any)
        return FP3_OK;
    r->told = calloc(objects, 1);
    r->touched = calloc(objects, 1);
    r->flags = calloc(objects, 1);
    r->moved = calloc(objects, 1);
    r->root = malloc(objects * sizeof *r->root);
    if (r->told)
        memset(r->told, 1, objects); /* a record may begin with a sleeper */
    return r->told && r->touched && r->flags && r->moved && r->root
               ? FP3_OK
               : fp3_no_memory(engine->def.error);
}

void fp3_rest_close(fp3_rest *rest) {
    fp3_islands_forget(rest);
    free(rest->told);
    free(rest->touched);
    free(rest->flags);
    free(rest->moved);
    free(rest->root);
    *rest = (fp3_rest){0};
}

/* ---- what the caller does ---- */

static void note_group(fp3_engine *engine, uint32_t number) {
    const fp3_members *group = &engine->layout.groups[number];
    memset(fp3_kinds_of(engine)->rest.touched + group->first, 1, group->objects);
}

void fp3_rest_note(fp3_engine *engine, fp3_cells cells) {
    fp3_rest *r = &fp3_kinds_of(engine)->rest;
    if (!r->is_any || cells.kind == FP3_CELLS_STATUS)
        return;
    engine->sleepers.is_listed = 0;
    if (cells.kind == FP3_CELLS_CONSTANT) {
        note_group(engine, cells.number);
        return;
    }
    for (size_t i = cells.first; i < cells.first + cells.count; i++) {
        const int rest = fp3_layout_group_of(&engine->layout, i)->rest;
        (rest == (int)cells.number ? r->told : r->touched)[i] = 1;
    }
}

void fp3_rest_note_list(fp3_engine *engine, uint32_t group, const fp3_list *list) {
    fp3_rest *r = &fp3_kinds_of(engine)->rest;
    if (!r->is_any)
        return;
    engine->sleepers.is_listed = 0;
    fp3_islands_forget(r);
    note_group(engine, group);
    if (list->kind)
        note_group(engine, list->kind - 1);
}

/* ---- who moves of those that never rest ---- */

/* A word of each object of a group: compared with what it was after the step before. */
static fp3_status compare_word(fp3_engine *engine, fp3_foreign_word *word) {
    fp3_kinds *self = fp3_kinds_of(engine);
    const fp3_members *from = &engine->layout.groups[word->from];
    const fp3_cells cells = {FP3_CELLS_REGISTER, word->of, from->first, from->objects};
    const int is_first = !word->last;
    if (is_first)
        word->last = malloc((from->objects + (size_t)1) * sizeof *word->last);
    if (!word->last)
        return fp3_no_memory(engine->def.error);
    const fp3_status status = fp3_kinds_read(engine, cells, self->words);
    for (uint32_t i = 0; !status && i < from->objects; i++)
        self->rest.moved[from->first + i] |= !is_first && self->words[i] != word->last[i];
    memcpy(word->last, self->words, from->objects * sizeof *word->last);
    return status;
}

fp3_status fp3_rest_compare(fp3_engine *engine) {
    fp3_kinds *self = fp3_kinds_of(engine);
    fp3_status status = FP3_OK;
    memset(self->rest.moved, 0, engine->objects);
    for (uint32_t i = 0; i < self->count; i++)
        for (uint32_t k = 0; k < self->kinds[i].word_count; k++) {
            fp3_foreign_word *word = &self->kinds[i].words[k];
            if (!status && word->is_stored && engine->layout.groups[word->from].rest < 0)
                status = compare_word(engine, word);
        }
    return status;
}

/* ---- who sleeps ---- */

static void begin_flags(fp3_engine *engine, const uint8_t *stage) {
    fp3_rest *r = &fp3_kinds_of(engine)->rest;
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        for (uint32_t n = group->first; n < group->first + group->objects; n++)
            r->flags[n] = stage[n] == FP3_STAGE_ASLEEP ? SLEEPS
                          : stage[n] == FP3_STAGE_AWAKE
                              ? group->rest >= 0 || r->moved[n] ? MOVES : IS_KEPT
                              : 0;
    }
}

/* `at_rest` of all objects: read, or those written whose stage is another one. */
static fp3_status read_rest(fp3_engine *engine, uint32_t number, uint32_t *words) {
    const fp3_members *group = &engine->layout.groups[number];
    return fp3_kinds_read(
        engine,
        (fp3_cells){FP3_CELLS_REGISTER, (uint32_t)group->rest, group->first, group->objects},
        words);
}

static fp3_status write_rest(fp3_engine *engine, const uint8_t *before, const uint8_t *stage) {
    fp3_kinds *self = fp3_kinds_of(engine);
    uint32_t sleeping = 0;
    fp3_status status = FP3_OK;
    fp3_format_word(engine->config, -1, &sleeping);
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        int is_new = 0;
        if (group->rest < 0)
            continue;
        status = status ? status : read_rest(engine, i, self->words);
        for (uint32_t n = 0; n < group->objects; n++) {
            const uint32_t object = group->first + n;
            if (stage[object] == FP3_STAGE_NONE || before[object] == stage[object])
                continue;
            self->words[n] = stage[object] == FP3_STAGE_ASLEEP ? sleeping : 0;
            is_new = 1;
        }
        if (!status && is_new)
            status = fp3_kinds_put(engine,
                                   (fp3_cells){FP3_CELLS_REGISTER, (uint32_t)group->rest,
                                               group->first, group->objects},
                                   self->words);
    }
    return status;
}

/* Islands of which one is hit. */
static void wake(const fp3_engine *engine, uint8_t *stage, int *is_new) {
    const fp3_rest *r = &fp3_kinds_of(engine)->rest;
    fp3_islands_spread(engine, IS_HIT);
    for (uint32_t i = 0; i < engine->objects; i++)
        if (r->flags[i] & SLEEPS && r->flags[i] & IS_HIT && stage[i] == FP3_STAGE_ASLEEP) {
            stage[i] = FP3_STAGE_AWAKE;
            *is_new = 1;
        }
}

/* What the words say, where the caller wrote them, and of those that are born. */
static fp3_status take_told(fp3_engine *engine, uint8_t *before, uint8_t *stage) {
    fp3_kinds *self = fp3_kinds_of(engine);
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        if (group->rest < 0)
            continue;
        status = read_rest(engine, i, self->words);
        for (uint32_t n = 0; !status && n < group->objects; n++) {
            const uint32_t object = group->first + n;
            if (stage[object] == FP3_STAGE_NONE)
                continue;
            if (self->rest.told[object] || before[object] == FP3_STAGE_NONE)
                before[object] = fp3_format_value(engine->config, self->words[n]) < 0
                                     ? FP3_STAGE_ASLEEP
                                     : FP3_STAGE_AWAKE;
            stage[object] = before[object];
        }
    }
    return status;
}

/* Who has just gone is where it was, once more: it wakes those that it leaves behind. */
static fp3_status settle(fp3_engine *engine, uint8_t *before, uint8_t *stage) {
    fp3_kinds *self = fp3_kinds_of(engine);
    fp3_rest *r = &self->rest;
    int is_new = 0;
    fp3_islands_forget(r); /* others may live */
    fp3_status status = take_told(engine, before, stage);
    if (status)
        return status;
    memset(r->moved, 0, engine->objects);
    begin_flags(engine, stage);
    for (uint32_t i = 0; r->clock == engine->clock && i < engine->objects; i++) {
        if (stage[i] == FP3_STAGE_NONE && self->stage[i] != FP3_STAGE_NONE)
            r->flags[i] = MOVES;
        else if (stage[i] != FP3_STAGE_NONE && r->touched[i] && !r->told[i])
            r->flags[i] |= r->flags[i] & SLEEPS ? IS_HIT : MOVES;
    }
    status = fp3_islands_find(engine, 0);
    if (!status)
        wake(engine, stage, &is_new);
    fp3_islands_forget(r);
    return status ? status : write_rest(engine, before, stage);
}

/* Whether the caller wrote something, or others live, since the last part of a run. */
static int is_changed(const fp3_engine *engine, const uint8_t *stage) {
    const fp3_kinds *self = fp3_kinds_of(engine);
    for (uint32_t i = 0; i < engine->objects; i++)
        if (self->rest.told[i] || self->rest.touched[i] || !stage[i] != !self->stage[i])
            return 1;
    return 0;
}

fp3_status fp3_rest_settle(fp3_engine *engine, uint8_t *stage) {
    fp3_rest *r = &fp3_kinds_of(engine)->rest;
    uint8_t *before = NULL;
    if (!is_changed(engine, stage)) {
        memcpy(stage, fp3_kinds_of(engine)->stage, engine->objects);
        return FP3_OK;
    }
    before = malloc(engine->objects + (size_t)1);
    if (!before)
        return fp3_no_memory(engine->def.error);
    memcpy(before, fp3_kinds_of(engine)->stage, engine->objects);
    const fp3_status status = settle(engine, before, stage);
    free(before);
    if (!status) {
        memset(r->told, 0, engine->objects);
        memset(r->touched, 0, engine->objects);
    }
    return status;
}

/* Those that have been at rest for long enough. */
static fp3_status find_who_rests(fp3_engine *engine, int *is_any) {
    fp3_kinds *self = fp3_kinds_of(engine);
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        if (group->rest < 0 || !self->kinds[i].awake)
            continue;
        status = read_rest(engine, i, self->words);
        for (uint32_t n = 0; !status && n < group->objects; n++)
            if (self->rest.flags[group->first + n] & MOVES &&
                fp3_format_value(engine->config, self->words[n]) >= 1) {
                self->rest.flags[group->first + n] |= RESTS;
                *is_any = 1;
            }
    }
    return status;
}

static void fall_asleep(const fp3_engine *engine, uint8_t *stage, int *is_new) {
    const fp3_rest *r = &fp3_kinds_of(engine)->rest;
    for (uint32_t i = 0; i < engine->objects; i++)
        if (r->flags[i] & MOVES && !(r->flags[i] & RESTS))
            r->flags[i] |= IS_KEPT;
    fp3_islands_spread(engine, IS_KEPT);
    for (uint32_t i = 0; i < engine->objects; i++)
        if (r->flags[i] & MOVES && !(r->flags[i] & IS_KEPT)) {
            stage[i] = FP3_STAGE_ASLEEP;
            *is_new = 1;
        }
}

static int is_anyone(const fp3_engine *engine, uint8_t flag) {
    const fp3_rest *r = &fp3_kinds_of(engine)->rest;
    for (uint32_t i = 0; i < engine->objects; i++)
        if (r->flags[i] & flag)
            return 1;
    return 0;
}

fp3_status fp3_rest_look(fp3_engine *engine, uint32_t number, uint8_t *stage, int *is_new) {
    const fp3_kinds *self = fp3_kinds_of(engine);
    int is_any = 0, may_wake = 0;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < self->count; i++)
        may_wake |= self->kinds[i].awake < self->kinds[i].living;
    if (!may_wake && number % EVERY)
        return FP3_OK;
    begin_flags(engine, stage);
    if (number % EVERY == 0)
        status = find_who_rests(engine, &is_any);
    if (!status && !is_any && may_wake)
        status = fp3_islands_find(engine, 1);
    if (status || (!is_any && !is_anyone(engine, IS_HIT)))
        return status;
    status = fp3_islands_find(engine, 0);
    if (status)
        return status;
    wake(engine, stage, is_new);
    if (is_any)
        fall_asleep(engine, stage, is_new);
    return *is_new ? write_rest(engine, self->stage, stage) : FP3_OK;
}
