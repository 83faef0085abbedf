/* SPDX-License-Identifier: Apache-2.0 */
/* around.h - what a recording keeps of relations: who is linked, and within what distance objects
 * are near. */
#ifndef FP3_OUTPUT_AROUND_H
#define FP3_OUTPUT_AROUND_H

#include "source.h"

#include "machine/neighbours.h"

#define FP3_AROUND_POSITION_SIZE (3 * (FP3_NAME_SIZE + 1))

typedef struct {
    char name[FP3_NAME_SIZE]; /* of the relation */
    uint32_t *pairs;          /* linked objects, each pair once; NULL: there are none */
    size_t count;             /* of pairs */
    double reach;             /* of those near; 0: it is no relation of those near */
    char position[FP3_AROUND_POSITION_SIZE]; /* the states of their position: "x_x,x_y,x_z" */
} fp3_around_list;

typedef struct {
    fp3_around_list lists[FP3_LISTS_MAX];
    size_t count;
} fp3_around;

/* Asks the engine, whose program is loaded. The caller frees *around, after a failure too.
 * FP3_E_SYSTEM: out of memory. */
fp3_status fp3_around_find(const fp3_source *source, fp3_around *around, fp3_error *error);
/* Leaves {0}, which may be freed as well. */
void fp3_around_free(fp3_around *around);

#endif
