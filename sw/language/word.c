/* SPDX-License-Identifier: Apache-2.0 */
#include "word.h"

#include <stdio.h>
#include <string.h>

#include "base/nearest.h"
#include "symbol.h"

/* Without a component. */
static fp3_token alone(fp3_token name) {
    const char *dot = memchr(name.text, '.', name.length);
    if (dot)
        name.length = (size_t)(dot - name.text);
    return name;
}

const ode_quantity *fp3_ode_word_of(const ode_parser *p, const fp3_kind *kind, fp3_token name) {
    for (uint32_t i = kind->first; i < kind->first + kind->count; i++)
        if (p->params[i].size && fp3_token_same(p->params[i].at, name))
            return &p->params[i];
    return NULL;
}

uint32_t fp3_ode_kind_named(ode_parser *p, fp3_token name) {
    const ode_symbol *s = name.kind == FP3_TOKEN_NAME ? fp3_ode_find(p, name) : NULL;
    return s && s->class == ODE_KIND ? s->first : FP3_NONE;
}

uint32_t fp3_ode_kind_here(ode_parser *p, fp3_token name) {
    const uint32_t kind = fp3_ode_kind_named(p, name);
    const char *near = NULL;
    const fp3_token base = alone(name);
    for (uint32_t i = 0; i < p->kind_count; i++)
        fp3_nearest(base, p->kinds[i].name, &near);
    if (kind == FP3_NONE && near)
        fp3_ode_lost_at(&p->in, name, "a kind (did you mean '%s'?)", near);
    else if (kind == FP3_NONE)
        fp3_ode_lost_at(&p->in, name, "a kind that is declared above, as in kind %.*s(x [m])",
                        (int)base.length, base.text);
    return kind;
}

/* "x, v, R" */
static void list_words(const ode_parser *p, const fp3_kind *kind, char *text, size_t size) {
    size_t used = 0;
    *text = '\0';
    for (uint32_t i = kind->first; i < kind->first + kind->count; i++) {
        const fp3_token at = p->params[i].at;
        if (!p->params[i].size)
            continue;
        const int room = used + at.length + 8 < size;
        used += (size_t)snprintf(text + used, size - used, "%s%.*s", used ? ", " : "",
                                 room ? (int)at.length : 2, room ? at.text : "..");
        if (!room)
            return;
    }
}

static void no_word(ode_parser *p, const fp3_kind *kind, fp3_token part) {
    char best[FP3_NAME_SIZE] = "", candidate[FP3_NAME_SIZE], words[128];
    const fp3_token base = alone(part);
    for (uint32_t i = kind->first; i < kind->first + kind->count; i++) {
        const char *near = *best ? best : NULL;
        if (!p->params[i].size)
            continue;
        fp3_ode_scalar_name(p->params[i].at, 1, 0, candidate);
        fp3_nearest(base, candidate, &near);
        if (near == candidate)
            memcpy(best, candidate, sizeof best);
    }
    list_words(p, kind, words, sizeof words);
    fp3_ode_lost_at(&p->in, part, "a word of kind '%s': %s%s%s%s", kind->name, words,
                    *best ? " (did you mean '" : "", best, *best ? "'?)" : "");
}

int fp3_ode_word_named(ode_parser *p, uint32_t kind, fp3_token name, ode_symbol *symbol) {
    const ode_quantity *q = fp3_ode_word_of(p, &p->kinds[kind], alone(name));
    if (!q) {
        no_word(p, &p->kinds[kind], name);
        return 0;
    }
    *symbol = (ode_symbol){.at = q->at,
                           .class = ODE_WORD,
                           .first = (uint32_t)(q - p->params),
                           .value = {.size = q->size}};
    return 1;
}
