/* SPDX-License-Identifier: Apache-2.0 */
/* polish.h - a good order made better by moving one instruction at a time. */
#ifndef FP3_SCHEDULE_POLISH_H
#define FP3_SCHEDULE_POLISH_H

#include "dependences.h"

/* Tries `moves` moves, always the same ones, and keeps the moves that cost no cycle and exceed no
 * limit of registers; is_ahead of the nodes stays. The graph is a loop's
 * (fp3_interval_dependences). Ends when a step takes `enough` cycles or fewer. */
fp3_status fp3_polish(const fp3_block *block, const fp3_dependences *graph, double enough,
                      uint32_t moves, uint32_t *order, fp3_error *error);

#endif
