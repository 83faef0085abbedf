/* occupancy.h - where the cycles of a run went, as text.
 *
 *     for (uint32_t s = 0; s < stats.schedulers; s++)
 *         if (!fp3_engine_scheduler_counters(engine, s, counter))
 *             fp3_occupancy_print(stdout, s, counter);
 */
#ifndef FP3_OCCUPANCY_H
#define FP3_OCCUPANCY_H

#include <fp3/engine.h>
#include <stdio.h>

/* The counters of one scheduler: its cycles by what was issued and by why nothing was, in per cent that
 * add up to 100.0 with a bar each, and how busy its adder and multiplier were. counter has
 * FP3_COUNTER_COUNT numbers, as in fp3_stats. Rows of 0 cycles are left out. */
void fp3_occupancy_print(FILE *out, uint32_t scheduler, const uint64_t *counter);

#endif
