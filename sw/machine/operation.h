/* operation.h - the rows of isa/isa.toml as a table. */
#ifndef FP3_OPERATION_H
#define FP3_OPERATION_H

#include <fp3/image.h>
#include <stdint.h>

typedef struct {
    uint32_t code;
    const char *name;
    const char *operands; /* a letter each, in the order of the assembly language: "dab" */
} fp3_operation;

extern const fp3_operation fp3_operations[];
extern const unsigned fp3_operation_count;

/* By code; NULL if unknown. */
const fp3_operation *fp3_operation_find(uint32_t code);

/* The operand that a letter of `operands` stands for. */
static inline uint32_t fp3_operand(const fp3_instruction *word, char letter) {
    return letter == 'd' ? word->d : letter == 'a' ? word->a : letter == 'b' ? word->b : word->c;
}

#endif
