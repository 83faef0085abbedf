/* SPDX-License-Identifier: Apache-2.0 */
/* radii.c - see radii.h. */
#include "radii.h"

#include "cells.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

int fp3_is_radius(double x) { return x == 0 || (x >= FP3_NEAR_LEAST && x <= FP3_NEAR_RADIUS_MOST); }

/* ---- which they are ---- */

/* The word that a program reads of another group, of this name; NULL: there is none. */
static const fp3_foreign *foreign(const fp3_members *own, const char *word) {
    for (uint32_t i = 0; i < own->foreign_count; i++)
        if (strcmp(own->foreign[i].word, word) == 0)
            return &own->foreign[i];
    return NULL;
}

/* What it is in the program of that group; NULL: nothing that stays as it is. */
static const fp3_symbol *what_is(const fp3_engine *engine, const fp3_foreign *f) {
    return fp3_image_find(engine->layout.groups[f->group].image, f->of,
                          FP3_CLASS(FP3_SYMBOL_PARAM) | FP3_CLASS(FP3_SYMBOL_SHARED));
}

/* 1 + the register. kind: as of fp3_near. */
static fp3_status find(const fp3_engine *engine, size_t group, const char *name, const char *radius,
                       size_t kind, uint32_t *reg) {
    const fp3_members *members = &engine->layout.groups[group];
    const fp3_symbol *s = fp3_image_find(members->image, radius, FP3_CLASS(FP3_SYMBOL_PARAM));
    const fp3_foreign *f = foreign(members, radius);
    if (!s || (kind ? !f || f->group + 1 != kind : f != NULL))
        return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                        "list '%s': '%s' is no param of %s, which could be added to the reach",
                        name, radius, kind ? "the other group" : "the program");
    if (kind && !what_is(engine, f))
        return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                        "list '%s': '%s' is a state of group %zu, and a reach changes with params "
                        "alone: a step would change who is near before lists are made",
                        name, radius, kind - 1);
    *reg = 1 + s->index;
    return FP3_OK;
}

fp3_status fp3_radii_find(const fp3_engine *engine, size_t group, const char *name,
                          const fp3_near *near, fp3_near_rule *rule) {
    fp3_status status = FP3_OK;
    if (near->their_radius && !near->kind)
        return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                        "list '%s': objects of the own group have one radius, and '%s' is another",
                        name, near->their_radius);
    if (near->radius)
        status = find(engine, group, name, near->radius, 0, &rule->radius);
    if (!status && near->their_radius)
        status = find(engine, group, name, near->their_radius, near->kind, &rule->their_radius);
    if (near->radius || near->their_radius)
        rule->share = near->share;
    return status;
}

/* ---- what objects have ---- */

static fp3_status check_group(fp3_engine *engine, uint32_t number, fp3_cells cells,
                              const char *name) {
    const fp3_near_rule rule = {.format =
                                    fp3_format_is_float(engine->config) ? NULL : engine->config};
    uint32_t *words = malloc((cells.count + (size_t)1) * sizeof *words);
    fp3_status status =
        words ? engine->backend->read(engine, cells, words) : fp3_no_memory(engine->def.error);
    for (uint32_t i = 0; !status && i < cells.count; i++) {
        const double radius = fp3_near_number(&rule, words[i]);
        if (!fp3_is_radius(radius))
            status =
                fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                         "%sobject %" PRIu32 " adds %g to the reach of '%s': expected 0, or "
                         "2^-50 to 2^61",
                         fp3_engine_prefix(number, engine->layout.count).text, i, radius, name);
    }
    free(words);
    return status;
}

static fp3_status check_theirs(fp3_engine *engine, const fp3_members *group, const fp3_list *list,
                               const char *name) {
    const char *word = fp3_image_name(group->image, list->near.their_radius - 1);
    const fp3_foreign *f = word ? foreign(group, word) : NULL;
    const fp3_symbol *s = f ? what_is(engine, f) : NULL;
    const fp3_members *theirs = f ? &engine->layout.groups[f->group] : NULL;
    if (!s)
        return FP3_OK;
    return check_group(
        engine, (uint32_t)f->group,
        s->symbol_class == FP3_SYMBOL_PARAM
            ? (fp3_cells){FP3_CELLS_REGISTER, s->index, theirs->first, theirs->objects}
            : (fp3_cells){FP3_CELLS_CONSTANT, (uint32_t)f->group, s->index, 1},
        name);
}

fp3_status fp3_radii_check(fp3_engine *engine) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        for (uint32_t k = 0; !status && k < group->lists.shape.list_count; k++) {
            const fp3_list *list = &group->lists.lists[k];
            const char *name = fp3_image_name(group->image, list->reg);
            if (!list->is_near || !(list->near.radius || list->near.their_radius))
                continue;
            if (engine->backend->is_divided)
                return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                                "list '%s': several ranks have one reach for all pairs: each of "
                                "them finds whom it needs from positions alone",
                                name ? name : "?");
            if (list->near.radius)
                status = check_group(engine, i,
                                     (fp3_cells){FP3_CELLS_REGISTER, list->near.radius - 1,
                                                 group->first, group->objects},
                                     name ? name : "?");
            if (!status && list->kind && list->near.their_radius)
                status = check_theirs(engine, group, list, name ? name : "?");
        }
    }
    return status;
}
