/* SPDX-License-Identifier: Apache-2.0 */
#include "operation.h"

#include <stdlib.h>
#include <string.h>

const fp3_operation fp3_operations[] = {FP3_OPERATION_ROWS};
const unsigned fp3_operation_count = sizeof fp3_operations / sizeof *fp3_operations;

const fp3_operation *fp3_operation_find(uint32_t code) {
    for (unsigned i = 0; i < fp3_operation_count; i++)
        if (fp3_operations[i].code == code)
            return &fp3_operations[i];
    return NULL;
}

int fp3_operation_is_arithmetic(const fp3_operation *operation) {
    return !(operation->path & (FP3_UNIT_STORE | FP3_UNIT_COMPARISON | FP3_UNIT_SEQUENCE));
}

uint64_t fp3_operation_bit(uint32_t code) {
    const fp3_operation *operation = fp3_operation_find(code);
    return operation ? UINT64_C(1) << (operation - fp3_operations) : 0;
}

_Static_assert(sizeof fp3_operations / sizeof *fp3_operations <= 64,
               "fp3_operation_bit has a bit for each");

fp3_key fp3_operation_lacks(const fp3_config *config, uint32_t code) {
    const fp3_operation *operation = fp3_operation_find(code);
    if (!operation || operation->needs == FP3_KEY_NONE ||
        fp3_config_value(config, operation->needs))
        return FP3_KEY_NONE;
    return operation->needs;
}

static int is_sum(uint32_t operand) { return operand < FP3_BANK_SHARED_BASE && !(operand & 1); }
static int is_product(uint32_t operand) { return operand < FP3_BANK_SHARED_BASE && operand & 1; }

fp3_counter fp3_operation_counter(const fp3_config *config, const fp3_operation *of) {
    return config->dual && of->counter == FP3_COUNTER_ISSUED_ADD && fp3_operation_multiplies(of)
               ? FP3_COUNTER_ISSUED_MUL
               : of->counter;
}

int fp3_operation_scales(uint32_t code) {
    const fp3_operation *operation = fp3_operation_find(code);
    return operation && operation->needs == FP3_KEY_SCALE;
}

const char *fp3_operation_mixes(const fp3_config *config, const fp3_instruction *in) {
    const fp3_operation *of = fp3_operation_find(in->op);
    if (!config->dual || !of || !fp3_operation_is_arithmetic(of))
        return NULL;
    const int adds = !fp3_operation_multiplies(of), has_b = strchr(of->operands, 'b') != NULL;
    if (adds && is_product(in->d))
        return "writes a sum to a register of odd number";
    const int values = (of->path & FP3_UNIT_VALUE) != 0;
    if (!adds && is_sum(in->d))
        return values ? "writes an estimate to a register of even number"
                      : "writes a product to a register of even number";
    if (has_b && is_sum(in->a) && is_sum(in->b))
        return "reads two registers of even number";
    if (has_b && is_product(in->a) && is_product(in->b))
        return "reads two registers of odd number";
    if (values && is_product(in->a))
        return "estimates from a register of odd number";
    if (fp3_operation_scales(in->op) && is_sum(in->b))
        return "scales a register of even number";
    if (fp3_operation_scales(in->op) && is_product(in->a))
        return "adds a scaled value to a register of odd number";
    return NULL;
}

/* ---- words ---- */

#define MASK(field) ((2u << (FP3_FIELD_##field##_HI - FP3_FIELD_##field##_LO)) - 1)
#define GET(word, field) ((word) >> FP3_FIELD_##field##_LO & MASK(field))
#define PUT(value, field) (((value)&MASK(field)) << FP3_FIELD_##field##_LO)

fp3_status fp3_word_decode(uint32_t word, fp3_instruction *instruction, fp3_error *error) {
    fp3_instruction i = {.op = GET(word, OP),
                         .d = GET(word, D),
                         .a = GET(word, A),
                         .b = GET(word, B),
                         .c = GET(word, C)};
    if (i.op == MASK(OP)) {
        i.op = FP3_CODE_MORE + i.c;
        i.c = 0;
    }
    const fp3_operation *operation = fp3_operation_find(i.op);
    if (!operation)
        return fp3_fail(error, FP3_E_PROGRAM, "0x%08x is no instruction: opcode %u is unknown",
                        word, i.op);
    const uint32_t value[] = {i.d, i.a, i.b, i.c};
    for (unsigned letter = 0; letter < 4; letter++)
        if (!strchr(operation->operands, "dabc"[letter]) && value[letter])
            return fp3_fail(error, FP3_E_PROGRAM,
                            "0x%08x is no instruction: %s has no operand %c, but the field holds "
                            "%u instead of 0",
                            word, operation->name, "dabc"[letter], value[letter]);
    if (instruction)
        *instruction = i;
    return FP3_OK;
}

fp3_decoded *fp3_decode_all(const uint32_t *code, uint32_t count) {
    fp3_decoded *all = calloc(count + 1u, sizeof *all);
    for (uint32_t i = 0; all && i < count; i++)
        if (!fp3_word_decode(code[i], &all[i].in, NULL))
            all[i].of = fp3_operation_find(all[i].in.op);
    return all;
}

uint32_t fp3_word_encode(const fp3_instruction *i) {
    const uint32_t code = i->op < FP3_CODE_MORE ? PUT(i->op, OP) | PUT(i->c, C)
                                                : PUT(MASK(OP), OP) | PUT(i->op - FP3_CODE_MORE, C);
    return code | PUT(i->d, D) | PUT(i->a, A) | PUT(i->b, B);
}
