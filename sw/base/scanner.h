/* SPDX-License-Identifier: Apache-2.0 */
/* scanner.h - the bytes of a source, line by line. The lexers stand on it.
 *
 * The source needs no NUL at its end: whatever stands behind it reads as the end of a line.
 */
#ifndef FP3_SCANNER_H
#define FP3_SCANNER_H

#include "token.h"

typedef struct {
    const char *next, *end, *line_start;
    unsigned line;
} fp3_scanner;

/* At the first byte, behind a byte order mark. */
fp3_scanner fp3_scanner_open(const char *source, size_t size);
/* The line that begins at start becomes the next one. */
void fp3_scanner_new_line(fp3_scanner *scanner, const char *start);
/* The newline that ends this line; NULL in the last line. */
const char *fp3_scanner_newline(const fp3_scanner *scanner);
/* A token that begins at the next byte: empty and of kind BAD, until a lexer says more. */
fp3_token fp3_scanner_token(const fp3_scanner *scanner);

static inline char fp3_scanner_at(const fp3_scanner *s, const char *p) {
    return p < s->end ? *p : '\n';
}

static inline int fp3_is_digit(char c) { return c >= '0' && c <= '9'; }

static inline int fp3_is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static inline int fp3_is_word(char c) { return fp3_is_letter(c) || fp3_is_digit(c); }

#endif
