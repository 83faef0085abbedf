/* SPDX-License-Identifier: Apache-2.0 */
/* near.h - lists of those that are near: made on a grid with a skin, and made again before one
 * could be missed.
 *
 * A list has all pairs that are nearer than reach + skin. As long as no object has moved by more
 * than half the skin since it was made, it has all that are nearer than reach.
 */
#ifndef FP3_ENGINE_NEAR_H
#define FP3_ENGINE_NEAR_H

#include "machine/format.h"
#include "parts.h"

#include <fp3/isa.h>
#include <fp3/status.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define FP3_NEAR_DIMENSIONS 3

/* How far a list may reach. A program compares squares in FP32: below, a square could lose too many
 * digits to underflow; above, it could overflow. */
#define FP3_NEAR_LEAST 0x1p-50
#define FP3_NEAR_MOST 0x1p63

/* Positions of objects: component k of the object at row i is position[k][i * stride]. */
typedef struct {
    const uint32_t *position[FP3_NEAR_DIMENSIONS]; /* words */
    /* Positions of objects of another kind, in rows from..objects-1. Lists are then of the rows
     * before `own`, with those as neighbours. NULLs: lists are of all rows, with all rows; nobody
     * needs those from row `own` on, unless it is 0. */
    const uint32_t *theirs[FP3_NEAR_DIMENSIONS];
    uint32_t own, from;
    const uint32_t *row;   /* of each object; NULL: its number */
    const uint32_t *order; /* objects as lists have them; NULL: by their numbers */
    const uint8_t *lives;  /* of each row; 0: nobody is near it. NULL: all live */
    size_t stride;
    uint32_t objects, dimensions;
    const fp3_crew *crew; /* NULL: the caller alone */
} fp3_where_they_are;

typedef struct {
    uint32_t regs[FP3_NEAR_DIMENSIONS];   /* of the position */
    uint32_t theirs[FP3_NEAR_DIMENSIONS]; /* of that of another kind */
    uint32_t dimensions;
    const fp3_config *format; /* whose words positions are; NULL: FP32 */
    double reach, skin;
    uint32_t *made[FP3_NEAR_DIMENSIONS]; /* where the object of each row was when the list was made;
                                            NULL: there is none */
    uint64_t lists;                      /* how many were made */
    uint64_t looks;                      /* at how many candidates the last of them took */
} fp3_near_rule;

/* Whether the list has to be made again. */
int fp3_near_is_stale(const fp3_near_rule *rule, const fp3_where_they_are *now);

/* Makes the list: *begin and *other as in fp3_neighbours, but of rows and with rows; the caller
 * frees them. Neighbours are in the order of their objects. Nobody is near an object whose position
 * is not finite. FP3_E_SYSTEM: out of memory. FP3_E_LIMIT: more than 2^31 entries. */
fp3_status fp3_near_make(fp3_near_rule *rule, const fp3_where_they_are *now, uint32_t **begin,
                         uint32_t **other, fp3_error *error);
/* Rows in an order in which those that are near each other mostly stand together: as many as there
 * are objects. Likewise. */
fp3_status fp3_near_order(const fp3_near_rule *rule, const fp3_where_they_are *now, uint32_t *rows,
                          fp3_error *error);
/* There is no list; the next look finds it stale. */
void fp3_near_close(fp3_near_rule *rule);

/* ---- for the files of near.c ---- */

/* A list has been made of what is so now. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_near_note(fp3_near_rule *rule, const fp3_where_they_are *now, fp3_error *error);

/* Distances are computed in FP32, here as by the program, each in its own way. Either may be wrong
 * by some units in the last place, for which the list reaches a little farther. Of words that are
 * no floats distances are computed in double here: a position rounded to a float would be wrong by
 * units of its own last place, which may be more than the whole reach. */
#define FP3_NEAR_ROUNDING 1e-5

/* How far a list reaches. A program that computes with fewer bits is wrong by more: each
 * difference, square, sum and the bound may be by a last place of theirs, which is less than 4 of a
 * distance. */
static inline double fp3_near_reach(const fp3_near_rule *rule) {
    const double place = rule->format ? ldexp(1, -(int)rule->format->fraction) : 0;
    return (rule->reach + rule->skin) * (1 + FP3_NEAR_ROUNDING + 4 * place);
}

/* Rows first .. end-1. */
typedef struct {
    uint32_t first, end;
} fp3_row_range;

/* Whose lists are made, and who is in them. */
static inline fp3_row_range fp3_near_seekers(const fp3_where_they_are *w) {
    return (fp3_row_range){0, w->theirs[0] ? w->own : w->objects};
}

static inline fp3_row_range fp3_near_sought(const fp3_where_they_are *w) {
    return (fp3_row_range){w->theirs[0] ? w->from : 0, w->objects};
}

static inline const uint32_t *fp3_near_words(const fp3_where_they_are *w, uint32_t k, size_t row) {
    return w->theirs[0] && row >= w->own ? w->theirs[k] : w->position[k];
}

/* Who does not live is nowhere. */
static inline uint32_t fp3_near_word(const fp3_where_they_are *w, uint32_t k, size_t row) {
    return w->lives && !w->lives[row] ? FP3_BITS_NAN : fp3_near_words(w, k, row)[row * w->stride];
}

static inline double fp3_near_number(const fp3_near_rule *rule, uint32_t word) {
    float f;
    if (rule->format)
        return fp3_format_number(rule->format, word);
    memcpy(&f, &word, sizeof f);
    return f;
}

static inline double fp3_near_at(const fp3_near_rule *rule, const fp3_where_they_are *w, uint32_t k,
                                 size_t row) {
    return fp3_near_number(rule, fp3_near_word(w, k, row));
}

/* One of `parts` of these rows. */
static inline fp3_row_range fp3_near_part(fp3_row_range all, uint32_t part, uint32_t parts) {
    const uint32_t count = all.end - all.first;
    return (fp3_row_range){all.first + fp3_part_begin(count, part, parts),
                           all.first + fp3_part_begin(count, part + 1, parts)};
}

/* In how many parts the work of so many objects is done: one below `least`. */
static inline uint32_t fp3_near_parts(const fp3_where_they_are *now, uint32_t least) {
    return now->objects < least ? 1 : fp3_parts_of(now->crew);
}

#endif
