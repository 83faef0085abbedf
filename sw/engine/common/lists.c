/* SPDX-License-Identifier: Apache-2.0 */
/* lists.c - lists of neighbours: copied, and kept until the next load. */
#include "lists.h"

#include <stdlib.h>
#include <string.h>

void fp3_lists_open(const fp3_neighbourhood *shape, uint32_t objects, fp3_lists *lists) {
    *lists = (fp3_lists){.shape = *shape};
    for (uint32_t i = 0; i < shape->list_count; i++)
        lists->lists[i] = (fp3_list){.reg = shape->lists[i].reg,
                                     .fields = shape->lists[i].fields,
                                     .kept = shape->lists[i].kept,
                                     .objects = objects,
                                     .end = objects,
                                     .own = objects};
}

static void forget(fp3_list *list) {
    free(list->begin);
    free(list->other);
    free(list->field);
    free(list->whole.begin);
    free(list->whole.other);
    free(list->whole.field);
    fp3_near_close(&list->near);
    list->begin = list->other = list->field = NULL;
    list->whole = (fp3_entries){NULL, NULL, NULL};
    list->living = NULL;
    list->is_there = list->is_all = list->is_near = 0;
}

void fp3_living_free(fp3_living **living) {
    if (!*living)
        return;
    free((*living)->is);
    free((*living)->who);
    free((*living)->place);
    free(*living);
    *living = NULL;
}

void fp3_lists_close(fp3_lists *lists) {
    for (uint32_t i = 0; i < lists->shape.list_count; i++)
        forget(&lists->lists[i]);
    free(lists->order);
    lists->order = NULL;
    fp3_living_free(&lists->living);
    lists->shape = (fp3_neighbourhood){0};
}

void fp3_list_carry(const fp3_list *list, int is_back) {
    const fp3_entries *whole = &list->whole;
    const size_t bytes = list->fields * sizeof *list->field;
    uint32_t *field = list->field;
    if (!whole->begin || !list->fields)
        return;
    for (uint32_t i = 0; i < list->objects; i++)
        for (uint32_t k = whole->begin[i]; list->living->is[i] && k < whole->begin[i + 1]; k++) {
            uint32_t *given = &whole->field[(size_t)k * list->fields];
            if (!list->living->is[whole->other[k]])
                continue;
            memcpy(is_back ? given : field, is_back ? field : given, bytes);
            field += list->fields;
        }
}

fp3_list *fp3_lists_of(fp3_lists *lists, uint32_t reg) {
    fp3_list *list = lists->lists;
    while (list->reg != reg)
        list++;
    return list;
}

static uint32_t *copied(const void *words, size_t count) {
    uint32_t *copy = malloc((count + 1) * sizeof *copy);
    if (copy && count)
        memcpy(copy, words, count * sizeof *copy);
    return copy;
}

fp3_status fp3_list_take(fp3_list *to, const fp3_neighbours *from, fp3_error *error) {
    const size_t entries = from->begin ? from->begin[to->objects] : 0;
    fp3_list made = {.reg = to->reg,
                     .fields = to->fields,
                     .kept = to->kept,
                     .objects = to->objects,
                     .first = to->first,
                     .end = to->end,
                     .own = to->own,
                     .kind = (uint32_t)from->kind,
                     .is_there = 1,
                     .is_all = !from->begin};
    made.begin = made.is_all ? NULL : copied(from->begin, to->objects + (size_t)1);
    made.other = made.is_all ? NULL : copied(from->other, entries);
    made.field = made.is_all ? NULL : copied(from->fields, entries * to->fields);
    if (!made.is_all && (!made.begin || !made.other || !made.field)) {
        forget(&made);
        return fp3_no_memory(error);
    }
    forget(to);
    *to = made;
    return FP3_OK;
}

void fp3_list_take_near(fp3_list *to, const fp3_near_rule *rule, uint32_t kind) {
    if (to->is_near && fp3_list_remembers(to) && to->kind == kind)
        fp3_near_close(&to->near);
    else
        forget(to);
    to->near = fp3_near_without_list(rule);
    to->kind = kind;
    to->is_there = to->is_near = 1;
    to->is_placed = 0;
}

void fp3_lists_take_order(fp3_lists *lists, uint32_t *order) {
    free(lists->order);
    lists->order = order;
    for (uint32_t i = 0; i < lists->shape.list_count; i++)
        fp3_near_close(&lists->lists[i].near);
}

fp3_status fp3_lists_copy(const fp3_lists *from, uint32_t rows, fp3_lists *to, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < from->shape.list_count; i++) {
        const fp3_list *list = &from->lists[i];
        const fp3_entries whole = fp3_list_given(list);
        const fp3_neighbours given = {.begin = whole.begin,
                                      .other = whole.other,
                                      .fields = (const float *)(void *)whole.field,
                                      .kind = list->kind};
        if (list->is_near)
            fp3_list_take_near(&to->lists[i], &list->near, list->kind);
        else if (list->is_there)
            status = fp3_list_take(&to->lists[i], &given, error);
    }
    if (!status && from->order) {
        uint32_t *order = copied(from->order, rows);
        if (!order)
            return fp3_no_memory(error);
        fp3_lists_take_order(to, order);
    }
    return status;
}

uint32_t fp3_list_same_place(const fp3_list *list, const uint32_t *words, size_t each,
                             uint32_t first, uint32_t object, uint32_t turn) {
    if (!list || !list->is_near)
        return 0;
    const uint32_t other = first + fp3_list_entry(list, object - first, turn);
    for (uint32_t k = 0; k < FP3_NEAR_COLUMNS; k++) {
        float x, y;
        if (!fp3_near_has(&list->near, k))
            continue;
        memcpy(&x, &words[object * each + list->near.regs[k]], sizeof x);
        memcpy(&y, &words[other * each + (list->kind ? list->near.theirs : list->near.regs)[k]],
               sizeof y);
        if (x != y)
            return 0;
    }
    return other + 1;
}
