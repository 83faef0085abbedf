/* SPDX-License-Identifier: Apache-2.0 */
/* order.h - orders of issue that keep what has to come first first. */
#ifndef FP3_SCHEDULE_ORDER_H
#define FP3_SCHEDULE_ORDER_H

#include "dependences.h"

/* What is issued next of all that may be. */
typedef enum {
    FP3_NEXT_GIVEN,  /* the first in the caller's order */
    FP3_NEXT_FEWEST, /* what leaves the fewest values that are waited for; then that order */
    FP3_NEXT_DEEP,   /* likewise; then what uses the newest value */
    FP3_NEXT_LONG,   /* likewise; then what most depends on */
    FP3_NEXT_TURN,   /* for the unit that the one before does not need; then what most depends on */
    FP3_NEXT_SOON,   /* what can issue first (solo machine); then what most depends on */
    FP3_NEXT_COUNT
} fp3_next;

/* The graph has the block's edges, order room for its nodes. Nothing is computed ahead. */
fp3_status fp3_order_list(const fp3_block *block, const fp3_dependences *graph, fp3_next next,
                          uint32_t *order, fp3_error *error);

#endif
