/* SPDX-License-Identifier: Apache-2.0 */
#include "spelled.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scanner.h"

enum {
    DEPTH_MOST = 16,     /* libconfig descends into itself */
    SETTINGS_MOST = 1024 /* of one group: libconfig compares each new name with all of it */
};

typedef struct {
    fp3_scanner in;
    const char *name; /* of the source */
    FILE *out;
    fp3_spelled *made;
    size_t room;
    unsigned depth, settings[DEPTH_MOST + 1]; /* of the group at each depth */
    fp3_error *error;
} writer;

static char at(const writer *w, size_t ahead) {
    return w->in.next + ahead < w->in.end ? w->in.next[ahead] : '\0';
}

__attribute__((format(printf, 3, 4))) static fp3_status wrong(const writer *w, unsigned line,
                                                              const char *format, ...) {
    char text[400];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return fp3_fail_at(w->error, FP3_E_ARGUMENT, w->name, line, 0, "%s", text);
}

/* The next count bytes go out unchanged. */
static void copy(writer *w, size_t count) {
    for (; count > 0; count--) {
        const char *p = w->in.next++;
        fputc(*p, w->out);
        if (*p == '\n')
            fp3_scanner_new_line(&w->in, w->in.next);
    }
}

/* ---- what is copied ---- */

static fp3_status copy_comment(writer *w) {
    const unsigned line = w->in.line;
    copy(w, 2);
    while (w->in.next < w->in.end && !(at(w, 0) == '*' && at(w, 1) == '/'))
        copy(w, 1);
    if (w->in.next == w->in.end)
        return wrong(w, line, "found a comment without an end, expected '*/'");
    copy(w, 2);
    return FP3_OK;
}

static void copy_line(writer *w) {
    while (w->in.next < w->in.end && at(w, 0) != '\n')
        copy(w, 1);
}

static fp3_status copy_text(writer *w) {
    const unsigned line = w->in.line;
    copy(w, 1);
    while (w->in.next < w->in.end && at(w, 0) != '"')
        copy(w, at(w, 0) == '\\' && w->in.next + 1 < w->in.end ? 2 : 1);
    if (w->in.next == w->in.end)
        return wrong(w, line, "found a text without an end, expected '\"'");
    copy(w, 1);
    return FP3_OK;
}

static void copy_name(writer *w) {
    do
        copy(w, 1);
    while (fp3_is_word(at(w, 0)) || at(w, 0) == '-' || at(w, 0) == '*');
}

/* ---- groups and lists ---- */

static fp3_status open_group(writer *w) {
    if (w->depth == DEPTH_MOST)
        return wrong(w, w->in.line, "expected groups and lists within each other at most %d deep",
                     DEPTH_MOST);
    w->settings[++w->depth] = 0;
    copy(w, 1);
    return FP3_OK;
}

/* One too many is a syntax error, which libconfig tells. */
static fp3_status close_group(writer *w) {
    w->depth -= w->depth > 0;
    copy(w, 1);
    return FP3_OK;
}

static fp3_status count_setting(writer *w) {
    if (++w->settings[w->depth] > SETTINGS_MOST)
        return wrong(w, w->in.line, "expected at most %d settings in a group", SETTINGS_MOST);
    copy(w, 1);
    return FP3_OK;
}

/* ---- numbers ---- */

static int begins_number(const writer *w) {
    const size_t sign = at(w, 0) == '-' || at(w, 0) == '+';
    return fp3_is_digit(at(w, sign)) || at(w, sign) == '.';
}

/* All that looks like a part of it: what is no number is refused as a whole. */
static size_t number_length(const writer *w) {
    const char exponent = at(w, 0) == '0' && (at(w, 1) | 0x20) == 'x' ? 'p' : 'e';
    size_t length = 1;
    while (
        fp3_is_word(at(w, length)) || at(w, length) == '.' ||
        ((at(w, length - 1) | 0x20) == exponent && (at(w, length) == '-' || at(w, length) == '+')))
        length++;
    return length;
}

static fp3_status replace_number(writer *w) {
    fp3_spelled *made = w->made;
    fp3_token number = fp3_scanner_token(&w->in);
    number.kind = FP3_TOKEN_NUMBER;
    number.length = number_length(w);
    if (made->count == w->room) {
        w->room = w->room ? 2 * w->room : 64;
        fp3_token *more = realloc(made->numbers, w->room * sizeof *more);
        if (!more)
            return fp3_no_memory(w->error);
        made->numbers = more;
    }
    fprintf(w->out, " %zu ", made->count); /* not a part of what stands beside it */
    made->numbers[made->count++] = number;
    w->in.next += number.length;
    return FP3_OK;
}

/* ---- all ---- */

static fp3_status write_next(writer *w) {
    const char c = at(w, 0);
    if (c == '@')
        return wrong(
            w, w->in.line,
            "found '@', expected settings: @include is not read, a file stands for itself");
    if (c == '"')
        return copy_text(w);
    if (c == '/' && at(w, 1) == '*')
        return copy_comment(w);
    if (c == '{' || c == '(' || c == '[')
        return open_group(w);
    if (c == '}' || c == ')' || c == ']')
        return close_group(w);
    if (c == '=' || c == ':')
        return count_setting(w);
    if (begins_number(w))
        return replace_number(w);
    if (c == '#' || (c == '/' && at(w, 1) == '/'))
        copy_line(w);
    else if (fp3_is_letter(c) || c == '*')
        copy_name(w);
    else
        copy(w, 1);
    return FP3_OK;
}

/* libconfig would take it for the end. */
static fp3_status check_nul(writer *w) {
    if (memchr(w->in.next, '\0', (size_t)(w->in.end - w->in.next)) == NULL)
        return FP3_OK;
    unsigned line = 1;
    for (const char *p = w->in.next; *p; p++)
        line += *p == '\n';
    return wrong(w, line, "found a NUL byte, expected text");
}

fp3_status fp3_spelled_open(const char *source, size_t size, const char *name, fp3_spelled *made,
                            fp3_error *error) {
    size_t written = 0;
    *made = (fp3_spelled){0};
    writer w = {.in = fp3_scanner_open(source, size), .name = name, .made = made, .error = error};
    w.out = open_memstream(&made->text, &written);
    if (!w.out)
        return fp3_no_memory(error);
    fp3_status status = check_nul(&w);
    while (!status && w.in.next < w.in.end)
        status = write_next(&w);
    fputc('\n', w.out); /* libconfig wants one behind a comment */
    const int is_bad = ferror(w.out);
    if (fclose(w.out) || is_bad)
        status = status ? status : fp3_no_memory(error);
    return status;
}

void fp3_spelled_close(fp3_spelled *spelled) {
    free(spelled->text);
    free(spelled->numbers);
    *spelled = (fp3_spelled){0};
}
