/* SPDX-License-Identifier: Apache-2.0 */
/* memory.c - what pairs remember, among ranks: by the objects' numbers in the lists of the engine
 * that has them all, by rows in that of a rank.
 *
 * Each rank has all of it between runs. In a run a rank has what its own objects remember, and rows
 * of guests change.
 */
#include "engine/common/cells.h"
#include "inside.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* A pair takes its object and neighbour, and its fields. */
#define NAMES 2

static const uint32_t *rows_of(const fp3_engine *own) {
    return own->backend->rows ? own->backend->rows(own) : NULL;
}

static fp3_status save(const fp3_engine *own, uint32_t k, fp3_remembered *saved) {
    const fp3_members *group = &own->layout.groups[0];
    return fp3_list_save(&group->lists.lists[k], rows_of(own), group->rows, saved, own->def.error);
}

static fp3_status restore(fp3_engine *own, uint32_t k, const fp3_remembered *saved) {
    fp3_members *group = &own->layout.groups[0];
    return fp3_list_restore(&group->lists.lists[k], rows_of(own), group->rows, saved,
                            own->def.error);
}

static fp3_status open_memory(fp3_remembered *made, size_t objects, size_t pairs, size_t fields,
                              fp3_error *error) {
    *made = (fp3_remembered){calloc(objects + 1, sizeof *made->begin),
                             calloc(pairs + 1, sizeof *made->other),
                             calloc(pairs * fields + 1, sizeof *made->field)};
    return made->begin && made->other && made->field ? FP3_OK : fp3_no_memory(error);
}

/* ---- rows ---- */

fp3_status fp3_ranks_give_near(fp3_engine *engine, const fp3_ranked *to, uint32_t k,
                               const uint32_t *rows) {
    const fp3_list *list = &engine->layout.groups[0].lists.lists[k];
    const uint32_t count = to->share[fp3_ranks_here(to)];
    const size_t fields = list->fields;
    fp3_remembered made = {0};
    uint32_t n = 0;
    if (!list->begin)
        return FP3_OK;
    fp3_status status =
        open_memory(&made, to->room, list->begin[list->objects], fields, engine->def.error);
    for (uint32_t i = 0; !status && i < to->room; i++) {
        const uint32_t at = i - to->first, from = at < count ? list->begin[to->mine[at]] : 0,
                       end = at < count ? list->begin[to->mine[at] + 1] : 0;
        for (uint32_t e = from; e < end; e++) {
            if (rows[list->other[e]] == UINT32_MAX)
                continue; /* nobody that was near when the last step ended */
            made.other[n] = rows[list->other[e]];
            memcpy(&made.field[n++ * fields], &list->field[e * fields],
                   fields * sizeof *made.field);
        }
        made.begin[i + 1] = n;
    }
    if (!status)
        status = restore(to->own, k, &made);
    fp3_remembered_free(&made);
    return status;
}

/* An entry of a pair that remembers has no row any more if it moved apart within a step, farther
 * than the skin: its partner's rank does not know of it. */
static fp3_status rename_pairs(const fp3_engine *own, const uint32_t *before, const uint32_t *now,
                               uint32_t rooms, const fp3_remembered *from, uint32_t rows,
                               fp3_remembered *made, size_t fields) {
    uint32_t most = 0, *row = NULL;
    for (uint32_t i = 0; i < rooms; i++) {
        most = before[i] != UINT32_MAX && before[i] > most ? before[i] : most;
        most = now[i] != UINT32_MAX && now[i] > most ? now[i] : most;
    }
    row = malloc((most + (size_t)1) * sizeof *row);
    fp3_status status = open_memory(made, rooms, from->begin[rows], fields, own->def.error);
    if (!row || status) {
        free(row);
        return status ? status : fp3_no_memory(own->def.error);
    }
    memset(row, 0xff, (most + (size_t)1) * sizeof *row);
    for (uint32_t i = 0; i < rooms; i++)
        if (now[i] != UINT32_MAX)
            row[now[i]] = i;
    for (uint32_t i = 0; i < rooms; i++) {
        const uint32_t begin = from->begin[i < rows ? i : rows],
                       end = from->begin[i < rows ? i + 1 : rows];
        /* Own objects keep their rows; guests are in the lists of others alone. */
        const int is_own = before[i] != UINT32_MAX && before[i] == now[i];
        made->begin[i + 1] = made->begin[i];
        for (uint32_t e = begin; is_own && e < end; e++) {
            const uint32_t to = row[before[from->other[e]]], n = made->begin[i + 1]++;
            if (to == UINT32_MAX && !status)
                status = fp3_fail(own->def.error, FP3_E_PROGRAM,
                                  "objects %" PRIu32 " and %" PRIu32
                                  " remember each other, are on two ranks, and move apart within a "
                                  "step by more than the skin: expected a wider `skin`",
                                  before[i], before[from->other[e]]);
            made->other[n] = to;
            memcpy(&made->field[n * fields], &from->field[e * fields],
                   fields * sizeof *made->field);
        }
    }
    free(row);
    return status;
}

