/* SPDX-License-Identifier: Apache-2.0 */
/* phased.c - see phased.h. */
#include "phased.h"

#include "cycles.h"

#include "gen/timing.h"
#include <fp3/isa.h>

/* From the last issue of `each` to the next issue: the lanes say how long the longest list is
 * (rtl/sequence/fp3_loops.v), and what was held goes on. */
#define KNOWN 9

static uint32_t op_at(const fp3_phased *program, uint32_t at) {
    return program->code[at].of ? program->code[at].in.op : 0;
}

static uint32_t loop_wait(const fp3_config *config) {
    return FP3_TIMING_LIST + config->lanes + fp3_cycles_groups(config) + KNOWN;
}

static uint32_t end_of(const fp3_phased *program, uint32_t begin) {
    while (begin < program->count && !fp3_ends_phase(&program->code[begin]))
        begin++;
    return begin;
}

static uint32_t next_of(const fp3_phased *program, uint32_t each) {
    while (op_at(program, each) != FP3_OP_NEXT)
        each++;
    return each;
}

fp3_phase_cost fp3_phase_cost_of(const fp3_config *config, const fp3_phased *program,
                                 uint32_t begin) {
    fp3_phase_cost cost = {.begin = begin,
                           .end = end_of(program, begin),
                           .loop = loop_wait(config),
                           .around =
                               fp3_cycles_around_round(config) + fp3_cycles_copies(config, 0, 0),
                           .full = fp3_cycles_gap(config)};
    for (uint32_t pc = begin; pc < cost.end; pc++)
        if (op_at(program, pc) == FP3_OP_EACH) {
            cost.loops++; /* its issue makes up for that of `next` in the last turn */
            pc = next_of(program, pc);
        } else {
            cost.object++;
        }
    return cost;
}

uint32_t fp3_turn_cost_of(const fp3_phased *program, uint32_t each) {
    return next_of(program, each) - each;
}
