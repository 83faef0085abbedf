/* SPDX-License-Identifier: Apache-2.0 */
/* overlap.c - see overlap.h. */
#include "overlap.h"

#include <fp3/isa.h>

/* A load or a store takes both units, and so does a word that is no instruction. */
static unsigned units_of(const fp3_decoded *word) {
    const unsigned both = FP3_UNIT_ADDER | FP3_UNIT_MULTIPLIER;
    if (!word->of || !fp3_operation_is_arithmetic(word->of))
        return both;
    return fp3_operation_multiplies(word->of) ? FP3_UNIT_MULTIPLIER : FP3_UNIT_ADDER;
}

static uint64_t later(uint64_t a, uint64_t b) { return a > b ? a : b; }

static void run(fp3_overlap *now, const fp3_swept *visit, uint32_t from, uint32_t to, uint32_t n,
                uint32_t gap) {
    for (uint32_t pc = from; pc < to; pc++) {
        const unsigned units = units_of(&visit->code[pc]);
        uint64_t at = now->soonest;
        if (units & FP3_UNIT_ADDER)
            at = later(at, now->adder);
        if (units & FP3_UNIT_MULTIPLIER)
            at = later(at, now->multiplier);
        if (units & FP3_UNIT_ADDER)
            now->adder = at + n;
        if (units & FP3_UNIT_MULTIPLIER)
            now->multiplier = at + n;
        now->soonest = at + gap;
    }
}

/* How much later a unit is free than the next sweep might begin. */
static uint64_t beyond(uint64_t unit, const fp3_overlap *now) {
    return unit > now->soonest ? unit - now->soonest : 0;
}

static int is_alike(const fp3_overlap *a, const fp3_overlap *b) {
    return beyond(a->adder, a) == beyond(b->adder, b) &&
           beyond(a->multiplier, a) == beyond(b->multiplier, b);
}

/* Steps, until they repeat or all are made. What they repeat with is renewed after 1, 2, 4 .. of
 * them. Gives the steps and the cycles in between; 0 steps: they do not repeat. */
typedef struct {
    uint64_t made, steps, cycles;
} period;

static period repeat(fp3_overlap *now, const fp3_swept *visit, uint64_t steps, uint32_t n,
                     uint32_t gap) {
    fp3_overlap past = *now;
    uint64_t since = 0, power = 1;
    for (uint64_t made = 1; made <= steps; made++) {
        run(now, visit, visit->step, visit->last, n, gap);
        if (is_alike(now, &past))
            return (period){made, since + 1, now->soonest - past.soonest};
        if (++since == power) {
            past = *now;
            power *= 2;
            since = 0;
        }
    }
    return (period){steps, 0, 0};
}

void fp3_overlap_visit(fp3_overlap *now, const fp3_swept *visit, uint32_t n, uint32_t gap) {
    run(now, visit, 0, visit->step, n, gap);
    const period p = repeat(now, visit, visit->steps, n, gap);
    const uint64_t left = visit->steps - p.made;
    if (p.steps) {
        const uint64_t cycles = left / p.steps * p.cycles;
        now->soonest += cycles;
        now->adder += cycles;
        now->multiplier += cycles;
        for (uint64_t i = left % p.steps; i; i--)
            run(now, visit, visit->step, visit->last, n, gap);
    }
    run(now, visit, visit->last, visit->count, n, gap);
}

uint64_t fp3_overlap_end(const fp3_overlap *now) { return later(now->adder, now->multiplier); }

double fp3_overlap_step(const fp3_swept *visit, uint32_t n, uint32_t gap) {
    /* A state is two small numbers: they repeat long before this. */
    const uint64_t enough = 100000;
    fp3_overlap now = {0};
    const period p = repeat(&now, visit, enough, n, gap);
    return p.steps ? (double)p.cycles / (double)p.steps : 0;
}