fp3_status fp3_ranks_keep(const fp3_ranked *self, fp3_remembered saved[FP3_LISTS_MAX]) {
    const fp3_lists *lists = &self->own->layout.groups[0].lists;
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; !status && k < lists->shape.list_count; k++)
        if (lists->lists[k].is_near && fp3_list_remembers(&lists->lists[k]))
            status = save(self->own, k, &saved[k]);
    return status;
}

fp3_status fp3_ranks_rename(const fp3_ranked *self, uint32_t rows, const uint32_t *before,
                            const uint32_t *now, const fp3_remembered saved[FP3_LISTS_MAX]) {
    const fp3_lists *lists = &self->own->layout.groups[0].lists;
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; !status && k < lists->shape.list_count; k++) {
        fp3_remembered made = {0};
        if (!saved[k].begin)
            continue;
        status = rename_pairs(self->own, before, now, self->room, &saved[k], rows, &made,
                              lists->lists[k].fields);
        if (!status)
            status = restore(self->own, k, &made);
        fp3_remembered_free(&made);
    }
    return status;
}

void fp3_ranks_rename_links(const fp3_ranked *self, const uint32_t *before, const uint32_t *now,
                            uint32_t *row) {
    const fp3_lists *lists = &self->own->layout.groups[0].lists;
    for (uint32_t i = 0; i < self->room; i++)
        if (now[i] != UINT32_MAX)
            row[now[i]] = i;
    for (uint32_t k = 0; k < lists->shape.list_count; k++) {
        const fp3_list *list = &lists->lists[k];
        for (uint32_t e = 0; !list->is_near && list->begin && e < list->begin[list->objects]; e++)
            list->other[e] = row[before[list->other[e]]];
    }
}

fp3_status fp3_ranks_note_names(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    const size_t bytes = self->room * sizeof *self->began;
    if (!self->own || !self->made[0])
        return FP3_OK;
    if (!self->began)
        self->began = malloc(bytes + 1);
    if (!self->again)
        self->again = malloc(bytes + 1);
    if (!self->began || !self->again)
        return fp3_no_memory(engine->def.error);
    memcpy(self->began, self->names, bytes);
    return FP3_OK;
}

/* ---- all ranks together ---- */

/* Words of all ranks, side by side; `bytes` of each. The caller frees *all. */
static fp3_status gather(const fp3_engine *engine, const uint32_t *words, size_t count,
                         uint64_t *bytes, uint32_t **all) {
    const fp3_ranked *self = engine->self;
    const fp3_ranks *ranks = self->ranks;
    const uint64_t here = count * sizeof *words;
    uint64_t *each = calloc(ranks->count, sizeof *each), sum = 0;
    *all = NULL;
    if (!each)
        return fp3_no_memory(engine->def.error);
    for (unsigned r = 0; r < ranks->count; r++)
        each[r] = sizeof *bytes;
    ranks->calls->gather(ranks->world, &here, each, bytes);
    free(each);
    for (unsigned r = 0; r < ranks->count; r++)
        sum += bytes[r];
    *all = malloc(sum + sizeof **all);
    if (!*all)
        return fp3_no_memory(engine->def.error);
    ranks->calls->gather(ranks->world, words, bytes, *all);
    return FP3_OK;
}

