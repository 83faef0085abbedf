/* SPDX-License-Identifier: Apache-2.0 */
/* kinds_rest.c - objects at rest fall asleep by islands, and wake.
 *
 * A program counts in its state `at_rest` for how long its object has been at rest: from 1 on the
 * object may sleep. An island is all objects that are linked or near each other, directly or by
 * others. All objects of an island fall asleep together, and wake together: `at_rest` is -1 while
 * one sleeps, and 0 when it wakes. What follows from numbers alone is the same on all engines, so
 * no list of an engine, which a skin makes longer, is asked.
 */
#include "kinds_inside.h"
#include "machine/format.h"

#include <stdlib.h>
#include <string.h>

#define EVERY 16u /* steps: then islands may fall asleep; one may wake after each step */

/* Of each object, while islands are found. */
enum { MOVES = 1, SLEEPS = MOVES << 1, RESTS = 4, IS_HIT = 8, IS_KEPT = 16 };

/* ---- opened ---- */

fp3_status fp3_rest_open(const fp3_engine *engine, const fp3_layout *layout, fp3_kinds *self) {
    fp3_rest *r = &self->rest;
    const size_t objects = engine->objects + (size_t)1;
    for (uint32_t i = 0; i < layout->count; i++)
        r->is_any |= layout->groups[i].rest >= 0;
    if (!r->is_any)
        return FP3_OK;
    r->told = calloc(objects, 1);
    r->touched = calloc(objects, 1);
    r->flags = calloc(objects, 1);
    r->root = malloc(objects * sizeof *r->root);
    if (r->told)
        memset(r->told, 1, objects); /* a record may begin with a sleeper */
    return r->told && r->touched && r->flags && r->root ? FP3_OK : fp3_no_memory(engine->def.error);
}

static void forget_near(fp3_rest *r) {
    for (int i = 0; i < FP3_JOINED_MAX; i++)
        for (int k = 0; k < FP3_LISTS_MAX; k++) {
            struct fp3_rest_near *n = &r->near[i][k];
            fp3_near_close(&n->rule);
            free(n->begin);
            free(n->other);
            free(n->words);
            *n = (struct fp3_rest_near){.begin = NULL};
        }
}

void fp3_rest_close(fp3_rest *rest) {
    forget_near(rest);
    free(rest->told);
    free(rest->touched);
    free(rest->flags);
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
    forget_near(r);
    note_group(engine, group);
    if (list->kind)
        note_group(engine, list->kind - 1);
}

/* ---- islands ---- */

/* Nobody waits for those that others see at the same place for ever. */
static int is_fixed(const fp3_engine *engine, uint32_t number) {
    const fp3_kinds *self = fp3_kinds_of(engine);
    const fp3_members *group = &engine->layout.groups[number];
    int is = group->rest < 0 && !fp3_layout_published(group);
    for (uint32_t i = 0; i < self->count; i++)
        for (uint32_t k = 0; k < self->kinds[i].word_count; k++)
            is &= self->kinds[i].words[k].from != number || !self->kinds[i].words[k].is_stored;
    return is;
}

/* Whose pairs tell all that a group wakes, or is woken by: those of another one, or its own. Own
 * pairs are in the lists of both ends, so the fewer rows do. */
static uint8_t whose_pairs(const fp3_engine *engine, uint32_t group, uint32_t other) {
    const fp3_kinds *self = fp3_kinds_of(engine);
    const fp3_kind_engine *own = &self->kinds[group], *their = &self->kinds[other];
    const uint32_t asleep = own->living - own->awake;
    if (group == other)
        return own->awake < asleep ? MOVES : SLEEPS;
    return (their->awake < their->living ? MOVES : 0) |
           (their->awake && !is_fixed(engine, other) ? SLEEPS : 0);
}

static uint32_t root_of(uint32_t *root, uint32_t i) {
    while (root[i] != i)
        i = root[i] = root[root[i]];
    return i;
}

/* Two objects that are linked, or near each other. Who does not move is in no island. */
static void meet(fp3_rest *r, uint32_t a, uint32_t b) {
    const uint8_t x = r->flags[a], y = r->flags[b];
    if ((x & y) & (MOVES | SLEEPS)) {
        a = root_of(r->root, a);
        b = root_of(r->root, b);
        r->root[a > b ? a : b] = a > b ? b : a;
    } else if ((x | y) & MOVES && (x | y) & SLEEPS) { /* the one wakes, and the other stays awake */
        r->flags[a] |= x & SLEEPS ? IS_HIT : IS_KEPT;
        r->flags[b] |= y & SLEEPS ? IS_HIT : IS_KEPT;
    }
}

/* Where a word of these objects stands for those of another group, as `theirs` in a list. */
static const fp3_foreign_word *foreign(const fp3_kind_engine *k, uint32_t reg) {
    uint32_t i = 0;
    while (i + 1 < k->word_count && k->words[i].reg != reg)
        i++;
    return &k->words[i];
}

