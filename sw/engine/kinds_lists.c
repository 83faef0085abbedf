/* SPDX-License-Identifier: Apache-2.0 */
/* kinds_lists.c - lists of objects of several groups, as the engine of each has them: of rows. */
#include "kinds_inside.h"

#include <stdlib.h>
#include <string.h>

/* Rows among which neighbours are. */
static void limit(const fp3_engine *engine, uint32_t number, uint32_t kind, fp3_list *own) {
    const fp3_kind_engine *k = &fp3_kinds_of(engine)->kinds[number];
    const uint32_t other = kind ? kind - 1 : number;
    own->first = kind ? k->base[other] : 0;
    own->end = own->first + fp3_kinds_of(engine)->kinds[other].living;
    own->own = k->living;
}

/* Links between objects that live become links between rows; guests have none. */
static fp3_status give_entries(fp3_engine *engine, uint32_t number, const fp3_list *list,
                               fp3_list *own) {
    const fp3_kinds *self = fp3_kinds_of(engine);
    const fp3_layout *layout = &engine->layout;
    const uint32_t *place =
                       self->place + layout->groups[list->kind ? list->kind - 1 : number].first,
                   *who = fp3_kinds_who(engine, number), entries = list->begin[list->objects];
    uint32_t *begin = malloc((own->objects + (size_t)1) * sizeof *begin),
             *other = malloc((entries + (size_t)1) * sizeof *other), count = 0;
    float *field = malloc(((size_t)entries * list->fields + 1) * sizeof *field);
    fp3_status status = begin && other && field ? FP3_OK : fp3_no_memory(engine->def.error);
    for (uint32_t i = 0; !status && i <= own->objects; i++) {
        const uint32_t object = i < own->own ? who[i] - layout->groups[number].first : 0;
        begin[i] = count;
        for (uint32_t e = list->begin[object]; i < own->own && e < list->begin[object + 1]; e++) {
            if (place[list->other[e]] == FP3_NO_OBJECT_ROW)
                continue;
            memcpy(&field[(size_t)count * list->fields], &list->field[(size_t)e * list->fields],
                   list->fields * sizeof *field);
            other[count++] = place[list->other[e]] + own->first;
        }
    }
    const fp3_neighbours given = {
        .begin = begin, .other = other, .fields = field, .kind = list->kind};
    if (!status)
        status = fp3_list_take(own, &given, engine->def.error);
    free(begin);
    free(other);
    free(field);
    return status;
}

/* The row of each object of a kind's engine; NULL: its number. */
static const uint32_t *rows_of(const fp3_engine *own) {
    return own->backend->rows ? own->backend->rows(own) : NULL;
}

/* What pairs of near objects remember, to the engine of their kind. */
static fp3_status give_memory(fp3_engine *engine, const fp3_kind_engine *k, const fp3_list *list,
                              fp3_list *own) {
    const uint32_t entries = list->begin ? list->begin[list->own] : 0;
    if (!list->begin)
        return FP3_OK;
    fp3_remembered saved = {.begin = list->begin,
                            .other = malloc((entries + (size_t)1) * sizeof *saved.other),
                            .field = list->field};
    if (!saved.other)
        return fp3_no_memory(engine->def.error);
    for (uint32_t e = 0; e < entries; e++)
        saved.other[e] = list->other[e] + own->first;
    const fp3_status status = fp3_list_restore(own, rows_of(k->own), k->own->layout.groups[0].rows,
                                               &saved, engine->def.error);
    free(saved.other);
    return status;
}

/* ... and back, to the lists that the caller's engine has: to be found, and kept. */
static fp3_status take_memory(fp3_engine *engine, const fp3_kind_engine *k, fp3_list *list,
                              fp3_list *own) {
    const uint32_t rows = k->own->layout.groups[0].rows;
    fp3_remembered saved;
    const fp3_status status = fp3_list_save(own, rows_of(k->own), rows, &saved, engine->def.error);
    if (status) {
        fp3_remembered_free(&saved);
        return status;
    }
    if (!list->is_near) {
        memcpy(list->field, saved.field,
               (size_t)list->begin[list->own] * list->fields * sizeof *list->field);
        fp3_remembered_free(&saved);
        return FP3_OK;
    }
    for (uint32_t e = 0; e < saved.begin[list->own]; e++)
        saved.other[e] -= own->first;
    free(list->begin);
    free(list->other);
    free(list->field);
    list->begin = saved.begin;
    list->other = saved.other;
    list->field = saved.field;
    return FP3_OK;
}

fp3_status fp3_kinds_take_memories(fp3_engine *engine) {
    const fp3_kinds *self = fp3_kinds_of(engine);
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < self->count; i++) {
        fp3_lists *lists = &engine->layout.groups[i].lists;
        for (uint32_t n = 0; !status && n < lists->shape.list_count; n++)
            if (self->kinds[i].own && fp3_list_remembers(&lists->lists[n]))
                status = take_memory(engine, &self->kinds[i], &lists->lists[n],
                                     &self->kinds[i].own->layout.groups[0].lists.lists[n]);
    }
    return status;
}

static fp3_status give_list(fp3_engine *engine, uint32_t number, const fp3_list *list) {
    const fp3_members *group = &engine->layout.groups[number];
    const fp3_kind_engine *k = &fp3_kinds_of(engine)->kinds[number];
    fp3_members *members = &k->own->layout.groups[0];
    fp3_list *own = &members->lists.lists[list - group->lists.lists];
    fp3_status status = FP3_OK;
    limit(engine, number, list->kind, own);
    if (list->is_near) {
        fp3_list_take_near(own, &list->near, list->kind);
        if (fp3_list_remembers(list))
            status = give_memory(engine, k, list, own);
    } else if (list->is_all)
        status = fp3_list_take(own, &(fp3_neighbours){.kind = list->kind}, engine->def.error);
    else if (list->is_there)
        status = give_entries(engine, number, list, own);
    if (!status && k->own->backend->connect)
        status = k->own->backend->connect(k->own, members, own);
    return status;
}

fp3_status fp3_kinds_connect(fp3_engine *engine, fp3_members *group, const fp3_list *list) {
    const uint32_t number = (uint32_t)(group - engine->layout.groups);
    const int is_there = fp3_kinds_of(engine)->kinds[number].own != NULL;
    fp3_status status = FP3_OK;
    if (list)
        fp3_rest_note_list(engine, number, list);
    for (uint32_t i = 0; !status && is_there && i < group->lists.shape.list_count; i++)
        if (!list || list == &group->lists.lists[i])
            status = give_list(engine, number, &group->lists.lists[i]);
    return status;
}
