/* SPDX-License-Identifier: Apache-2.0 */
/* image.c - words, constants and symbols. Constants that the host gives come first, numbers behind
 * them in the order of their first use, each once. */
#include "image.h"
#include "base/bits.h"

#include "base/number.h"
#include "machine/operation.h"

#include <fp3/isa.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const fp3_step *step;
    const conversion *c;
    fp3_constant constants[FP3_BANK_SHARED_COUNT];
    uint32_t constant_count;
    uint32_t named; /* constants without a value here */
    int is_full;
} builder;

static int is_number(const builder *b, uint32_t constant) {
    return constant == b->c->code.constant_count || /* -0.0, which copies add */
           b->step->known.list[b->c->constants[constant]].op == KNOWN_NUMBER;
}

static uint32_t bits_of(const builder *b, uint32_t constant) {
    float single = -0.0f;
    if (constant < b->c->code.constant_count)
        fp3_number_single(b->step->known.list[b->c->constants[constant]].number, &single);
    return fp3_bits_of(single);
}

static uint32_t number_at(builder *b, uint32_t bits) {
    uint32_t i = 0;
    while (i < b->constant_count && b->constants[i].bits != bits)
        i++;
    if (b->named + i == FP3_BANK_SHARED_COUNT) {
        b->is_full = 1;
        return 0;
    }
    if (i == b->constant_count)
        b->constants[b->constant_count++] = (fp3_constant){b->named + i, bits};
    return b->named + i;
}

static uint32_t operand_of(builder *b, uint32_t operand) {
    if (operand < FP3_BANK_SHARED_BASE)
        return operand;
    const uint32_t constant = operand - FP3_BANK_SHARED_BASE;
    if (is_number(b, constant))
        return FP3_BANK_SHARED_BASE + number_at(b, bits_of(b, constant));
    uint32_t index = 0;
    for (uint32_t i = 0; i < constant; i++)
        index += !is_number(b, i);
    return FP3_BANK_SHARED_BASE + index;
}

static uint32_t *encode(builder *b, const fp3_line *lines, uint32_t count, uint32_t *code) {
    for (uint32_t i = 0; i < count; i++) {
        fp3_instruction word = {.op = lines[i].op};
        for (const char *letter = fp3_operation_find(lines[i].op)->operands; *letter; letter++)
            *(*letter == 'd'   ? &word.d
              : *letter == 'a' ? &word.a
              : *letter == 'b' ? &word.b
                               : &word.c) =
                *letter == 'd' ? lines[i].d : operand_of(b, lines[i].operand[*letter - 'a']);
        *code++ = fp3_word_encode(&word);
    }
    return code;
}

static fp3_symbol_class class_of(const builder *b, uint32_t reg) {
    const fp3_ref of = fp3_code_owner(&b->c->code, reg);
    const int is_kept = of.at == FP3_AT_VARIABLE &&
                        b->step->variables[of.index].role != ROLE_CARRIED &&
                        b->step->variables[of.index].role != ROLE_LIST;
    if (of.at == FP3_AT_VARIABLE && b->step->variables[of.index].role == ROLE_WORST)
        return FP3_SYMBOL_WORST;
    return is_kept ? FP3_SYMBOL_STATE : of.at == FP3_AT_PARAM ? FP3_SYMBOL_PARAM : FP3_SYMBOL_TEMP;
}

static uint32_t put_symbols(builder *b, const fp3_names *names, fp3_symbol *symbols) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < names->object_count; i++) {
        symbols[count] = (fp3_symbol){.symbol_class = class_of(b, i), .index = i};
        memcpy(symbols[count].name, names->object[i], FP3_NAME_SIZE);
        count += *names->object[i] != '\0';
    }
    for (uint32_t i = 0; i < b->c->code.constant_count; i++) {
        if (is_number(b, i))
            continue;
        symbols[count] = (fp3_symbol){.symbol_class = FP3_SYMBOL_SHARED, .index = b->named++};
        memcpy(symbols[count++].name, names->constant[i], FP3_NAME_SIZE);
    }
    return count;
}

fp3_status fp3_compiler_image(const fp3_step *step, const conversion *c,
                              const fp3_schedule *schedule, const fp3_names *names,
                              fp3_image **image, fp3_error *error) {
    const uint32_t words = schedule->first_count + schedule->step_count + schedule->last_count;
    builder b = {.step = step, .c = c};
    uint32_t *code = calloc(words + 1u, sizeof *code), *end = code;
    fp3_symbol *symbols =
        calloc(names->object_count + c->code.constant_count + 1u, sizeof *symbols);
    fp3_status status = code && symbols ? FP3_OK : fp3_no_memory(error);
    if (!status) {
        fp3_image draft = {.code_count = words,
                           .words = step->words,
                           .step = schedule->first_count,
                           .last = schedule->first_count + schedule->step_count,
                           .code = code,
                           .constants = b.constants,
                           .symbols = symbols};
        draft.symbol_count = put_symbols(&b, names, symbols);
        end = encode(&b, schedule->first, schedule->first_count, end);
        end = encode(&b, schedule->step, schedule->step_count, end);
        encode(&b, schedule->last, schedule->last_count, end);
        draft.constant_count = b.constant_count;
        status = b.is_full
                     ? fp3_fail(error, FP3_E_PROGRAM, "the program has more than %d constants",
                                FP3_BANK_SHARED_COUNT)
                     : fp3_image_make(&draft, image, error);
    }
    free(code);
    free(symbols);
    return status;
}