/* A word of all objects of the group; or its constant, for each of them. */
static fp3_status read_word(fp3_engine *engine, uint32_t group, uint32_t reg, int is_shared,
                            uint32_t *to) {
    const fp3_members *g = &engine->layout.groups[group];
    const uint32_t registers = engine->config->registers;
    for (uint32_t i = 0; is_shared && i < g->objects; i++)
        to[i] = fp3_kinds_of(engine)->constants[group * registers + reg];
    return is_shared ? FP3_OK
                     : fp3_kinds_read(
                           engine, (fp3_cells){FP3_CELLS_REGISTER, reg, g->first, g->objects}, to);
}

/* The words of those that have moved since. */
static fp3_status read_awake(fp3_engine *engine, uint32_t group, uint32_t reg, uint32_t *to) {
    fp3_kinds *self = fp3_kinds_of(engine);
    const fp3_kind_engine *k = &self->kinds[group];
    const uint32_t *who = fp3_kinds_who(engine, group), first = engine->layout.groups[group].first;
    if (!k->awake)
        return FP3_OK;
    const fp3_status status = k->own->backend->read(
        k->own, (fp3_cells){FP3_CELLS_REGISTER, reg, 0, k->awake}, self->words);
    for (uint32_t i = 0; !status && i < k->awake; i++)
        to[who[i] - first] = self->words[i];
    return status;
}

/* Whether rows are nearer than the reach; a program tells by FP32, which may differ in the last
 * places. */
static int is_near(const fp3_near_rule *rule, const fp3_where_they_are *w, uint32_t a, uint32_t b) {
    double sum = 0;
    for (uint32_t k = 0; k < w->dimensions; k++) {
        const double way =
            fp3_near_number(rule, w->position[k][a]) - fp3_near_number(rule, w->position[k][b]);
        sum += way * way;
    }
    return sum < rule->reach * rule->reach;
}

/* The columns of `near` as they are now: own rows, and then those of the kind. */
static fp3_status look_where(fp3_engine *engine, uint32_t number, const fp3_list *list,
                             struct fp3_rest_near *n, fp3_where_they_are *now) {
    const fp3_kinds *self = fp3_kinds_of(engine);
    const uint32_t from = list->kind ? list->kind - 1 : number;
    const int is_first = !n->words;
    fp3_status status = FP3_OK;
    if (is_first)
        n->words = malloc((now->objects * (size_t)now->dimensions + 1) * sizeof *n->words);
    if (!n->words)
        return fp3_no_memory(engine->def.error);
    for (uint32_t k = 0; !status && k < now->dimensions; k++) {
        uint32_t *column = n->words + (size_t)k * now->objects;
        const fp3_foreign_word *f =
            list->kind ? foreign(&self->kinds[number], list->near.theirs[k]) : NULL;
        status = is_first ? read_word(engine, number, list->near.regs[k], 0, column)
                          : read_awake(engine, number, list->near.regs[k], column);
        if (!status && f && is_first)
            status = read_word(engine, from, f->of, f->is_shared, column + now->own);
        else if (!status && f && !f->is_shared)
            status = read_awake(engine, from, f->of, column + now->own);
        now->position[k] = column;
        now->theirs[k] = f ? column : NULL;
    }
    if (status) {
        free(n->words);
        n->words = NULL;
    }
    return status;
}

/* Whose list has all that are near now, and perhaps others. */
static fp3_status list_near(fp3_engine *engine, const fp3_near_rule *rule, struct fp3_rest_near *n,
                            const fp3_where_they_are *now) {
    uint32_t *begin = NULL, *other = NULL;
    if (!n->begin)
        n->rule = (fp3_near_rule){.dimensions = rule->dimensions,
                                  .format = rule->format,
                                  .reach = rule->reach,
                                  .skin = rule->skin};
    else if (!fp3_near_is_stale(&n->rule, now))
        return FP3_OK;
    const fp3_status status = fp3_near_make(&n->rule, now, &begin, &other, engine->def.error);
    free(n->begin);
    free(n->other);
    n->begin = status ? NULL : begin;
    n->other = status ? NULL : other;
    if (status) {
        free(begin);
        free(other);
        fp3_near_close(&n->rule);
    }
    return status;
}

/* is_brief: only pairs matter of which one sleeps and the other moves. */
static fp3_status meet_near(fp3_engine *engine, uint32_t number, uint32_t list_number,
                            int is_brief) {
    fp3_kinds *self = fp3_kinds_of(engine);
    fp3_rest *r = &self->rest;
    const fp3_members *group = &engine->layout.groups[number];
    const fp3_list *list = &group->lists.lists[list_number];
    struct fp3_rest_near *n = &r->near[number][list_number];
    const fp3_members *theirs = list->kind ? &engine->layout.groups[list->kind - 1] : NULL;
    const uint32_t rows = group->objects + (theirs ? theirs->objects : 0);
    const uint8_t whose =
        is_brief ? whose_pairs(engine, number, list->kind ? list->kind - 1 : number) : 0xff;
    uint8_t *lives = malloc(rows + (size_t)1);
    fp3_where_they_are now = {.own = group->objects,
                              .from = group->objects,
                              .lives = lives,
                              .stride = 1,
                              .objects = rows,
                              .dimensions = list->near.dimensions};
    fp3_status status =
        lives ? look_where(engine, number, list, n, &now) : fp3_no_memory(engine->def.error);
    for (uint32_t i = 0; !status && i < rows; i++)
        lives[i] =
            r->flags[i < group->objects ? group->first + i : theirs->first + i - group->objects] !=
            0;
    if (!status)
        status = list_near(engine, &list->near, n, &now);
    for (uint32_t i = 0; !status && i < group->objects; i++)
        for (uint32_t e = n->begin[i]; r->flags[group->first + i] & whose && e < n->begin[i + 1];
             e++)
            if (lives[i] && lives[n->other[e]] && is_near(&list->near, &now, i, n->other[e]))
                meet(r, group->first + i,
                     n->other[e] < group->objects ? group->first + n->other[e]
                                                  : theirs->first + n->other[e] - group->objects);
    free(lives);
    return status;
}

