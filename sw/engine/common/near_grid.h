/* SPDX-License-Identifier: Apache-2.0 */
/* near_grid.h - objects are sorted into cells as large as they see; neighbours are in the cells
 * around.
 *
 * Cells fill a box, where all objects are in a box of not many more cells than there are objects.
 * Where some are far away, only cells with objects in them are kept, by a hash of where they are:
 * then the cost does not depend on the box.
 */
#ifndef FP3_ENGINE_NEAR_GRID_H
#define FP3_ENGINE_NEAR_GRID_H

#include "near_rule.h"

/* From this number of objects on threads are asked for help. */
#define FP3_NEAR_TOGETHER 1024u

/* Who is in a grid, and how far it is seen. */
typedef struct {
    const uint32_t *rows; /* ascending; NULL: the first rows */
    uint32_t count;
    double reach;        /* no search in the grid goes farther */
    const float *shares; /* of each row of the program, how far it reaches; NULL: all the reach */
    int is_box;          /* nothing but a box will do */
} fp3_near_members;

typedef struct {
    const fp3_near_rule *rule;
    const fp3_where_they_are *now;
    fp3_near_members of;
    double least[FP3_NEAR_DIMENSIONS], size; /* of a cell */
    uint32_t cells[FP3_NEAR_DIMENSIONS];     /* of the box */
    uint32_t mask;                           /* 0: there is a box; else hashes are cut with it */
    uint32_t *cell;                          /* of each of them; of a hash: what is left of it */
    uint32_t *first;                         /* of each cell, in `order` */
    uint32_t *order;                         /* rows, cell by cell, ascending */
    float *place[FP3_NEAR_DIMENSIONS];       /* of each row, in this order; NULLs: ... */
    double *exact[FP3_NEAR_DIMENSIONS];      /* ... where words are no floats */
    float *share;                            /* likewise, if there are shares */
    float far;                               /* else the square of how far the list reaches */
    uint32_t parts;                          /* in which the cells of rows are found */
} fp3_near_grid;

/* Who looks for those that are near it. */
typedef struct {
    double place[FP3_NEAR_DIMENSIONS];
    float share; /* if there are shares: one reaches the sum of both */
} fp3_near_seeker;

/* Rows that are found, one search behind the other. */
typedef struct {
    uint32_t *found;
    size_t count, room;
    uint64_t looks; /* at how many objects it took to find them */
} fp3_near_found;

/* FP3_E_SYSTEM: out of memory. The caller closes, also then. */
fp3_status fp3_near_grid_open(const fp3_near_rule *rule, const fp3_where_they_are *now,
                              const fp3_near_members *of, fp3_near_grid *grid, fp3_error *error);
void fp3_near_grid_close(fp3_near_grid *grid);
/* Those that are near the seeker, in the order of the cells; itself, too. */
fp3_status fp3_near_grid_find(const fp3_near_grid *grid, const fp3_near_seeker *seeker,
                              fp3_near_found *found, fp3_error *error);
/* Room for so many more. */
fp3_status fp3_near_need_room(fp3_near_found *found, size_t more, fp3_error *error);

#endif
