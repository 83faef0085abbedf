/* SPDX-License-Identifier: Apache-2.0 */
/* living.c - see living.h. */
#include "living.h"

#include "origin.h"

#include <stdlib.h>
#include <string.h>

/* Of the objects of a group. */
static fp3_living *find_living(const fp3_engine *engine, const fp3_members *group) {
    const size_t rows = group->rows;
    fp3_living *made = calloc(1, sizeof *made);
    if (!made)
        return NULL;
    made->is = calloc(rows + 1, sizeof *made->is);
    made->who = malloc((rows + 1) * sizeof *made->who);
    made->place = malloc((rows + 1) * sizeof *made->place);
    if (!made->is || !made->who || !made->place) {
        fp3_living_free(&made);
        return NULL;
    }
    for (uint32_t i = 0; i < rows; i++) {
        made->is[i] = fp3_engine_life(engine, group->first + i) == FP3_ALIVE;
        made->place[i] = made->is[i] ? made->count : UINT32_MAX;
        if (made->is[i])
            made->who[made->count++] = i;
    }
    return made;
}

/* ---- links ---- */

static void restore(fp3_list *list) {
    if (list->whole.begin && fp3_list_remembers(list))
        fp3_list_carry(list, 1);
    list->living = NULL;
    if (!list->whole.begin)
        return;
    free(list->begin);
    free(list->other);
    free(list->field);
    list->begin = list->whole.begin;
    list->other = list->whole.other;
    list->field = list->whole.field;
    list->whole = (fp3_entries){NULL, NULL, NULL};
}

/* Entries of living objects, of which both ends live. */
static void put_entries(const fp3_list *list, const fp3_living *living, fp3_entries *to) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < list->objects; i++) {
        to->begin[i] = count;
        for (uint32_t k = list->begin[i]; living->is[i] && k < list->begin[i + 1]; k++)
            if (living->is[list->other[k]])
                to->other[count++] = list->other[k];
    }
    to->begin[list->objects] = count;
}

static fp3_status leave_out(fp3_list *list, const fp3_living *living, fp3_error *error) {
    const size_t entries = list->begin[list->objects];
    fp3_entries made = {.begin = malloc((list->objects + (size_t)1) * sizeof *made.begin),
                        .other = malloc((entries + 1) * sizeof *made.other),
                        .field = malloc((entries * list->fields + 1) * sizeof *made.field)};
    if (!made.begin || !made.other || !made.field) {
        free(made.begin);
        free(made.other);
        free(made.field);
        return fp3_no_memory(error);
    }
    put_entries(list, living, &made);
    list->whole = (fp3_entries){list->begin, list->other, list->field};
    list->begin = made.begin;
    list->other = made.other;
    list->field = made.field;
    list->living = living;
    fp3_list_carry(list, 0);
    return FP3_OK;
}

/* ---- all lists ---- */

/* The next look makes it, of other objects. What pairs remember is still there. */
static void forget_near(fp3_list *list) {
    fp3_near_close(&list->near);
    if (fp3_list_remembers(list))
        return;
    free(list->begin);
    free(list->other);
    list->begin = list->other = NULL;
}

static void restore_all(fp3_lists *lists) {
    for (uint32_t i = 0; i < lists->shape.list_count; i++) {
        fp3_list *list = &lists->lists[i];
        restore(list);
        list->is_placed = 0;
        if (list->is_near)
            forget_near(list);
    }
    fp3_living_free(&lists->living);
}

/* Takes `living`; NULL: all live. */
static fp3_status take(fp3_lists *lists, fp3_living *living, fp3_error *error) {
    fp3_status status = FP3_OK;
    restore_all(lists);
    for (uint32_t i = 0; !status && living && i < lists->shape.list_count; i++) {
        fp3_list *list = &lists->lists[i];
        if (!list->is_near && !list->is_all && list->begin)
            status = leave_out(list, living, error);
        list->living = status ? NULL : living;
    }
    lists->living = living;
    if (status)
        restore_all(lists);
    return status;
}

