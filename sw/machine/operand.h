/* SPDX-License-Identifier: Apache-2.0 */
/* operand.h - how operands are written: numbers, and registers by number. */
#ifndef FP3_ASM_OPERAND_H
#define FP3_ASM_OPERAND_H

#include <fp3/image.h>
#include <stdint.h>

#include "base/token.h"
#include <fp3/isa.h>

enum { ASM_REGISTERS = FP3_BANK_OBJECT_COUNT + FP3_BANK_SHARED_COUNT };
#define ASM_NOWHERE UINT32_MAX /* no operand */

/* The FP32 bits of a number. NULL, or what is expected instead: "a number" and so on. Needs the
 * locale "C" (base/number.h). */
const char *fp3_asm_number(fp3_token token, uint32_t *bits);

/* Whether the token is spelled like a register: r or k (after % in a raw one) and a number without
 * leading zeros. *operand is as in a word, or ASM_NOWHERE when the number is out of range. */
int fp3_asm_register(fp3_token token, uint32_t *operand);

/* An operand as in a word, as register: "r5", "k5". */
void fp3_asm_register_text(uint32_t operand, char text[FP3_NAME_SIZE]);

static inline int fp3_asm_is_object(uint32_t operand) { return operand < FP3_BANK_SHARED_BASE; }

static inline uint32_t fp3_asm_base(int is_object) {
    return is_object ? FP3_BANK_OBJECT_BASE : FP3_BANK_SHARED_BASE;
}

#endif
