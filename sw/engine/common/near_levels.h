/* SPDX-License-Identifier: Apache-2.0 */
/* near_levels.h - grids for objects that reach differently far, a level for those that reach about
 * as far as each other: so one that reaches far makes no cell larger for those that do not.
 *
 * Level 0 has those that reach farthest. Pairs of one level are found as in one grid. Of pairs of
 * two levels one of both looks for the other: those that reach less, who find it in the cells
 * around, or, where they are many more, those that reach farther, in all cells that they reach.
 */
#ifndef FP3_ENGINE_NEAR_LEVELS_H
#define FP3_ENGINE_NEAR_LEVELS_H

#include "near_grid.h"

/* What two objects with the middle radius of all those that have one reach, without the skin. */
double fp3_near_middle(const fp3_near_rule *rule, const fp3_where_they_are *now);
/* Before a list is made: finds the skin, where it is a share, and what rounding of positions adds.
 */
void fp3_near_find_margins(fp3_near_rule *rule, const fp3_where_they_are *now);

#define FP3_NEAR_LEVELS 16 /* the last one has all that reach less than those before it */

typedef struct {
    const fp3_near_rule *rule;
    const fp3_where_they_are *now;
    uint32_t count;
    /* Of each level, those whose lists are made; and those of another kind, if there are several
     * levels. Without objects: not open. */
    fp3_near_grid own[FP3_NEAR_LEVELS], theirs[FP3_NEAR_LEVELS];
    /* Whether own objects of one level look in the grid of another, and those of another kind. */
    uint8_t looks[2][FP3_NEAR_LEVELS][FP3_NEAR_LEVELS];
    float *shares;  /* of each row; NULL: all reach equally far */
    uint8_t *level; /* likewise; NULL: there is one */
    uint32_t *rows; /* level by level */
} fp3_near_levels;

/* FP3_E_SYSTEM: out of memory. The caller closes, also then. */
fp3_status fp3_near_levels_open(const fp3_near_rule *rule, const fp3_where_they_are *now,
                                fp3_near_levels *levels, fp3_error *error);
void fp3_near_levels_close(fp3_near_levels *levels);

/* Whether rows of another kind stand from this one on. */
static inline int fp3_near_is_theirs(const fp3_where_they_are *w, uint32_t row) {
    return w->theirs[0] && row >= w->from;
}

/* Whether a row has found one that does not find it: of the own kind one of another level, else an
 * own row any. */
static inline int fp3_near_is_across(const fp3_near_levels *l, uint32_t row, uint32_t found) {
    return l->level && (l->now->theirs[0] ? row < l->now->own : l->level[row] != l->level[found]);
}

/* Whether a row may find such ones. */
static inline int fp3_near_looks_across(const fp3_near_levels *l, uint32_t row) {
    int looks = l->level && l->now->theirs[0] && row < l->now->own;
    for (uint32_t i = 0; l->level && !l->now->theirs[0] && i < l->count; i++)
        looks |= i != l->level[row] && l->looks[0][l->level[row]][i];
    return looks;
}

/* Those that a row finds, and itself. */
fp3_status fp3_near_levels_find(const fp3_near_levels *levels, uint32_t row, fp3_near_found *found,
                                fp3_error *error);

#endif
