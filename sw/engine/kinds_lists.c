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

/* ---- what pairs remember: here by the numbers of objects, in the engine of a kind by rows ---- */

/* Entries of `count` objects: `at` has the place of each in `from`, or FP3_NO_OBJECT_ROW, and
 * `names` what each neighbour is called; who has no place is left out. */
typedef struct {
    const fp3_remembered *from;
    const uint32_t *at, *names;
    uint32_t count, less, more; /* of a neighbour's name: before it is looked up, and after it */
} renaming;

static fp3_status rename_all(const renaming *r, size_t fields, fp3_remembered *to,
                             fp3_error *error) {
    size_t most = 0;
    uint32_t made = 0;
    for (uint32_t i = 0; i < r->count; i++)
        if (r->at[i] != FP3_NO_OBJECT_ROW)
            most += r->from->begin[r->at[i] + 1] - r->from->begin[r->at[i]];
    *to = (fp3_remembered){calloc(r->count + (size_t)1, sizeof *to->begin),
                           calloc(most + 1, sizeof *to->other),
                           calloc(most * fields + 1, sizeof *to->field)};
    if (!to->begin || !to->other || !to->field)
        return fp3_no_memory(error);
    for (uint32_t i = 0; i < r->count; i++) {
        const int is_there = r->at[i] != FP3_NO_OBJECT_ROW;
        const uint32_t end = is_there ? r->from->begin[r->at[i] + 1] : 0;
        for (uint32_t e = is_there ? r->from->begin[r->at[i]] : 0; e < end; e++) {
            const uint32_t name = r->names[r->from->other[e] - r->less];
            if (name == FP3_NO_OBJECT_ROW)
                continue;
            to->other[made] = name + r->more;
            memcpy(&to->field[made++ * fields], &r->from->field[e * fields],
                   fields * sizeof *to->field);
        }
        to->begin[i + 1] = made;
    }
    return FP3_OK;
}

/* Of a group: the number of each row's object, or the row of each object. */
static uint32_t *numbers_of(const fp3_engine *engine, uint32_t group) {
    const uint32_t *who = fp3_kinds_who(engine, group),
                   living = fp3_kinds_of(engine)->kinds[group].living;
    uint32_t *numbers = malloc((living + (size_t)1) * sizeof *numbers);
    for (uint32_t i = 0; numbers && i < living; i++)
        numbers[i] = who[i] - engine->layout.groups[group].first;
    return numbers;
}

static const uint32_t *places_of(const fp3_engine *engine, uint32_t group) {
    return fp3_kinds_of(engine)->place + engine->layout.groups[group].first;
}

/* Of near objects, to the engine of their kind. */
static fp3_status give_memory(fp3_engine *engine, uint32_t number, const fp3_list *list,
                              fp3_list *own) {
    const fp3_kind_engine *k = &fp3_kinds_of(engine)->kinds[number];
    const fp3_remembered from = {list->begin, list->other, list->field};
    uint32_t *numbers = list->begin ? numbers_of(engine, number) : NULL;
    fp3_remembered rows = {0};
    if (!list->begin)
        return FP3_OK;
    const renaming way = {.from = &from,
                          .at = numbers,
                          .names = places_of(engine, list->kind ? list->kind - 1 : number),
                          .count = k->living,
                          .more = own->first};
    fp3_status status = numbers ? rename_all(&way, list->fields, &rows, engine->def.error)
                                : fp3_no_memory(engine->def.error);
    if (!status)
        status = fp3_list_restore(own, rows_of(k->own), k->own->layout.groups[0].rows, &rows,
                                  engine->def.error);
    fp3_remembered_free(&rows);
    free(numbers);
    return status;
}

/* ... and back, to the lists that the caller's engine has: to be found, and kept. */
static fp3_status take_near(fp3_engine *engine, uint32_t number, fp3_list *list, fp3_list *own) {
    const fp3_kind_engine *k = &fp3_kinds_of(engine)->kinds[number];
    const uint32_t other = list->kind ? list->kind - 1 : number;
    uint32_t *names = numbers_of(engine, other);
    fp3_remembered rows = {0}, made = {0};
    fp3_status status = names ? fp3_list_save(own, rows_of(k->own), k->own->layout.groups[0].rows,
                                              &rows, engine->def.error)
                              : fp3_no_memory(engine->def.error);
    const renaming way = {.from = &rows,
                          .at = places_of(engine, number),
                          .names = names,
                          .count = list->objects,
                          .less = own->first};
    if (!status)
        status = rename_all(&way, list->fields, &made, engine->def.error);
    if (!status)
        status = fp3_list_restore(list, NULL, list->objects, &made, engine->def.error);
    fp3_remembered_free(&rows);
    fp3_remembered_free(&made);
    free(names);
    return status;
}

/* Links between objects that live, as give_entries goes through them. */
static void take_links(const fp3_engine *engine, uint32_t number, fp3_list *list,
                       const fp3_list *own) {
    const uint32_t *here = places_of(engine, number),
                   *there = places_of(engine, list->kind ? list->kind - 1 : number);
    for (uint32_t i = 0; i < list->objects; i++) {
        size_t at = here[i] == FP3_NO_OBJECT_ROW ? 0 : own->begin[here[i]];
        for (uint32_t e = list->begin[i]; here[i] != FP3_NO_OBJECT_ROW && e < list->begin[i + 1];
             e++)
            if (there[list->other[e]] != FP3_NO_OBJECT_ROW)
                memcpy(&list->field[(size_t)e * list->fields], &own->field[at++ * list->fields],
                       list->fields * sizeof *list->field);
    }
}

/* Of a group: nobody of it lives if it has no engine, and near objects forget. */
static fp3_status take_list(fp3_engine *engine, uint32_t number, fp3_list *list) {
    const fp3_kind_engine *k = &fp3_kinds_of(engine)->kinds[number];
    fp3_lists *lists = &engine->layout.groups[number].lists;
    fp3_list *own = k->own ? &k->own->layout.groups[0].lists.lists[list - lists->lists] : NULL;
    if (!own && list->is_near && list->begin)
        memset(list->begin, 0, (list->own + (size_t)1) * sizeof *list->begin);
    if (!own)
        return FP3_OK;
    if (list->is_near)
        return take_near(engine, number, list, own);
    take_links(engine, number, list, own);
    return FP3_OK;
}

fp3_status fp3_kinds_take_memories(fp3_engine *engine) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < fp3_kinds_of(engine)->count; i++) {
        fp3_lists *lists = &engine->layout.groups[i].lists;
        for (uint32_t n = 0; !status && n < lists->shape.list_count; n++)
            if (fp3_list_remembers(&lists->lists[n]))
                status = take_list(engine, i, &lists->lists[n]);
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
            status = give_memory(engine, number, list, own);
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
