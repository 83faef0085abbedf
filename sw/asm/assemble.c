/* The assembler: after the first pass (parse.c), which has read every line, the second gives
 * registers to names and numbers and encodes. So a name may be used before its line. */
#include <fp3/asm.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "assembler.h"

static uint32_t allocate(assembler *a, int object) {
    uint32_t base = object ? FP3_BANK_OBJECT_BASE : FP3_BANK_SHARED_BASE;
    uint32_t count = object ? FP3_BANK_OBJECT_COUNT : FP3_BANK_SHARED_COUNT;
    for (uint32_t i = base; i < base + count; i++)
        if (!a->taken[i]) {
            a->taken[i] = 1;
            return i;
        }
    return NOWHERE;
}

/* Whether an operand token names a register by its number. */
static int raw_operand(const assembler *a, token t, uint32_t *operand) {
    return (t.kind == TOKEN_RAW || (t.kind == TOKEN_NAME && !fp3_asm_find(a, t))) &&
           fp3_token_register(t, operand);
}

static void allocate_names(assembler *a) {
    int full[2] = {0};
    for (uint32_t i = 0; i < a->statement_count; i++)
        for (const token *t = a->statements[i].operands;
             t < a->statements[i].operands + OPERAND_LIMIT; t++) {
            uint32_t operand;
            if (t->length && raw_operand(a, *t, &operand) && operand != UINT32_MAX)
                a->taken[operand] = 1;
        }
    for (uint32_t i = 0; i < a->declaration_count; i++)
        if (a->declarations[i].operand != NOWHERE)
            a->taken[a->declarations[i].operand] = 1;
    for (uint32_t i = 0; i < a->declaration_count; i++) {
        declaration *d = &a->declarations[i];
        int object = fp3_class_is_object(d->symbol_class);
        if (d->operand == NOWHERE)
            d->operand = allocate(a, object);
        if (d->operand == NOWHERE) {
            if (!full[object])
                fp3_report_expected(&a->report, d->at, "no more than %d %s",
                                    object ? FP3_BANK_OBJECT_COUNT : FP3_BANK_SHARED_COUNT,
                                    object ? "object registers" : "shared constants");
            full[object] = 1;
            d->operand = object ? FP3_BANK_OBJECT_BASE : FP3_BANK_SHARED_BASE;
            continue;
        }
        if (d->symbol_class == FP3_SYMBOL_CONST)
            a->constants[a->constant_count++] =
                (fp3_constant){d->operand - FP3_BANK_SHARED_BASE, d->bits};
    }
}

/* The shared constant that holds these bits; the lowest, should the program declare several. */
static uint32_t constant_for(assembler *a, uint32_t bits) {
    uint32_t found = NOWHERE;
    for (uint32_t i = 0; i < a->constant_count; i++)
        if (a->constants[i].bits == bits && a->constants[i].index + FP3_BANK_SHARED_BASE < found)
            found = a->constants[i].index + FP3_BANK_SHARED_BASE;
    if (found == NOWHERE) {
        found = allocate(a, 0);
        if (found != NOWHERE)
            a->constants[a->constant_count++] = (fp3_constant){found - FP3_BANK_SHARED_BASE, bits};
    }
    return found;
}

static void undefined(assembler *a, token name) {
    for (unsigned i = 0; i < a->undefined_count; i++)
        if (fp3_token_same(a->undefined[i], name))
            return;
    if (a->undefined_count < REPORT_LIMIT)
        a->undefined[a->undefined_count++] = name;
    const char *near = NULL;
    char names[REGISTERS][FP3_NAME_SIZE] = {0};
    for (uint32_t i = 0; i < a->declaration_count; i++) {
        const token *at = &a->declarations[i].at;
        if (at->kind == TOKEN_NAME) {
            memcpy(names[i], at->text, at->length);
            fp3_report_nearest(name, names[i], &near);
        }
    }
    if (near)
        fp3_report_expected(&a->report, name, "a declared name; is it '%s'?", near);
    else
        fp3_report_expected(&a->report, name, "a declared name, a register or a number%s",
                            fp3_asm_find_label(a, name) ? " (this is a label)" : "");
}

/* The operand as in a word, NOWHERE after an error. only_object: NULL, or what an operand is for
 * that can be no shared constant. */
static uint32_t resolve(assembler *a, token t, const char *only_object) {
    char text[64];
    if (only_object)
        snprintf(text, sizeof text, "an object register %s", only_object);
    const declaration *declared = t.kind == TOKEN_NAME ? fp3_asm_find(a, t) : NULL;
    const char *expected = NULL;
    uint32_t operand = NOWHERE, bits = 0;
    if (declared) {
        operand = declared->operand;
    } else if (raw_operand(a, t, &operand)) {
        if (operand == UINT32_MAX)
            expected = "a register r0 to r63 or k0 to k63";
    } else if (t.kind == TOKEN_RAW) {
        expected = "a register as %r5 or %k5";
    } else if (t.kind == TOKEN_NUMBER || fp3_token_is(t, "inf") || fp3_token_is(t, "nan")) {
        expected = only_object ? text : fp3_token_number(t, &bits);
        if (!expected && (operand = constant_for(a, bits)) == NOWHERE)
            expected = "no more than 64 shared constants";
    } else {
        undefined(a, t);
        return NOWHERE;
    }
    if (!expected && only_object && !is_object(operand)) {
        strcat(text, " (this is a shared constant)");
        expected = text;
    }
    if (!expected)
        return operand;
    fp3_report_expected(&a->report, t, "%s", expected);
    return NOWHERE;
}

