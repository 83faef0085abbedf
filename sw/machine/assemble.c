/* SPDX-License-Identifier: Apache-2.0 */
/* assemble.c - the assembler. The first pass (parse.c) reads every line; the second gives registers
 * to names and numbers and encodes. So a name may be used before the line that declares it. */
#include <fp3/image.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "allocate.h"
#include "base/host.h"
#include "base/nearest.h"
#include "base/number.h"
#include "parse.h"

static void undefined(asm_source *a, fp3_token name) {
    for (unsigned i = 0; i < a->undefined_count; i++)
        if (fp3_token_same(a->undefined[i], name))
            return;
    if (a->undefined_count < FP3_REPORT_LIMIT)
        a->undefined[a->undefined_count++] = name;
    const char *near = NULL;
    char names[ASM_REGISTERS][FP3_NAME_SIZE] = {0};
    for (uint32_t i = 0; i < a->declaration_count; i++) {
        const fp3_token *at = &a->declarations[i].at;
        if (at->kind == FP3_TOKEN_NAME) {
            memcpy(names[i], at->text, at->length);
            fp3_nearest(name, names[i], &near);
        }
    }
    if (near)
        fp3_report_expected(&a->report, name, "a declared name; is it '%s'?", near);
    else
        fp3_report_expected(&a->report, name, "a declared name, a register or a number%s",
                            fp3_asm_find_label(a, name) ? " (this is a label)" : "");
}

/* The operand as in a word; ASM_NOWHERE after an error. only_object is NULL, or says why the
 * operand must be an object register: "to store". */
static uint32_t resolve(asm_source *a, fp3_token t, const char *only_object) {
    char text[64];
    if (only_object)
        snprintf(text, sizeof text, "an object register %s", only_object);
    const asm_declaration *declared = t.kind == FP3_TOKEN_NAME ? fp3_asm_find(a, t) : NULL;
    const char *expected = NULL;
    uint32_t operand = ASM_NOWHERE, bits = 0;
    if (declared) {
        operand = declared->operand;
    } else if (fp3_asm_raw_operand(a, t, &operand)) {
        if (operand == ASM_NOWHERE)
            expected = "a register r0 to r63 or k0 to k63";
    } else if (t.kind == FP3_TOKEN_RAW) {
        expected = "a register as %r5 or %k5";
    } else if (t.kind == FP3_TOKEN_NUMBER || fp3_token_is(t, "inf") || fp3_token_is(t, "nan")) {
        expected = only_object ? text : fp3_asm_number(t, &bits);
        if (!expected && (operand = fp3_asm_constant(a, bits)) == ASM_NOWHERE)
            expected = "no more than 64 shared constants";
    } else {
        undefined(a, t);
        return ASM_NOWHERE;
    }
    if (!expected && only_object && !fp3_asm_is_object(operand)) {
        strcat(text, " (this is a shared constant)");
        expected = text;
    }
    if (!expected)
        return operand;
    fp3_report_expected(&a->report, t, "%s", expected);
    return ASM_NOWHERE;
}

/* The messages above name these registers. */
_Static_assert(FP3_BANK_OBJECT_COUNT == 64 && FP3_BANK_SHARED_COUNT == 64 &&
                   FP3_BANK_OBJECT_PREFIX == 'r' && FP3_BANK_SHARED_PREFIX == 'k',
               "registers are r0 to r63 and k0 to k63");

/* Every sleep and lds of a program has the same d: the host reads and writes this one register to
 * see whether an object sleeps. */
static void check_slept(asm_source *a, fp3_token t, uint32_t operand) {
    if (fp3_token_exists(a->slept_at)) {
        if (operand != a->slept)
            fp3_report_expected(&a->report, t, "'%.*s', the program's sleep register (line %u)",
                                (int)a->slept_at.length, a->slept_at.text,
                                a->slept_at.location.line);
        return;
    }
    for (uint32_t i = 0; i < a->declaration_count; i++) {
        const asm_declaration *d = &a->declarations[i];
        if (d->operand == operand && d->symbol_class != FP3_SYMBOL_STATE) {
            fp3_report_expected(&a->report, t,
                                "a .state, or a register without a name, to sleep in (line %u "
                                "declares a .%s)",
                                d->at.location.line, fp3_class_name(d->symbol_class));
            return;
        }
    }
    a->slept = operand;
    a->slept_at = t;
}

