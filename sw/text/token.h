/* token.h - the words of a source, with their places, and the lexer of the assembly language. */
#ifndef FP3_TOKEN_H
#define FP3_TOKEN_H

#include <fp3/image.h>
#include <stddef.h>
#include <stdint.h>

typedef enum {
    TOKEN_END,         /* of the line */
    TOKEN_END_OF_FILE, /* only in messages */
    TOKEN_NAME,
    TOKEN_RAW,       /* %r5: a register by its number */
    TOKEN_NUMBER,    /* what should be one: it is not checked yet */
    TOKEN_DIRECTIVE, /* .state */
    TOKEN_COMMA,
    TOKEN_COLON,
    TOKEN_EQUALS,
    TOKEN_SYMBOL, /* of the model language: an operator, a bracket */
    TOKEN_TEXT,   /* likewise: "a text", with its quotes */
    TOKEN_BAD     /* bytes that begin nothing */
} token_kind;

typedef struct {
    const char *text; /* within the source, no NUL after it */
    size_t length;
    unsigned line, column; /* from 1 */
    token_kind kind;
} token;

typedef struct {
    const char *next, *end, *line_start;
    unsigned line;
} lexer;

void fp3_lexer_open(lexer *lexer, const char *source, size_t size);
/* The next token of this line; TOKEN_END as often as asked at its end. */
token fp3_lexer_next(lexer *lexer);
/* To the next line; 0 if there is none. */
int fp3_lexer_next_line(lexer *lexer);

int fp3_token_is(token token, const char *text);
int fp3_token_same(token a, token b);
/* As shown in a message: quoted, printable, not too long. */
#define TOKEN_SHOWN_SIZE 64
const char *fp3_token_shown(token token, char text[TOKEN_SHOWN_SIZE]);

/* NULL, or why the token is no number: "a number" and so on, to follow "expected". *bits is FP32.
 * Needs the C locale. */
const char *fp3_token_number(token token, uint32_t *bits);

/* Whether the token is spelled like a register: r or k (after % in a raw one) and a number without
 * leading zeros. *operand is as in a word, or UINT32_MAX when the number is out of range. */
int fp3_token_register(token token, uint32_t *operand);

#endif
