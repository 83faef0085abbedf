/* SPDX-License-Identifier: Apache-2.0 */
/* near_rule.h - who is near, and who has to be in a list of those that are near.
 *
 * A list has all pairs that are nearer than reach + skin. As long as no object has moved by more
 * than half the skin since it was made, it has all that are nearer than reach. The reach of a pair
 * is the rule's, and what both objects add to it: their radii, numbers of their records.
 */
#ifndef FP3_ENGINE_NEAR_RULE_H
#define FP3_ENGINE_NEAR_RULE_H

#include "machine/format.h"
#include "parts.h"

#include <fp3/isa.h>
#include <fp3/status.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define FP3_NEAR_DIMENSIONS 3
/* Columns of words: of each component, and behind them the second words, if it is a sum of two. */
#define FP3_NEAR_COLUMNS (2 * FP3_NEAR_DIMENSIONS)

/* How far a list may reach. A program compares squares in FP32: below, a square could lose too many
 * digits to underflow; above, it could overflow. */
#define FP3_NEAR_LEAST 0x1p-50
#define FP3_NEAR_MOST 0x1p63
/* What an object may add to the reach, if it is not 0: two of these, and another one, are in range.
 */
#define FP3_NEAR_RADIUS_MOST 0x1p61

/* Positions of objects: column k of the object at row i is position[k][i * stride]. */
typedef struct {
    const uint32_t *position[FP3_NEAR_COLUMNS]; /* words */
    /* Positions of objects of another kind, in rows from..objects-1. Lists are then of the rows
     * before `own`, with those as neighbours. NULLs: lists are of all rows, with all rows; nobody
     * needs those from row `own` on, unless it is 0. */
    const uint32_t *theirs[FP3_NEAR_COLUMNS];
    uint32_t own, from;
    /* What an object adds to the reach, likewise, of own rows and of those of another kind; NULL:
     * 0.
     */
    const uint32_t *radius, *their_radius;
    const uint32_t *row;   /* of each object; NULL: its number */
    const uint32_t *order; /* objects as lists have them; NULL: by their numbers */
    const uint8_t *lives;  /* of each row; 0: nobody is near it. NULL: all live */
    size_t stride;
    uint32_t objects, dimensions;
    const fp3_crew *crew; /* NULL: the caller alone */
} fp3_where_they_are;

typedef struct {
    uint32_t regs[FP3_NEAR_COLUMNS];   /* of the position */
    uint32_t theirs[FP3_NEAR_COLUMNS]; /* of that of another kind */
    uint32_t dimensions;
    int is_pair;                   /* components are sums of two words */
    uint32_t radius, their_radius; /* 1 + the register of what an object adds; 0: nothing */
    const fp3_config *format;      /* whose words positions are; NULL: FP32 */
    double reach, skin;
    double share; /* above 0: the skin is this share of what objects with the middle radius reach */
    double rounding; /* of sums of two words: how much farther a list reaches for it */
    uint32_t *made[FP3_NEAR_COLUMNS]; /* where the object of each row was when the list was made;
                                            NULL: there is none */
    uint32_t *radii;                  /* ... and what it added; NULL: nothing */
    uint64_t lists;                   /* how many were made */
    uint64_t looks;                   /* at how many candidates the last of them took */
} fp3_near_rule;

/* Whether the rule has this column. */
static inline int fp3_near_has(const fp3_near_rule *rule, uint32_t column) {
    return column % FP3_NEAR_DIMENSIONS < rule->dimensions &&
           (rule->is_pair || column < FP3_NEAR_DIMENSIONS);
}

/* The same rule; there is no list. */
static inline fp3_near_rule fp3_near_without_list(const fp3_near_rule *rule) {
    fp3_near_rule same = *rule;
    for (int k = 0; k < FP3_NEAR_COLUMNS; k++)
        same.made[k] = NULL;
    same.radii = NULL;
    same.lists = same.looks = 0;
    return same;
}

