/* SPDX-License-Identifier: Apache-2.0 */
#include "parse.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/nearest.h"
#include "lexer.h"

static void advance(asm_source *a) { a->next = fp3_asm_next(&a->scanner); }

/* The array with room for one element behind the first count; NULL when out of memory. The capacity
 * is not stored: it is count rounded up to a power of two. */
static void *grown(asm_source *a, void *array, uint32_t count, size_t element) {
    if (count & (count - 1) || a->out_of_memory) /* count is no power of two: there is room */
        return a->out_of_memory ? NULL : array;
    void *more = realloc(array, (count ? 2 * (size_t)count : 1) * element);
    if (!more)
        a->out_of_memory = 1;
    return more;
}

#define PUSH(a, array, count, ...)                                                                 \
    do {                                                                                           \
        void *more_ = grown(a, array, count, sizeof *(array));                                     \
        if (more_) {                                                                               \
            (array) = more_;                                                                       \
            (array)[(count)] = (__VA_ARGS__);                                                      \
        }                                                                                          \
    } while (0)

/* Whether the token can be a new name. Reports it if not. */
static int new_name(asm_source *a, fp3_token name) {
    if (name.kind != FP3_TOKEN_NAME) {
        fp3_report_expected(&a->report, name, "a name");
        return 0;
    }
    if (name.length >= FP3_NAME_SIZE) {
        fp3_report_expected(&a->report, name, "a name of at most %d characters", FP3_NAME_SIZE - 1);
        return 0;
    }
    char text[FP3_NAME_SIZE] = {0};
    memcpy(text, name.text, name.length);
    if (!fp3_name_valid(text)) {
        fp3_report_expected(&a->report, name, "a name ('%s' has a meaning of its own)", text);
        return 0;
    }
    const asm_declaration *other = fp3_asm_find(a, name);
    const fp3_token *label = fp3_asm_find_label(a, name);
    if (other || label) {
        fp3_report_expected(&a->report, name, "a new name (line %u declares this one)",
                            other ? other->at.location.line : label->location.line);
        return 0;
    }
    return 1;
}

/* "= r5" after a name. 0 after an error that ends the line. */
static int parse_fixed(asm_source *a, asm_declaration *made) {
    advance(a);
    int object = fp3_class_is_object(made->symbol_class);
    char prefix = object ? FP3_BANK_OBJECT_PREFIX : FP3_BANK_SHARED_PREFIX;
    int count = object ? FP3_BANK_OBJECT_COUNT : FP3_BANK_SHARED_COUNT;
    uint32_t operand;
    if (!fp3_asm_register(a->next, &operand) || operand == ASM_NOWHERE ||
        fp3_asm_is_object(operand) != object) {
        fp3_report_expected(&a->report, a->next, "a register %c0 to %c%d for a .%s", prefix, prefix,
                            count - 1, fp3_class_name(made->symbol_class));
        return 0;
    }
    made->operand = operand;
    return 1;
}

static int parse_declaration(asm_source *a, fp3_symbol_class symbol_class) {
    asm_declaration made = {.at = a->next, .symbol_class = symbol_class, .operand = ASM_NOWHERE};
    int unnamed = symbol_class == FP3_SYMBOL_CONST && made.at.kind == FP3_TOKEN_RAW;
    int good = 1, readable = 1;
    fp3_token fixed_at = made.at;
    if (unnamed) {
        if (!fp3_asm_register(made.at, &made.operand) || made.operand == ASM_NOWHERE ||
            fp3_asm_is_object(made.operand)) {
            fp3_report_expected(&a->report, made.at, "a shared constant %%k0 to %%k%d",
                                FP3_BANK_SHARED_COUNT - 1);
            return 0;
        }
        advance(a);
    } else {
        good = new_name(a, made.at);
        if (made.at.kind != FP3_TOKEN_NAME)
            return 0;
        advance(a);
        if (fp3_token_is(a->next, "=")) {
            if (!parse_fixed(a, &made))
                return 0;
            fixed_at = a->next;
            advance(a);
        }
    }
    if (good && !unnamed) {
        char text[FP3_NAME_SIZE] = {0};
        memcpy(text, made.at.text, made.at.length);
        const char *expected = fp3_name_expected(text, symbol_class);
        if (expected)
            fp3_report_expected(&a->report, made.at, "%s", expected);
    }
    if (symbol_class == FP3_SYMBOL_CONST) {
        const char *expected = fp3_asm_number(a->next, &made.bits);
        if (expected) /* the name is declared nevertheless, so its uses are right */
            fp3_report_expected(&a->report, a->next, "%s", expected);
        else
            advance(a);
        readable = !expected;
    }
    for (uint32_t i = 0; good && made.operand != ASM_NOWHERE && i < a->declaration_count; i++)
        if (a->declarations[i].operand == made.operand) {
            fp3_report_expected(&a->report, fixed_at,
                                "a register that is free (line %u takes this one)",
                                a->declarations[i].at.location.line);
            good = 0;
        }
    if (good && a->declaration_count < ASM_REGISTERS) {
        PUSH(a, a->declarations, a->declaration_count, made);
        a->declaration_count += !a->out_of_memory;
    } else if (good) {
        fp3_report_expected(&a->report, made.at, "no more than %d names", ASM_REGISTERS);
        return 0;
    }
    return readable;
}