/* Digits alone: it is no constant of the program. */
static uint32_t number_in(asm_source *a, fp3_token t, const fp3_operation *of) {
    const int is_field = of->gives == FP3_GIVES_FIELD || of->takes_field;
    const int is_from_0 = is_field || of->code == FP3_OP_HOLD;
    uint32_t number = 0;
    for (size_t i = 0; i < t.length && number < FP3_BANK_SHARED_BASE; i++)
        number = t.text[i] >= '0' && t.text[i] <= '9' ? 10 * number + (uint32_t)(t.text[i] - '0')
                                                      : FP3_BANK_SHARED_BASE;
    if (number < FP3_BANK_SHARED_BASE && (is_from_0 || number))
        return number;
    fp3_report_expected(&a->report, t,
                        is_field    ? "the number of a field, 0 to 63"
                        : is_from_0 ? "a number of words, 0 to 63"
                                    : "a number of times, 1 to 63");
    return ASM_NOWHERE;
}

static void encode(asm_source *a, uint32_t *code) {
    for (uint32_t i = 0; i < a->statement_count && !fp3_report_full(&a->report); i++) {
        const asm_statement *s = &a->statements[i];
        fp3_instruction word = {.op = s->operation->code};
        for (unsigned j = 0; s->operation->operands[j]; j++) {
            const char letter = s->operation->operands[j];
            const char *only_object = letter != 'd'                              ? NULL
                                      : s->operation->writes == FP3_WRITES_NEVER ? "to store"
                                                                                 : "as destination";
            uint32_t operand = fp3_operation_counts(s->operation, letter)
                                   ? number_in(a, s->operands[j], s->operation)
                                   : resolve(a, s->operands[j], only_object);
            if (operand == ASM_NOWHERE)
                continue;
            if (letter == 'd' && (word.op == FP3_OP_SLEEP || word.op == FP3_OP_LDS))
                check_slept(a, s->operands[j], operand);
            *(letter == 'd'   ? &word.d
              : letter == 'a' ? &word.a
              : letter == 'b' ? &word.b
                              : &word.c) = operand;
        }
        code[i] = fp3_word_encode(&word);
    }
}

static fp3_status finish(asm_source *a, fp3_assembly *result, fp3_error *error) {
    uint32_t *code = calloc((size_t)a->statement_count + 1, sizeof *code);
    fp3_symbol *symbols =
        calloc((size_t)a->declaration_count + a->label_count + 1, sizeof *symbols);
    result->lines = calloc((size_t)a->statement_count + 1, sizeof *result->lines);
    fp3_status status = FP3_OK;
    if (!code || !symbols || !result->lines || a->out_of_memory) {
        status = fp3_no_memory(error);
        goto end;
    }
    if (!fp3_report_full(&a->report))
        fp3_asm_allocate(a);
    encode(a, code);
    if (a->report.count > 0)
        goto end;
    uint32_t count = 0;
    for (uint32_t i = 0; i < a->declaration_count; i++) {
        const asm_declaration *d = &a->declarations[i];
        if (d->at.kind != FP3_TOKEN_NAME)
            continue;
        symbols[count].symbol_class = d->symbol_class;
        symbols[count].index = d->operand - fp3_asm_base(fp3_asm_is_object(d->operand));
        memcpy(symbols[count++].name, d->at.text, d->at.length);
    }
    for (uint32_t i = 0; i < a->label_count; i++)
        symbols[count++] = a->labels[i];
    for (uint32_t i = 0; i < a->statement_count; i++)
        result->lines[i] = a->statements[i].operands[0].location.line;
    const fp3_image draft = {.code_count = a->statement_count,
                             .step = a->step_index,
                             .last = a->last_index,
                             .constant_count = a->constant_count,
                             .symbol_count = count,
                             .words = a->words,
                             .code = code,
                             .constants = a->constants,
                             .symbols = symbols};
    status = fp3_image_make(&draft, &result->image, error);
end:
    free(code);
    free(symbols);
    return status;
}

fp3_status fp3_assemble(const char *source, size_t size, const char *name, fp3_assembly **result,
                        fp3_error *error) {
    fp3_assembly *made = calloc(1, sizeof *made);
    *result = made;
    asm_source *a = calloc(1, sizeof *a);
    if (!made || !a) {
        free(a);
        fp3_assembly_free(result);
        return fp3_no_memory(error);
    }
    FP3_HOST;
    a->report = (fp3_report){.name = name, .source = source, .size = size};
    a->scanner = fp3_scanner_open(source, size);
    fp3_asm_parse(a);
    fp3_status status = finish(a, made, error);

    made->error_count = a->report.count;
    if (!status && a->report.count > 0)
        status = fp3_report_fail(&a->report, &made->report, error);
    else if (!status && !(made->report = calloc(1, 1)))
        status = fp3_no_memory(error);
    free(a->declarations);
    free(a->statements);
    free(a->labels);
    free(a->label_tokens);
    free(a);
    if (status && status != FP3_E_PROGRAM)
        fp3_assembly_free(result);
    return status;
}

void fp3_assembly_free(fp3_assembly **result) {
    if (!result || !*result)
        return;
    fp3_image_free(&(*result)->image);
    free((*result)->lines);
    free((*result)->report);
    free(*result);
    *result = NULL;
}
