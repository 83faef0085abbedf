#include "operation.h"

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
    return !(operation->path & (FP3_UNIT_STORE | FP3_UNIT_COMPARISON));
}

fp3_key fp3_operation_lacks(const fp3_config *config, uint32_t code) {
    const fp3_operation *operation = fp3_operation_find(code);
    if (!operation || operation->needs == FP3_KEY_NONE ||
        fp3_config_value(config, operation->needs))
        return FP3_KEY_NONE;
    return operation->needs;
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

uint32_t fp3_word_encode(const fp3_instruction *i) {
    return PUT(i->op, OP) | PUT(i->d, D) | PUT(i->a, A) | PUT(i->b, B) | PUT(i->c, C);
}
