/* SPDX-License-Identifier: Apache-2.0 */
/* stages.c - see stages.h. */
#include "stages.h"

#include "gen/timing.h"
#include "machine/cycles.h"
#include "machine/operation.h"

#include <assert.h>

/* Schedulers take turns at one adder and one multiplier. */
static int is_shared(const fp3_config *config) { return config->schedulers > 1; }

/* The units that an instruction goes through. */
static unsigned path_of(uint32_t word) {
    fp3_instruction in;
    return fp3_word_decode(word, &in, NULL) ? 0 : fp3_operation_find(in.op)->path;
}

static void add(fp3_stages *s, const char *name, uint64_t from, uint64_t until) {
    if (from >= until)
        return;
    assert(s->count < FP3_STAGES_MOST);
    s->stages[s->count++] = (fp3_stage){name, from};
}

/* One object: issue, its unit, and the write. */
static void of_one(const fp3_config *config, const fp3_traced *t, unsigned path, fp3_stages *s) {
    const unsigned before = path & (FP3_UNIT_VALUE | FP3_UNIT_MULTIPLIER);
    const uint64_t from = t->issued + fp3_cycles_operands(config);
    const uint64_t joined = config->fused && path & FP3_UNIT_MULTIPLIER ? FP3_TIMING_SOLO_FUSED : 0;
    add(s, "Is", t->issued, t->ended);
    if (before)
        add(s, path & FP3_UNIT_VALUE ? "Va" : "Mu", from, t->ended);
    if (path & FP3_UNIT_ADDER)
        add(s, "Ad", before ? from + config->mul_latency - joined : from, t->ended);
    add(s, "Wb", t->ended, s->end);
}

/* What an instruction does while others multiply, and while others add. A sum and a product go
 * through both units, unless schedulers share these. */
static const char *while_multiplied(const fp3_config *config, unsigned path) {
    return path & FP3_UNIT_VALUE                              ? "Va"
           : path & FP3_UNIT_MULTIPLIER || !is_shared(config) ? "Mu"
                                                              : "Wa";
}

/* From operands to results. */
static uint64_t arithmetic_of(const fp3_config *config) {
    const uint64_t mul = config->mul_latency, add = config->add_latency;
    return !config->dual ? mul + add : mul > add ? mul : add;
}

static const char *while_added(const fp3_config *config, unsigned path) {
    return path & FP3_UNIT_ADDER || !is_shared(config) ? "Ad" : "Wa";
}

/* Contexts in turn: all are equally late, counted back from the write. */
static void of_many(const fp3_config *config, const fp3_traced *t, unsigned path, fp3_stages *s) {
    const uint64_t write = fp3_cycles_write(config);
    const uint64_t chosen = t->ended - write; /* the result is chosen, then written */
    const uint64_t late = t->ended - t->issued;
    const uint64_t arithmetic = arithmetic_of(config);
    const uint64_t operands = late > arithmetic + write ? chosen - arithmetic : t->issued;
    const uint64_t reading = fp3_cycles_operands(config);
    const uint64_t read = operands > t->issued + reading ? operands - reading : t->issued;
    add(s, "Is", t->issued, read);
    add(s, "Rd", read, operands);
    if (path & (FP3_UNIT_STORE | FP3_UNIT_COMPARISON)) {
        add(s, path & FP3_UNIT_STORE ? "Me" : "Cm", operands, chosen);
    } else if (config->dual) {
        add(s,
            path & FP3_UNIT_VALUE   ? "Va"
            : path & FP3_UNIT_ADDER ? "Ad"
                                    : "Mu",
            operands, chosen);
    } else {
        add(s, while_multiplied(config, path), operands, chosen);
        add(s, while_added(config, path), operands + config->mul_latency, chosen);
    }
    add(s, "Wb", chosen, s->end);
}

fp3_stages fp3_stages_of(const fp3_config *config, const fp3_traced *traced) {
    fp3_stages s = {.end = traced->ended + 1};
    assert(traced->ended > traced->issued);
    (config->interleave ? of_many : of_one)(config, traced, path_of(traced->word), &s);
    assert(s.count && s.stages[0].from == traced->issued);
    return s;
}
