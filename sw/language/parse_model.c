/* parse_model.c - a source from its first token to what only its end can tell. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "parse.h"

void fp3_ode_start(ode_parser *p, const char *source, size_t size, const char *name) {
    p->report = (report){.name = name, .source = source, .size = size};
    fp3_ode_open(&p->lexer, source, size);
    p->next = fp3_ode_next(&p->lexer);
}

void fp3_ode_advance(ode_parser *p) {
    if (!p->is_lost)
        p->next = fp3_ode_next(&p->lexer);
}

int fp3_ode_at(const ode_parser *p, const char *text) { return fp3_token_is(p->next, text); }

int fp3_ode_accept(ode_parser *p, const char *text) {
    if (!fp3_ode_at(p, text))
        return 0;
    fp3_ode_advance(p);
    return 1;
}

void fp3_ode_give_up(ode_parser *p, token at) {
    if (p->is_lost)
        return;
    p->is_lost = 1;
    p->lost_at = at;
    p->next = (token){.text = at.text, .line = at.line, .column = at.column, .kind = TOKEN_BAD};
}

void fp3_ode_lost(ode_parser *p, const char *format, ...) {
    char text[200];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    fp3_ode_wrong(p, p->next, "%s", text);
    fp3_ode_give_up(p, p->next);
}

void fp3_ode_over(ode_parser *p, token at, const char *format, ...) {
    char text[200];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    fp3_ode_wrong(p, at, "%s", text);
    fp3_ode_give_up(p, at);
    p->is_over = 1;
}

void fp3_ode_expect_end(ode_parser *p) {
    if (p->next.kind != TOKEN_END && p->next.kind != TOKEN_END_OF_FILE)
        fp3_ode_lost(p, "an operator or the end of the line");
}

/* Whether the line that the lexer stands at begins like a statement. */
static int begins_statement(ode_lexer at) {
    static const char *const behind[] = {"=", "'", "''"};
    token first = fp3_ode_next(&at);
    if (first.kind != TOKEN_NAME || fp3_ode_begins_statement(first))
        return first.kind == TOKEN_NAME;
    token second = fp3_ode_next(&at);
    for (size_t i = 0; i < sizeof behind / sizeof *behind; i++)
        if (fp3_token_is(second, behind[i]))
            return 1;
    return 0;
}

/* Where a bracket was left open, the line of the error may be the next statement. */
static void find_next_statement(ode_parser *p, unsigned line) {
    token at = p->lost_at;
    p->is_lost = 0;
    fp3_ode_back_to_line(&p->lexer, at);
    if (at.line == line || !begins_statement(p->lexer))
        fp3_ode_skip_line(&p->lexer, at);
    p->next = fp3_ode_next(&p->lexer);
}

/* The state that alone is the derivative of a state, or FP3_NONE. */
static uint32_t bare_state(const ode_parser *p, const ode_equation *e) {
    if (!e->at.line || e->expr == FP3_NONE || p->exprs[e->expr].op != FP3_EXPR_STATE)
        return FP3_NONE;
    return p->exprs[e->expr].index;
}

/* s'' = e where s' = v: v' = e. */
static void resolve_second(ode_parser *p, ode_quantity *s) {
    uint32_t v = bare_state(p, &s->first);
    if (v == FP3_NONE) {
        if (!s->first.at.line || s->first.expr != FP3_NONE)
            fp3_ode_wrong(p, s->second.at,
                          "an equation %s' = v as well, where v is a state: %s'' is then v'",
                          s->quantity.name, s->quantity.name);
    } else if (p->states[v].first.at.line) {
        fp3_ode_wrong(p, s->second.at, "no second equation for '%s' (line %u has one)",
                      p->states[v].quantity.name, p->states[v].first.at.line);
    } else {
        p->states[v].first = s->second;
    }
}

static void finish_states(ode_parser *p) {
    const char *last_missing = NULL;
    for (uint32_t i = 0; i < p->state_count; i++)
        if (p->states[i].second.at.line)
            resolve_second(p, &p->states[i]);
    for (uint32_t i = 0; i < p->state_count; i++) {
        ode_quantity *s = &p->states[i];
        if (!s->first.at.line && s->at.text != last_missing) {
            fp3_ode_wrong(p, s->at, "an equation for this state, %s' = ...", s->quantity.name);
            last_missing = s->at.text;
        }
        uint32_t v = bare_state(p, &s->first);
        s->quantity.derivative = s->first.expr;
        s->quantity.velocity = v == i ? FP3_NONE : v;
        s->quantity.exact = s->exact.at.line ? s->exact.expr : FP3_NONE;
    }
}

static void finish(ode_parser *p) {
    fp3_ode_check_units(p, 0);
    fp3_ode_check_equations(p);
    finish_states(p);
    if (!p->state_count)
        fp3_ode_wrong(p, p->next, "a state, as in: state v = 0");
    if (!p->step.at.line)
        fp3_ode_wrong(p, p->next, "a time step, as in: step 0.01");
    if (p->span.at.line && !fp3_ode_unit_fits(&p->step.unit, &p->span.unit))
        fp3_ode_wrong(p, p->span.at, "the unit of the step (line %u)", p->step.at.line);
}

void fp3_ode_parse(ode_parser *p) {
    while (p->next.kind != TOKEN_END_OF_FILE && !fp3_report_full(&p->report)) {
        if (p->next.kind == TOKEN_END) {
            fp3_ode_advance(p);
            continue;
        }
        unsigned line = p->next.line;
        fp3_ode_statement(p);
        if (p->is_over)
            return;
        if (p->is_lost)
            find_next_statement(p, line);
    }
    if (!fp3_report_full(&p->report))
        finish(p);
}
