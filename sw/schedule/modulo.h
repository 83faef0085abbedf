/* modulo.h - the step part as a loop in which steps overlap (solo machine).
 *
 * Every node gets a cycle so that the same cycles, an interval later, do for the next step:
 * operands are there, no two nodes issue or write in the same cycle of an interval, and a register
 * is not written before its last reader has issued. (B. R. Rau, "Iterative modulo scheduling",
 * MICRO-27, 1994: the most urgent node takes the first cycle that is free, or drives out who has
 * it.) Where the step part then begins is one more node: what comes before it is executed ahead,
 * and no variable is written before it.
 */
#ifndef FP3_SCHEDULE_MODULO_H
#define FP3_SCHEDULE_MODULO_H

#include "dependences.h"

typedef struct fp3_modulo fp3_modulo;

/* The caller frees *modulo; the block must stay. */
fp3_status fp3_modulo_make(const fp3_block *block, fp3_modulo **modulo, fp3_error *error);
void fp3_modulo_free(fp3_modulo **modulo);

/* The smallest interval, from `least` on, that the dependences allow. 0: none below `most`. */
uint32_t fp3_modulo_interval(const fp3_modulo *modulo, uint32_t least, uint32_t most);

/* The smallest interval that the dependences and the issue slots of a block allow; 0: none. */
fp3_status fp3_modulo_least(const fp3_block *block, uint32_t *interval, fp3_error *error);

/* What a loop with this interval, which the dependences allow, has to hold; and of each node the
 * cycles from its issue to the end of all that depends on it, an interval taken off for each step
 * in between. */
const fp3_dependences *fp3_modulo_dependences(const fp3_modulo *modulo);
const int32_t *fp3_modulo_heights(const fp3_modulo *modulo, uint32_t interval);

/* 1: order and is_ahead (block->count each) are such a loop; 0: none was found with this interval.
 * patience: how many cycles a node may wait for one in which it is less in the way of others. */
int fp3_modulo_order(fp3_modulo *modulo, uint32_t interval, uint32_t patience, uint32_t *order,
                     char *is_ahead);

#endif
