/* SPDX-License-Identifier: Apache-2.0 */
/* near_rows.h - rows of objects whose lists are made, and of those that are in them. */
#ifndef FP3_NEAR_ROWS_H
#define FP3_NEAR_ROWS_H

#include "near.h"

#include <math.h>
#include <string.h>

/* Distances are computed in FP32, here as by the program, each in its own way. Either may be wrong
 * by some units in the last place, for which the list reaches a little farther. */
#define FP3_NEAR_ROUNDING 1e-5

/* Rows first .. end-1. */
typedef struct {
    uint32_t first, end;
} fp3_rows;

/* Whose lists are made, and who is in them. */
static inline fp3_rows fp3_near_seekers(const fp3_where_they_are *w) {
    return (fp3_rows){0, w->theirs[0] ? w->own : w->objects};
}

static inline fp3_rows fp3_near_sought(const fp3_where_they_are *w) {
    return (fp3_rows){w->theirs[0] ? w->from : 0, w->objects};
}

static inline const uint32_t *fp3_near_words(const fp3_where_they_are *w, uint32_t k, size_t row) {
    return w->theirs[0] && row >= w->own ? w->theirs[k] : w->position[k];
}

/* Who does not live is nowhere. */
static inline double fp3_near_at(const fp3_where_they_are *w, uint32_t k, size_t row) {
    float f;
    if (w->lives && !w->lives[row])
        return NAN;
    memcpy(&f, &fp3_near_words(w, k, row)[row * w->stride], sizeof f);
    return f;
}

/* One of `parts` of these rows. */
static inline fp3_rows fp3_near_part(fp3_rows all, uint32_t part, uint32_t parts) {
    const uint32_t count = all.end - all.first;
    return (fp3_rows){all.first + fp3_part_begin(count, part, parts),
                      all.first + fp3_part_begin(count, part + 1, parts)};
}

/* In how many parts the work of so many objects is done: one below `least`. */
static inline uint32_t fp3_near_parts(const fp3_where_they_are *now, uint32_t least) {
    return now->objects < least ? 1 : fp3_parts_of(now->crew);
}

#endif
