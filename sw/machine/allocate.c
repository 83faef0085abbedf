/* SPDX-License-Identifier: Apache-2.0 */
#include "allocate.h"

#include <assert.h>

static uint32_t allocate(asm_source *a, int object) {
    const uint32_t base = fp3_asm_base(object);
    const uint32_t count = object ? FP3_BANK_OBJECT_COUNT : FP3_BANK_SHARED_COUNT;
    for (uint32_t i = base; i < base + count; i++)
        if (!a->taken[i]) {
            a->taken[i] = 1;
            return i;
        }
    return ASM_NOWHERE;
}

static void add_constant(asm_source *a, uint32_t operand, uint32_t bits) {
    assert(!fp3_asm_is_object(operand) && a->constant_count < FP3_BANK_SHARED_COUNT);
    a->constants[a->constant_count++] = (fp3_constant){operand - FP3_BANK_SHARED_BASE, bits};
}

int fp3_asm_raw_operand(const asm_source *a, fp3_token t, uint32_t *operand) {
    return (t.kind == FP3_TOKEN_RAW || (t.kind == FP3_TOKEN_NAME && !fp3_asm_find(a, t))) &&
           fp3_asm_register(t, operand);
}

/* Automatic allocation keeps away from every register that the program mentions. */
static void take_mentioned(asm_source *a) {
    for (uint32_t i = 0; i < a->statement_count; i++)
        for (const fp3_token *t = a->statements[i].operands;
             t < a->statements[i].operands + ASM_OPERAND_LIMIT; t++) {
            uint32_t operand;
            if (t->length && fp3_asm_raw_operand(a, *t, &operand) && operand != ASM_NOWHERE)
                a->taken[operand] = 1;
        }
    for (uint32_t i = 0; i < a->declaration_count; i++)
        if (a->declarations[i].operand != ASM_NOWHERE)
            a->taken[a->declarations[i].operand] = 1;
}

void fp3_asm_allocate(asm_source *a) {
    int full[2] = {0};
    take_mentioned(a);
    for (uint32_t i = 0; i < a->declaration_count; i++) {
        asm_declaration *d = &a->declarations[i];
        int object = fp3_class_is_object(d->symbol_class);
        if (d->operand == ASM_NOWHERE)
            d->operand = allocate(a, object);
        if (d->operand == ASM_NOWHERE) {
            if (!full[object])
                fp3_report_expected(&a->report, d->at, "no more than %d %s",
                                    object ? FP3_BANK_OBJECT_COUNT : FP3_BANK_SHARED_COUNT,
                                    object ? "object registers" : "shared constants");
            full[object] = 1;
            d->operand = fp3_asm_base(object); /* so that its uses are right */
            continue;
        }
        if (d->symbol_class == FP3_SYMBOL_CONST)
            add_constant(a, d->operand, d->bits);
    }
}

uint32_t fp3_asm_constant(asm_source *a, uint32_t bits) {
    uint32_t found = ASM_NOWHERE;
    for (uint32_t i = 0; i < a->constant_count; i++)
        if (a->constants[i].bits == bits && a->constants[i].index + FP3_BANK_SHARED_BASE < found)
            found = a->constants[i].index + FP3_BANK_SHARED_BASE;
    if (found != ASM_NOWHERE)
        return found;
    found = allocate(a, 0);
    if (found != ASM_NOWHERE)
        add_constant(a, found, bits);
    return found;
}
