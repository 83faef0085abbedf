/* SPDX-License-Identifier: Apache-2.0 */
#include "cursor.h"

#include <assert.h>
#include <stdio.h>

#include "keyword.h"

void fp3_ode_open(ode_cursor *c, const char *source, size_t size, const char *name) {
    *c = (ode_cursor){.report = {.name = name, .source = source, .size = size}};
    fp3_ode_lexer_open(&c->lexer, source, size);
    c->next = fp3_ode_next(&c->lexer);
}

void fp3_ode_advance(ode_cursor *c) {
    if (!c->is_lost)
        c->next = fp3_ode_next(&c->lexer);
}

int fp3_ode_at(const ode_cursor *c, const char *text) { return fp3_token_is(c->next, text); }

int fp3_ode_at_end(const ode_cursor *c) {
    return c->next.kind == FP3_TOKEN_END || c->next.kind == FP3_TOKEN_END_OF_FILE;
}

int fp3_ode_accept(ode_cursor *c, const char *text) {
    if (!fp3_ode_at(c, text))
        return 0;
    fp3_ode_advance(c);
    return 1;
}

void fp3_ode_give_up(ode_cursor *c, fp3_token at) {
    if (c->is_lost)
        return;
    c->is_lost = 1;
    c->lost_at = at;
    c->next = (fp3_token){.text = at.text, .location = at.location, .kind = FP3_TOKEN_BAD};
}

static void report(ode_cursor *c, fp3_token at, const char *format, va_list arguments) {
    char text[256];
    if (c->is_lost || c->is_quiet)
        return;
    vsnprintf(text, sizeof text, format, arguments);
    if (*c->note)
        fp3_report_expected(&c->report, at, "%s (where %s)", text, c->note);
    else
        fp3_report_expected(&c->report, at, "%s", text);
}

void fp3_ode_wrong(ode_cursor *c, fp3_token at, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    report(c, at, format, arguments);
    va_end(arguments);
}

void fp3_ode_lost(ode_cursor *c, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    report(c, c->next, format, arguments);
    va_end(arguments);
    fp3_ode_give_up(c, c->next);
}

void fp3_ode_lost_at(ode_cursor *c, fp3_token at, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    report(c, at, format, arguments);
    va_end(arguments);
    fp3_ode_give_up(c, at);
}

void fp3_ode_expect(ode_cursor *c, const char *symbol, const char *format, ...) {
    if (fp3_ode_accept(c, symbol))
        return;
    va_list arguments;
    va_start(arguments, format);
    report(c, c->next, format, arguments);
    va_end(arguments);
    fp3_ode_give_up(c, c->next);
}

void fp3_ode_over(ode_cursor *c, fp3_token at, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    report(c, at, format, arguments);
    va_end(arguments);
    fp3_ode_give_up(c, at);
    c->is_over = 1;
}

/* The token behind the index "[...]" that begins with this one; without one, this one. */
static fp3_token behind_index(ode_lexer *at, fp3_token t) {
    if (!fp3_token_is(t, "["))
        return t;
    while (!fp3_token_is(t, "]") && t.kind != FP3_TOKEN_END_OF_FILE)
        t = fp3_ode_next(at);
    return fp3_ode_next(at);
}

/* Whether the line at which the lexer stands begins like a statement. */
static int begins_statement(ode_lexer at) {
    static const char *const behind[] = {"=", "'", "''"};
    fp3_token first = fp3_ode_next(&at);
    if (first.kind != FP3_TOKEN_NAME || fp3_ode_begins_statement(first))
        return first.kind == FP3_TOKEN_NAME;
    const fp3_token second = behind_index(&at, fp3_ode_next(&at));
    for (size_t i = 0; i < sizeof behind / sizeof *behind; i++)
        if (fp3_token_is(second, behind[i]))
            return 1;
    return 0;
}

void fp3_ode_recover(ode_cursor *c, unsigned line) {
    assert(c->is_lost);
    c->is_lost = 0;
    fp3_ode_back_to_line(&c->lexer, c->lost_at);
    /* Where a bracket was left open, the line of the error may be the next statement already. */
    if (c->lost_at.location.line == line || !begins_statement(c->lexer))
        fp3_ode_skip_line(&c->lexer, c->lost_at);
    c->next = fp3_ode_next(&c->lexer);
}
