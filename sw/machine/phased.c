/* SPDX-License-Identifier: Apache-2.0 */
/* phased.c - see phased.h. */
#include "phased.h"

#include "cycles.h"
#include "neighbours.h"

#include "gen/timing.h"
#include <fp3/isa.h>

/* From the last issue of `each` to the next issue: the lanes say how long the longest list is
 * (rtl/sequence/fp3_loops.v), and what was held goes on. */
#define KNOWN 9
/* `phase` is taken a cycle after the last sweep has begun, and ends the round a cycle later. */
#define PHASE_ENDS 2

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

/* ---- a whole step ---- */

/* Issues of a round: sweeps follow each other, and two that have a context in common are GAP cycles
 * apart. */
typedef struct {
    uint64_t start; /* of the sweep before */
    uint32_t count; /* ... its contexts; 0: there is none */
    uint32_t gap;
} issues;

static void sweep(issues *s, uint32_t count, uint32_t late) {
    const uint32_t fewer = s->count < count ? s->count : count;
    const uint64_t soonest =
        s->start + s->count + (s->count && fewer < s->gap ? s->gap - fewer : 0);
    s->start = soonest > s->start + late ? soonest : s->start + late;
    s->count = count;
}

/* The words of a phase, for one batch. late: the next issue is not sooner after the start of the
 * one before. */
static void issue_batch(const fp3_phased *program, const fp3_phased_run *run, issues *s,
                        const fp3_phase_cost *phase, uint32_t first, uint32_t count) {
    uint32_t late = 0, turn = 0, turns = 0, loop = 0;
    for (uint32_t pc = phase->begin; pc < phase->end; pc++) {
        const uint32_t op = op_at(program, pc);
        if (op == FP3_OP_NEXT && ++turn == turns) {
            late += late > 0; /* nothing stands in the loop */
            continue;
        }
        sweep(s, count, late);
        late = 0;
        if (op == FP3_OP_NEXT)
            pc = loop;
        if (op != FP3_OP_EACH)
            continue;
        turns = run->longest(run->user, program->code[pc].in.d, first, count);
        turn = 0;
        loop = pc;
        late = count + phase->loop;
        if (!turns) { /* words up to `next` are dropped, one in each cycle */
            pc += fp3_turn_cost_of(program, pc);
            late += pc - loop;
        }
    }
}

uint64_t fp3_phased_cycles(const fp3_config *config, const fp3_phased *program,
                           const fp3_phased_run *run) {
    const uint32_t most = config->contexts;
    uint64_t cycles = 0;
    fp3_repetition repetition = {0, 0};
    for (uint32_t begin = 0; begin < program->count;) {
        const fp3_phase_cost phase = fp3_phase_cost_of(config, program, begin);
        issues s = {.gap = fp3_cycles_gap(config)};
        for (uint32_t first = 0; first < run->rows; first += most) {
            const uint32_t left = run->rows - first;
            issue_batch(program, run, &s, &phase, first, left < most ? left : most);
        }
        const int is_last = phase.end + 1 >= program->count; /* or an `again` ends the program */
        cycles += fp3_cycles_copies(config, run->copies, run->words) + s.start +
                  (!is_last && s.count < PHASE_ENDS ? PHASE_ENDS : s.count) +
                  fp3_cycles_around_round(config);
        begin = phase.end == program->count
                    ? program->count
                    : fp3_neighbourhood_behind(program->code, phase.end, &repetition);
        if (phase.end < program->count && op_at(program, phase.end) == FP3_OP_HOLD &&
            !run->raised(run->user))
            begin += program->code[phase.end].in.d;
    }
    return cycles;
}
