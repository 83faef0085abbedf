/* SPDX-License-Identifier: Apache-2.0 */
/* allocate.h - which register a name or a number has. */
#ifndef FP3_ASM_ALLOCATE_H
#define FP3_ASM_ALLOCATE_H

#include "source.h"

/* Gives a register to every name that has none, in the order of the declarations. Reports it if
 * there are too many names. */
void fp3_asm_allocate(asm_source *source);

/* The shared constant that holds these bits: the lowest one if the program declares several, a new
 * one if there is none. ASM_NOWHERE if all are taken. */
uint32_t fp3_asm_constant(asm_source *source, uint32_t bits);

/* Whether an operand names a register by its number, and which. */
int fp3_asm_raw_operand(const asm_source *source, fp3_token token, uint32_t *operand);

#endif
