/* SPDX-License-Identifier: Apache-2.0 */
#include "symbol.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "base/nearest.h"
#include "function.h"
#include "keyword.h"

/* The name alone. *component is 0 to 2, -1 without one, NO_COMPONENT for anything else behind the
 * dot. */
enum { NO_COMPONENT = ODE_LETTERS };
static fp3_token base_of(fp3_token name, int *component) {
    const char *dot = memchr(name.text, '.', name.length);
    *component = -1;
    if (!dot)
        return name;
    size_t behind = name.length - (size_t)(dot + 1 - name.text);
    *component = behind == 1 && dot[1] >= 'x' && dot[1] <= 'z' ? dot[1] - 'x' : NO_COMPONENT;
    name.length = (size_t)(dot - name.text);
    return name;
}

ode_symbol *fp3_ode_find(ode_parser *p, fp3_token name) {
    int component;
    const fp3_token base = base_of(name, &component);
    for (uint32_t i = 0; i < p->symbol_count; i++)
        if (fp3_token_same(p->symbols[i].at, base))
            return &p->symbols[i];
    return NULL;
}

uint32_t fp3_ode_declare(ode_parser *p, fp3_token name, ode_class class, uint32_t first,
                         ode_value value) {
    assert(p->symbol_count < ODE_SYMBOLS); /* the limits of what is declared see to it */
    p->symbols[p->symbol_count] =
        (ode_symbol){.at = name, .class = class, .first = first, .value = value};
    return p->symbol_count++;
}

void fp3_ode_undeclare(ode_parser *p, uint32_t symbol) {
    const uint32_t behind = --p->symbol_count - symbol;
    memmove(&p->symbols[symbol], &p->symbols[symbol + 1], behind * sizeof *p->symbols);
}

void fp3_ode_scalar_name(fp3_token base, unsigned size, unsigned i, char name[FP3_NAME_SIZE]) {
    const int length = (int)base.length;
    if (size <= 1)
        snprintf(name, FP3_NAME_SIZE, "%.*s", length, base.text);
    else if (size <= ODE_LETTERS)
        snprintf(name, FP3_NAME_SIZE, "%.*s_%c", length, base.text, 'x' + (int)i);
    else
        snprintf(name, FP3_NAME_SIZE, "%.*s_%u", length, base.text, i + 1);
}

/* Whether the text is the name of a component of a vector: r_x of an r of two. */
static int is_component(fp3_token base, unsigned size, fp3_token name) {
    char text[FP3_NAME_SIZE];
    if (name.length <= base.length || memcmp(name.text, base.text, base.length))
        return 0;
    for (unsigned i = 0; size > 1 && i < size; i++) {
        fp3_ode_scalar_name(base, size, i, text);
        if (fp3_token_is(name, text))
            return 1;
    }
    return 0;
}

/* A symbol that shares a name with the new one, or NULL. Components of two vectors are alike only
 * if the vectors are. */
const ode_symbol *fp3_ode_occupied(const ode_parser *p, fp3_token name, unsigned size) {
    for (uint32_t i = 0; i < p->symbol_count; i++) {
        const ode_symbol *s = &p->symbols[i];
        if (fp3_token_same(s->at, name) || is_component(s->at, s->value.size, name) ||
            is_component(name, size, s->at))
            return s;
    }
    return NULL;
}

/* What every program has, or may have, beside the model's own names. */
static const struct {
    const char *name, *meaning;
} given[] = {{"t", "the time"},
             {FP3_NAME_STEP, "the time step, which `step` and --set h= give"},
             {FP3_NAME_STEPS, "the number of steps made"}};

/* Whether the names of its components have room. */
static int is_short(ode_parser *p, fp3_token name, unsigned size) {
    const unsigned room = FP3_NAME_SIZE - (size > 9 ? 4 : size > 1 ? 3 : 1);
    if (name.length <= room)
        return 1;
    fp3_ode_wrong(&p->in, name, "a name of at most %u characters", room);
    return 0;
}

