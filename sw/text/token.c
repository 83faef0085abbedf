#include "token.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "isa.h"

static int is_digit(char c) { return c >= '0' && c <= '9'; }

static int is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static int is_word(char c) { return is_letter(c) || is_digit(c); }

static int is_other(char c) {
    return !is_word(c) && !strchr(" \t\r\n#;,:=.%+-", c); /* NUL is in every string: see its use */
}

void fp3_lexer_open(lexer *l, const char *source, size_t size) {
    if (size >= 3 && !memcmp(source, "\xef\xbb\xbf", 3)) { /* a byte order mark */
        source += 3;
        size -= 3;
    }
    *l = (lexer){.next = source, .end = source + size, .line_start = source, .line = 1};
}

/* What stands at p, or a line's end after the source's end. */
static char at(const lexer *l, const char *p) { return p < l->end ? *p : '\n'; }

static const char *number_end(const lexer *l, const char *p) {
    if (at(l, p) == '+' || at(l, p) == '-')
        p++;
    while (is_word(at(l, p)) || at(l, p) == '.') {
        char c = *p++ | 0x20;
        if ((c == 'e' || c == 'p') && (at(l, p) == '+' || at(l, p) == '-'))
            p++;
    }
    return p;
}

token fp3_lexer_next(lexer *l) {
    while (at(l, l->next) == ' ' || at(l, l->next) == '\t' || at(l, l->next) == '\r')
        l->next++;
    const char *p = l->next;
    token t = {
        .text = p, .line = l->line, .column = (unsigned)(p - l->line_start) + 1, .kind = TOKEN_BAD};
    char first = at(l, p);
    switch (first) {
    case '\n':
    case '#':
    case ';':
        t.kind = TOKEN_END;
        return t;
    case ',':
        t.kind = TOKEN_COMMA;
        p++;
        break;
    case ':':
        t.kind = TOKEN_COLON;
        p++;
        break;
    case '=':
        t.kind = TOKEN_EQUALS;
        p++;
        break;
    case '%':
        p++;
        while (is_word(at(l, p)))
            p++;
        t.kind = TOKEN_RAW;
        break;
    default:
        if (is_letter(first)) {
            while (is_word(at(l, p)))
                p++;
            t.kind = TOKEN_NAME;
            if (p - l->next == 4 && !memcmp(l->next, "bits", 4) && at(l, p) == ':' &&
                is_digit(at(l, p + 1))) {
                p = number_end(l, p + 1);
                t.kind = TOKEN_NUMBER;
            }
        } else if (first == '.' && is_letter(at(l, p + 1))) {
            p++;
            while (is_word(at(l, p)))
                p++;
            t.kind = TOKEN_DIRECTIVE;
        } else if (is_digit(first) || first == '.' || first == '+' || first == '-') {
            p = number_end(l, p);
            t.kind = TOKEN_NUMBER;
        } else {
            do
                p++;
            while (p < l->end && (*p == 0 || is_other(*p)));
        }
    }
    t.length = (size_t)(p - l->next);
    l->next = p;
    return t;
}

int fp3_lexer_next_line(lexer *l) {
    const char *newline = memchr(l->next, '\n', (size_t)(l->end - l->next));
    if (!newline)
        return 0;
    l->next = l->line_start = newline + 1;
    l->line++;
    return 1;
}

int fp3_token_is(token t, const char *text) {
    return strlen(text) == t.length && !memcmp(text, t.text, t.length);
}

int fp3_token_same(token a, token b) {
    return a.length == b.length && !memcmp(a.text, b.text, a.length);
}

const char *fp3_token_shown(token t, char text[TOKEN_SHOWN_SIZE]) {
    if (t.kind == TOKEN_END)
        return "end of line";
    if (t.kind == TOKEN_END_OF_FILE)
        return "end of file";
    size_t used = 0;
    text[used++] = '\'';
    for (size_t i = 0; i < t.length; i++) {
        if (used > TOKEN_SHOWN_SIZE - 12) {
            used += (size_t)sprintf(text + used, "...");
            break;
        }
        unsigned char c = (unsigned char)t.text[i];
        if (c >= ' ' && c < 0x7f)
            text[used++] = (char)c;
        else
            used += (size_t)sprintf(text + used, "\\x%02x", c);
    }
    text[used++] = '\'';
    text[used] = 0;
    return text;
}

static const char *bits_number(const char *text, uint32_t *bits) {
    static const char expected[] = "FP32 bits as bits:0x and one to eight hexadecimal digits";
    if (text[0] != '0' || text[1] != 'x')
        return expected;
    text += 2;
    size_t length = strspn(text, "0123456789abcdefABCDEF");
    if (length < 1 || length > 8 || text[length])
        return expected;
    *bits = (uint32_t)strtoul(text, NULL, 16);
    return NULL;
}

const char *fp3_token_number(token t, uint32_t *bits) {
    /* 200 digits are more than any FP32 value needs to be written exactly. */
    char text[256];
    if (t.length >= sizeof text)
        return "a number of fewer than 256 characters";
    memcpy(text, t.text, t.length);
    text[t.length] = 0;
    if (strlen(text) != t.length)
        return "a number";
    if (!strncmp(text, "bits:", 5))
        return bits_number(text + 5, bits);
    int negative = text[0] == '-';
    const char *unsigned_text = text + (text[0] == '-' || text[0] == '+');
    if (!strcmp(unsigned_text, "nan")) {
        *bits = 0x7fc00000u | (uint32_t)negative << 31;
        return NULL;
    }
    int infinite = !strcmp(unsigned_text, "inf");
    if (!infinite && !is_digit(*unsigned_text) && *unsigned_text != '.')
        return "a number";
    char *end = NULL;
    errno = 0;
    float value = strtof(text, &end);
    if (end == text || *end)
        return "a number";
    if (isinf(value) && !infinite)
        return "a number below 3.4028236e38, the end of FP32";
    if (value == 0 && errno == ERANGE)
        return "0 or a number above 7e-46, the start of FP32";
    memcpy(bits, &value, sizeof value);
    return NULL;
}

int fp3_token_register(token t, uint32_t *operand) {
    const char *p = t.text, *end = t.text + t.length;
    if (t.kind == TOKEN_RAW)
        p++;
    else if (t.kind != TOKEN_NAME)
        return 0;
    int object = p < end && *p == FP3_BANK_OBJECT_PREFIX,
        shared = p < end && *p == FP3_BANK_SHARED_PREFIX;
    if (!object && !shared)
        return 0;
    p++;
    if (p == end || (*p == '0' && end - p > 1))
        return 0;
    uint32_t number = 0;
    for (; p < end; p++) {
        if (!is_digit(*p))
            return 0;
        if (number < 1000)
            number = 10 * number + (uint32_t)(*p - '0');
    }
    if (number >= (object ? FP3_BANK_OBJECT_COUNT : FP3_BANK_SHARED_COUNT))
        *operand = UINT32_MAX;
    else
        *operand = number + (object ? FP3_BANK_OBJECT_BASE : FP3_BANK_SHARED_BASE);
    return 1;
}
