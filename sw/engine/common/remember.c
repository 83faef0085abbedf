/* SPDX-License-Identifier: Apache-2.0 */
/* remember.c - what entries remember: kept as lists are made again, as rows move, and by the host.
 */
#include "remember.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

int fp3_lists_remember(const fp3_lists *lists) {
    int is_any = 0;
    for (uint32_t i = 0; i < lists->shape.list_count; i++)
        is_any |= fp3_list_remembers(&lists->lists[i]);
    return is_any;
}

static const uint32_t *fields_at(const fp3_list *list, size_t entry) {
    return &list->field[entry * list->fields];
}

/* Whether an entry remembers anything. A zero with a sign is something. */
static int has_memory(const fp3_list *list, size_t entry) {
    uint32_t any = 0;
    for (uint32_t f = 0; f < list->fields; f++)
        any |= fields_at(list, entry)[f];
    return any != 0;
}

static uint32_t *words_of(size_t count) { return calloc(count + 1, sizeof(uint32_t)); }

/* ---- a list is made again ---- */

typedef struct {
    const fp3_list *list;
    uint32_t *rank;                  /* of each row: where lists have it */
    uint32_t *old;                   /* of each row: 1 + the entry of the list as it was, or 0 */
    uint32_t *begin, *other, *field; /* what is made */
    uint32_t count;
} merger;

/* Puts an entry behind those that an object has by now, or before some of these. */
static void put(merger *m, uint32_t first, uint32_t other, uint32_t old) {
    const size_t fields = m->list->fields, bytes = fields * sizeof *m->field;
    uint32_t at = m->count++;
    while (at > first && m->rank[m->other[at - 1]] > m->rank[other]) {
        m->other[at] = m->other[at - 1];
        memcpy(&m->field[at * fields], &m->field[(at - 1) * fields], bytes);
        at--;
    }
    m->other[at] = other;
    if (old)
        memcpy(&m->field[at * fields], fields_at(m->list, old - 1), bytes);
    else
        memset(&m->field[at * fields], 0, bytes);
}

static void merge_object(merger *m, uint32_t row, const uint32_t *begin, const uint32_t *other) {
    const fp3_list *list = m->list;
    const uint32_t first = m->begin[row] = m->count;
    const uint32_t from = list->begin ? list->begin[row] : 0,
                   end = list->begin ? list->begin[row + 1] : 0;
    for (uint32_t e = from; e < end; e++)
        m->old[list->other[e]] = has_memory(list, e) ? e + 1 : 0;
    for (uint32_t e = begin[row]; e < begin[row + 1]; e++) {
        put(m, first, other[e], m->old[other[e]]);
        m->old[other[e]] = 0;
    }
    for (uint32_t e = from; e < end; e++) {
        if (m->old[list->other[e]])
            put(m, first, list->other[e], e + 1);
        m->old[list->other[e]] = 0;
    }
}

static void find_ranks(merger *m, const fp3_where_they_are *now) {
    for (uint32_t i = 0; i < now->objects; i++) {
        const uint32_t object = now->order ? now->order[i] : i;
        m->rank[now->row ? now->row[object] : object] = i;
    }
}

/* How many entries there may be. */
static size_t most_of(const fp3_list *list, uint32_t objects, const uint32_t *begin) {
    size_t most = begin[objects];
    for (uint32_t e = 0; list->begin && e < list->begin[objects]; e++)
        most += (size_t)has_memory(list, e);
    return most;
}

fp3_status fp3_list_merge(const fp3_list *list, const fp3_where_they_are *now, uint32_t **begin,
                          uint32_t **other, uint32_t **field, fp3_error *error) {
    const uint32_t objects = now->objects, own = objects < list->own ? objects : list->own;
    const size_t most = most_of(list, own, *begin);
    if (most > INT32_MAX)
        return fp3_fail(error, FP3_E_LIMIT,
                        "the lists of near objects have more than 2147483647 entries");
    merger m = {.list = list,
                .rank = words_of(objects),
                .old = words_of(objects),
                .begin = words_of(list->objects),
                .other = words_of(most),
                .field = words_of(most * list->fields)};
    const int is_good = m.rank && m.old && m.begin && m.other && m.field;
    if (is_good) {
        find_ranks(&m, now);
        for (uint32_t i = 0; i < own; i++)
            merge_object(&m, i, *begin, *other);
        for (uint32_t i = own; i <= list->objects; i++) /* also of rows that are in no list */
            m.begin[i] = m.count;
        free(*begin);
        free(*other);
        *begin = m.begin;
        *other = m.other;
        *field = m.field;
    } else {
        free(m.begin);
        free(m.other);
        free(m.field);
    }
    free(m.rank);
    free(m.old);
    return is_good ? FP3_OK : fp3_no_memory(error);
}

/* ---- rows ---- */

/* Of near objects, from rows to others: row i gets what is in row from[i], and an entry of row r
 * becomes one of to[r]; NULL: the same. is_all: entries that remember nothing, too. */
