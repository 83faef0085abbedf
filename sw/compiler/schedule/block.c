/* SPDX-License-Identifier: Apache-2.0 */
/* block.c - nodes, added one by one. */
#include "block.h"

#include "machine/cycles.h"

#include <assert.h>
#include <fp3/isa.h>
#include <stdlib.h>

fp3_ref *fp3_node_operand_at(fp3_node *node, uint32_t i) {
    assert(i < 3);
    return i == 0 ? &node->op.a : i == 1 ? &node->op.b : &node->op.c;
}

int fp3_node_reads_variable(const fp3_node *node, uint32_t variable) {
    for (uint32_t k = 0; k < 3; k++) {
        const fp3_ref ref = fp3_node_operand(node, k);
        if (ref.at == FP3_AT_VARIABLE && ref.index == variable)
            return 1;
    }
    return 0;
}

fp3_status fp3_block_open(const fp3_step_code *code, const fp3_config *config, fp3_block *block,
                          fp3_error *error) {
    *block = (fp3_block){.code = code, .config = config};
    block->writer = malloc((code->variable_count + 1) * sizeof *block->writer);
    if (!block->writer)
        return fp3_no_memory(error);
    for (uint32_t x = 0; x < code->variable_count; x++)
        block->writer[x] = FP3_NONE_INDEX;
    return FP3_OK;
}

void fp3_block_free(fp3_block *block) {
    free(block->nodes);
    free(block->writer);
    *block = (fp3_block){0};
}

uint32_t fp3_block_add(fp3_block *block, const fp3_node *node) {
    if (block->count == block->room) {
        const uint32_t room = block->room ? 2 * block->room : 64;
        fp3_node *nodes = realloc(block->nodes, room * sizeof *nodes);
        if (!nodes)
            return FP3_NONE_INDEX;
        block->nodes = nodes;
        block->room = room;
    }
    fp3_node *added = &block->nodes[block->count];
    *added = *node;
    added->latency = fp3_cycles_latency(block->config, node->op.op);
    added->delay = fp3_cycles_delay(block->config, node->op.op);
    return block->count++;
}

/* x + -0.0 is x, for every x that an operation or the host can make, -0.0 included. */
uint32_t fp3_block_add_copy(fp3_block *block, fp3_ref what) {
    const fp3_step_code *code = block->code;
    const uint32_t minus_zero =
        code->minus_zero == FP3_NONE_INDEX ? code->constant_count : code->minus_zero;
    block->reads_minus_zero = 1;
    block->copies++;
    return fp3_block_add(block, &(fp3_node){.op = {.op = FP3_OP_ADD,
                                                   .a = what,
                                                   .b = {FP3_AT_CONSTANT, minus_zero},
                                                   .note = FP3_NONE_INDEX},
                                            .writes = FP3_NONE_INDEX,
                                            .fixed = FP3_NONE_INDEX,
                                            .from = FP3_NONE_INDEX});
}

fp3_status fp3_block_clone(const fp3_block *block, fp3_block *clone, fp3_error *error) {
    fp3_status status = fp3_block_open(block->code, block->config, clone, error);
    for (uint32_t i = 0; !status && i < block->count; i++)
        if (fp3_block_add(clone, &block->nodes[i]) == FP3_NONE_INDEX)
            status = fp3_no_memory(error);
    for (uint32_t x = 0; !status && x < block->code->variable_count; x++)
        clone->writer[x] = block->writer[x];
    clone->is_first = block->is_first;
    clone->is_cyclic = block->is_cyclic;
    clone->copies = block->copies;
    clone->reads_minus_zero = block->reads_minus_zero;
    return status;
}
