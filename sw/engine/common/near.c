/* SPDX-License-Identifier: Apache-2.0 */
/* near.c - lists of those that are near: each object looks around, and enters itself in the lists
 * of those that it has found. */
#include "near.h"

#include "near_levels.h"

#include <inttypes.h>
#include <stdlib.h>

/* A part of the rows: row i has found[first[i]] .., in the order of the cells. */
typedef struct {
    fp3_near_found all;
    uint32_t begin, end;
    fp3_status status;
    fp3_error error;
} pairs;

/* All parts, where each row's begin in its part, and who has found a row that has not found them:
 * met[met_first[i]] .. of row i; NULLs: nobody has. */
typedef struct {
    fp3_near_levels levels;
    const fp3_where_they_are *now;
    pairs *part;
    uint32_t *first, count;
    uint32_t *met_first, *met;
} search;

static fp3_status too_many(const fp3_where_they_are *now, fp3_error *error) {
    return fp3_fail(error, FP3_E_LIMIT,
                    "the lists of near objects have more than 2147483647 entries: the %" PRIu32
                    " objects are too many, or the reach is too long",
                    now->objects);
}

static void find_part(void *of, uint32_t number) {
    const search *s = of;
    const fp3_where_they_are *now = s->now;
    pairs *p = &s->part[number];
    for (uint32_t i = p->begin; !p->status && i < p->end; i++) {
        s->first[i] = (uint32_t)p->all.count;
        if (now->theirs[0] && i >= now->own && i < now->from) /* of a third kind */
            continue;
        p->status = fp3_near_levels_find(&s->levels, i, &p->all, &p->error);
        if (!p->status && p->all.count > INT32_MAX)
            p->status = too_many(now, &p->error);
    }
}

/* Who looks: of two kinds the other one, and both if there are several levels. */
static fp3_row_range seekers(const search *s) {
    fp3_row_range range = fp3_near_sought(s->now);
    if (s->levels.count > 1)
        range.first = 0;
    return range;
}

static fp3_status find_pairs(search *s, fp3_error *error) {
    const fp3_row_range range = seekers(s);
    s->count = fp3_near_parts(s->now, FP3_NEAR_TOGETHER);
    s->part = calloc(s->count, sizeof *s->part);
    s->first = malloc((range.end + 2u) * sizeof *s->first);
    if (!s->part || !s->first)
        return fp3_no_memory(error);
    for (uint32_t i = 0; i < s->count; i++) {
        s->part[i].begin = fp3_near_part(range, i, s->count).first;
        s->part[i].end = fp3_near_part(range, i, s->count).end;
    }
    fp3_parts_make(s->now->crew, find_part, s, s->count);
    size_t all = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        const pairs *p = &s->part[i];
        if (p->status && error)
            *error = p->error;
        if (p->status)
            return p->status;
        all += p->all.count;
    }
    if (s->levels.count > 1) /* what is found across them is in two lists */
        all *= 2;
    return all > INT32_MAX ? too_many(s->now, error) : FP3_OK;
}

static uint32_t end_of(const pairs *p, const search *s, uint32_t row) {
    return row + 1 < p->end ? s->first[row + 1] : (uint32_t)p->all.count;
}

/* The part that has this row. */
static const pairs *part_with(const search *s, uint32_t row) {
    const fp3_row_range range = seekers(s);
    const pairs *p = &s->part[(uint64_t)(row - range.first) * s->count / (range.end - range.first)];
    while (row >= p->end)
        p++;
    return p;
}

/* Goes through what has been found across levels: counts, or puts. */
static void meet_all(const search *s, uint32_t *at, int is_put) {
    for (uint32_t k = 0; k < s->count; k++)
        for (uint32_t i = s->part[k].begin; i < s->part[k].end; i++)
            for (uint32_t n = s->first[i], end = fp3_near_looks_across(&s->levels, i)
                                                     ? end_of(&s->part[k], s, i)
                                                     : n;
                 n < end; n++) {
                const uint32_t found = s->part[k].all.found[n];
                if (!fp3_near_is_across(&s->levels, i, found))
                    continue;
                if (is_put)
                    s->met[at[found]] = i;
                at[found]++;
            }
}

static fp3_status find_met(search *s, fp3_error *error) {
    if (s->levels.count < 2)
        return FP3_OK;
    const uint32_t objects = s->now->objects;
    s->met_first = calloc(objects + 2u, sizeof *s->met_first);
    if (!s->met_first)
        return fp3_no_memory(error);
    meet_all(s, s->met_first + 2, 0);
    for (uint32_t i = 2; i < objects + 2u; i++)
        s->met_first[i] += s->met_first[i - 1];
    s->met = malloc((s->met_first[objects + 1] + (size_t)1) * sizeof *s->met);
    if (!s->met)
        return fp3_no_memory(error);
    meet_all(s, s->met_first + 1, 1);
    return FP3_OK;
}

