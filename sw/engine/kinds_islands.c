/* SPDX-License-Identifier: Apache-2.0 */
/* kinds_islands.c - which objects are linked or near each other, directly or by others. */
#include "kinds_islands.h"

#include "engine/common/near_few.h"

#include <stdlib.h>
#include <string.h>

void fp3_islands_forget(fp3_rest *r) {
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

static int has_movers(const fp3_engine *engine, uint32_t number) {
    const fp3_members *group = &engine->layout.groups[number];
    for (uint32_t i = group->first; i < group->first + group->objects; i++)
        if (fp3_kinds_of(engine)->rest.flags[i] & MOVES)
            return 1;
    return 0;
}

/* Whose pairs tell all that a group wakes, or is woken by: those of another one, or its own. Own
 * pairs are in the lists of both ends, so the fewer rows do. */
static uint8_t whose_pairs(const fp3_engine *engine, uint32_t group, uint32_t other) {
    const fp3_kinds *self = fp3_kinds_of(engine);
    const fp3_kind_engine *own = &self->kinds[group], *their = &self->kinds[other];
    const uint32_t asleep = own->living - own->awake;
    if (group == other)
        return own->awake < asleep ? MOVES : SLEEPS;
    return (their->awake < their->living ? MOVES : 0) | (has_movers(engine, other) ? SLEEPS : 0);
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
    const double reach = fp3_near_reach_of(rule, w, a, b), most = reach * reach;
    double sum = 0;
    for (uint32_t k = 0; k < w->dimensions && !(sum >= most); k++) {
        const double way = fp3_near_at(rule, w, k, a) - fp3_near_at(rule, w, k, b);
        sum += way * way;
    }
    return sum < most;
}

#define NOTHING UINT32_MAX

/* A column of `near`: own rows, and then those of the kind. NOTHING: nothing of these. */
static fp3_status look_at_column(fp3_engine *engine, uint32_t number, const fp3_list *list,
                                 uint32_t reg, uint32_t theirs, int is_first, uint32_t *column) {
    const fp3_kinds *self = fp3_kinds_of(engine);
    const uint32_t own = engine->layout.groups[number].objects,
                   from = list->kind ? list->kind - 1 : number;
    const fp3_foreign_word *f = theirs != NOTHING ? foreign(&self->kinds[number], theirs) : NULL;
    fp3_status status = FP3_OK;
    if (reg != NOTHING)
        status = is_first ? read_word(engine, number, reg, 0, column)
                          : read_awake(engine, number, reg, column);
    if (!status && f && is_first)
        status = read_word(engine, from, f->of, f->is_shared, column + own);
    else if (!status && f && !f->is_shared)
        status = read_awake(engine, from, f->of, column + own);
    return status;
}

/* The columns of `near` as they are now. */
static fp3_status look_where(fp3_engine *engine, uint32_t number, const fp3_list *list,
                             struct fp3_rest_near *n, fp3_where_they_are *now) {
    const fp3_near_rule *rule = &list->near;
    const int is_first = !n->words;
    fp3_status status = FP3_OK;
    if (is_first)
        n->words = calloc(now->objects * (FP3_NEAR_COLUMNS + (size_t)1) + 1, sizeof *n->words);
    if (!n->words)
        return fp3_no_memory(engine->def.error);
    for (uint32_t k = 0; !status && k < FP3_NEAR_COLUMNS; k++) {
        if (!fp3_near_has(rule, k))
            continue;
        uint32_t *column = n->words + (size_t)k * now->objects;
        status = look_at_column(engine, number, list, rule->regs[k],
                                list->kind ? rule->theirs[k] : NOTHING, is_first, column);
        now->position[k] = column;
        now->theirs[k] = list->kind ? column : NULL;
    }
    const int has_theirs = list->kind && rule->their_radius;
    if (!status && (rule->radius || has_theirs)) {
        uint32_t *column = n->words + (size_t)FP3_NEAR_COLUMNS * now->objects;
        status = look_at_column(engine, number, list, rule->radius ? rule->radius - 1 : NOTHING,
                                has_theirs ? rule->their_radius - 1 : NOTHING, is_first, column);
        now->radius = rule->radius ? column : NULL;
        now->their_radius = has_theirs ? column : NULL;
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
        n->rule = fp3_near_without_list(rule);
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

static uint32_t count(const fp3_rest *r, const fp3_members *group, uint8_t flags) {
    uint32_t found = 0;
    for (uint32_t i = 0; i < group->objects; i++)
        found += (r->flags[group->first + i] & flags) != 0;
    return found;
}

/* Whose pairs are looked for: rows of a group, and behind them those of another kind, if there is
 * one. */
typedef struct {
    const fp3_members *group, *theirs;
    const fp3_near_rule *rule;
    const fp3_where_they_are *now;
} sides;

static void meet_one(fp3_rest *r, const sides *s, uint32_t i, uint32_t with) {
    const uint32_t own = s->group->objects;
    if (with != i && s->now->lives[with] && is_near(s->rule, s->now, i, with))
        meet(r, s->group->first + i,
             with < own ? s->group->first + with : s->theirs->first + with - own);
}

/* Most rows are too far in the first component already. */
static void meet_all_near(fp3_rest *r, const sides *s, uint32_t i) {
    const float *x = (const float *)(const void *)s->now->position[0];
    const double at = (double)x[i];
    for (uint32_t with = s->theirs ? s->group->objects : 0; with < s->now->objects; with++) {
        const double way = (double)x[with] - at, most = fp3_near_reach_of(s->rule, s->now, i, with);
        if (fp3_near_is_exact(s->rule) || way * way < most * most)
            meet_one(r, s, i, with);
    }
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
    const int are_few = is_brief && (uint64_t)rows * count(r, group, whose) <= FP3_NEAR_FEW;
    if (!status && !are_few)
        status = list_near(engine, &list->near, n, &now);
    for (uint32_t i = 0; !status && i < group->objects; i++) {
        if (!lives[i] || !(r->flags[group->first + i] & whose))
            continue;
        if (are_few)
            meet_all_near(r, &(sides){group, theirs, &list->near, &now}, i);
        else
            for (uint32_t e = n->begin[i]; e < n->begin[i + 1]; e++)
                meet_one(r, &(sides){group, theirs, &list->near, &now}, i, n->other[e]);
    }
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

fp3_status fp3_islands_find(fp3_engine *engine, int is_brief) {
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

void fp3_islands_spread(const fp3_engine *engine, uint8_t flag) {
    const fp3_rest *r = &fp3_kinds_of(engine)->rest;
    for (uint32_t i = 0; i < engine->objects; i++)
        if (r->flags[i] & flag)
            r->flags[root_of(r->root, i)] |= flag;
    for (uint32_t i = 0; i < engine->objects; i++)
        r->flags[i] |= r->flags[root_of(r->root, i)] & flag;
}
