/* SPDX-License-Identifier: Apache-2.0 */
/* lists.h - the lists of neighbours of a group's objects, which its program's loops go through. */
#ifndef FP3_ENGINE_LISTS_H
#define FP3_ENGINE_LISTS_H

#include "machine/neighbours.h"
#include "near.h"

#include <fp3/engine.h>

/* Who lives, where some objects of a group do not. */
typedef struct {
    uint8_t *is;     /* of each object: 1 or 0 */
    uint32_t *who;   /* those that live, by their numbers */
    uint32_t *place; /* of each object, its place in `who`; UINT32_MAX: it does not live */
    uint32_t count;
} fp3_living;

/* Links of all objects, as in fp3_list. */
typedef struct {
    uint32_t *begin, *other, *field;
} fp3_entries;

/* One list of each object of a group. */
typedef struct {
    uint32_t reg, fields; /* as of fp3_list_shape */
    uint64_t kept;        /* likewise: the program writes them, each object those of its entries */
    int is_there;         /* the host has given it */
    int is_all;           /* all other objects, in the order of their numbers */
    int is_near;          /* those within a distance: the list is made as objects move */
    int is_placed;        /* objects have been divided among lanes since it was given */
    fp3_near_rule near;
    uint32_t objects;
    /* Neighbours are among rows first .. end-1: all objects; of another kind its guests. Only rows
     * before `own` have any. */
    uint32_t first, end, own;
    uint32_t kind;            /* as of fp3_neighbours */
    uint32_t *begin;          /* object i has the entries begin[i] .. begin[i+1]; NULL if is_all */
    uint32_t *other;          /* of each entry: a number in the group */
    uint32_t *field;          /* FP32 bits: `fields` words of each entry */
    const fp3_living *living; /* the entries are those of these objects; NULL: of all */
    fp3_entries whole;        /* ... and links as the host gave them; NULLs: none are left out */
} fp3_list;

typedef struct {
    fp3_neighbourhood shape;
    uint32_t *order; /* objects in the order in which sums go through those that are near; NULL: as
                        they are numbered */
    fp3_living *living; /* whose lists they are (living.h); NULL: all live */
    fp3_list lists[FP3_LISTS_MAX];
} fp3_lists;

/* Leaves NULL, which it may be already. */
void fp3_living_free(fp3_living **living);

/* No list is there yet. */
void fp3_lists_open(const fp3_neighbourhood *shape, uint32_t objects, fp3_lists *lists);
void fp3_lists_close(fp3_lists *lists);
/* The list of register reg, which there is. */
fp3_list *fp3_lists_of(fp3_lists *lists, uint32_t reg);
/* Makes a list what the host gives, or the one of those that are near. FP3_E_SYSTEM: out of memory;
 * it is as it was. */
fp3_status fp3_list_take(fp3_list *list, const fp3_neighbours *from, fp3_error *error);
/* kind: as in fp3_list. Pairs keep what they remember if they were near ones of that kind before.
 */
void fp3_list_take_near(fp3_list *list, const fp3_near_rule *rule, uint32_t kind);
/* `order` is the lists' then. Those of objects that are near are made again. */
void fp3_lists_take_order(fp3_lists *lists, uint32_t *order);
/* rows: as many as the group has. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_lists_copy(const fp3_lists *from, uint32_t rows, fp3_lists *to, fp3_error *error);

/* ---- what entries remember ----
 *
 * Fields that the program writes. A list of those that are near is made again with what its pairs
 * remember. A pair that remembers anything but +0 stays in it, however far it is: until the program
 * has written +0, nobody can tell from the list how wide the skin is. */

/* A copy, by the objects' numbers: of near objects those entries that remember something, else
 * all that the host gave, whoever lives. */
typedef struct {
    uint32_t *begin, *other; /* NULL if the host gave the list */
    uint32_t *field;
} fp3_remembered;

static inline int fp3_list_remembers(const fp3_list *list) { return list->kept != 0; }
/* Whether a list of the program has such fields. */
int fp3_lists_remember(const fp3_lists *lists);
/* Of near objects, by their numbers: pairs of which one does not live are no more. */
void fp3_list_forget(fp3_list *list, const uint8_t *lives);
/* Where links between some that do not live are left out: fields of the others go to the whole
 * list, or come from there. */
void fp3_list_carry(const fp3_list *list, int is_back);
/* row: of each object, NULL: its number. The caller frees with fp3_remembered_free, also after a
 * failure. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_list_save(const fp3_list *list, const uint32_t *row, uint32_t objects,
                         fp3_remembered *saved, fp3_error *error);
/* Back: the list is the one of which it was saved, or one that was given likewise. */
fp3_status fp3_list_restore(fp3_list *list, const uint32_t *row, uint32_t objects,
                            const fp3_remembered *saved, fp3_error *error);
void fp3_remembered_free(fp3_remembered *saved);
/* Near lists after row i has got what was in row rows[i]. */
fp3_status fp3_lists_move(fp3_lists *lists, const uint32_t *rows, uint32_t count, fp3_error *error);

/* Links as the host gave them. */
static inline fp3_entries fp3_list_given(const fp3_list *list) {
    return list->whole.begin ? list->whole : (fp3_entries){list->begin, list->other, list->field};
}

/* 1 + the number of the neighbour that an object sees in this turn of a loop, if it is near and at
 * the same place; else 0. Objects have `each` words; those of the group begin at `first`. list:
 * NULL outside of loops. */
uint32_t fp3_list_same_place(const fp3_list *list, const uint32_t *words, size_t each,
                             uint32_t first, uint32_t object, uint32_t turn);

static inline uint32_t fp3_list_length(const fp3_list *list, uint32_t object) {
    if (!list->is_all)
        return list->begin[object + 1] - list->begin[object];
    if (!list->living)
        return list->end - list->first - (object >= list->first && object < list->end);
    return list->living->is[object] ? list->living->count - 1 : 0;
}

static inline uint32_t fp3_list_entry(const fp3_list *list, uint32_t object, uint32_t turn) {
    if (!list->is_all)
        return list->other[list->begin[object] + turn];
    if (!list->living)
        return list->first + turn + (object >= list->first && list->first + turn >= object);
    return list->living->who[turn + (turn >= list->living->place[object])];
}

#endif