static int names_kind(fp3_token token, uint32_t kind) {
    char name[FP3_WORDS_NAME_SIZE];
    return fp3_token_is(token, fp3_image_words_name(kind, name));
}

/* Fraction bits of a number; all, where none are told. */
static int parse_fraction(asm_source *a, uint32_t *fraction) {
    char text[16];
    *fraction = FP3_WORDS_FRACTION;
    if (a->next.kind == FP3_TOKEN_END)
        return 1;
    do
        snprintf(text, sizeof text, "%" PRIu32, --*fraction);
    while (*fraction >= FP3_WORDS_FRACTION_LEAST && !fp3_token_is(a->next, text));
    if (*fraction >= FP3_WORDS_FRACTION_LEAST) {
        advance(a);
        return 1;
    }
    fp3_report_expected(&a->report, a->next,
                        "a number of fraction bits from %d to %d, or the end of the line",
                        FP3_WORDS_FRACTION_LEAST, FP3_WORDS_FRACTION - 1);
    return 0;
}

/* ".words floats 7" */
static void parse_words(asm_source *a, fp3_token directive) {
    uint32_t words = FP3_WORDS_FLOATS, fraction;
    char name[FP3_WORDS_NAME_SIZE];
    if (fp3_token_exists(a->words_at)) {
        fp3_report_expected(&a->report, directive, "one '.words' only (line %u has it)",
                            a->words_at.location.line);
        return;
    }
    a->words_at = directive;
    while (words < FP3_WORDS_KINDS && !names_kind(a->next, words))
        words++;
    if (words == FP3_WORDS_KINDS) {
        fp3_report_expected(
            &a->report, a->next,
            "floats, logarithms, flushed, cell, truncated, truncated_flushed or mixed");
        return;
    }
    const fp3_token kind = a->next;
    advance(a);
    if (!parse_fraction(a, &fraction))
        return;
    a->words = words + FP3_WORDS_FEWER * (FP3_WORDS_FRACTION - fraction);
    if (!fp3_image_words_name(a->words, name)) {
        fp3_report_expected(&a->report, kind,
                            "floats, flushed, truncated or truncated_flushed before fraction bits");
        a->words = FP3_WORDS_ANY;
    } else if (a->next.kind != FP3_TOKEN_END) {
        fp3_report_expected(&a->report, a->next, "the end of the line");
    }
}

static void parse_directive(asm_source *a) {
    fp3_token directive = a->next;
    advance(a);
    if (fp3_token_is(directive, ".words")) {
        parse_words(a, directive);
        return;
    }
    for (fp3_symbol_class symbol_class = 0; symbol_class < FP3_SYMBOL_CLASSES; symbol_class++) {
        char text[16];
        snprintf(text, sizeof text, ".%s", fp3_class_name(symbol_class));
        if (symbol_class == FP3_SYMBOL_LABEL || !fp3_token_is(directive, text))
            continue;
        do
            if (!parse_declaration(a, symbol_class))
                return;
        while (a->next.kind != FP3_TOKEN_END && !fp3_report_full(&a->report) && !a->out_of_memory);
        return;
    }
    fp3_report_expected(&a->report, directive,
                        ".state, .param, .temp, .shared, .const, .worst or .words");
}

static void parse_label(asm_source *a, fp3_token name) {
    static const char *const words[] = {"first", "step", "last"};
    fp3_token *const marks[] = {&a->first, &a->step, &a->last};
    for (int i = 0; i < 3; i++) {
        if (!fp3_token_is(name, words[i]))
            continue;
        if (fp3_token_exists(*marks[i])) {
            fp3_report_expected(&a->report, name, "one '%s:' only (line %u has it)", words[i],
                                marks[i]->location.line);
            return;
        }
        *marks[i] = name;
        if (i == 1)
            a->step_index = a->statement_count;
        if (i == 2)
            a->last_index = a->statement_count;
        for (int later = i + 1; later < 3; later++)
            if (fp3_token_exists(*marks[later])) {
                fp3_report_expected(&a->report, name, "it before '%s:' (line %u)", words[later],
                                    marks[later]->location.line);
                return;
            }
        if (i == 0 && a->statement_count > 0)
            fp3_report_expected(&a->report, name, "it before the first instruction");
        return;
    }
    if (!new_name(a, name))
        return;
    if (a->label_count == FP3_IMAGE_LABEL_LIMIT) {
        fp3_report_expected(&a->report, name, "no more than %u labels", FP3_IMAGE_LABEL_LIMIT);
        return;
    }
    fp3_symbol label = {.symbol_class = FP3_SYMBOL_LABEL, .index = a->statement_count};
    memcpy(label.name, name.text, name.length);
    PUSH(a, a->labels, a->label_count, label);
    PUSH(a, a->label_tokens, a->label_count, name);
    a->label_count += !a->out_of_memory;
}