/* Of near objects: pairs of the own objects, by their numbers. */
static uint32_t *list_pairs(const fp3_ranked *self, const fp3_remembered *saved, size_t fields,
                            const uint32_t *numbers, size_t *count) {
    const uint32_t own = self->share[fp3_ranks_here(self)], first = self->first;
    const size_t pairs = saved->begin[first + own] - saved->begin[first];
    uint32_t *words = malloc((pairs * (NAMES + fields) + 1) * sizeof *words), *to = words;
    for (uint32_t i = 0; words && i < own; i++)
        for (uint32_t e = saved->begin[first + i]; e < saved->begin[first + i + 1]; e++) {
            *to++ = self->mine[i];
            *to++ = numbers[saved->other[e]];
            memcpy(to, &saved->field[e * fields], fields * sizeof *to);
            to += fields;
        }
    *count = pairs * (NAMES + fields);
    return words;
}

/* Pairs of each object are those of one rank, in the order of its list. */
static fp3_status take_pairs(fp3_list *list, const uint32_t *words, size_t pairs,
                             fp3_error *error) {
    const size_t each = NAMES + list->fields;
    fp3_remembered made = {0};
    fp3_status status = open_memory(&made, list->objects + (size_t)1, pairs, list->fields, error);
    for (size_t i = 0; !status && i < pairs; i++)
        made.begin[words[i * each] + 2]++;
    for (uint32_t i = 0; !status && i < list->objects; i++)
        made.begin[i + 2] += made.begin[i + 1];
    for (size_t i = 0; !status && i < pairs; i++) {
        const uint32_t at = made.begin[words[i * each] + 1]++;
        made.other[at] = words[i * each + 1];
        memcpy(&made.field[at * (size_t)list->fields], &words[i * each + NAMES],
               list->fields * sizeof *made.field);
    }
    if (!status)
        status = fp3_list_restore(list, NULL, list->objects, &made, error);
    fp3_remembered_free(&made);
    return status;
}

/* Of links: the fields of the own objects' entries, which come object by object. */
static void take_fields(const fp3_ranked *self, fp3_list *list, const uint32_t *words,
                        const uint64_t *bytes) {
    const size_t fields = list->fields;
    for (uint32_t r = 0; r < self->ranks->count; words += bytes[r++] / sizeof *words) {
        const uint32_t *from = words;
        for (uint32_t i = 0; i < list->objects; i++) {
            const size_t count = (list->begin[i + 1] - list->begin[i]) * fields;
            if (self->whose[i] != r)
                continue;
            memcpy(&list->field[list->begin[i] * fields], from, count * sizeof *from);
            from += count;
        }
    }
}

static fp3_status take_list(fp3_engine *engine, uint32_t k, const uint32_t *numbers) {
    fp3_ranked *self = engine->self;
    fp3_list *list = &engine->layout.groups[0].lists.lists[k];
    const fp3_list *here = self->own ? &self->own->layout.groups[0].lists.lists[k] : NULL;
    const uint32_t first = self->first, end = first + self->share[fp3_ranks_here(self)];
    uint64_t *bytes = calloc(self->ranks->count, sizeof *bytes), sum = 0;
    uint32_t *pairs = NULL, *all = NULL;
    const uint32_t *words = NULL;
    fp3_remembered saved = {0};
    size_t count = 0;
    fp3_status status = bytes ? FP3_OK : fp3_no_memory(engine->def.error);
    if (!status && here)
        status = save(self->own, k, &saved);
    if (!status && here && list->is_near) {
        words = pairs = list_pairs(self, &saved, list->fields, numbers, &count);
        status = pairs ? FP3_OK : fp3_no_memory(engine->def.error);
    } else if (!status && here) {
        words = &saved.field[(size_t)here->begin[first] * list->fields];
        count = (size_t)(here->begin[end] - here->begin[first]) * list->fields;
    }
    if (!status)
        status = gather(engine, words ? words : &(uint32_t){0}, count, bytes, &all);
    for (unsigned r = 0; !status && r < self->ranks->count; r++)
        sum += bytes[r];
    if (!status && list->is_near)
        status =
            take_pairs(list, all, sum / sizeof *all / (NAMES + list->fields), engine->def.error);
    else if (!status)
        take_fields(self, list, all, bytes);
    free(bytes);
    free(pairs);
    free(all);
    fp3_remembered_free(&saved);
    return status;
}

fp3_status fp3_ranks_take_memory(fp3_engine *engine) {
    const fp3_ranked *self = engine->self;
    const fp3_lists *lists = &engine->layout.groups[0].lists;
    if (!fp3_lists_remember(lists))
        return FP3_OK;
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; !status && k < lists->shape.list_count; k++)
        if (fp3_list_remembers(&lists->lists[k]))
            status = take_list(engine, k, self->names);
    return status;
}
