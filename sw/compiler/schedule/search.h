/* SPDX-License-Identifier: Apache-2.0 */
/* search.h - the best order of the step part.
 *
 * Orders that fit are best, then orders with fewer cycles, then orders with fewer registers. The
 * same block has the same order, on every machine and at every time.
 */
#ifndef FP3_SCHEDULE_SEARCH_H
#define FP3_SCHEDULE_SEARCH_H

#include "allocate.h"
#include "block.h"

typedef struct {
    uint32_t *order; /* node at each position */
    char *is_ahead;  /* of each node */
    fp3_places places;
    double cycles; /* a step */
} fp3_choice;

/* Sets is_ahead of the block's nodes, too. FP3_E_LIMIT: too few registers. */
fp3_status fp3_search(fp3_block *block, fp3_choice *choice, fp3_error *error);
void fp3_choice_free(fp3_choice *choice);

#endif
