/* SPDX-License-Identifier: Apache-2.0 */
/* ends.c - lines for the first and the last part. */
#include "ends.h"

#include "dependences.h"
#include "order.h"
#include "parts.h"

#include <stdlib.h>

/* Whether the step that comes reads what was executed ahead of it. */
static int is_carried(const fp3_block *block, uint32_t value) {
    for (uint32_t i = 0; i < block->count; i++)
        for (uint32_t k = 0; k < 3 && !block->nodes[i].is_ahead; k++) {
            const fp3_ref ref = fp3_node_operand(&block->nodes[i], k);
            if (ref.at == FP3_AT_OP && ref.index == value)
                return 1;
        }
    return 0;
}

/* The first part executes, for the first step, the operations that a step executes for the next
 * step: with its own variables, into the same registers. at[i]: the node in first of node i of the
 * step. */
static fp3_status add_ahead(const fp3_block *step, const fp3_choice *best, fp3_block *first,
                            uint32_t *at, fp3_error *error) {
    for (uint32_t p = 0; p < step->count; p++) {
        const uint32_t i = best->order[p];
        fp3_node node = step->nodes[i];
        if (!node.is_ahead)
            continue;
        fp3_ref *refs[3] = {&node.op.a, &node.op.b, &node.op.c};
        for (int k = 0; k < 3; k++) {
            fp3_ref *ref = refs[k];
            if (ref->at == FP3_AT_OP)
                ref->index = at[ref->index];
            else if (ref->at == FP3_AT_VARIABLE && first->writer[ref->index] != FP3_NONE_INDEX)
                *ref = (fp3_ref){FP3_AT_OP, first->writer[ref->index]};
        }
        node.fixed = is_carried(step, i) ? best->places.reg[i] : FP3_NONE_INDEX;
        node.writes = FP3_NONE_INDEX;
        at[i] = fp3_block_add(first, &node);
        if (at[i] == FP3_NONE_INDEX)
            return fp3_no_memory(error);
    }
    return FP3_OK;
}

/* A part that runs once: soon if it fits, small if not. */
static fp3_status finish_block(const fp3_block *block, fp3_schedule *made, fp3_line **lines,
                               uint32_t *count, fp3_error *error) {
    static const fp3_next ways[] = {FP3_NEXT_SOON, FP3_NEXT_DEEP, FP3_NEXT_FEWEST, FP3_NEXT_LONG};
    uint32_t *order = malloc((block->count + 1) * sizeof *order);
    fp3_dependences graph = {0};
    fp3_places places = {0};
    fp3_status status = order ? FP3_OK : fp3_no_memory(error);
    uint32_t fewest = UINT32_MAX;
    if (!status)
        status = fp3_dependences_make(block, NULL, 0, 0, &graph, error);
    for (size_t i = 0;
         !status && i < sizeof ways / sizeof *ways && fewest > block->config->registers; i++) {
        fp3_places_free(&places);
        status = fp3_order_list(block, &graph, ways[i], order, error);
        if (!status)
            status = fp3_allocate_within(block, order, &places, error);
        if (!status && places.registers < fewest)
            fewest = places.registers;
    }
    if (!status && fewest > block->config->registers)
        status = fp3_allocate_refuse(block, fewest, error);
    if (!status)
        status = fp3_places_lines(block, order, &places, lines, error);
    if (!status) {
        *count = block->count;
        if (places.registers > made->registers)
            made->registers = places.registers;
        made->needs_minus_zero |= block->reads_minus_zero;
    }
    free(order);
    fp3_dependences_free(&graph);
    fp3_places_free(&places);
    return status;
}

fp3_status fp3_ends_first(const fp3_block *step, const fp3_choice *best, fp3_schedule *made,
                          fp3_error *error) {
    fp3_block first;
    uint32_t *at = calloc(step->count + 1, sizeof *at);
    fp3_status status =
        at ? fp3_part_first(step->code, step->config, &first, error) : fp3_no_memory(error);
    if (at && !status)
        status = add_ahead(step, best, &first, at, error);
    if (at && !status)
        status = finish_block(&first, made, &made->first, &made->first_count, error);
    if (at)
        fp3_block_free(&first);
    free(at);
    return status;
}

fp3_status fp3_ends_last(const fp3_step_code *code, const fp3_config *config, fp3_schedule *made,
                         fp3_error *error) {
    fp3_block last;
    fp3_status status = fp3_part_last(code, config, &last, error);
    if (!status)
        status = finish_block(&last, made, &made->last, &made->last_count, error);
    fp3_block_free(&last);
    return status;
}
