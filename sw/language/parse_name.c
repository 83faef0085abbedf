/* parse_name.c - names: what they may be, and what they stand for. */
#include <stdio.h>
#include <string.h>

#include "parse.h"

static const char *const words[] = {"model", "param", "shared",    "state", "step",
                                    "span",  "exact", "invariant", "and",   "or",
                                    "not",   "t",     "pi"};
enum { WORDS = sizeof words / sizeof *words, STATEMENTS = 8 };

static int is_one_of(token name, unsigned count) {
    for (unsigned i = 0; i < count; i++)
        if (fp3_token_is(name, words[i]))
            return 1;
    return 0;
}

int fp3_ode_begins_statement(token name) { return is_one_of(name, STATEMENTS); }

int fp3_ode_is_keyword(token name) { return is_one_of(name, WORDS); }

void fp3_ode_nearest_statement(token name, const char **best) {
    for (unsigned i = 0; i < STATEMENTS; i++)
        fp3_report_nearest(name, words[i], best);
}

token fp3_ode_base(token name, int *component) {
    const char *dot = memchr(name.text, '.', name.length);
    *component = -1;
    if (!dot)
        return name;
    size_t behind = name.length - (size_t)(dot + 1 - name.text);
    *component = behind == 1 && dot[1] >= 'x' && dot[1] <= 'z' ? dot[1] - 'x' : ODE_VECTOR;
    name.length = (size_t)(dot - name.text);
    return name;
}

ode_symbol *fp3_ode_find(ode_parser *p, token base) {
    for (uint32_t i = 0; i < p->symbol_count; i++)
        if (fp3_token_same(p->symbols[i].at, base))
            return &p->symbols[i];
    return NULL;
}

void fp3_ode_scalar_name(token base, unsigned size, unsigned i, char name[FP3_NAME_SIZE]) {
    snprintf(name, FP3_NAME_SIZE, size > 1 ? "%.*s_%c" : "%.*s", (int)base.length, base.text,
             'x' + (int)i);
}

/* Whether a symbol occupies this name: r, and r_x and r_y if it is a vector. */
static int occupies(const ode_symbol *s, const char *name) {
    char own[FP3_NAME_SIZE];
    if (fp3_token_is(s->at, name))
        return 1;
    for (unsigned i = 0; s->value.size > 1 && i < s->value.size; i++) {
        fp3_ode_scalar_name(s->at, s->value.size, i, own);
        if (!strcmp(own, name))
            return 1;
    }
    return 0;
}

static const ode_symbol *occupied(const ode_parser *p, token name, unsigned size) {
    char text[1 + ODE_VECTOR][FP3_NAME_SIZE];
    unsigned count = 1;
    fp3_ode_scalar_name(name, 1, 0, text[0]);
    for (; size > 1 && count <= size; count++)
        fp3_ode_scalar_name(name, size, count - 1, text[count]);
    for (uint32_t i = 0; i < p->symbol_count; i++)
        for (unsigned j = 0; j < count; j++)
            if (occupies(&p->symbols[i], text[j]))
                return &p->symbols[i];
    return NULL;
}

int fp3_ode_is_new_name(ode_parser *p, token name, unsigned size) {
    char text[FP3_NAME_SIZE];
    unsigned room = FP3_NAME_SIZE - (size > 1 ? 3 : 1);
    if (name.length > room) {
        fp3_ode_wrong(p, name, "a name of at most %u characters", room);
        return 0;
    }
    fp3_ode_scalar_name(name, 1, 0, text);
    if (memchr(name.text, '.', name.length)) {
        fp3_ode_wrong(p, name, "a name without a '.'");
        return 0;
    }
    if (!fp3_name_valid(text) || fp3_ode_is_keyword(name) || fp3_ode_is_function(name)) {
        fp3_ode_wrong(p, name, "a name ('%s' has a meaning of its own)", text);
        return 0;
    }
    const ode_symbol *other = occupied(p, name, size);
    if (!other)
        return 1;
    if (fp3_token_same(other->at, name))
        fp3_ode_wrong(p, name, "a new name (line %u declares this one)", other->at.line);
    else
        fp3_ode_wrong(p, name, "a new name (the components of '%.*s', line %u, would share it)",
                      (int)(size > 1 ? name.length : other->at.length),
                      size > 1 ? name.text : other->at.text, other->at.line);
    return 0;
}

static void undefined(ode_parser *p, token name) {
    for (unsigned i = 0; i < p->undefined_count; i++)
        if (fp3_token_same(p->undefined[i], name))
            return;
    if (p->undefined_count < REPORT_LIMIT)
        p->undefined[p->undefined_count++] = name;
    if (p->context == ODE_IN_CONSTANT) {
        fp3_ode_wrong(p, name, "a number or a function");
        return;
    }
    char best[FP3_NAME_SIZE] = "", candidate[FP3_NAME_SIZE];
    for (uint32_t i = 0; i < p->symbol_count; i++) {
        const char *near = *best ? best : NULL;
        fp3_ode_scalar_name(p->symbols[i].at, 1, 0, candidate);
        fp3_report_nearest(name, candidate, &near);
        if (near == candidate)
            memcpy(best, candidate, sizeof best);
    }
    if (*best)
        fp3_ode_wrong(p, name, "a name that is defined (did you mean '%s'?)", best);
    else
        fp3_ode_wrong(p, name, "a name that is defined above");
}

ode_symbol *fp3_ode_resolve(ode_parser *p, token name, unsigned *start, unsigned *size) {
    int component;
    token base = fp3_ode_base(name, &component);
    ode_symbol *s = fp3_ode_find(p, base);
    if (!s) {
        undefined(p, base);
        return NULL;
    }
    *start = component > 0 ? (unsigned)component : 0;
    *size = component < 0 || !s->value.size ? s->value.size : 1;
    if (component < 0 || !s->value.size || (s->value.size > 1 && *start < s->value.size))
        return s;
    if (s->value.size > 1)
        fp3_ode_wrong(p, name, "a component .x%s or .%c of it", s->value.size == 3 ? ", .y" : "",
                      s->value.size == 3 ? 'z' : 'y');
    else
        fp3_ode_wrong(p, name, "'%.*s' alone (it is no vector)", (int)base.length, base.text);
    return NULL;
}