/* The registers that lists are made of, a bit for each. */
static inline uint64_t fp3_near_registers(const fp3_near_rule *rule, uint32_t kind) {
    uint64_t all = rule->radius ? UINT64_C(1) << (rule->radius - 1) : 0;
    if (kind && rule->their_radius)
        all |= UINT64_C(1) << (rule->their_radius - 1);
    for (uint32_t k = 0; k < FP3_NEAR_COLUMNS; k++)
        if (fp3_near_has(rule, k))
            all |= UINT64_C(1) << rule->regs[k] | (kind ? UINT64_C(1) << rule->theirs[k] : 0);
    return all;
}

/* Distances are computed in FP32, here as by the program, each in its own way. Either may be wrong
 * by some units in the last place, for which the list reaches a little farther. Of words that are
 * no floats distances are computed in double here: a position rounded to a float would be wrong by
 * units of its own last place, which may be more than the whole reach. */
#define FP3_NEAR_ROUNDING 1e-5

/* Sums of two words are added in double here. That is off by 2^-53 of the largest component, and so
 * is the number of its cell, which must be known to less than FP3_NEAR_ROUNDING: a list reaches
 * farther by this share of the largest component, and a cell is as wide. A program's differences,
 * squares, their sum and the bound are off by some 2^-48 of themselves. */
#define FP3_NEAR_PAIR_ROUNDING 0x1p-35

/* Whether distances are computed in double here. */
static inline int fp3_near_is_exact(const fp3_near_rule *rule) {
    return rule->format || rule->is_pair;
}

/* A program that computes with fewer bits is wrong by more: each difference, square, sum and the
 * bound may be by a last place of theirs, which is less than 4 of a distance, and with the sum of
 * radii less than 6. */
static inline double fp3_near_slack(const fp3_near_rule *rule) {
    const double place = rule->format ? ldexp(1, -(int)rule->format->fraction) : 0;
    return 1 + FP3_NEAR_ROUNDING + (rule->radius || rule->their_radius ? 6 : 4) * place;
}

/* How far a list reaches, but for radii. */
static inline double fp3_near_reach(const fp3_near_rule *rule) {
    return (rule->reach + rule->skin) * fp3_near_slack(rule) + rule->rounding;
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
    const double x = fp3_near_number(rule, fp3_near_word(w, k, row));
    return rule->is_pair ? x + fp3_near_number(rule, fp3_near_word(w, k + FP3_NEAR_DIMENSIONS, row))
                         : x;
}

/* Where it was when the list was made. */
static inline double fp3_near_was(const fp3_near_rule *rule, uint32_t k, size_t row) {
    const double x = fp3_near_number(rule, rule->made[k][row]);
    return rule->is_pair ? x + fp3_near_number(rule, rule->made[k + FP3_NEAR_DIMENSIONS][row]) : x;
}

static inline int fp3_near_has_radii(const fp3_where_they_are *w) {
    return w->radius || w->their_radius;
}

static inline uint32_t fp3_near_radius_word(const fp3_where_they_are *w, size_t row) {
    const uint32_t *words = w->theirs[0] && row >= w->own ? w->their_radius : w->radius;
    return words ? words[row * w->stride] : 0;
}

/* What the object of a row adds to the reach. The engine refuses other values before a run. */
static inline double fp3_near_radius(const fp3_near_rule *rule, const fp3_where_they_are *w,
                                     size_t row) {
    const double radius = fp3_near_number(rule, fp3_near_radius_word(w, row));
    return radius > 0 ? fmin(radius, FP3_NEAR_RADIUS_MOST) : 0;
}

/* The reach of two rows. */
static inline double fp3_near_reach_of(const fp3_near_rule *rule, const fp3_where_they_are *w,
                                       size_t a, size_t b) {
    return rule->reach + fp3_near_radius(rule, w, a) + fp3_near_radius(rule, w, b);
}

/* How far a list reaches for a pair is the sum of both shares: in FP32, so that both find the same.
 * An object finds itself, whatever it reaches. */
static inline float fp3_near_share(const fp3_near_rule *rule, const fp3_where_they_are *w,
                                   size_t row) {
    const double share =
        fp3_near_radius(rule, w, row) * fp3_near_slack(rule) + fp3_near_reach(rule) / 2;
    return (float)fmax(share, FP3_NEAR_LEAST / 2);
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
