/* SPDX-License-Identifier: Apache-2.0 */
/* numbers.c - see numbers.h. */
#include "numbers.h"

#include "machine/operation.h"

#define BIT(reg) (UINT64_C(1) << (reg))
#define MASK (FP3_BANK_OBJECT_COUNT - 1)

void fp3_chunks_number(const fp3_members *group, uint64_t apart, fp3_chunks_numbers *numbers) {
    const uint64_t seen = group->lists.shape.published, stored = group->visit->stored,
                   loaded = group->visit->loaded;
    const uint64_t sets[] = {seen & stored, seen, stored, loaded & ~apart, loaded, UINT64_MAX};
    const uint32_t count = sizeof sets / sizeof *sets;
    uint64_t left = UINT64_MAX;
    uint32_t next = 0;
    for (uint32_t k = 0; k < count; k++) {
        for (uint32_t reg = 0; reg < FP3_BANK_OBJECT_COUNT; reg++)
            if (sets[k] & left & BIT(reg)) {
                numbers->now[reg] = (uint8_t)next;
                numbers->before[next++] = (uint8_t)reg;
            }
        left &= ~sets[k];
        if (k == 0)
            numbers->published = next;
        if (k == count - 2)
            numbers->moved = next;
    }
}

static uint32_t *field(fp3_instruction *in, char letter) {
    return letter == 'd' ? &in->d : letter == 'a' ? &in->a : letter == 'b' ? &in->b : &in->c;
}

uint32_t fp3_chunks_renamed(const fp3_chunks_numbers *numbers, const fp3_decoded *word) {
    fp3_instruction in = word->in;
    for (const char *letter = word->of->operands; *letter; letter++) {
        uint32_t *operand = field(&in, *letter);
        const int is_word = *letter == word->of->number; /* of a neighbour's record */
        if (!fp3_operation_counts(word->of, *letter) &&
            (is_word || *operand < FP3_BANK_SHARED_BASE))
            *operand = (*operand & ~MASK) | numbers->now[*operand & MASK];
    }
    return fp3_word_encode(&in);
}
