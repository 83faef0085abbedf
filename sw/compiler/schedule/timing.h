/* SPDX-License-Identifier: Apache-2.0 */
/* timing.h - cycles of an order of nodes, or of lines, on the solo machine. */
#ifndef FP3_SCHEDULE_TIME_H
#define FP3_SCHEDULE_TIME_H

#include "block.h"
#include "lines.h"
#include "machine/cycles.h"

/* Cycles per step in the long run, of the step part in this order; is_ahead of the nodes counts. */
fp3_status fp3_time_order(const fp3_block *block, const uint32_t *order, double *cycles,
                          fp3_error *error);

/* A schedule as the issue stage sees it. The caller frees *code. 0: out of memory. */
int fp3_time_schedule(const fp3_schedule *schedule, const fp3_config *config, fp3_timed **code,
                      fp3_timed_program *program);

#endif
