/* SPDX-License-Identifier: Apache-2.0 */
/* neighbours.c - lists of neighbours as the caller gives them: checked. */
#include "checks.h"
#include "machine/format.h"
#include "origin.h"
#include "radii.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static fp3_status check_entries(fp3_engine *engine, const fp3_list *list, const char *name,
                                const fp3_neighbours *n) {
    fp3_error *error = engine->def.error;
    const uint32_t others = n->kind ? engine->layout.groups[n->kind - 1].objects : list->objects;
    if (n->begin[0] != 0)
        return fp3_fail(error, FP3_E_ARGUMENT, "list '%s': begin[0] is %" PRIu32 ", expected 0",
                        name, n->begin[0]);
    for (uint32_t i = 0; i < list->objects; i++) /* before any of them says where to look */
        if (n->begin[i + 1] < n->begin[i])
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "list '%s': begin[%" PRIu32 "] is below begin[%" PRIu32 "]", name,
                            i + 1, i);
    if (n->begin[list->objects] && (!n->other || (list->fields && !n->fields)))
        return fp3_fail(error, FP3_E_ARGUMENT, "list '%s': entries without %s", name,
                        n->other ? "their fields" : "their neighbours");
    for (uint32_t i = 0; i < list->objects; i++)
        for (uint32_t k = n->begin[i]; k < n->begin[i + 1]; k++)
            if (n->other[k] >= others || (n->other[k] == i && !n->kind))
                return fp3_fail(error, FP3_E_ARGUMENT,
                                "list '%s': object %" PRIu32 " has the neighbour %" PRIu32
                                ", expected another one of the group's %" PRIu32 " objects",
                                name, i, n->other[k], others);
    return FP3_OK;
}

static fp3_status find_list(fp3_engine *engine, size_t group, const char *name, fp3_list **list) {
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
    *list = &lists->lists[i];
    return FP3_OK;
}

/* Fields as words of the machine; the caller frees *words. NULL: they are already, or there are
 * none. */
static fp3_status convert_fields(fp3_engine *engine, const fp3_list *list, const char *name,
                                 const fp3_neighbours *n, uint32_t **words) {
    const size_t fields = n->begin ? (size_t)n->begin[list->objects] * list->fields : 0;
    *words = NULL;
    if (!fields || fp3_format_is_float(engine->config))
        return FP3_OK;
    *words = malloc(fields * sizeof **words);
    if (!*words)
        return fp3_no_memory(engine->def.error);
    for (size_t i = 0; i < fields; i++) {
        const char *wrong = fp3_format_written(engine->config, n->fields[i], &(*words)[i]);
        if (wrong)
            return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                            "list '%s': field %zu of entry %zu is %g, which %s: configuration "
                            "'%s' has no word for it",
                            name, i % list->fields, i / list->fields, (double)n->fields[i], wrong,
                            engine->config->name);
    }
    return FP3_OK;
}

/* word: NULL: any. */
static int is_foreign(const fp3_members *own, size_t kind, const char *word) {
    int is = 0;
    for (uint32_t i = 0; i < own->foreign_count; i++)
        is |=
            own->foreign[i].group + 1 == kind && (!word || strcmp(own->foreign[i].word, word) == 0);
    return is;
}

/* Neighbours of another group are of one whose words the program reads. */
static fp3_status check_kind(fp3_engine *engine, size_t group, const char *name, size_t kind) {
    return !kind || is_foreign(&engine->layout.groups[group], kind, NULL)
               ? FP3_OK
               : fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                          "list '%s': the program reads no words of group %zu", name, kind - 1);
}

/* The list is another one. */
static fp3_status changed(fp3_engine *engine, size_t group, fp3_list *list) {
    fp3_status status = FP3_OK;
    engine->origin->is_complete = 0;
    if (fp3_lives_vary(engine))
        engine->sleepers.is_listed = 0;
    if (engine->backend->connect)
        status = engine->backend->connect(engine, &engine->layout.groups[group], list);
    if (status)
        list->is_there = 0; /* no run is right without it */
    return status;
}

/* The name of a column of a position (near.h), first words and then the second ones; NULL: it has
 * no such column. */
static const char *column_of(const fp3_near *near, const char *const first[3],
                             const char *const low[3], uint32_t column) {
    const uint32_t k = column % FP3_NEAR_DIMENSIONS;
    return k >= near->dimensions ? NULL : column < FP3_NEAR_DIMENSIONS ? first[k] : low[k];
}

