/* SPDX-License-Identifier: Apache-2.0 */
/* parts.c - the operations of a part become nodes; who writes each variable. */
#include "parts.h"

#include "copies.h"

#include <inttypes.h>

/* Where a reference of the caller is found in a block of its kind. */
static fp3_ref found_at(fp3_ref ref) {
    if (ref.at == FP3_AT_FIRST || ref.at == FP3_AT_LAST)
        ref.at = FP3_AT_OP;
    else if (ref.at == FP3_AT_NEXT)
        ref.at = FP3_AT_VARIABLE;
    return ref;
}

/* op_at: what an operation of this part is called, variable_at: a variable at its beginning. */
static fp3_status check(const fp3_step_code *code, fp3_ref ref, fp3_place op_at,
                        fp3_place variable_at, uint32_t op_count, fp3_error *error) {
    uint32_t count = 0;
    if (ref.at == FP3_AT_NOWHERE)
        return FP3_OK;
    if (ref.at == op_at)
        count = op_count;
    else if (ref.at == variable_at)
        count = code->variable_count;
    else if (ref.at == FP3_AT_PARAM)
        count = code->param_count;
    else if (ref.at == FP3_AT_CONSTANT)
        count = code->constant_count;
    return ref.index < count
               ? FP3_OK
               : fp3_fail(error, FP3_E_ARGUMENT, "the code refers to place %d, index %" PRIu32,
                          (int)ref.at, ref.index);
}

static fp3_status add_ops(fp3_block *block, const fp3_op *ops, uint32_t count, fp3_place op_at,
                          fp3_place variable_at, fp3_error *error) {
    for (uint32_t i = 0; i < count; i++) {
        fp3_node node = {
            .op = ops[i], .writes = FP3_NONE_INDEX, .fixed = FP3_NONE_INDEX, .from = i};
        for (uint32_t k = 0; k < 3; k++) {
            fp3_ref *ref = fp3_node_operand_at(&node, k);
            fp3_status status = check(block->code, *ref, op_at, variable_at, i, error);
            if (status)
                return status;
            *ref = found_at(*ref);
        }
        if (fp3_block_add(block, &node) == FP3_NONE_INDEX)
            return fp3_no_memory(error);
    }
    return FP3_OK;
}

/* The variable gets this value from the node that makes it, if no other variable needs that node's
 * register. */
static fp3_status write_variable(fp3_block *block, uint32_t variable, fp3_ref value,
                                 fp3_error *error) {
    uint32_t writer = value.index;
    if (value.at != FP3_AT_OP || block->nodes[writer].writes != FP3_NONE_INDEX)
        writer = fp3_block_add_copy(block, value);
    if (writer == FP3_NONE_INDEX)
        return fp3_no_memory(error);
    block->nodes[writer].writes = variable;
    block->nodes[writer].fixed = fp3_code_variable(block->code, variable);
    block->writer[variable] = writer;
    return FP3_OK;
}

/* ---- the three parts ---- */

static fp3_status check_states(const fp3_block *block, fp3_error *error) {
    for (uint32_t x = 0; x < block->code->variable_count; x++)
        for (uint32_t i = 0; block->writer[x] != FP3_NONE_INDEX && i < block->count; i++)
            if (fp3_node_reads_variable(&block->nodes[i], x))
                return fp3_fail(error, FP3_E_ARGUMENT,
                                "the first part reads variable %" PRIu32 ", which it makes", x);
    return FP3_OK;
}

fp3_status fp3_part_first(const fp3_step_code *code, const fp3_config *config, fp3_block *block,
                          fp3_error *error) {
    fp3_status status = fp3_block_open(code, config, block, error);
    block->is_first = 1;
    if (!status)
        status =
            add_ops(block, code->first, code->first_count, FP3_AT_FIRST, FP3_AT_VARIABLE, error);
    for (uint32_t x = 0; !status && x < code->variable_count; x++) {
        const fp3_ref value = code->variables[x].first;
        status = check(code, value, FP3_AT_FIRST, FP3_AT_VARIABLE, code->first_count, error);
        if (!status && value.at != FP3_AT_NOWHERE)
            status = write_variable(block, x, found_at(value), error);
    }
    return status ? status : check_states(block, error);
}

fp3_status fp3_part_step(const fp3_step_code *code, const fp3_config *config, fp3_block *block,
                         fp3_error *error) {
    fp3_status status = fp3_block_open(code, config, block, error);
    block->is_cyclic = 1;
    if (!status)
        status = add_ops(block, code->step, code->step_count, FP3_AT_OP, FP3_AT_VARIABLE, error);
    for (uint32_t x = 0; !status && x < code->variable_count; x++) {
        const fp3_ref value = code->variables[x].next;
        status = check(code, value, FP3_AT_OP, FP3_AT_VARIABLE, code->step_count, error);
        const int is_kept =
            value.at == FP3_AT_NOWHERE || (value.at == FP3_AT_VARIABLE && value.index == x);
        if (!status && !is_kept)
            status = write_variable(block, x, value, error);
    }
    return status ? status : fp3_copies_add(block, error);
}

fp3_status fp3_part_last(const fp3_step_code *code, const fp3_config *config, fp3_block *block,
                         fp3_error *error) {
    fp3_status status = fp3_block_open(code, config, block, error);
    if (!status)
        status = add_ops(block, code->last, code->last_count, FP3_AT_LAST, FP3_AT_NEXT, error);
    for (uint32_t x = 0; !status && x < code->variable_count; x++) {
        const fp3_ref value = code->variables[x].last;
        status = check(code, value, FP3_AT_LAST, FP3_AT_NEXT, code->last_count, error);
        if (!status && value.at != FP3_AT_NOWHERE)
            status = write_variable(block, x, found_at(value), error);
    }
    return status ? status : fp3_copies_add(block, error);
}
