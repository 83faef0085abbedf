/* SPDX-License-Identifier: Apache-2.0 */
/* kinds_islands.h - objects that sleep and wake together. */
#ifndef FP3_KINDS_ISLANDS_H
#define FP3_KINDS_ISLANDS_H

#include "kinds_inside.h"

/* Of each object, while islands are found. */
enum { MOVES = 1, SLEEPS = MOVES << 1, RESTS = 4, IS_HIT = 8, IS_KEPT = 16 };

/* A tree of each island in `root`, from the flags and from where objects are. A mover that touches
 * a sleeper IS_KEPT, and the sleeper IS_HIT. is_brief: only that is found out. */
fp3_status fp3_islands_find(fp3_engine *engine, int is_brief);
/* What is true of one is true of its island. */
void fp3_islands_spread(const fp3_engine *engine, uint8_t flag);
/* Other objects live, or lists are others: where all are is read anew. */
void fp3_islands_forget(fp3_rest *rest);

#endif
