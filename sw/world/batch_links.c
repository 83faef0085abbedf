/* SPDX-License-Identifier: Apache-2.0 */
/* batch_links.c - links of a batch: all of a relation, some more, some less. */
#include "batch_own.h"

#include "base/host.h"
#include "engine/common/inside.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* first: how many links there are before these. */
static fp3_status check_ends(const fp3_batch *b, const fp3_links *links, size_t first) {
    for (size_t i = 0; i < links->count; i++)
        for (int end = 0; end < 2; end++) {
            const uint32_t object = end ? links->b[i] : links->a[i];
            if (object < b->objects && !b->births.lives[object])
                return fp3_fail(b->error, FP3_E_ARGUMENT,
                                "link %zu joins object %" PRIu32 ", which does not live", first + i,
                                object);
        }
    return FP3_OK;
}

/* ---- what pairs remember, while links change ---- */

/* Entries of all objects, by their numbers, and the words of their fields. */
typedef struct {
    uint32_t *begin, *other;
    fp3_remembered words;
} entries;

static void free_entries(entries *e) {
    free(e->begin);
    free(e->other);
    fp3_remembered_free(&e->words);
}

static uint32_t *copied(const uint32_t *from, size_t count) {
    uint32_t *made = malloc((count + 1) * sizeof *made);
    if (made && count)
        memcpy(made, from, count * sizeof *made);
    return made;
}

static const fp3_list *list_of(const fp3_batch *b, int number) {
    return &fp3_engine_layout(b->engine)->groups[0].lists.lists[number];
}

/* -1: no list whose entries remember anything is there. */
static int find_list(const fp3_batch *b, const char *relation) {
    const int number = fp3_relations_list(&b->relations, relation);
    return number >= 0 && list_of(b, number)->is_there && fp3_list_remembers(list_of(b, number))
               ? number
               : -1;
}

static fp3_status take(const fp3_batch *b, int number, entries *e) {
    fp3_status status = fp3_engine_read_remembered(b->engine, 0, (uint32_t)number, &e->words);
    const fp3_entries given = fp3_list_given(list_of(b, number));
    if (status)
        return status;
    e->begin = copied(given.begin, b->objects + 1);
    e->other = e->begin ? copied(given.other, given.begin[b->objects]) : NULL;
    return e->other ? FP3_OK : fp3_no_memory(b->error);
}

/* Links that stay are in the order in which they were; those that are new begin anew. */
static fp3_status give_back(const fp3_batch *b, int number, const entries *before) {
    entries now = {0};
    const size_t fields = list_of(b, number)->fields;
    fp3_status status = take(b, number, &now);
    for (size_t i = 0; !status && i < b->objects; i++) {
        uint32_t old = before->begin[i];
        for (uint32_t e = now.begin[i]; e < now.begin[i + 1]; e++) {
            while (old < before->begin[i + 1] && before->other[old] != now.other[e])
                old++;
            if (old < before->begin[i + 1])
                memcpy(&now.words.field[e * fields], &before->words.field[old * fields],
                       fields * sizeof *now.words.field);
        }
    }
    if (!status)
        status = fp3_engine_write_remembered(b->engine, 0, (uint32_t)number, &now.words);
    free_entries(&now);
    return status;
}

/* made: all links that the relation has from now on, and no others. */
static fp3_status change(fp3_batch *b, const char *relation, fp3_linked *made, int is_kept) {
    fp3_relations one = b->relations;
    entries before = {0};
    one.linked = made;
    const int number = is_kept ? find_list(b, relation) : -1;
    fp3_status status = number < 0 ? FP3_OK : take(b, number, &before);
    if (!status)
        status = fp3_relations_link(&one, b->error);
    if (!status && number >= 0)
        status = give_back(b, number, &before);
    if (!status)
        status = fp3_linked_copy(made, &b->relations.linked, b->error);
    free_entries(&before);
    return status;
}

/* ---- calls ---- */

static fp3_status put(fp3_batch *b, const char *relation, const fp3_links *links, int is_more) {
    const fp3_linked *old = is_more ? fp3_linked_find(b->relations.linked, relation) : NULL;
    fp3_linked *made = NULL;
    fp3_status status = old ? fp3_linked_copy_one(old, &made, b->error) : FP3_OK;
    if (!status)
        status = fp3_linked_put(&made, relation, links, is_more, NULL, b->error);
    if (!status)
        status = check_ends(b, links, old ? old->links.count : 0);
    if (!status)
        status = change(b, relation, made, is_more);
    fp3_linked_free(&made);
    return status;
}

fp3_status fp3_batch_link(fp3_batch *b, const char *relation, const fp3_links *links) {
    FP3_HOST;
    return b ? put(b, relation, links, 0) : FP3_E_ARGUMENT;
}

fp3_status fp3_batch_link_more(fp3_batch *b, const char *relation, const fp3_links *links) {
    FP3_HOST;
    return b ? put(b, relation, links, 1) : FP3_E_ARGUMENT;
}

fp3_status fp3_batch_unlink(fp3_batch *b, const char *relation, const uint32_t *ends_a,
                            const uint32_t *ends_b, size_t count) {
    FP3_HOST;
    if (!b)
        return FP3_E_ARGUMENT;
    const fp3_linked *old = fp3_linked_find(b->relations.linked, relation);
    fp3_linked *made = NULL;
    if (!old)
        return fp3_fail(b->error, FP3_E_ARGUMENT, "there are no links of '%s'", relation);
    fp3_status status = fp3_linked_copy_one(old, &made, b->error);
    if (!status)
        status = fp3_linked_remove(made, ends_a, ends_b, count, b->error);
    if (!status)
        status = change(b, relation, made, 1);
    fp3_linked_free(&made);
    return status;
}
