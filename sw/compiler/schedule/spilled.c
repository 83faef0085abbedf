/* SPDX-License-Identifier: Apache-2.0 */
/* spilled.c - see spilled.h. Of several orders and several sets of values that stay in their
 * registers between two steps, takes the combination with the fewest instructions. */
#include "spilled.h"

#include "order.h"
#include "parts.h"
#include "spill.h"

#include <fp3/isa.h>
#include <stdlib.h>
#include <string.h>

#define BIT(reg) (UINT64_C(1) << (reg))
#define ROUNDS 4u      /* times that what a step leaves is what the next one begins with */
#define FEWER_MOST 16u /* owners that are not in their registers */

typedef struct {
    const fp3_step_code *code;
    const fp3_config *config;
    uint64_t owners, states; /* registers */
    uint64_t unwritten;      /* by the first and the step part */
    uint64_t always;         /* in their registers between two steps */
    fp3_spilled best;
    uint64_t between; /* likewise, of the best */
} maker;

/* The better one stays in *best. */
static void take(fp3_spilled *made, fp3_spilled *best) {
    const int is_better = !best->lines || made->count < best->count;
    free(is_better ? best->lines : made->lines);
    if (is_better)
        *best = *made;
    *made = (fp3_spilled){0};
}

/* What does not fit is no mistake: another order or another set may. */
static fp3_status tolerate(fp3_status status) { return status == FP3_E_LIMIT ? FP3_OK : status; }

/* ---- the step ---- */

static fp3_spill_ends between(const maker *m, uint64_t in) {
    return (fp3_spill_ends){.in = in,
                            .valid = (m->owners & ~in) | (m->unwritten & in),
                            .out = in,
                            .saved = m->owners & ~in};
}

static fp3_status try_set(maker *m, const fp3_block *block, const uint32_t *order, uint64_t in,
                          fp3_error *error) {
    const fp3_spill_ends ends = between(m, in | m->always);
    fp3_spilled made;
    const fp3_status status = fp3_spill(block, order, &ends, &made, error);
    if (status)
        return tolerate(status);
    const int is_better = !m->best.lines || made.count < m->best.count;
    m->between = is_better ? in | m->always : m->between;
    take(&made, &m->best);
    return FP3_OK;
}

/* What a step leaves in the registers that does not care. */
static fp3_status find_left(const maker *m, const fp3_block *block, const uint32_t *order,
                            uint64_t *in, fp3_error *error) {
    fp3_spill_ends ends = between(m, *in | m->always);
    fp3_spilled made;
    ends.is_open = 1;
    const fp3_status status = fp3_spill(block, order, &ends, &made, error);
    if (!status)
        *in = made.left;
    free(made.lines);
    return tolerate(status);
}

/* The owner in the set that the step needs last. */
static uint64_t last_needed(const fp3_block *block, const uint32_t *order, uint64_t set) {
    const fp3_step_code *code = block->code;
    for (uint32_t p = 0; p < block->count && set & (set - 1); p++)
        for (uint32_t k = 0; k < 3; k++) {
            const fp3_ref ref = fp3_node_operand(&block->nodes[order[p]], k);
            const uint32_t reg = ref.at == FP3_AT_VARIABLE ? fp3_code_variable(code, ref.index)
                                 : ref.at == FP3_AT_PARAM  ? fp3_code_param(code, ref.index)
                                                           : FP3_BANK_OBJECT_COUNT;
            if (reg < FP3_BANK_OBJECT_COUNT && set & (set - 1))
                set &= ~BIT(reg);
        }
    return set & (~set + 1);
}

static fp3_status try_order(maker *m, const fp3_block *block, const uint32_t *order,
                            fp3_error *error) {
    uint64_t in = 0;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < ROUNDS; i++) {
        status = find_left(m, block, order, &in, error);
        if (!status)
            status = try_set(m, block, order, in, error);
    }
    in = m->owners;
    for (uint32_t i = 0; !status && i <= FEWER_MOST && in; i++) {
        status = try_set(m, block, order, in, error);
        in &= ~last_needed(block, order, in);
    }
    return status;
}

/* ---- a part ---- */

typedef fp3_status part_maker(const fp3_step_code *code, const fp3_config *config, fp3_block *block,
                              fp3_error *error);

/* ends: of a part that runs once; NULL: the step. */
static fp3_status make_part(maker *m, part_maker *make, const fp3_spill_ends *ends, int *copies,
                            fp3_error *error) {
    fp3_block block;
    fp3_dependences graph = {0};
    fp3_status status = make(m->code, m->config, &block, error);
    uint32_t *order = malloc((block.count + 1) * sizeof *order);
    m->best = (fp3_spilled){0};
    if (!status && !order)
        status = fp3_no_memory(error);
    if (!status)
        status = fp3_dependences_make(&block, NULL, 0, 0, &graph, error);
    for (fp3_next next = 0; !status && next < FP3_NEXT_COUNT; next++) {
        fp3_spilled made = {0};
        status = fp3_order_list(&block, &graph, next, order, error);
        if (!status && !ends)
            status = try_order(m, &block, order, error);
        else if (!status) {
            status = fp3_spill(&block, order, ends, &made, error);
            if (!status)
                take(&made, &m->best);
            status = tolerate(status);
        }
    }
    *copies = block.reads_minus_zero;
    fp3_dependences_free(&graph);
    fp3_block_free(&block);
    free(order);
    return status;
}