static void meet_linked(fp3_engine *engine, const fp3_members *group, const fp3_list *list) {
    const uint32_t first = engine->layout.groups[list->kind ? list->kind - 1 : 0].first;
    for (uint32_t i = 0; i < group->objects; i++)
        for (uint32_t e = list->begin[i]; e < list->begin[i + 1]; e++)
            meet(&fp3_kinds_of(engine)->rest, group->first + i,
                 (list->kind ? first : group->first) + list->other[e]);
}

static void meet_each(const fp3_engine *engine, const fp3_members *group, uint32_t pivot) {
    for (uint32_t i = group->first; i < group->first + group->objects; i++)
        if (i != pivot)
            meet(&fp3_kinds_of(engine)->rest, i, pivot);
}

/* Everybody of `group` sees everybody of `seen`. Those of `seen` are one island whoever sees them:
 * sums over all go by rows, and rows are in the order of numbers as long as none sleeps alone. */
static void meet_all(const fp3_engine *engine, const fp3_members *group, const fp3_members *seen) {
    const uint8_t *flags = fp3_kinds_of(engine)->rest.flags;
    for (uint8_t which = MOVES; which <= SLEEPS; which <<= 1) {
        uint32_t pivot = seen->first;
        while (pivot < seen->first + seen->objects && !(flags[pivot] & which))
            pivot++;
        if (pivot == seen->first + seen->objects)
            continue;
        meet_each(engine, group, pivot);
        meet_each(engine, seen, pivot);
    }
}

/* is_brief: only who is hit. */
static fp3_status find_islands(fp3_engine *engine, int is_brief) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < engine->objects; i++)
        fp3_kinds_of(engine)->rest.root[i] = i;
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        for (uint32_t k = 0; !status && k < group->lists.shape.list_count; k++) {
            const fp3_list *list = &group->lists.lists[k];
            if (list->is_near)
                status = meet_near(engine, i, k, is_brief);
            else if (list->is_all)
                meet_all(engine, group,
                         list->kind ? &engine->layout.groups[list->kind - 1] : group);
            else if (list->is_there)
                meet_linked(engine, group, list);
        }
    }
    return status;
}

/* What is true of one is true of its island. */
static void spread(const fp3_engine *engine, uint8_t flag) {
    const fp3_rest *r = &fp3_kinds_of(engine)->rest;
    for (uint32_t i = 0; i < engine->objects; i++)
        if (r->flags[i] & flag)
            r->flags[root_of(r->root, i)] |= flag;
    for (uint32_t i = 0; i < engine->objects; i++)
        r->flags[i] |= r->flags[root_of(r->root, i)] & flag;
}

/* ---- who sleeps ---- */

static void begin_flags(fp3_engine *engine, const uint8_t *stage) {
    fp3_rest *r = &fp3_kinds_of(engine)->rest;
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        const uint8_t moves = is_fixed(engine, i) ? IS_KEPT : MOVES;
        for (uint32_t n = group->first; n < group->first + group->objects; n++)
            r->flags[n] = stage[n] == FP3_STAGE_ASLEEP  ? SLEEPS
                          : stage[n] == FP3_STAGE_AWAKE ? moves
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
    spread(engine, IS_HIT);
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
    forget_near(r); /* others may live */
    fp3_status status = take_told(engine, before, stage);
    if (status)
        return status;
    begin_flags(engine, stage);
    for (uint32_t i = 0; i < engine->objects; i++) {
        if (stage[i] == FP3_STAGE_NONE && self->stage[i] != FP3_STAGE_NONE)
            r->flags[i] = MOVES;
        else if (stage[i] != FP3_STAGE_NONE && r->touched[i] && !r->told[i])
            r->flags[i] |= r->flags[i] & SLEEPS ? IS_HIT : MOVES;
    }
    status = find_islands(engine, 0);
    if (!status)
        wake(engine, stage, &is_new);
    forget_near(r);
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
    spread(engine, IS_KEPT);
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
        status = find_islands(engine, 1);
    if (status || (!is_any && !is_anyone(engine, IS_HIT)))
        return status;
    status = find_islands(engine, 0);
    if (status)
        return status;
    wake(engine, stage, is_new);
    if (is_any)
        fall_asleep(engine, stage, is_new);
    return *is_new ? write_rest(engine, self->stage, stage) : FP3_OK;
}
