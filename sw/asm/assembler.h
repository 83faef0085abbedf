/* assembler.h - one source between the two passes: what its lines say, then where names go. */
#ifndef FP3_ASSEMBLER_H
#define FP3_ASSEMBLER_H

#include "isa.h"
#include "machine/operation.h"
#include "text/report.h"
#include "text/token.h"

enum { OPERAND_LIMIT = 4, REGISTERS = FP3_BANK_OBJECT_COUNT + FP3_BANK_SHARED_COUNT };
#define NOWHERE UINT32_MAX

typedef struct {
    token at;
    fp3_symbol_class symbol_class;
    uint32_t operand; /* as in a word; NOWHERE until it is allocated */
    uint32_t bits;    /* of a const */
} declaration;

typedef struct {
    const fp3_operation *operation;
    token operands[OPERAND_LIMIT];
} statement;

typedef struct {
    lexer lexer;
    token next;
    report report;
    int out_of_memory;

    declaration *declarations; /* all but labels */
    statement *statements;
    fp3_symbol *labels;
    token *label_tokens;
    uint32_t declaration_count, statement_count, label_count;
    token first, step, last; /* line 0: not there */
    uint32_t step_index, last_index;

    uint8_t taken[REGISTERS]; /* by a name, a number, or an operand that names the register */
    fp3_constant constants[FP3_BANK_SHARED_COUNT];
    uint32_t constant_count;
    uint32_t slept;                /* the sleep register, once slept_at names it */
    token slept_at;                /* line 0: not yet */
    token undefined[REPORT_LIMIT]; /* each is reported once */
    unsigned undefined_count;
} assembler;

/* The first pass: fills in all up to last_index and reports what is wrong with the lines. */
void fp3_asm_parse(assembler *a);

/* What declares the name, or NULL. */
const declaration *fp3_asm_find(const assembler *a, token name);
const token *fp3_asm_find_label(const assembler *a, token name);

static inline int is_object(uint32_t operand) { return operand < FP3_BANK_SHARED_BASE; }

#endif
