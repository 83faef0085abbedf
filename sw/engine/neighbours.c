/* neighbours.c - lists of neighbours: checked, copied, kept until the next load. */
#include "neighbours.h"

#include "backend.h"
#include "checks.h"
#include "origin.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

void fp3_lists_open(const fp3_neighbourhood *shape, uint32_t objects, fp3_lists *lists) {
    *lists = (fp3_lists){.shape = *shape};
    for (uint32_t i = 0; i < shape->list_count; i++)
        lists->lists[i] = (fp3_list){
            .reg = shape->lists[i].reg, .fields = shape->lists[i].fields, .objects = objects};
}

static void forget(fp3_list *list) {
    free(list->begin);
    free(list->other);
    free(list->field);
    list->begin = list->other = list->field = NULL;
    list->is_there = list->is_all = 0;
}

void fp3_lists_close(fp3_lists *lists) {
    for (uint32_t i = 0; i < lists->shape.list_count; i++)
        forget(&lists->lists[i]);
    lists->shape = (fp3_neighbourhood){0};
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

static fp3_status take(const fp3_neighbours *from, fp3_list *to, fp3_error *error) {
    const size_t entries = from->begin ? from->begin[to->objects] : 0;
    fp3_list made = *to;
    made.is_there = 1;
    made.is_all = !from->begin;
    made.begin = made.is_all ? NULL : copied(from->begin, to->objects + (size_t)1);
    made.other = made.is_all ? NULL : copied(from->other, entries);
    made.field = made.is_all ? NULL : copied(from->fields, entries * to->fields);
    if (!made.is_all && (!made.begin || !made.other || !made.field)) {
        forget(&made);
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    }
    forget(to);
    *to = made;
    return FP3_OK;
}

fp3_status fp3_lists_copy(const fp3_lists *from, fp3_lists *to, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < from->shape.list_count; i++) {
        const fp3_list *list = &from->lists[i];
        const fp3_neighbours given = {list->begin, list->other, (const float *)(void *)list->field};
        if (list->is_there)
            status = take(&given, &to->lists[i], error);
    }
    return status;
}

/* ---- what the caller gives ---- */

static fp3_status check_entries(fp3_engine *engine, const fp3_list *list, const char *name,
                                const fp3_neighbours *n) {
    fp3_error *error = engine->def.error;
    if (n->begin[0] != 0)
        return fp3_fail(error, FP3_E_ARGUMENT, "list '%s': begin[0] is %" PRIu32 ", expected 0",
                        name, n->begin[0]);
    for (uint32_t i = 0; i < list->objects; i++) {
        if (n->begin[i + 1] < n->begin[i])
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "list '%s': begin[%" PRIu32 "] is below begin[%" PRIu32 "]", name,
                            i + 1, i);
        for (uint32_t k = n->begin[i]; k < n->begin[i + 1]; k++)
            if (n->other[k] >= list->objects || n->other[k] == i)
                return fp3_fail(error, FP3_E_ARGUMENT,
                                "list '%s': object %" PRIu32 " has the neighbour %" PRIu32
                                ", expected another one of the group's %" PRIu32 " objects",
                                name, i, n->other[k], list->objects);
    }
    return FP3_OK;
}

fp3_status fp3_engine_set_neighbours(fp3_engine *engine, size_t group, const char *name,
                                     const fp3_neighbours *neighbours) {
    fp3_status status = fp3_engine_check_range(engine, "group", group, 1, engine->layout.count);
    if (!status)
        status = fp3_engine_check_loaded(engine);
    if (status)
        return status;
    fp3_lists *lists = &engine->layout.groups[group].lists;
    const fp3_symbol *s =
        fp3_image_find(engine->layout.groups[group].image, name, FP3_CLASSES_OBJECT);
    uint32_t i = 0;
    while (s && i < lists->shape.list_count && lists->lists[i].reg != s->index)
        i++;
    if (!s || i == lists->shape.list_count)
        return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                        "the program has no list of neighbours '%s'", name);
    fp3_list *list = &lists->lists[i];
    if (neighbours->begin)
        status = check_entries(engine, list, name, neighbours);
    else if (list->fields)
        status = fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                          "list '%s': entries have fields, so each has to be given", name);
    if (!status)
        status = take(neighbours, list, engine->def.error);
    if (!status && engine->backend->connect)
        status = engine->backend->connect(engine, &engine->layout.groups[group], list);
    engine->origin->is_complete = 0;
    return status;
}

fp3_status fp3_engine_check_neighbours(fp3_engine *engine) {
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        for (uint32_t k = 0; k < group->lists.shape.list_count; k++) {
            const fp3_list *list = &group->lists.lists[k];
            const char *name = fp3_image_name(group->image, list->reg);
            if (!list->is_there)
                return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                                "%sthe list of neighbours '%s' has not been given",
                                fp3_engine_prefix(i, engine->layout.count).text, name ? name : "?");
        }
        if (group->lists.shape.is_any && engine->lives.list)
            return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                            "objects that are born or gone cannot be neighbours");
    }
    return FP3_OK;
}