/* Takes the lines of the best over. */
static fp3_status keep(maker *m, fp3_schedule *made, int copies, fp3_line **lines, uint32_t *count,
                       fp3_error *error) {
    if (!m->best.lines && !(m->best.lines = calloc(1, sizeof *m->best.lines)))
        return fp3_no_memory(error);
    *lines = m->best.lines;
    *count = m->best.count;
    if (m->best.registers > made->registers)
        made->registers = m->best.registers;
    made->needs_minus_zero |= copies || m->best.moves;
    made->is_spilled |= m->best.spills > 0; /* a program without any gets those of a visit */
    m->best = (fp3_spilled){0};
    return FP3_OK;
}

/* ---- all of it ---- */

static fp3_status too_many(const maker *m, fp3_error *error) {
    return fp3_fail(error, FP3_E_LIMIT,
                    "the program has more values than the registers of configuration '%s' and the "
                    "records of its objects hold",
                    m->config->name);
}

static fp3_status make_step(maker *m, fp3_schedule *made, fp3_error *error) {
    int copies;
    fp3_status status = make_part(m, fp3_part_step, NULL, &copies, error);
    if (!status && !m->best.lines)
        status = too_many(m, error);
    if (status)
        return status;
    made->spills = m->best.spills;
    made->copies = m->best.count - m->code->step_count - m->best.spills;
    return keep(m, made, copies, &made->step, &made->step_count, error);
}

static fp3_status make_end(maker *m, part_maker *make, fp3_spill_ends ends, fp3_schedule *made,
                           fp3_line **lines, uint32_t *count, fp3_error *error) {
    int copies;
    fp3_status status = make_part(m, make, &ends, &copies, error);
    if (!status && !m->best.lines)
        status = too_many(m, error);
    return status ? status : keep(m, made, copies, lines, count, error);
}

/* An object that sleeps loads nothing else. */
static fp3_status add_lds(const maker *m, fp3_schedule *made, fp3_error *error) {
    fp3_line *lines = calloc(made->first_count + 1u, sizeof *lines);
    if (!lines)
        return fp3_no_memory(error);
    memcpy(lines + 1, made->first, made->first_count * sizeof *lines);
    uint32_t reg = 0;
    while (!(m->code->slept >> reg & 1))
        reg++;
    lines[0] =
        (fp3_line){.op = FP3_OP_LDS, .d = reg, .note = FP3_NONE_INDEX, .from = FP3_NONE_INDEX};
    free(made->first);
    made->first = lines;
    made->first_count++;
    return FP3_OK;
}

static void find_owners(maker *m) {
    const fp3_step_code *code = m->code;
    for (uint32_t x = 0; x < code->variable_count; x++) {
        const fp3_variable *v = &code->variables[x];
        const uint64_t bit = BIT(fp3_code_variable(code, x));
        const int is_state = v->first.at == FP3_AT_NOWHERE;
        const int is_kept =
            v->next.at == FP3_AT_NOWHERE || (v->next.at == FP3_AT_VARIABLE && v->next.index == x);
        m->owners |= bit;
        m->states |= is_state ? bit : 0;
        m->unwritten |= is_state && is_kept ? bit : 0;
    }
    for (uint32_t p = 0; p < code->param_count; p++) {
        m->owners |= BIT(fp3_code_param(code, p));
        m->unwritten |= BIT(fp3_code_param(code, p));
    }
    m->always = code->slept | code->tested;
}

fp3_status fp3_spilled_make(const fp3_step_code *code, const fp3_config *config, fp3_schedule *made,
                            fp3_error *error) {
    maker m = {.code = code, .config = config};
    fp3_needs needs = fp3_code_needs(code);
    needs.registers = code->variable_count + code->param_count;
    if (needs.registers > config->registers)
        return fp3_needs_check(&needs, config, error);
    if (config->dual)
        return too_many(&m, error);
    find_owners(&m);
    fp3_status status = make_step(&m, made, error);
    const uint64_t in = m.between, loaded = m.owners & (m.states | m.unwritten);
    /* What `sleep` writes is in its register alone. */
    const fp3_spill_ends first = {code->slept, loaded, in, m.owners & ~in, 0};
    const fp3_spill_ends last = {in, (m.owners & ~in) | (m.unwritten & in & ~code->slept), 0,
                                 m.states, 0};
    if (!status)
        status = make_end(&m, fp3_part_first, first, made, &made->first, &made->first_count, error);
    if (!status && code->slept)
        status = add_lds(&m, made, error);
    if (!status)
        status = make_end(&m, fp3_part_last, last, made, &made->last, &made->last_count, error);
    free(m.best.lines);
    return status;
}
