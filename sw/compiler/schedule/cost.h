/* SPDX-License-Identifier: Apache-2.0 */
/* cost.h - what a schedule costs. */
#ifndef FP3_COST_H
#define FP3_COST_H

#include "code.h"
#include "lines.h"

/* Fills loads, stores, cycles and the bounds of a schedule that has its lines. */
fp3_status fp3_cost_find(const fp3_step_code *code, const fp3_config *config, fp3_schedule *made,
                         fp3_error *error);

/* Exact cycles of a run of this many steps, as the hardware's counter CYCLES counts them: for one
 * object (solo machine), or with full contexts and one visit, its loads and stores included
 * (interleaved, one scheduler per arithmetic unit). 0: no steps, or not predictable. */
uint64_t fp3_cost_cycles(const fp3_schedule *schedule, const fp3_config *config, uint64_t steps);

#endif
