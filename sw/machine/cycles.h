/* SPDX-License-Identifier: Apache-2.0 */
/* cycles.h - how many cycles a sequence of instructions takes, exactly. The one place in the
 * software that knows the machine's timing; its constants are those of isa/timing.toml.
 *
 * The solo machine issues in order, so a sequence has one timing: an instruction issues when what
 * it reads and what it writes is there, and when the write port is free in the cycle of its
 * result. That covers the adder, too: a sum and a chained product that met there would be written
 * in one cycle.
 *
 * The machine with contexts has no timing that depends on the instructions: it sweeps. With `dual`
 * it depends on their order: overlap.h. Where objects see each other it depends on their lists:
 * phased.h.
 */
#ifndef FP3_CYCLES_H
#define FP3_CYCLES_H

#include "config.h"
#include "overlap.h"
#include <stdint.h>

/* An instruction as the busy flags see it. Slots are registers, or whatever stands for them. */
typedef struct {
    uint32_t latency; /* operands to result */
    uint32_t d, source[3], source_count;
} fp3_timed;

typedef struct {
    const fp3_timed *first, *step, *last;
    uint32_t first_count, step_count, last_count;
    uint32_t slots;
} fp3_timed_program;

/* Cycles from operands to result, and from issue to the issue of a reader (solo machine). */
uint32_t fp3_cycles_latency(const fp3_config *config, uint32_t op);
uint32_t fp3_cycles_delay(const fp3_config *config, uint32_t op);

/* The solo machine's counter CYCLES after a run. 0: out of memory, or latencies beyond
 * FP3_LATENCY_LIMIT. */
#define FP3_LATENCY_LIMIT 60
uint64_t fp3_cycles_solo(const fp3_config *config, const fp3_timed_program *program,
                         uint64_t steps);
/* What a step adds to it in the long run; 0 likewise. */
double fp3_cycles_solo_step(const fp3_config *config, const fp3_timed_program *program);

/* From the cycle in which an instruction's registers are named to its operands, and from its result
 * to its write: both machines. */
uint32_t fp3_cycles_operands(const fp3_config *config);
uint32_t fp3_cycles_write(const fp3_config *config);

/* Interleaved: from an issue to the next one of the same context, at least; from the last issue of
 * a round to its last report; groups of lanes that hear the same in the same cycle. */
uint32_t fp3_cycles_gap(const fp3_config *config);
uint32_t fp3_cycles_settle(const fp3_config *config);
uint32_t fp3_cycles_groups(const fp3_config *config);

/* Interleaved: one instruction for n contexts, with the pause that they need; 0 for none. Where
 * schedulers share the arithmetic, an instruction that needs it (FP3_GRANTED) waits a cycle for its
 * grant, or longer if others want it, too. Elsewhere the two take equally long. */
typedef enum { FP3_UNGRANTED, FP3_GRANTED } fp3_grant;
uint64_t fp3_cycles_sweep(const fp3_config *config, uint32_t n, fp3_grant grant);

/* Up to so many contexts, a sweep with a grant takes equally long. At least 1. */
uint32_t fp3_cycles_waiting(const fp3_config *config);

/* What copies before a round take: of so many objects, so many published words of each. To find
 * that there is none takes some, too. */
uint64_t fp3_cycles_copies(const fp3_config *config, uint32_t copies, uint32_t words);
/* What a round takes beyond its copies, and from its first issue to its last: one settling, too. */
uint32_t fp3_cycles_around_round(const fp3_config *config);
/* A round in which the fullest lane has so many rows, each visited in this way. Each instruction is
 * granted as soon as it can be, and each sweep pauses. 0 for no rows. */
uint64_t fp3_cycles_round(const fp3_config *config, uint32_t rows, const fp3_swept *visit);

/* One scheduler per arithmetic unit: the counter CYCLES of a run of such rounds. */
uint64_t fp3_cycles_interleaved(const fp3_config *config, uint32_t rows, uint64_t rounds,
                                const fp3_swept *visit);

/* What a step adds to it in the long run, with full contexts, for each context. One scheduler per
 * arithmetic unit, again. */
double fp3_cycles_swept_step(const fp3_config *config, const fp3_swept *visit);

#endif