static fp3_status translate(const fp3_list *list, const uint32_t *from, const uint32_t *to,
                            uint32_t rows, int is_all, fp3_remembered *made, fp3_error *error) {
    rows = rows < list->own ? rows : list->own;
    const size_t entries = list->begin ? list->begin[rows] : 0, fields = list->fields;
    uint32_t count = 0;
    *made = (fp3_remembered){words_of(rows), words_of(entries), words_of(entries * fields)};
    if (!made->begin || !made->other || !made->field)
        return fp3_no_memory(error);
    for (uint32_t i = 0; list->begin && i < rows; i++) {
        const uint32_t row = from ? from[i] : i;
        made->begin[i] = count;
        for (uint32_t e = list->begin[row]; e < list->begin[row + 1]; e++) {
            if (!is_all && !has_memory(list, e))
                continue;
            made->other[count] = to ? to[list->other[e]] : list->other[e];
            memcpy(&made->field[count++ * fields], fields_at(list, e),
                   fields * sizeof *made->field);
        }
    }
    made->begin[rows] = count;
    return FP3_OK;
}

static uint32_t *inverse(const uint32_t *row, uint32_t count) {
    uint32_t *made = words_of(count);
    for (uint32_t i = 0; made && i < count; i++)
        made[row[i]] = i;
    return made;
}

static void become(fp3_list *list, fp3_remembered *made) {
    free(list->begin);
    free(list->other);
    free(list->field);
    list->begin = made->begin;
    list->other = made->other;
    list->field = made->field;
    *made = (fp3_remembered){0};
    fp3_near_close(&list->near);
}

fp3_status fp3_lists_move(fp3_lists *lists, const uint32_t *rows, uint32_t count,
                          fp3_error *error) {
    uint32_t *to = fp3_lists_remember(lists) ? inverse(rows, count) : NULL;
    fp3_status status = FP3_OK;
    if (fp3_lists_remember(lists) && !to)
        return fp3_no_memory(error);
    for (uint32_t i = 0; !status && i < lists->shape.list_count; i++) {
        fp3_list *list = &lists->lists[i];
        fp3_remembered made = {0};
        if (list->is_near && list->fields) {
            status = translate(list, rows, to, count, 0, &made, error);
            if (!status)
                become(list, &made);
        }
        fp3_remembered_free(&made);
    }
    free(to);
    return status;
}

/* ---- the host ---- */

void fp3_list_forget(fp3_list *list, const uint8_t *lives) {
    const size_t fields = list->fields, bytes = fields * sizeof *list->field;
    uint32_t count = 0, from = 0;
    for (uint32_t i = 0; list->begin && i < list->own; i++) {
        const uint32_t end = list->begin[i + 1];
        list->begin[i] = count;
        for (; from < end; from++) {
            if (!lives[i] || !lives[list->other[from]])
                continue;
            list->other[count] = list->other[from];
            memmove(&list->field[count++ * fields], fields_at(list, from), bytes);
        }
    }
    if (list->begin)
        list->begin[list->own] = count;
}

/* Fields of all links that the host gave, as the program has written them. */
static size_t given_words(const fp3_list *list) {
    const fp3_entries given = fp3_list_given(list);
    return given.begin ? (size_t)given.begin[list->objects] * list->fields : 0;
}

fp3_status fp3_list_save(const fp3_list *list, const uint32_t *row, uint32_t objects,
                         fp3_remembered *saved, fp3_error *error) {
    *saved = (fp3_remembered){0};
    if (!list->is_near) {
        const size_t words = given_words(list);
        fp3_list_carry(list, 1);
        saved->field = words_of(words);
        if (saved->field && words)
            memcpy(saved->field, fp3_list_given(list).field, words * sizeof *saved->field);
        return saved->field ? FP3_OK : fp3_no_memory(error);
    }
    uint32_t *to = row ? inverse(row, objects) : NULL;
    if (row && !to)
        return fp3_no_memory(error);
    const fp3_status status = translate(list, row, to, objects, 0, saved, error);
    free(to);
    return status;
}

fp3_status fp3_list_restore(fp3_list *list, const uint32_t *row, uint32_t objects,
                            const fp3_remembered *saved, fp3_error *error) {
    if (!list->is_near) {
        const size_t words = given_words(list);
        if (words)
            memcpy(fp3_list_given(list).field, saved->field, words * sizeof *saved->field);
        fp3_list_carry(list, 0);
        return FP3_OK;
    }
    fp3_list from = {.fields = list->fields,
                     .own = list->own,
                     .begin = saved->begin,
                     .other = saved->other,
                     .field = saved->field};
    uint32_t *to = row ? inverse(row, objects) : NULL;
    fp3_remembered made = {0};
    if (row && !to)
        return fp3_no_memory(error);
    const fp3_status status = translate(&from, to, row, objects, 1, &made, error);
    free(to);
    if (!status)
        become(list, &made);
    fp3_remembered_free(&made);
    return status;
}

void fp3_remembered_free(fp3_remembered *saved) {
    free(saved->begin);
    free(saved->other);
    free(saved->field);
    *saved = (fp3_remembered){0};
}
