/* SPDX-License-Identifier: Apache-2.0 */
#include <fp3/image.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/host.h"
#include "operand.h"
#include "operation.h"

/* How one image is written. */
typedef struct {
    const fp3_image *image;
    const char *names[ASM_REGISTERS];       /* by operand */
    const uint32_t *numbers[ASM_REGISTERS]; /* bits of the constants with a value and no name */
    int write_numbers; /* constants without a name as numbers, else as registers */
} view;

static view view_of(const fp3_image *image) {
    view v = {.image = image, .write_numbers = 1};
    for (uint32_t i = 0; image && i < ASM_REGISTERS; i++)
        v.names[i] = fp3_image_name(image, i);
    for (uint32_t i = 0; image && i < image->constant_count; i++) {
        uint32_t operand = FP3_BANK_SHARED_BASE + image->constants[i].index;
        if (!v.names[operand])
            v.numbers[operand] = &image->constants[i].bits;
    }
    return v;
}

static void register_text(const view *v, uint32_t operand, char text[FP3_NAME_SIZE]) {
    fp3_asm_register_text(operand, text);
    for (uint32_t i = 0; i < ASM_REGISTERS; i++)
        if (v->names[i] && !strcmp(v->names[i], text)) {
            /* A name hides the register that is spelled like it: %r5 always means the register. */
            memmove(text + 1, text, strlen(text) + 1);
            *text = '%';
            return;
        }
}

static void operand_text(const view *v, uint32_t operand, char text[FP3_NAME_SIZE]) {
    if (v->names[operand])
        snprintf(text, FP3_NAME_SIZE, "%s", v->names[operand]);
    else if (v->numbers[operand] && v->write_numbers)
        fp3_number_text(*v->numbers[operand], text);
    else
        register_text(v, operand, text);
}

static fp3_status word_text(const view *v, uint32_t word, char text[FP3_WORD_TEXT_SIZE],
                            fp3_error *error) {
    fp3_instruction decoded;
    fp3_status status = fp3_word_decode(word, &decoded, error);
    if (status)
        return status;
    const fp3_operation *operation = fp3_operation_find(decoded.op);
    size_t used = (size_t)snprintf(text, FP3_WORD_TEXT_SIZE, "%-4s", operation->name);
    for (const char *letter = operation->operands; *letter; letter++) {
        char operand[FP3_NAME_SIZE];
        if (fp3_operation_counts(operation, *letter))
            snprintf(operand, sizeof operand, "%u", fp3_operand(&decoded, *letter));
        else
            operand_text(v, fp3_operand(&decoded, *letter), operand);
        used += (size_t)snprintf(text + used, FP3_WORD_TEXT_SIZE - used, "%s%s",
                                 letter == operation->operands ? " " : ", ", operand);
    }
    return FP3_OK;
}

fp3_status fp3_word_text(uint32_t word, const fp3_image *image, char text[FP3_WORD_TEXT_SIZE],
                         fp3_error *error) {
    view v = view_of(image);
    return word_text(&v, word, text, error);
}

/* Constants without a name can be written as numbers if the assembler would put each of them where
 * the image has it. It allocates them in the order of their first use, each in the lowest register
 * that is not taken. */
static int numbers_fall_into_place(const view *v) {
    const fp3_image *image = v->image;
    uint8_t taken[ASM_REGISTERS] = {0}, seen[ASM_REGISTERS] = {0};
    for (uint32_t i = 0; i < image->constant_count; i++)
        for (uint32_t j = 0; j < image->constant_count; j++)
            if (i != j && image->constants[i].bits == image->constants[j].bits &&
                v->numbers[FP3_BANK_SHARED_BASE + image->constants[i].index])
                return 0; /* the same bits twice: a number does not say which */
    /* Pass 0 finds what names and register numbers take, pass 1 allocates the numbers. */
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t i = 0; i < image->code_count; i++) {
            const fp3_decoded *word = &image->decoded[i];
            for (const char *letter = word->of ? word->of->operands : ""; *letter; letter++) {
                uint32_t operand = fp3_operand(&word->in, *letter);
                if (fp3_operation_counts(word->of, *letter))
                    continue;
                if (pass == 0 && !v->numbers[operand])
                    taken[operand] = 1;
                if (pass == 0 || !v->numbers[operand] || seen[operand])
                    continue;
                uint32_t place = FP3_BANK_SHARED_BASE;
                while (taken[place] || v->names[place])
                    place++;
                if (place != operand)
                    return 0;
                taken[place] = seen[place] = 1;
            }
        }
    for (uint32_t i = 0; i < ASM_REGISTERS; i++)
        if (v->numbers[i] && !seen[i])
            return 0;
    return 1;
}

static void write_declarations(const view *v, FILE *out) {
    char text[FP3_NUMBER_TEXT_SIZE], place[FP3_NAME_SIZE], words[FP3_WORDS_NAME_SIZE];
    if (v->image->words != FP3_WORDS_ANY)
        fprintf(out, ".words  %s\n", fp3_image_words_name(v->image->words, words));
    for (uint32_t i = 0; i < v->image->symbol_count; i++) {
        const fp3_symbol *s = &v->image->symbols[i];
        if (s->symbol_class == FP3_SYMBOL_LABEL)
            continue;
        int object = fp3_class_is_object(s->symbol_class);
        fprintf(out, ".%-6s %s = %c%u", fp3_class_name(s->symbol_class), s->name,
                object ? FP3_BANK_OBJECT_PREFIX : FP3_BANK_SHARED_PREFIX, s->index);
        if (s->symbol_class == FP3_SYMBOL_CONST) {
            fp3_number_text(*fp3_image_value(v->image, s->index), text);
            fprintf(out, " %s", text);
        }
        fputc('\n', out);
    }
    for (uint32_t i = 0; !v->write_numbers && i < ASM_REGISTERS; i++) {
        if (!v->numbers[i])
            continue;
        fp3_number_text(*v->numbers[i], text);
        fp3_asm_register_text(i, place);
        fprintf(out, ".const  %%%s %s\n", place, text);
    }
}

static void write_labels(const fp3_image *image, uint32_t place, FILE *out) {
    if (place == 0 && image->step > 0)
        fprintf(out, "first:\n");
    if (place == image->step)
        fprintf(out, "step:\n");
    if (place == image->last && place < image->code_count)
        fprintf(out, "last:\n");
    for (uint32_t i = 0; i < image->symbol_count; i++)
        if (image->symbols[i].symbol_class == FP3_SYMBOL_LABEL && image->symbols[i].index == place)
            fprintf(out, "%s:\n", image->symbols[i].name);
}

fp3_status fp3_disassemble(const fp3_image *image, char **text, fp3_error *error) {
    FP3_HOST;
    *text = NULL;
    view v = view_of(image);
    v.write_numbers = numbers_fall_into_place(&v);
    char *made = NULL, line[FP3_WORD_TEXT_SIZE];
    size_t size = 0;
    FILE *out = open_memstream(&made, &size);
    if (!out)
        return fp3_no_memory(error);
    write_declarations(&v, out);
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < image->code_count; i++) {
        write_labels(image, i, out);
        fp3_error why;
        status = word_text(&v, image->code[i], line, &why);
        if (status)
            fp3_fail(error, status, "code word %u: %s", i, why.text);
        else
            fprintf(out, "    %s\n", line);
    }
    write_labels(image, image->code_count, out);
    if (fclose(out) && !status)
        status = fp3_no_memory(error);
    if (status)
        free(made);
    else
        *text = made;
    return status;
}
