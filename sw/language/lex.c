/* lex.c - source bytes to tokens. A line ends a statement unless it cannot end there. */
#include "lex.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int is_digit(char c) { return c >= '0' && c <= '9'; }

static int is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static int is_word(char c) { return is_letter(c) || is_digit(c); }

static int is_symbol(char c) { return c && strchr("+-*/^()[],=<>!?:'", c) != NULL; }

static int begins_nothing(char c) {
    return !is_word(c) && !is_symbol(c) && (!c || !strchr(" \t\r\n#\".", c));
}

void fp3_ode_open(ode_lexer *l, const char *source, size_t size) {
    if (size >= 3 && !memcmp(source, "\xef\xbb\xbf", 3)) { /* a byte order mark */
        source += 3;
        size -= 3;
    }
    *l = (ode_lexer){.next = source, .end = source + size, .line_start = source, .line = 1};
}

static char at(const ode_lexer *l, const char *p) { return p < l->end ? *p : '\n'; }

static void new_line(ode_lexer *l, const char *start) {
    l->next = l->line_start = start;
    l->line++;
}

/* To the next token or the end of a statement. */
static void skip_blank(ode_lexer *l) {
    for (; l->next < l->end; l->next++) {
        if (*l->next == '#') {
            const char *newline = memchr(l->next, '\n', (size_t)(l->end - l->next));
            l->next = newline ? newline : l->end;
            if (!newline)
                return;
        }
        if (*l->next == '\n') {
            if (!l->depth && !l->continues)
                return;
            new_line(l, l->next + 1);
            l->next--;
        } else if (!strchr(" \t\r", *l->next) || !*l->next) {
            return;
        }
    }
}

static const char *name_end(const ode_lexer *l, const char *p) {
    while (is_word(at(l, p)))
        p++;
    if (at(l, p) == '.' && is_letter(at(l, p + 1)))
        for (p++; is_word(at(l, p));)
            p++;
    return p;
}

static const char *number_end(const ode_lexer *l, const char *p) {
    while (is_word(at(l, p)) || at(l, p) == '.') {
        char c = *p++;
        if ((c == 'e' || c == 'E') && (at(l, p) == '+' || at(l, p) == '-'))
            p++;
    }
    return p;
}

static const char *text_end(const ode_lexer *l, const char *p, token_kind *kind) {
    for (p++; at(l, p) != '\n'; p++)
        if (*p == '"') {
            *kind = TOKEN_TEXT;
            return p + 1;
        }
    while (p[-1] == '\r' || p[-1] == ' ')
        p--;
    return p;
}

static const char *symbol_end(const ode_lexer *l, const char *p, token_kind *kind) {
    char first = *p++;
    *kind = TOKEN_SYMBOL;
    if (first == '\'')
        while (at(l, p) == '\'')
            p++;
    else if (strchr("<>=!", first) && at(l, p) == '=')
        p++;
    else if (first == '!')
        *kind = TOKEN_BAD;
    return p;
}

static int wants_more(token t) {
    if (t.kind == TOKEN_SYMBOL)
        return !strchr("()[]'", *t.text);
    return t.kind == TOKEN_NAME &&
           (fp3_token_is(t, "and") || fp3_token_is(t, "or") || fp3_token_is(t, "not"));
}

static void follow(ode_lexer *l, token t) {
    l->continues = wants_more(t);
    if (t.kind != TOKEN_SYMBOL)
        return;
    if (*t.text == '(' || *t.text == '[')
        l->depth++;
    else if ((*t.text == ')' || *t.text == ']') && l->depth)
        l->depth--;
}

token fp3_ode_next(ode_lexer *l) {
    skip_blank(l);
    const char *p = l->next;
    token t = {
        .text = p, .line = l->line, .column = (unsigned)(p - l->line_start) + 1, .kind = TOKEN_BAD};
    if (p == l->end) {
        t.kind = TOKEN_END_OF_FILE;
        return t;
    }
    if (*p == '\n') {
        t.kind = TOKEN_END;
        new_line(l, p + 1);
        return t;
    }
    if (is_letter(*p)) {
        t.kind = TOKEN_NAME;
        p = name_end(l, p);
    } else if (is_digit(*p) || (*p == '.' && is_digit(at(l, p + 1)))) {
        t.kind = TOKEN_NUMBER;
        p = number_end(l, p);
    } else if (*p == '"') {
        p = text_end(l, p, &t.kind);
    } else if (is_symbol(*p)) {
        p = symbol_end(l, p, &t.kind);
    } else {
        for (p++; p < l->end && begins_nothing(*p);)
            p++;
    }
    t.length = (size_t)(p - l->next);
    l->next = p;
    follow(l, t);
    return t;
}

void fp3_ode_back_to_line(ode_lexer *l, token t) {
    l->next = l->line_start = t.text - (t.column - 1);
    l->line = t.line;
    l->depth = 0;
    l->continues = 0;
}

void fp3_ode_skip_line(ode_lexer *l, token t) {
    fp3_ode_back_to_line(l, t);
    const char *newline = memchr(t.text, '\n', (size_t)(l->end - t.text));
    if (newline)
        new_line(l, newline + 1);
    else
        l->next = l->end;
}

static int is_decimal(const char *p) {
    size_t before = strspn(p, "0123456789"), after = 0;
    p += before;
    if (*p == '.') {
        after = strspn(p + 1, "0123456789");
        p += 1 + after;
    }
    if (before + after == 0)
        return 0;
    if (*p == 'e' || *p == 'E') {
        p += 1 + (p[1] == '+' || p[1] == '-');
        if (!is_digit(*p))
            return 0;
        p += strspn(p, "0123456789");
    }
    return !*p;
}

const char *fp3_ode_number(token t, double *value) {
    char text[256];
    if (t.length >= sizeof text)
        return "a number of fewer than 256 characters";
    memcpy(text, t.text, t.length);
    text[t.length] = 0;
    if (!is_decimal(text))
        return "a number as 2, 0.5 or 1.5e-3";
    errno = 0;
    *value = strtod(text, NULL);
    if (isinf(*value))
        return "a number below 1.8e308, the end of double";
    if (*value == 0 && errno == ERANGE)
        return "0 or a number above 4.9e-324, the start of double";
    return NULL;
}

/* Bytes of the character at p, 0 if it is none or controls something. */
static size_t character(const unsigned char *p, size_t room) {
    if (*p < 0x80)
        return *p >= ' ' && *p != 0x7f;
    size_t length = *p >= 0xf0 ? 4 : *p >= 0xe0 ? 3 : 2;
    if (*p < 0xc2 || *p > 0xf4 || length > room)
        return 0;
    for (size_t i = 1; i < length; i++)
        if ((p[i] & 0xc0) != 0x80)
            return 0;
    unsigned second = p[1];
    if ((*p == 0xc2 && second < 0xa0) || (*p == 0xe0 && second < 0xa0) ||
        (*p == 0xed && second > 0x9f) || (*p == 0xf0 && second < 0x90) ||
        (*p == 0xf4 && second > 0x8f))
        return 0;
    return length;
}

int fp3_ode_text_valid(token t) {
    for (size_t i = 0; i < t.length;) {
        size_t length = character((const unsigned char *)t.text + i, t.length - i);
        if (!length)
            return 0;
        i += length;
    }
    return 1;
}