static fp3_status check_near(fp3_engine *engine, size_t group, const fp3_list *list,
                             const char *name, const fp3_near *near, uint32_t *regs) {
    const fp3_image *image = engine->layout.groups[group].image;
    fp3_error *error = engine->def.error;
    const int is_given = ((list->fields < 64 ? (UINT64_C(1) << list->fields) - 1 : UINT64_MAX) &
                          ~list->kept) != 0; /* fields that the program does not write */
    if (is_given || near->dimensions < 1 || near->dimensions > FP3_NEAR_DIMENSIONS)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        is_given ? "list '%s': entries have fields, but none are given"
                                 : "list '%s': a position has 1 to 3 components",
                        name);
    const int has_radii = near->radius || near->their_radius;
    if (!(has_radii ? fp3_is_radius(near->reach)
                    : near->reach >= FP3_NEAR_LEAST && near->reach <= FP3_NEAR_MOST) ||
        !(near->skin >= 0 && near->skin <= FP3_NEAR_MOST))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "list '%s': reach %g, skin %g: expected a reach from 2^-50 to 2^6%c%s and "
                        "a skin from 0 to 2^63",
                        name, near->reach, near->skin, has_radii ? '1' : '3',
                        has_radii ? ", or 0" : "");
    if (!(near->share >= 0 && near->share <= FP3_NEAR_MOST))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "list '%s': a skin of %g of the reach: expected 0 to 2^63", name,
                        near->share);
    for (uint32_t k = 0; k < FP3_NEAR_COLUMNS; k++) {
        const char *state = column_of(near, near->position, near->low, k);
        if (!state)
            continue;
        const fp3_symbol *s = fp3_image_find(image, state, FP3_CLASS(FP3_SYMBOL_STATE));
        if (!s)
            return fp3_fail(error, FP3_E_ARGUMENT, "list '%s': the program has no state '%s'", name,
                            state);
        regs[k] = s->index;
    }
    return FP3_OK;
}

static fp3_status find_theirs(fp3_engine *engine, size_t group, const char *name,
                              const fp3_near *near, uint32_t *regs) {
    for (uint32_t k = 0; near->kind && k < FP3_NEAR_COLUMNS; k++) {
        const char *given = column_of(near, near->theirs, near->their_low, k);
        const char *of = given ? given : "";
        if (k % FP3_NEAR_DIMENSIONS >= near->dimensions ||
            (k >= FP3_NEAR_DIMENSIONS && !near->low[0]))
            continue;
        const fp3_symbol *s =
            fp3_image_find(engine->layout.groups[group].image, of, FP3_CLASS(FP3_SYMBOL_PARAM));
        if (!s || !is_foreign(&engine->layout.groups[group], near->kind, of))
            return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                            "list '%s': '%s' is no word that the program reads of group %zu", name,
                            of, near->kind - 1);
        regs[k] = s->index;
    }
    return FP3_OK;
}

fp3_status fp3_engine_set_near(fp3_engine *engine, size_t group, const char *name,
                               const fp3_near *near) {
    fp3_near_rule rule = {.dimensions = near->dimensions,
                          .is_pair = near->low[0] != NULL,
                          .format = fp3_format_is_float(engine->config) ? NULL : engine->config,
                          .reach = near->reach,
                          .skin = near->skin};
    fp3_list *list = NULL;
    fp3_status status = find_list(engine, group, name, &list);
    if (!status)
        status = check_near(engine, group, list, name, near, rule.regs);
    if (!status)
        status = check_kind(engine, group, name, near->kind);
    if (!status)
        status = find_theirs(engine, group, name, near, rule.theirs);
    if (!status)
        status = fp3_radii_find(engine, group, name, near, &rule);
    if (status)
        return status;
    fp3_list_take_near(list, &rule, (uint32_t)near->kind);
    return changed(engine, group, list);
}

fp3_status fp3_engine_set_neighbours(fp3_engine *engine, size_t group, const char *name,
                                     const fp3_neighbours *neighbours) {
    fp3_list *list = NULL;
    fp3_status status = find_list(engine, group, name, &list);
    if (status)
        return status;
    status = check_kind(engine, group, name, neighbours->kind);
    if (status)
        return status;
    if (neighbours->begin)
        status = check_entries(engine, list, name, neighbours);
    else if (list->fields)
        status = fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                          "list '%s': entries have fields, but none are given", name);
    fp3_neighbours as_words = *neighbours;
    uint32_t *words = NULL;
    if (!status)
        status = convert_fields(engine, list, name, neighbours, &words);
    if (words)
        as_words.fields = (const float *)(const void *)words;
    if (!status)
        status = fp3_list_take(list, &as_words, engine->def.error);
    free(words);
    return status ? status : changed(engine, group, list);
}

static const uint32_t *rows(const fp3_engine *engine) {
    return engine->backend->rows ? engine->backend->rows(engine) : NULL;
}

fp3_status fp3_engine_read_remembered(fp3_engine *engine, uint32_t group, uint32_t list,
                                      fp3_remembered *saved) {
    const fp3_members *of = &engine->layout.groups[group];
    return fp3_list_save(&of->lists.lists[list], rows(engine), of->rows, saved, engine->def.error);
}

fp3_status fp3_engine_write_remembered(fp3_engine *engine, uint32_t group, uint32_t list,
                                       const fp3_remembered *saved) {
    fp3_members *of = &engine->layout.groups[group];
    fp3_status status =
        fp3_list_restore(&of->lists.lists[list], rows(engine), of->rows, saved, engine->def.error);
    engine->origin->is_complete = 0;
    if (!status && engine->backend->connect)
        status = engine->backend->connect(engine, of, NULL);
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
        if (group->lists.shape.is_any && engine->lives.list && engine->backend->is_divided)
            return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                            "objects that are born or gone cannot be neighbours in several ranks: "
                            "ranks agree once, before a run, whose words each of them needs");
    }
    return fp3_radii_check(engine);
}
