/* SPDX-License-Identifier: Apache-2.0 */
/* parse.h - the first pass of the assembler. */
#ifndef FP3_ASM_PARSE_H
#define FP3_ASM_PARSE_H

#include "source.h"

/* Reads every line into declarations, labels and statements, and reports what is wrong with the
 * lines. The scanner stands at the first one. */
void fp3_asm_parse(asm_source *source);

#endif