/* Whether the lists are of these objects. */
static int are_of(const fp3_lists *lists, const fp3_living *living, uint32_t rows) {
    if (!lists->living || !living)
        return lists->living == living;
    int are = memcmp(lists->living->is, living->is, rows) == 0;
    for (uint32_t i = 0; i < lists->shape.list_count; i++)
        are = are && lists->lists[i].living == lists->living; /* none was given since */
    return are;
}

/* Objects stand in the order of their numbers. */
static void forget_pairs(fp3_lists *lists) {
    for (uint32_t i = 0; lists->living && i < lists->shape.list_count; i++)
        if (lists->lists[i].is_near && fp3_list_remembers(&lists->lists[i]))
            fp3_list_forget(&lists->lists[i], lists->living->is);
}

static fp3_status settle(fp3_engine *engine, fp3_members *group) {
    fp3_living *living = find_living(engine, group);
    if (!living)
        return fp3_no_memory(engine->def.error);
    if (living->count == group->rows)
        fp3_living_free(&living);
    if (are_of(&group->lists, living, group->rows)) {
        fp3_living_free(&living);
        return FP3_OK;
    }
    fp3_status status = take(&group->lists, living, engine->def.error);
    if (!status && engine->backend->connect)
        status = engine->backend->connect(engine, group, NULL);
    if (!status)
        forget_pairs(&group->lists);
    return status;
}

fp3_status fp3_living_settle(fp3_engine *engine) {
    fp3_status status = FP3_OK;
    if (fp3_layout_is_joined(&engine->layout))
        return FP3_OK; /* the engine of each group has those alone that live */
    for (uint32_t i = 0; !status && i < engine->layout.count; i++) {
        fp3_members *group = &engine->layout.groups[i];
        if (group->lists.shape.is_any && (fp3_lives_vary(engine) || group->lists.living))
            status = settle(engine, group);
    }
    return status;
}

/* ---- gone for good ---- */

/* Links of which an end does not stay. */
static void drop(const fp3_list *list, fp3_entries of, const uint8_t *stays) {
    const size_t fields = list->fields;
    uint32_t count = 0, from = 0;
    for (uint32_t i = 0; of.begin && i < list->objects; i++) {
        const uint32_t end = of.begin[i + 1];
        of.begin[i] = count;
        for (; from < end; from++) {
            if (!stays[i] || !stays[of.other[from]])
                continue;
            of.other[count] = of.other[from];
            if (fields)
                memmove(&of.field[count * fields], &of.field[from * fields],
                        fields * sizeof *of.field);
            count++;
        }
    }
    if (of.begin)
        of.begin[list->objects] = count;
}

static void drop_from(fp3_list *list, const uint8_t *stays) {
    if (list->is_near)
        fp3_near_close(&list->near);
    if (list->is_near && fp3_list_remembers(list))
        fp3_list_forget(list, stays);
    if (list->is_near || list->is_all)
        return;
    drop(list, (fp3_entries){list->begin, list->other, list->field}, stays);
    drop(list, list->whole, stays);
}

fp3_status fp3_living_forget(fp3_engine *engine, const uint8_t *stays) {
    fp3_members *group = &engine->layout.groups[0];
    const fp3_backend *backend = engine->backend;
    fp3_status status = FP3_OK;
    if (!group->lists.shape.is_any)
        return FP3_OK;
    if (backend->connect) /* objects stand in the order of their numbers then */
        status = backend->connect(engine, group, NULL);
    for (uint32_t i = 0; !status && i < group->lists.shape.list_count; i++)
        drop_from(&group->lists.lists[i], stays);
    engine->sleepers.is_listed = 0;
    engine->origin->is_complete = 0;
    if (!status && backend->connect)
        status = backend->connect(engine, group, NULL);
    return status;
}
