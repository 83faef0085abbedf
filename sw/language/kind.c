/* SPDX-License-Identifier: Apache-2.0 */
/* kind.c - each word of a kind is a param, which stands for that of a neighbour. */
#include "kind.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dimension_read.h"
#include "expression.h"
#include "symbol.h"
#include "word.h"

/* "[2]" behind a name: no unit, which stands apart from it. */
static unsigned size_here(ode_parser *p, fp3_token name) {
    const fp3_token at = p->in.next;
    long number = 1;
    if (!fp3_ode_at(&p->in, "[") || at.text != name.text + name.length)
        return 1;
    fp3_ode_advance(&p->in);
    const fp3_token number_at = p->in.next;
    const int is_whole = fp3_ode_whole(p, &number);
    if (is_whole && (number < 2 || number > ODE_VECTOR))
        fp3_ode_lost_at(&p->in, number_at, "a number from 2 to %d, the size of a vector",
                        ODE_VECTOR);
    else if (!is_whole)
        fp3_ode_give_up(&p->in, at);
    fp3_ode_expect(&p->in, "]", "']'");
    return number < 2 || number > ODE_VECTOR ? 1 : (unsigned)number;
}

/* Whether it can be a word of the kind; the name of its param goes to text. */
static int is_new_word(ode_parser *p, const fp3_kind *kind, fp3_token name, unsigned size,
                       char text[FP3_NAME_SIZE]) {
    const char *behind = size > 9 ? "_10" : size > ODE_LETTERS ? "_1" : size > 1 ? "_x" : "";
    const size_t length = strlen(kind->name) + 1 + name.length + strlen(behind);
    if (memchr(name.text, '.', name.length)) {
        fp3_ode_wrong(&p->in, name, "a name without a '.'");
        return 0;
    }
    if (length >= FP3_NAME_SIZE) {
        fp3_ode_wrong(&p->in, name, "a shorter name ('%s_%.*s%s' would have %zu characters, of %d)",
                      kind->name, (int)name.length, name.text, behind, length, FP3_NAME_SIZE - 1);
        return 0;
    }
    if (fp3_ode_word_of(p, kind, name)) {
        fp3_ode_wrong(&p->in, name, "another word ('%s' has this one)", kind->name);
        return 0;
    }
    snprintf(text, FP3_NAME_SIZE, "%s_%.*s", kind->name, (int)name.length, name.text);
    const fp3_token whole = {.text = text, .length = strlen(text)};
    const ode_symbol *other = fp3_ode_occupied(p, whole, size);
    if (other)
        fp3_ode_wrong(&p->in, name, "another word ('%.*s' of line %u has the name '%s')",
                      (int)other->at.length, other->at.text, other->at.location.line, text);
    return !other;
}

static char *copied(ode_parser *p, const char *text) {
    char *copy = strdup(text);
    p->out_of_memory |= !copy;
    return copy;
}

static void add_word(ode_parser *p, fp3_kind *kind, fp3_token name, unsigned size,
                     const char *param, const ode_dimension *dimension, const char *unit) {
    char doc[2 * FP3_NAME_SIZE + 8], scalar[FP3_NAME_SIZE];
    char *text = p->word_names[p->param_count];
    memcpy(text, param, FP3_NAME_SIZE);
    const fp3_token whole = {text, strlen(text), name.location, FP3_TOKEN_NAME};
    fp3_ode_declare(p, whole, ODE_WORD, p->param_count, (ode_value){.size = size});
    for (unsigned i = 0; i < size; i++) {
        ode_quantity *q = &p->params[p->param_count++];
        *q = (ode_quantity){.at = name, .dimension = *dimension, .size = i == 0 ? size : 0};
        fp3_ode_scalar_name(whole, size, i, q->quantity.name);
        fp3_ode_scalar_name(name, size, i, scalar);
        snprintf(doc, sizeof doc, "%s of %s", scalar, kind->name);
        q->quantity.dimension = copied(p, unit);
        q->quantity.doc = copied(p, doc);
        q->quantity.derivative = q->quantity.velocity = q->quantity.exact = q->quantity.start =
            FP3_NONE;
        q->quantity.line = name.location.line;
        kind->count++;
    }
}

/* "x[2] [m]" */
static void word(ode_parser *p, fp3_kind *kind) {
    const fp3_token name = p->in.next;
    char param[FP3_NAME_SIZE], unit[ODE_DIMENSION_SOURCE_SIZE];
    ode_dimension dimension;
    if (name.kind != FP3_TOKEN_NAME) {
        fp3_ode_lost(&p->in, "a word of such an object, as in kind balls(x[2] [m], R [m])");
        return;
    }
    fp3_ode_advance(&p->in);
    const unsigned size = size_here(p, name);
    fp3_ode_dimension_read(p, &dimension, unit);
    if (fp3_ode_at(&p->in, "="))
        fp3_ode_lost(&p->in, "',' or ')' (a word of a kind has no value here)");
    if (p->in.is_lost || !is_new_word(p, kind, name, size, param))
        return;
    if (p->param_count + size > ODE_QUANTITIES)
        fp3_ode_over(&p->in, name, "at most %d params, shared ones and words of kinds included",
                     ODE_QUANTITIES);
    else
        add_word(p, kind, name, size, param, &dimension, unit);
}

void fp3_ode_kind(ode_parser *p, fp3_token keyword) {
    const fp3_token name = p->in.next;
    if (name.kind != FP3_TOKEN_NAME) {
        fp3_ode_lost(&p->in, "a name, as in kind balls(x[2] [m], R [m])");
        return;
    }
    fp3_ode_advance(&p->in);
    const int is_new = fp3_ode_is_new_name(p, name, 1);
    if (p->kind_count == FP3_KINDS_MAX) {
        fp3_ode_over(&p->in, name, "at most %d kinds", FP3_KINDS_MAX);
        return;
    }
    fp3_kind made = {.first = p->param_count, .line = keyword.location.line};
    fp3_ode_scalar_name(name, 1, 0, made.name);
    fp3_ode_expect(&p->in, "(", "'(' and what is read of such an object, as in kind %.*s(x [m])",
                   (int)name.length, name.text);
    do
        word(p, &made);
    while (!p->in.is_lost && fp3_ode_accept(&p->in, ","));
    fp3_ode_expect(&p->in, ")", "',' or ')'");
    if (is_new)
        fp3_ode_declare(p, name, ODE_KIND, p->kind_count, (ode_value){.size = 1});
    p->kinds[p->kind_count++] = made;
}