/* The messages above say so. */
_Static_assert(FP3_BANK_OBJECT_COUNT == 64 && FP3_BANK_SHARED_COUNT == 64 &&
                   FP3_BANK_OBJECT_PREFIX == 'r' && FP3_BANK_SHARED_PREFIX == 'k',
               "registers are r0 to r63 and k0 to k63");

/* One register of an object says whether it sleeps, and the host reads and writes it: d of every
 * sleep and lds. */
static void check_slept(assembler *a, token t, uint32_t operand) {
    if (a->slept_at.line) {
        if (operand != a->slept)
            fp3_report_expected(&a->report, t, "'%.*s', the program's sleep register (line %u)",
                                (int)a->slept_at.length, a->slept_at.text, a->slept_at.line);
        return;
    }
    for (uint32_t i = 0; i < a->declaration_count; i++) {
        const declaration *d = &a->declarations[i];
        if (d->operand == operand && d->symbol_class != FP3_SYMBOL_STATE) {
            fp3_report_expected(&a->report, t,
                                "a .state, or a register without a name, to sleep in (line %u "
                                "declares a .%s)",
                                d->at.line, fp3_class_name(d->symbol_class));
            return;
        }
    }
    a->slept = operand;
    a->slept_at = t;
}

static void encode(assembler *a, uint32_t *code) {
    for (uint32_t i = 0; i < a->statement_count && !fp3_report_full(&a->report); i++) {
        const statement *s = &a->statements[i];
        fp3_instruction word = {.op = s->operation->code};
        for (unsigned j = 0; s->operation->operands[j]; j++) {
            const char letter = s->operation->operands[j];
            const char *only_object = letter != 'd'          ? NULL
                                      : word.op == FP3_OP_ST ? "to store"
                                                             : "as destination";
            uint32_t operand = resolve(a, s->operands[j], only_object);
            if (operand == NOWHERE)
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

static fp3_status finish(assembler *a, fp3_assembly *result, fp3_error *error) {
    uint32_t *code = calloc((size_t)a->statement_count + 1, sizeof *code);
    fp3_symbol *symbols =
        calloc((size_t)a->declaration_count + a->label_count + 1, sizeof *symbols);
    result->lines = calloc((size_t)a->statement_count + 1, sizeof *result->lines);
    fp3_status status = FP3_OK;
    if (!code || !symbols || !result->lines || a->out_of_memory) {
        status = fp3_fail(error, FP3_E_SYSTEM, "out of memory");
        goto end;
    }
    if (!fp3_report_full(&a->report))
        allocate_names(a);
    encode(a, code);
    if (a->report.count > 0)
        goto end;
    uint32_t count = 0;
    for (uint32_t i = 0; i < a->declaration_count; i++) {
        const declaration *d = &a->declarations[i];
        if (d->at.kind != TOKEN_NAME)
            continue;
        uint32_t base = is_object(d->operand) ? FP3_BANK_OBJECT_BASE : FP3_BANK_SHARED_BASE;
        symbols[count].symbol_class = d->symbol_class;
        symbols[count].index = d->operand - base;
        memcpy(symbols[count++].name, d->at.text, d->at.length);
    }
    for (uint32_t i = 0; i < a->label_count; i++)
        symbols[count++] = a->labels[i];
    for (uint32_t i = 0; i < a->statement_count; i++)
        result->lines[i] = a->statements[i].operands[0].line;
    const fp3_image draft = {.code_count = a->statement_count,
                             .step = a->step_index,
                             .last = a->last_index,
                             .constant_count = a->constant_count,
                             .symbol_count = count,
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
    assembler *a = calloc(1, sizeof *a);
    if (!made || !a) {
        free(a);
        fp3_assembly_free(result);
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    }
    /* The program may have set a locale that reads 0.5 as 0. "C" is built in: no failure. */
    locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0), before = uselocale(c);
    a->report = (report){.name = name, .source = source, .size = size};
    fp3_lexer_open(&a->lexer, source, size);
    fp3_asm_parse(a);
    fp3_status status = finish(a, made, error);
    uselocale(before);
    freelocale(c);

    made->error_count = a->report.count;
    made->report = fp3_report_text(&a->report);
    if (!made->report) {
        status = fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    } else if (!status && a->report.count > 0) {
        status =
            fp3_fail(error, FP3_E_PROGRAM, "%.*s", (int)strcspn(made->report, "\n"), made->report);
    }
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
