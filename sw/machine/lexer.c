/* SPDX-License-Identifier: Apache-2.0 */
#include "lexer.h"

#include <string.h>

/* strchr finds NUL in every string; fp3_asm_next knows. */
static int is_bad(char c) { return !fp3_is_word(c) && !strchr(" \t\r\n#;,:=.%+-", c); }

static const char *word_end(const fp3_scanner *s, const char *p) {
    while (fp3_is_word(fp3_scanner_at(s, p)))
        p++;
    return p;
}

static const char *number_end(const fp3_scanner *s, const char *p) {
    if (fp3_scanner_at(s, p) == '+' || fp3_scanner_at(s, p) == '-')
        p++;
    while (fp3_is_word(fp3_scanner_at(s, p)) || fp3_scanner_at(s, p) == '.') {
        char c = *p++ | 0x20;
        if ((c == 'e' || c == 'p') && (fp3_scanner_at(s, p) == '+' || fp3_scanner_at(s, p) == '-'))
            p++;
    }
    return p;
}

/* A name, or bits:0x3f800000. */
static const char *name_end(const fp3_scanner *s, const char *p, fp3_token_kind *kind) {
    const char *end = word_end(s, p);
    *kind = FP3_TOKEN_NAME;
    if (end - p != 4 || memcmp(p, "bits", 4) || fp3_scanner_at(s, end) != ':' ||
        !fp3_is_digit(fp3_scanner_at(s, end + 1)))
        return end;
    *kind = FP3_TOKEN_NUMBER;
    return number_end(s, end + 1);
}

fp3_token fp3_asm_next(fp3_scanner *s) {
    while (fp3_scanner_at(s, s->next) == ' ' || fp3_scanner_at(s, s->next) == '\t' ||
           fp3_scanner_at(s, s->next) == '\r')
        s->next++;
    const char *p = s->next;
    fp3_token t = fp3_scanner_token(s);
    const char first = fp3_scanner_at(s, p);
    if (first == '\n' || first == '#' || first == ';') {
        t.kind = FP3_TOKEN_END;
        return t;
    }
    if (first == ',' || first == ':' || first == '=') {
        t.kind = FP3_TOKEN_SYMBOL;
        p++;
    } else if (first == '%') {
        t.kind = FP3_TOKEN_RAW;
        p = word_end(s, p + 1);
    } else if (fp3_is_letter(first)) {
        p = name_end(s, p, &t.kind);
    } else if (first == '.' && fp3_is_letter(fp3_scanner_at(s, p + 1))) {
        t.kind = FP3_TOKEN_DIRECTIVE;
        p = word_end(s, p + 1);
    } else if (fp3_is_digit(first) || first == '.' || first == '+' || first == '-') {
        t.kind = FP3_TOKEN_NUMBER;
        p = number_end(s, p);
    } else {
        do
            p++;
        while (p < s->end && (*p == 0 || is_bad(*p)));
    }
    t.length = (size_t)(p - s->next);
    s->next = p;
    return t;
}

int fp3_asm_next_line(fp3_scanner *s) {
    const char *newline = fp3_scanner_newline(s);
    if (newline)
        fp3_scanner_new_line(s, newline + 1);
    return newline != NULL;
}
