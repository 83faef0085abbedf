/* SPDX-License-Identifier: Apache-2.0 */
/* interval.h - the shortest interval at which steps can follow each other (solo machine).
 *
 * Steps overlap: the schedule repeats after an interval for the next step. Operands are ready, a
 * register is not written before its last reader has issued, and the beginning of the step part is
 * one more node: earlier nodes are executed ahead, and no variable is written earlier.
 */
#ifndef FP3_INTERVAL_H
#define FP3_INTERVAL_H

#include "dependences.h"

typedef struct fp3_interval fp3_interval;

/* The caller frees *found; the block must stay. */
fp3_status fp3_interval_make(const fp3_block *block, fp3_interval **found, fp3_error *error);
void fp3_interval_free(fp3_interval **found);

/* The smallest interval, from `least` on, that the dependences allow. 0: none below `most`. */
uint32_t fp3_interval_least_from(const fp3_interval *found, uint32_t least, uint32_t most);

/* The smallest interval that the dependences and the issue slots of a block allow; 0: none. */
fp3_status fp3_interval_least(const fp3_block *block, uint32_t *interval, fp3_error *error);

/* The number of values in a loop with this interval, which the dependences allow; and the height of
 * each node: the cycles from its issue to the end of all dependent nodes, less an interval for each
 * step in between. */
const fp3_dependences *fp3_interval_dependences(const fp3_interval *found);
const int32_t *fp3_interval_heights(const fp3_interval *found, uint32_t interval);

#endif
