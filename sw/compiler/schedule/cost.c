/* SPDX-License-Identifier: Apache-2.0 */
/* cost.c - loads and stores of a visit, cycles, and what no order can beat. */
#include "cost.h"

#include "longest.h"
#include "machine/cycles.h"
#include "timing.h"

#include <assert.h>
#include <fp3/isa.h>
#include <machine/operation.h>
#include <stdlib.h>
#include <string.h>

/* ---- loads and stores of a visit ---- */

#define BIT(reg) (UINT64_C(1) << (reg))

/* As in lib/visit.c: what is read before it is written, if after is read after the end. */
static uint64_t live(const fp3_line *lines, uint32_t count, uint64_t after) {
    while (count-- > 0) {
        const fp3_operation *operation = fp3_operation_find(lines[count].op);
        after &= ~BIT(lines[count].d);
        for (size_t k = 0; operation && k + 1 < strlen(operation->operands); k++)
            if (lines[count].operand[k] < FP3_BANK_SHARED_BASE)
                after |= BIT(lines[count].operand[k]);
    }
    return after;
}

static uint64_t written(const fp3_line *lines, uint32_t count) {
    uint64_t set = 0;
    for (uint32_t i = 0; i < count; i++)
        set |= BIT(lines[i].d);
    return set;
}

static uint32_t size_of(uint64_t set) {
    uint32_t bits = 0;
    for (; set; set &= set - 1)
        bits++;
    return bits;
}

/* States are named .state, values of the first part .temp. A visit has at least one of each. */
static void find_visit(const fp3_step_code *code, fp3_schedule *s) {
    uint64_t states = 0, stored = written(s->first, s->first_count);
    stored |= written(s->step, s->step_count) | written(s->last, s->last_count);
    for (uint32_t x = 0; x < code->variable_count; x++)
        if (code->variables[x].first.at == FP3_AT_NOWHERE)
            states |= BIT(fp3_code_variable(code, x));
    stored &= states;
    const uint64_t loaded =
        live(s->first, s->first_count,
             live(s->step, s->step_count, live(s->last, s->last_count, stored)));
    s->loads = loaded ? size_of(loaded) : 1;
    s->stores = stored ? size_of(stored) : 1;
}

/* ---- cycles and bounds ---- */

/* The words of a visit with its loads and stores. The caller frees
 * visit->code; 0: out of memory. */
static int sweep(const fp3_schedule *s, uint64_t steps, fp3_swept *visit) {
    fp3_decoded *code =
        calloc((size_t)s->loads + s->first_count + s->step_count + s->last_count + s->stores + 1,
               sizeof *code);
    const fp3_line *const parts[] = {s->first, s->step, s->last};
    const uint32_t counts[] = {s->first_count, s->step_count, s->last_count};
    uint32_t at[3], count = 0;
    if (!code)
        return 0;
    for (uint32_t i = 0; i < s->loads; i++)
        code[count++] = (fp3_decoded){.of = fp3_operation_find(FP3_OP_LD)};
    for (int part = 0; part < 3; part++) {
        at[part] = count;
        for (uint32_t i = 0; i < counts[part]; i++)
            code[count++] = (fp3_decoded){.of = fp3_operation_find(parts[part][i].op)};
    }
    for (uint32_t i = 0; i < s->stores; i++)
        code[count++] = (fp3_decoded){.of = fp3_operation_find(FP3_OP_ST)};
    *visit = (fp3_swept){code, count, at[1], at[2], steps};
    return 1;
}

/* A load or a store needs no grant, so this is a bound where schedulers share units, too. */
static double per_sweep(const fp3_config *config) {
    return (double)fp3_cycles_sweep(config, config->contexts, FP3_UNGRANTED) / config->contexts;
}

/* Objects that the whole configuration advances at a time. */
static double parts(const fp3_config *config) {
    return (double)config->tiles * config->schedulers * config->lanes;
}

static fp3_status find_cycles(const fp3_config *config, fp3_schedule *made, fp3_error *error) {
    fp3_timed *code;
    fp3_timed_program program;
    fp3_swept visit;
    if (config->interleave && config->schedulers > 1)
        return FP3_OK;
    if (config->interleave) {
        if (!sweep(made, 1, &visit))
            return fp3_no_memory(error);
        made->cycles = fp3_cycles_swept_step(config, &visit) / parts(config);
        free((void *)visit.code);
        return FP3_OK;
    }
    if (!fp3_time_schedule(made, config, &code, &program))
        return fp3_no_memory(error);
    made->cycles = fp3_cycles_solo_step(config, &program);
    free(code);
    return FP3_OK;
}

/* No order takes fewer: issue slots, and uses of a unit where schedulers share it. */
static double issue_bound(const fp3_step_code *code, const fp3_config *config) {
    const double count = (double)code->step_count;
    uint32_t adds = 0, muls = 0;
    if (!config->interleave)
        return config->writeback_stall ? 2 * count : count;
    for (uint32_t i = 0; i < code->step_count; i++) {
        const fp3_operation *of = fp3_operation_find(code->step[i].op);
        const int multiplies = config->dual && fp3_operation_multiplies(of);
        adds += of->path & FP3_UNIT_ADDER && !multiplies ? 1 : 0;
        muls += of->path & FP3_UNIT_MULTIPLIER || multiplies ? 1 : 0;
    }
    const double issue = count * per_sweep(config) / parts(config);
    const double use = (adds > muls ? adds : muls) / (double)config->tiles;
    if (config->dual)
        return use / config->lanes;
    return config->schedulers > 1 && use > issue ? use : issue;
}

fp3_status fp3_cost_find(const fp3_step_code *code, const fp3_config *config, fp3_schedule *made,
                         fp3_error *error) {
    if (config->interleave && !made->is_spilled)
        find_visit(code, made);
    fp3_status status = find_cycles(config, made, error);
    made->bound_issue = issue_bound(code, config);
    if (!status && !config->interleave)
        status = fp3_longest_path(code, config, &made->bound_path, error);
    made->bound = made->bound_issue > made->bound_path ? made->bound_issue : made->bound_path;
    assert(status || !made->cycles || made->cycles >= made->bound - 1e-6);
    return status;
}

uint64_t fp3_cost_cycles(const fp3_schedule *schedule, const fp3_config *config, uint64_t steps) {
    const fp3_schedule *s = schedule;
    fp3_timed *code;
    fp3_timed_program program;
    if (config->interleave) {
        fp3_swept visit;
        if (config->schedulers > 1 || !steps || !sweep(s, steps, &visit))
            return 0;
        const uint64_t run = fp3_cycles_interleaved(config, config->contexts, 1, &visit);
        free((void *)visit.code);
        return run;
    }
    if (!fp3_time_schedule(s, config, &code, &program))
        return 0;
    const uint64_t cycles = fp3_cycles_solo(config, &program, steps);
    free(code);
    return cycles;
}