/* Object j enters itself in the lists of those that it has found, or that have found it. */
static void enter_one(const search *s, uint32_t j, uint32_t *next, uint32_t *other) {
    const pairs *p = part_with(s, j);
    for (uint32_t n = s->first[j], end = end_of(p, s, j); n < end; n++)
        if (p->all.found[n] != j)
            other[next[p->all.found[n]]++] = j;
    for (uint32_t n = s->met ? s->met_first[j] : 0; s->met && n < s->met_first[j + 1]; n++)
        other[next[s->met[n]]++] = j;
}

/* How long lists are: begin[i + 1] of row i. */
static void count_entries(const search *s, uint32_t *begin) {
    for (uint32_t k = 0; k < s->count; k++)
        for (uint32_t i = s->part[k].begin; i < s->part[k].end; i++) {
            const uint32_t end = end_of(&s->part[k], s, i);
            if (!s->now->theirs[0])
                begin[i + 1] += end - s->first[i] - 1; /* each has found itself, too */
            else if (i < s->now->own)
                begin[i + 1] += end - s->first[i];
            for (uint32_t n = s->first[i]; s->now->theirs[0] && i >= s->now->own && n < end; n++)
                begin[s->part[k].all.found[n] + 1]++;
            if (s->met && !s->now->theirs[0])
                begin[i + 1] += s->met_first[i + 1] - s->met_first[i];
        }
}

/* Objects come in the order of their numbers, so all lists have that order. */
static fp3_status enter(const search *s, uint32_t **begin, uint32_t **other, fp3_error *error) {
    const fp3_where_they_are *now = s->now;
    const uint32_t objects = now->objects;
    uint32_t *next = malloc((objects + 1u) * sizeof *next);
    *begin = calloc(objects + 2u, sizeof **begin);
    if (*begin && next) {
        count_entries(s, *begin);
        for (uint32_t i = 0; i < objects; i++)
            (*begin)[i + 1] += (*begin)[i];
        memcpy(next, *begin, objects * sizeof *next);
        *other = malloc(((*begin)[objects] + (size_t)1) * sizeof **other);
    }
    for (uint32_t i = fp3_near_sought(now).first; *other && i < objects; i++) {
        const uint32_t object = now->order ? now->order[i] : i;
        enter_one(s, now->row && !now->theirs[0] ? now->row[object] : object, next, *other);
    }
    free(next);
    return *other ? FP3_OK : fp3_no_memory(error);
}

fp3_status fp3_near_note(fp3_near_rule *rule, const fp3_where_they_are *now, fp3_error *error) {
    for (uint32_t k = 0; k < FP3_NEAR_COLUMNS; k++) {
        if (!fp3_near_has(rule, k))
            continue;
        if (!rule->made[k])
            rule->made[k] = malloc((now->objects + 1u) * sizeof *rule->made[k]);
        if (!rule->made[k])
            return fp3_no_memory(error);
        for (uint32_t i = 0; i < now->objects; i++)
            rule->made[k][i] = fp3_near_word(now, k, i);
    }
    if (fp3_near_has_radii(now) && !rule->radii &&
        !(rule->radii = malloc((now->objects + 1u) * sizeof *rule->radii)))
        return fp3_no_memory(error);
    for (uint32_t i = 0; rule->radii && i < now->objects; i++)
        rule->radii[i] = fp3_near_radius_word(now, i);
    rule->lists++;
    return FP3_OK;
}

fp3_status fp3_near_make(fp3_near_rule *rule, const fp3_where_they_are *now, uint32_t **begin,
                         uint32_t **other, fp3_error *error) {
    search s = {.now = now};
    *begin = *other = NULL;
    fp3_near_find_margins(rule, now);
    fp3_status status = fp3_near_levels_open(rule, now, &s.levels, error);
    if (!status)
        status = find_pairs(&s, error);
    if (!status)
        status = find_met(&s, error);
    if (!status)
        status = enter(&s, begin, other, error);
    if (!status)
        status = fp3_near_note(rule, now, error);
    rule->looks = 0;
    for (uint32_t i = 0; s.part && i < s.count; i++) {
        rule->looks += s.part[i].all.looks;
        free(s.part[i].all.found);
    }
    free(s.part);
    free(s.first);
    free(s.met_first);
    free(s.met);
    fp3_near_levels_close(&s.levels);
    return status;
}

fp3_status fp3_near_order(const fp3_near_rule *rule, const fp3_where_they_are *now, uint32_t *rows,
                          fp3_error *error) {
    fp3_near_grid g;
    const double reach =
        fp3_near_has_radii(now) ? fp3_near_middle(rule, now) + rule->skin : fp3_near_reach(rule);
    const fp3_near_members of = {
        .count = now->objects, .reach = fmax(reach, FP3_NEAR_LEAST), .is_box = 1};
    const fp3_status status = fp3_near_grid_open(rule, now, &of, &g, error);
    if (!status)
        memcpy(rows, g.order, now->objects * sizeof *rows);
    fp3_near_grid_close(&g);
    return status;
}

void fp3_near_close(fp3_near_rule *rule) {
    for (int k = 0; k < FP3_NEAR_COLUMNS; k++) {
        free(rule->made[k]);
        rule->made[k] = NULL;
    }
    free(rule->radii);
    rule->radii = NULL;
}