int fp3_ode_is_new_name(ode_parser *p, fp3_token name, unsigned size) {
    char text[FP3_NAME_SIZE];
    if (!is_short(p, name, size))
        return 0;
    fp3_ode_scalar_name(name, 1, 0, text);
    if (memchr(name.text, '.', name.length)) {
        fp3_ode_wrong(&p->in, name, "a name without a '.'");
        return 0;
    }
    for (size_t i = 0; i < sizeof given / sizeof *given; i++)
        if (fp3_token_is(name, given[i].name)) {
            fp3_ode_wrong(&p->in, name, "another name ('%s' is %s)", text, given[i].meaning);
            return 0;
        }
    if (!fp3_name_valid(text) || fp3_ode_is_keyword(name) || fp3_ode_function(name)) {
        fp3_ode_wrong(&p->in, name, "a name ('%s' has a meaning of its own)", text);
        return 0;
    }
    const ode_symbol *other = fp3_ode_occupied(p, name, size);
    if (!other)
        return 1;
    if (fp3_token_same(other->at, name))
        fp3_ode_wrong(&p->in, name, "a new name (line %u declares this one)",
                      other->at.location.line);
    else
        fp3_ode_wrong(&p->in, name,
                      "a new name (the components of '%.*s', line %u, would share it)",
                      (int)(size > 1 ? name.length : other->at.length),
                      size > 1 ? name.text : other->at.text, other->at.location.line);
    return 0;
}

static void undefined(ode_parser *p, fp3_token name) {
    for (unsigned i = 0; i < p->undefined_count; i++)
        if (fp3_token_same(p->undefined[i], name))
            return;
    if (p->undefined_count < FP3_REPORT_LIMIT)
        p->undefined[p->undefined_count++] = name;
    if (p->context == ODE_IN_CONSTANT) {
        fp3_ode_wrong(&p->in, name, "a number or a function");
        return;
    }
    char best[FP3_NAME_SIZE] = "", candidate[FP3_NAME_SIZE];
    for (uint32_t i = 0; i < p->symbol_count; i++) {
        const char *near = *best ? best : NULL;
        fp3_ode_scalar_name(p->symbols[i].at, 1, 0, candidate);
        if (p->symbols[i].class != ODE_WORD)
            fp3_nearest(name, candidate, &near);
        if (near == candidate)
            memcpy(best, candidate, sizeof best);
    }
    if (*best)
        fp3_ode_wrong(&p->in, name, "a name that is defined (did you mean '%s'?)", best);
    else
        fp3_ode_wrong(&p->in, name, "a name that is defined above");
}

/* The param of a formula that the name becomes. NULL after an error. */
static ode_symbol *taken(ode_parser *p, fp3_token name) {
    if (p->param_count == ODE_QUANTITIES) {
        fp3_ode_over(&p->in, name, "at most %d names", ODE_QUANTITIES);
        return NULL;
    }
    if (!is_short(p, name, 1))
        return NULL;
    ode_quantity *q = &p->params[p->param_count];
    fp3_ode_scalar_name(name, 1, 0, q->quantity.name);
    q->dimension.kind = ODE_DIMENSION_ANY;
    return &p->symbols[fp3_ode_declare(p, name, ODE_PARAM, p->param_count++,
                                       (ode_value){.size = 1})];
}

int fp3_ode_component(ode_parser *p, const ode_symbol *s, fp3_token name, unsigned *start,
                      unsigned *size) {
    int component;
    const fp3_token base = base_of(name, &component);
    *start = component > 0 ? (unsigned)component : 0;
    *size = component < 0 || !s->value.size ? s->value.size : 1;
    const unsigned letters = s->value.size > ODE_LETTERS ? 0 : s->value.size;
    if (component < 0 || !s->value.size || (letters > 1 && *start < letters))
        return 1;
    if (!letters)
        fp3_ode_wrong(&p->in, name, "a component from %.*s[1] to %.*s[%u]", (int)base.length,
                      base.text, (int)base.length, base.text, s->value.size);
    else if (letters > 1)
        fp3_ode_wrong(&p->in, name, "a component .x%s or .%c of it",
                      s->value.size == 3 ? ", .y" : "", s->value.size == 3 ? 'z' : 'y');
    else
        fp3_ode_wrong(&p->in, name, "'%.*s' without a component (it is not a vector)",
                      (int)base.length, base.text);
    return 0;
}

ode_symbol *fp3_ode_resolve(ode_parser *p, fp3_token name, unsigned *start, unsigned *size) {
    int component;
    const fp3_token base = base_of(name, &component);
    ode_symbol *s = fp3_ode_find(p, name);
    if (!s && p->takes_names && p->context == ODE_IN_START)
        s = taken(p, base);
    else if (!s)
        undefined(p, base);
    return s && fp3_ode_component(p, s, name, start, size) ? s : NULL;
}
