/* SPDX-License-Identifier: Apache-2.0 */
/* token.h - the words of a source, with their locations. Each language has a lexer of its own. */
#ifndef FP3_TOKEN_H
#define FP3_TOKEN_H

#include <stddef.h>

#include "location.h"

typedef enum {
    FP3_TOKEN_END, /* of a line */
    FP3_TOKEN_END_OF_FILE,
    FP3_TOKEN_NAME,
    FP3_TOKEN_NUMBER,    /* looks like one; it is not checked yet */
    FP3_TOKEN_SYMBOL,    /* an operator, a bracket, a comma ... */
    FP3_TOKEN_TEXT,      /* "a text", with its quotes: models only */
    FP3_TOKEN_RAW,       /* %r5, a register by its number: assembly only */
    FP3_TOKEN_DIRECTIVE, /* .state: assembly only */
    FP3_TOKEN_BAD        /* bytes that begin nothing */
} fp3_token_kind;

typedef struct {
    const char *text; /* within the source, no NUL after it */
    size_t length;
    fp3_location location;
    fp3_token_kind kind;
} fp3_token;

/* A token of zeros stands for none. */
static inline int fp3_token_exists(fp3_token token) { return token.location.line > 0; }

int fp3_token_is(fp3_token token, const char *text);
int fp3_token_same(fp3_token a, fp3_token b);

/* As a message shows it: quoted, printable, not too long. */
enum { FP3_TOKEN_SHOWN_SIZE = 64 };
const char *fp3_token_shown(fp3_token token, char text[FP3_TOKEN_SHOWN_SIZE]);

#endif
