/* SPDX-License-Identifier: Apache-2.0 */
/* timing.c - nodes and lines as the busy flags see them. */
#include "timing.h"

#include <fp3/isa.h>
#include <machine/operation.h>
#include <stdlib.h>
#include <string.h>

/* A node's register for the busy flags is its own number; a variable's stands behind them all. */
static uint32_t slot_of(const fp3_block *block, uint32_t node) {
    const uint32_t writes = block->nodes[node].writes;
    return writes == FP3_NONE_INDEX ? node : block->count + writes;
}

/* Nodes as the busy flags see them, in order; timed has room for block->count. */
static void time_nodes(const fp3_block *block, const uint32_t *order, fp3_timed *timed) {
    for (uint32_t p = 0; p < block->count; p++) {
        const fp3_node *node = &block->nodes[order[p]];
        timed[p] = (fp3_timed){.latency = node->latency, .d = slot_of(block, order[p])};
        for (uint32_t k = 0; k < 3; k++) {
            const fp3_ref ref = fp3_node_operand(node, k);
            if (ref.at == FP3_AT_OP)
                timed[p].source[timed[p].source_count++] = slot_of(block, ref.index);
            else if (ref.at == FP3_AT_VARIABLE)
                timed[p].source[timed[p].source_count++] = block->count + ref.index;
        }
    }
}

static fp3_status time_overlap(const fp3_block *block, const uint32_t *order, double *cycles,
                               fp3_error *error) {
    fp3_decoded *code = calloc((size_t)block->count + 1, sizeof *code);
    if (!code)
        return fp3_no_memory(error);
    for (uint32_t p = 0; p < block->count; p++)
        code[p].of = fp3_operation_find(block->nodes[order[p]].op.op);
    *cycles =
        fp3_cycles_swept_step(block->config, &(fp3_swept){code, block->count, 0, block->count, 1});
    free(code);
    return FP3_OK;
}

fp3_status fp3_time_order(const fp3_block *block, const uint32_t *order, double *cycles,
                          fp3_error *error) {
    if (block->config->dual)
        return time_overlap(block, order, cycles, error);
    if (block->config->interleave) {
        *cycles = (double)block->count; /* of the same rank as the truth */
        return FP3_OK;
    }
    fp3_timed *timed = calloc(2 * (size_t)block->count + 1, sizeof *timed);
    if (!timed)
        return fp3_no_memory(error);
    time_nodes(block, order, timed);
    uint32_t ahead = 0; /* what the first part executes */
    for (uint32_t p = 0; p < block->count; p++)
        if (block->nodes[order[p]].is_ahead)
            timed[block->count + ahead++] = timed[p];
    const fp3_timed_program program = {.first = timed + block->count,
                                       .first_count = ahead,
                                       .step = timed,
                                       .step_count = block->count,
                                       .slots = block->count + block->code->variable_count};
    *cycles = fp3_cycles_solo_step(block->config, &program);
    free(timed);
    return FP3_OK;
}

static void time_lines(const fp3_config *config, const fp3_line *lines, uint32_t count,
                       fp3_timed *timed) {
    for (uint32_t i = 0; i < count; i++) {
        const fp3_operation *operation = fp3_operation_find(lines[i].op);
        timed[i] = (fp3_timed){.latency = fp3_cycles_latency(config, lines[i].op), .d = lines[i].d};
        for (size_t k = 0; operation && k + 1 < strlen(operation->operands); k++)
            if (lines[i].operand[k] < FP3_BANK_SHARED_BASE)
                timed[i].source[timed[i].source_count++] = lines[i].operand[k];
    }
}

/* The program as the issue stage sees it; first is the one allocation. */
int fp3_time_schedule(const fp3_schedule *schedule, const fp3_config *config, fp3_timed **code,
                      fp3_timed_program *program) {
    const fp3_schedule *s = schedule;
    const uint32_t count = s->first_count + s->step_count + s->last_count;
    *code = calloc(count + 1, sizeof **code);
    if (!*code)
        return 0;
    fp3_timed *step = *code + s->first_count, *last = step + s->step_count;
    time_lines(config, s->first, s->first_count, *code);
    time_lines(config, s->step, s->step_count, step);
    time_lines(config, s->last, s->last_count, last);
    *program = (fp3_timed_program){.first = *code,
                                   .step = step,
                                   .last = last,
                                   .first_count = s->first_count,
                                   .step_count = s->step_count,
                                   .last_count = s->last_count,
                                   .slots = FP3_BANK_OBJECT_COUNT};
    return 1;
}
