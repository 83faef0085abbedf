/* SPDX-License-Identifier: Apache-2.0 */
/* lexer.h - the words of the model language. A name may have a component: r.x is one token. */
#ifndef FP3_ODE_LEXER_H
#define FP3_ODE_LEXER_H

#include "base/scanner.h"

typedef struct {
    fp3_scanner scanner;
    unsigned depth; /* open ( and [: inside them the end of a line means nothing */
    int continues;  /* nor does it after an operator or a comma */
} ode_lexer;

void fp3_ode_lexer_open(ode_lexer *lexer, const char *source, size_t size);
fp3_token fp3_ode_next(ode_lexer *lexer);
/* The next token is the first one behind the line of this token. */
void fp3_ode_skip_line(ode_lexer *lexer, fp3_token token);
/* The next token is the first one of this token's line, with no bracket open. */
void fp3_ode_back_to_line(ode_lexer *lexer, fp3_token token);

#endif