/* "add d, a, b" */
static const char *usage(const fp3_operation *operation, char text[32]) {
    int used = snprintf(text, 32, "%s ", operation->name);
    for (const char *letter = operation->operands; *letter; letter++)
        used += snprintf(text + used, 32 - (size_t)used,
                         letter == operation->operands ? "%c" : ", %c", *letter);
    return text;
}

static int begins_operand(fp3_token t) {
    return t.kind == FP3_TOKEN_NAME || t.kind == FP3_TOKEN_RAW || t.kind == FP3_TOKEN_NUMBER;
}

static void parse_instruction(asm_source *a, fp3_token mnemonic) {
    asm_statement made = {0};
    for (unsigned i = 0; i < fp3_operation_count; i++)
        if (fp3_token_is(mnemonic, fp3_operations[i].name))
            made.operation = &fp3_operations[i];
    if (!made.operation) {
        const char *near = NULL;
        for (unsigned i = 0; i < fp3_operation_count; i++)
            fp3_nearest(mnemonic, fp3_operations[i].name, &near);
        if (near)
            fp3_report_expected(&a->report, mnemonic, "an instruction; is it '%s'?", near);
        else
            fp3_report_expected(&a->report, mnemonic, "an instruction, a label or a directive");
        return;
    }
    char text[32];
    usage(made.operation, text);
    unsigned count = (unsigned)strlen(made.operation->operands);
    for (unsigned i = 0; i < count; i++) {
        if (i > 0) {
            if (!fp3_token_is(a->next, ",")) {
                fp3_report_expected(&a->report, a->next, "',' and operand %c: %s",
                                    made.operation->operands[i], text);
                return;
            }
            advance(a);
        }
        if (!begins_operand(a->next)) {
            fp3_report_expected(&a->report, a->next, "operand %c: %s", made.operation->operands[i],
                                text);
            return;
        }
        made.operands[i] = a->next;
        advance(a);
    }
    if (a->next.kind != FP3_TOKEN_END) {
        fp3_report_expected(&a->report, a->next, "end of line: %s", text);
        return;
    }
    if (a->statement_count == FP3_IMAGE_CODE_LIMIT) {
        fp3_report_expected(&a->report, mnemonic, "no more than %u instructions",
                            FP3_IMAGE_CODE_LIMIT);
        a->scanner.next = a->scanner.end; /* reads no further: every line would be one too many */
        return;
    }
    PUSH(a, a->statements, a->statement_count, made);
    a->statement_count += !a->out_of_memory;
}

static void parse_line(asm_source *a) {
    advance(a);
    while (a->next.kind == FP3_TOKEN_NAME) {
        fp3_token name = a->next;
        advance(a);
        if (!fp3_token_is(a->next, ":")) {
            parse_instruction(a, name);
            return;
        }
        parse_label(a, name);
        advance(a);
    }
    if (a->next.kind == FP3_TOKEN_DIRECTIVE)
        parse_directive(a);
    else if (a->next.kind != FP3_TOKEN_END)
        fp3_report_expected(&a->report, a->next, "an instruction, a label or a directive");
}

void fp3_asm_parse(asm_source *a) {
    do
        parse_line(a);
    while (!fp3_report_full(&a->report) && !a->out_of_memory && fp3_asm_next_line(&a->scanner));
    if (fp3_report_full(&a->report))
        return;
    a->scanner.next = a->scanner.end;
    fp3_token end = fp3_scanner_token(&a->scanner);
    end.kind = FP3_TOKEN_END_OF_FILE;
    if (!fp3_token_exists(a->last))
        a->last_index = a->statement_count;
    if (!fp3_token_exists(a->step))
        fp3_report_expected(&a->report, end, "the label 'step:' somewhere");
    else if (a->step_index == a->last_index && a->report.count == 0)
        fp3_report_expected(&a->report, fp3_token_exists(a->last) ? a->last : end,
                            "an instruction after 'step:' (line %u)", a->step.location.line);
}
