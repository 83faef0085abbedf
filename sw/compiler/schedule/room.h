/* SPDX-License-Identifier: Apache-2.0 */
/* room.h - which instructions can issue early while the rest still has its registers.
 *
 * A plan is an order of the step part with few values at a time. Instructions leave it one by one,
 * not always the first: an instruction that issues early makes its value sooner, and may end its
 * operands sooner. The rest, in the plan's order, always stays within the limit.
 */
#ifndef FP3_SCHEDULE_ROOM_H
#define FP3_SCHEDULE_ROOM_H

#include "block.h"

typedef struct fp3_room fp3_room;

/* limit: values at a time, variables and params included; the plans obey the limit. NULL: out of
 * memory. Block and is_ahead must stay. The caller frees. */
fp3_room *fp3_room_make(const fp3_block *block, const char *is_ahead, uint32_t limit);
void fp3_room_free(fp3_room **room);

/* Back to the whole plan. */
void fp3_room_begin(fp3_room *room, const uint32_t *plan);

/* How many instructions of the rest come before this one. */
uint32_t fp3_room_turn(const fp3_room *room, uint32_t node);

/* Whether it can be next. The first of the rest always can. */
int fp3_room_allows(const fp3_room *room, uint32_t node);
void fp3_room_issue(fp3_room *room, uint32_t node);

#endif
