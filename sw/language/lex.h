/* lex.h - the words of the model language: tokens of the kinds NAME (with a component: r.x),
 * NUMBER, SYMBOL, TEXT, END, END_OF_FILE and BAD. */
#ifndef FP3_LEX_H
#define FP3_LEX_H

#include "text/token.h"

typedef struct {
    const char *next, *end, *line_start;
    unsigned line;
    unsigned depth; /* of ( and [ that are open: a line's end is nothing there */
    int continues;  /* nor is it after an operator or a comma */
} ode_lexer;

void fp3_ode_open(ode_lexer *lexer, const char *source, size_t size);
token fp3_ode_next(ode_lexer *lexer);
/* The next token is the one behind the line of this one. */
void fp3_ode_skip_line(ode_lexer *lexer, token token);
/* The next token is the first of its line, with no bracket open. */
void fp3_ode_back_to_line(ode_lexer *lexer, token token);

/* NULL, or what is expected instead of this NUMBER. Needs the C locale. */
const char *fp3_ode_number(token token, double *value);
/* Whether a TEXT is UTF-8 without control characters. */
int fp3_ode_text_valid(token token);

#endif
