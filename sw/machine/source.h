/* SPDX-License-Identifier: Apache-2.0 */
/* source.h - one assembly source between the two passes: what its lines say, then which registers
 * its names and numbers have. */
#ifndef FP3_ASM_SOURCE_H
#define FP3_ASM_SOURCE_H

#include "base/report.h"
#include "base/scanner.h"
#include "operand.h"
#include "operation.h"

enum { ASM_OPERAND_LIMIT = 4 };

typedef struct {
    fp3_token at;
    fp3_symbol_class symbol_class;
    uint32_t operand; /* as in a word; ASM_NOWHERE until it is allocated */
    uint32_t bits;    /* of a const */
} asm_declaration;

typedef struct {
    const fp3_operation *operation;
    fp3_token operands[ASM_OPERAND_LIMIT];
} asm_statement;

typedef struct {
    fp3_scanner scanner;
    fp3_token next;
    fp3_report report;
    int out_of_memory;

    /* The first pass. */
    asm_declaration *declarations; /* all but labels */
    asm_statement *statements;
    fp3_symbol *labels;
    fp3_token *label_tokens;
    uint32_t declaration_count, statement_count, label_count;
    fp3_token first, step, last; /* their labels, if they exist */
    uint32_t step_index, last_index;
    fp3_token words_at; /* the directive .words, if it exists */
    uint32_t words;     /* as fp3_image has them */

    /* The second pass. */
    uint8_t taken[ASM_REGISTERS]; /* by a name, a number, or an operand that names the register */
    fp3_constant constants[FP3_BANK_SHARED_COUNT];
    uint32_t constant_count;
    uint32_t slept; /* the sleep register, once slept_at exists */
    fp3_token slept_at;
    fp3_token undefined[FP3_REPORT_LIMIT]; /* each is reported once */
    unsigned undefined_count;
} asm_source;

/* What declares the name, or NULL. */
const asm_declaration *fp3_asm_find(const asm_source *source, fp3_token name);
const fp3_token *fp3_asm_find_label(const asm_source *source, fp3_token name);

#endif
