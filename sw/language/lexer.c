/* SPDX-License-Identifier: Apache-2.0 */
/* lexer.c - the end of a line ends a statement, unless the statement cannot end there. */
#include "lexer.h"

#include <string.h>

static int is_symbol(char c) { return c && strchr("+-*/^()[],=<>!?:'", c) != NULL; }

static int begins_nothing(char c) {
    return !fp3_is_word(c) && !is_symbol(c) && (!c || !strchr(" \t\r\n#\".", c));
}

void fp3_ode_lexer_open(ode_lexer *l, const char *source, size_t size) {
    *l = (ode_lexer){.scanner = fp3_scanner_open(source, size)};
}

static char at(const ode_lexer *l, const char *p) { return fp3_scanner_at(&l->scanner, p); }

/* To the next token or the end of a statement. */
static void skip_blank(ode_lexer *l) {
    fp3_scanner *s = &l->scanner;
    while (s->next < s->end) {
        if (*s->next == '#') {
            const char *newline = fp3_scanner_newline(s);
            s->next = newline ? newline : s->end;
        } else if (*s->next == '\n') {
            if (!l->depth && !l->continues)
                return;
            fp3_scanner_new_line(s, s->next + 1);
        } else if (*s->next == ' ' || *s->next == '\t' || *s->next == '\r') {
            s->next++;
        } else {
            return;
        }
    }
}

static const char *name_end(const ode_lexer *l, const char *p) {
    while (fp3_is_word(at(l, p)))
        p++;
    while (at(l, p) == '.' && fp3_is_letter(at(l, p + 1)))
        for (p++; fp3_is_word(at(l, p));)
            p++;
    return p;
}

static const char *number_end(const ode_lexer *l, const char *p) {
    while (fp3_is_word(at(l, p)) || (at(l, p) == '.' && at(l, p + 1) != '.')) {
        char c = *p++;
        if ((c == 'e' || c == 'E') && (at(l, p) == '+' || at(l, p) == '-'))
            p++;
    }
    return p;
}

static const char *text_end(const ode_lexer *l, const char *p, fp3_token_kind *kind) {
    for (p++; at(l, p) != '\n'; p++)
        if (*p == '"') {
            *kind = FP3_TOKEN_TEXT;
            return p + 1;
        }
    while (p[-1] == '\r' || p[-1] == ' ')
        p--;
    return p;
}

static const char *symbol_end(const ode_lexer *l, const char *p, fp3_token_kind *kind) {
    char first = *p++;
    *kind = FP3_TOKEN_SYMBOL;
    if (first == '\'')
        while (at(l, p) == '\'')
            p++;
    else if (strchr("<>=!", first) && at(l, p) == '=')
        p++;
    else if (first == '!')
        *kind = FP3_TOKEN_BAD;
    return p;
}

static int wants_more(fp3_token t) {
    if (t.kind == FP3_TOKEN_SYMBOL)
        return !strchr("()[]'", *t.text);
    return t.kind == FP3_TOKEN_NAME &&
           (fp3_token_is(t, "and") || fp3_token_is(t, "or") || fp3_token_is(t, "not"));
}

static void follow(ode_lexer *l, fp3_token t) {
    l->continues = wants_more(t);
    if (t.kind != FP3_TOKEN_SYMBOL)
        return;
    if (*t.text == '(' || *t.text == '[')
        l->depth++;
    else if ((*t.text == ')' || *t.text == ']') && l->depth)
        l->depth--;
}

fp3_token fp3_ode_next(ode_lexer *l) {
    skip_blank(l);
    fp3_scanner *s = &l->scanner;
    const char *p = s->next;
    fp3_token t = fp3_scanner_token(s);
    if (p == s->end) {
        t.kind = FP3_TOKEN_END_OF_FILE;
        return t;
    }
    if (*p == '\n') {
        t.kind = FP3_TOKEN_END;
        fp3_scanner_new_line(s, p + 1);
        return t;
    }
    if (fp3_is_letter(*p)) {
        t.kind = FP3_TOKEN_NAME;
        p = name_end(l, p);
    } else if (fp3_is_digit(*p) || (*p == '.' && fp3_is_digit(at(l, p + 1)))) {
        t.kind = FP3_TOKEN_NUMBER;
        p = number_end(l, p);
    } else if (*p == '"') {
        p = text_end(l, p, &t.kind);
    } else if (is_symbol(*p)) {
        p = symbol_end(l, p, &t.kind);
    } else if (*p == '.' && at(l, p + 1) == '.') {
        t.kind = FP3_TOKEN_SYMBOL;
        p += 2;
    } else {
        for (p++; p < s->end && begins_nothing(*p);)
            p++;
    }
    t.length = (size_t)(p - s->next);
    s->next = p;
    follow(l, t);
    return t;
}

void fp3_ode_back_to_line(ode_lexer *l, fp3_token t) {
    l->scanner.next = l->scanner.line_start = t.text - (t.location.column - 1);
    l->scanner.line = t.location.line;
    l->depth = 0;
    l->continues = 0;
}

void fp3_ode_skip_line(ode_lexer *l, fp3_token t) {
    fp3_ode_back_to_line(l, t);
    const char *newline = fp3_scanner_newline(&l->scanner);
    if (newline)
        fp3_scanner_new_line(&l->scanner, newline + 1);
    else
        l->scanner.next = l->scanner.end;
}
