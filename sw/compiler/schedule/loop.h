/* SPDX-License-Identifier: Apache-2.0 */
/* loop.h - the step part of the solo machine, filled cycle by cycle.
 *
 * The list scheduler goes through the step as the issue stage does, and issues the most urgent
 * ready node in every cycle, beginning with the results of the previous step in flight. The caller
 * decides which nodes are executed ahead.
 */
#ifndef FP3_SCHEDULE_LOOP_H
#define FP3_SCHEDULE_LOOP_H

#include "dependences.h"

#define FP3_NO_GUARD INT32_MAX

typedef struct {
    const fp3_dependences
        *graph;             /* with an edge from each reader of a value to its next computation */
    const char *is_ahead;   /* of each node */
    const int32_t *urgency; /* larger ones first; an ahead node is an interval less urgent */
    uint32_t interval;
    /* Urgency that a node loses by taking the write cycle of one with a shorter latency. */
    int32_t loss;
    /* A node waits rather than take the write cycle of one that is so much more urgent, or more. */
    int32_t guard;
    /* With so many temporary values or more, whoever ends most of them comes first. */
    uint32_t limit;
    /* NULL, or an order with at most `limit` values at a time (room.h), which then counts variables
     * and params, too: in each cycle the first node of the order that can issue does, as long as
     * the rest has its registers. Urgency, loss and guard do not count. */
    const uint32_t *plan;
} fp3_loop;

/* order has room for block->count nodes. */
fp3_status fp3_loop_order(const fp3_block *block, const fp3_loop *loop, uint32_t *order,
                          fp3_error *error);

#endif
