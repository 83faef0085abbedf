/* SPDX-License-Identifier: Apache-2.0 */
/* lexer.h - the words of the assembly language. */
#ifndef FP3_ASM_LEXER_H
#define FP3_ASM_LEXER_H

#include "base/scanner.h"

/* The next token of this line; at the end of the line FP3_TOKEN_END, as often as asked. */
fp3_token fp3_asm_next(fp3_scanner *scanner);
/* Goes to the next line; 0 if there is none. */
int fp3_asm_next_line(fp3_scanner *scanner);

#endif
