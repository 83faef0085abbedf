/* The first pass of the assembler: lines into declarations, labels and instructions. */
#include "assembler.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const declaration *fp3_asm_find(const assembler *a, token name) {
    for (uint32_t i = 0; i < a->declaration_count; i++)
        if (a->declarations[i].at.kind == TOKEN_NAME && fp3_token_same(a->declarations[i].at, name))
            return &a->declarations[i];
    return NULL;
}

const token *fp3_asm_find_label(const assembler *a, token name) {
    for (uint32_t i = 0; i < a->label_count; i++)
        if (fp3_token_same(a->label_tokens[i], name))
            return &a->label_tokens[i];
    return NULL;
}

static void advance(assembler *a) { a->next = fp3_lexer_next(&a->lexer); }

/* Room for one element behind the first count; NULL when out of memory. Arrays double: their
 * capacity is the next power of two. */
static void *grown(assembler *a, void *array, uint32_t count, size_t element) {
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

/* Whether the token can be a new name; reports if not. */
static int new_name(assembler *a, token name) {
    if (name.kind != TOKEN_NAME) {
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
    const declaration *other = fp3_asm_find(a, name);
    const token *label = fp3_asm_find_label(a, name);
    if (other || label) {
        fp3_report_expected(&a->report, name, "a new name (line %u declares this one)",
                            other ? other->at.line : label->line);
        return 0;
    }
    return 1;
}

/* "= r5" after a name. Returns 0 after reporting what the line cannot go on from. */
static int parse_fixed(assembler *a, declaration *made) {
    advance(a);
    int object = fp3_class_is_object(made->symbol_class);
    char prefix = object ? FP3_BANK_OBJECT_PREFIX : FP3_BANK_SHARED_PREFIX;
    int count = object ? FP3_BANK_OBJECT_COUNT : FP3_BANK_SHARED_COUNT;
    uint32_t operand;
    if (!fp3_token_register(a->next, &operand) || operand == UINT32_MAX ||
        is_object(operand) != object) {
        fp3_report_expected(&a->report, a->next, "a register %c0 to %c%d for a .%s", prefix, prefix,
                            count - 1, fp3_class_name(made->symbol_class));
        return 0;
    }
    made->operand = operand;
    return 1;
}

static int parse_declaration(assembler *a, fp3_symbol_class symbol_class) {
    declaration made = {.at = a->next, .symbol_class = symbol_class, .operand = NOWHERE};
    int unnamed = symbol_class == FP3_SYMBOL_CONST && made.at.kind == TOKEN_RAW;
    int good = 1, readable = 1;
    token fixed_at = made.at;
    if (unnamed) {
        if (!fp3_token_register(made.at, &made.operand) || made.operand == UINT32_MAX ||
            is_object(made.operand)) {
            fp3_report_expected(&a->report, made.at, "a shared constant %%k0 to %%k%d",
                                FP3_BANK_SHARED_COUNT - 1);
            return 0;
        }
        advance(a);
    } else {
        good = new_name(a, made.at);
        if (made.at.kind != TOKEN_NAME)
            return 0;
        advance(a);
        if (a->next.kind == TOKEN_EQUALS) {
            if (!parse_fixed(a, &made))
                return 0;
            fixed_at = a->next;
            advance(a);
        }
    }
    if (symbol_class == FP3_SYMBOL_CONST) {
        const char *expected = fp3_token_number(a->next, &made.bits);
        if (expected) /* the name counts all the same: its uses are right */
            fp3_report_expected(&a->report, a->next, "%s", expected);
        else
            advance(a);
        readable = !expected;
    }
    for (uint32_t i = 0; good && made.operand != NOWHERE && i < a->declaration_count; i++)
        if (a->declarations[i].operand == made.operand) {
            fp3_report_expected(&a->report, fixed_at,
                                "a register that is free (line %u takes this one)",
                                a->declarations[i].at.line);
            good = 0;
        }
    if (good && a->declaration_count < REGISTERS) {
        PUSH(a, a->declarations, a->declaration_count, made);
        a->declaration_count += !a->out_of_memory;
    } else if (good) {
        fp3_report_expected(&a->report, made.at, "no more than %d names", REGISTERS);
        return 0;
    }
    return readable;
}

static void parse_directive(assembler *a) {
    token directive = a->next;
    advance(a);
    for (fp3_symbol_class symbol_class = 0; symbol_class < FP3_SYMBOL_LABEL; symbol_class++) {
        char text[16];
        snprintf(text, sizeof text, ".%s", fp3_class_name(symbol_class));
        if (!fp3_token_is(directive, text))
            continue;
        do
            if (!parse_declaration(a, symbol_class))
                return;
        while (a->next.kind != TOKEN_END && !fp3_report_full(&a->report) && !a->out_of_memory);
        return;
    }
    fp3_report_expected(&a->report, directive, ".state, .param, .temp, .shared or .const");
}

static void parse_label(assembler *a, token name) {
    static const char *const words[] = {"first", "step", "last"};
    token *const marks[] = {&a->first, &a->step, &a->last};
    for (int i = 0; i < 3; i++) {
        if (!fp3_token_is(name, words[i]))
            continue;
        if (marks[i]->line) {
            fp3_report_expected(&a->report, name, "one '%s:' only (line %u has it)", words[i],
                                marks[i]->line);
            return;
        }
        *marks[i] = name;
        if (i == 1)
            a->step_index = a->statement_count;
        if (i == 2)
            a->last_index = a->statement_count;
        for (int later = i + 1; later < 3; later++)
            if (marks[later]->line) {
                fp3_report_expected(&a->report, name, "it before '%s:' (line %u)", words[later],
                                    marks[later]->line);
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

static int begins_operand(token t) {
    return t.kind == TOKEN_NAME || t.kind == TOKEN_RAW || t.kind == TOKEN_NUMBER;
}

static void parse_instruction(assembler *a, token mnemonic) {
    statement made = {0};
    for (unsigned i = 0; i < fp3_operation_count; i++)
        if (fp3_token_is(mnemonic, fp3_operations[i].name))
            made.operation = &fp3_operations[i];
    if (!made.operation) {
        const char *near = NULL;
        for (unsigned i = 0; i < fp3_operation_count; i++)
            fp3_report_nearest(mnemonic, fp3_operations[i].name, &near);
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
            if (a->next.kind != TOKEN_COMMA) {
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
    if (a->next.kind != TOKEN_END) {
        fp3_report_expected(&a->report, a->next, "end of line: %s", text);
        return;
    }
    if (a->statement_count == FP3_IMAGE_CODE_LIMIT) {
        fp3_report_expected(&a->report, mnemonic, "no more than %u instructions",
                            FP3_IMAGE_CODE_LIMIT);
        a->lexer.next = a->lexer.end; /* every line to come is one too many */
        return;
    }
    PUSH(a, a->statements, a->statement_count, made);
    a->statement_count += !a->out_of_memory;
}

static void parse_line(assembler *a) {
    advance(a);
    while (a->next.kind == TOKEN_NAME) {
        token name = a->next;
        advance(a);
        if (a->next.kind != TOKEN_COLON) {
            parse_instruction(a, name);
            return;
        }
        parse_label(a, name);
        advance(a);
    }
    if (a->next.kind == TOKEN_DIRECTIVE)
        parse_directive(a);
    else if (a->next.kind != TOKEN_END)
        fp3_report_expected(&a->report, a->next, "an instruction, a label or a directive");
}

void fp3_asm_parse(assembler *a) {
    do
        parse_line(a);
    while (!fp3_report_full(&a->report) && !a->out_of_memory && fp3_lexer_next_line(&a->lexer));
    if (fp3_report_full(&a->report))
        return;
    const token end = {.text = a->lexer.end,
                       .line = a->lexer.line,
                       .column = (unsigned)(a->lexer.end - a->lexer.line_start) + 1,
                       .kind = TOKEN_END_OF_FILE};
    if (!a->last.line)
        a->last_index = a->statement_count;
    if (!a->step.line)
        fp3_report_expected(&a->report, end, "the label 'step:' somewhere");
    else if (a->step_index == a->last_index && a->report.count == 0)
        fp3_report_expected(&a->report, a->last.line ? a->last : end,
                            "an instruction after 'step:' (line %u)", a->step.line);
}
