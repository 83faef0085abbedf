/* SPDX-License-Identifier: Apache-2.0 */
#include "statement.h"

#include <stdlib.h>
#include <string.h>

#include "base/number.h"
#include "constant.h"
#include "dimension_check.h"
#include "event.h"
#include "expression.h"
#include "keyword.h"
#include "kind.h"
#include "quantity.h"
#include "relation.h"
#include "remember.h"
#include "repeat.h"
#include "side.h"
#include "symbol.h"
#include "utf8.h"
#include "vector.h"

/* Reads a name; 0 if there is none, after an error that says what is expected. */
static int name_here(ode_parser *p, const char *expected, fp3_token *name) {
    *name = p->in.next;
    if (name->kind != FP3_TOKEN_NAME) {
        fp3_ode_lost(&p->in, "%s", expected);
        return 0;
    }
    fp3_ode_advance(&p->in);
    return 1;
}

/* The text behind a statement, malloc'ed; "" if there is none. */
static char *doc_here(ode_parser *p) {
    fp3_token t = p->in.next;
    size_t size = 0;
    if (t.kind == FP3_TOKEN_BAD && t.length && *t.text == '"') {
        fp3_ode_lost(&p->in, "a text that ends with '\"' on its line");
    } else if (t.kind == FP3_TOKEN_TEXT) {
        if (fp3_ode_is_utf8(t))
            size = t.length - 2;
        else
            fp3_ode_wrong(&p->in, t, "a text in UTF-8 without control characters");
        fp3_ode_advance(&p->in);
    }
    char *doc = calloc(size + 1, 1);
    if (!doc)
        p->out_of_memory = 1;
    else if (size)
        memcpy(doc, t.text + 1, size);
    return doc;
}

static void model_statement(ode_parser *p, fp3_token keyword) {
    fp3_token name;
    char text[FP3_NAME_SIZE] = "";
    if (fp3_token_exists(p->model_at))
        fp3_ode_wrong(&p->in, keyword, "only one name of the model (line %u has one)",
                      p->model_at.location.line);
    if (!name_here(p, "the name of the model", &name))
        return;
    if (name.length < sizeof text)
        memcpy(text, name.text, name.length);
    if (!fp3_name_valid(text))
        fp3_ode_wrong(&p->in, name, "a name of at most %d letters, digits and _",
                      FP3_NAME_SIZE - 1);
    char *doc = doc_here(p);
    if (fp3_token_exists(p->model_at)) {
        free(doc);
        return;
    }
    p->model_at = keyword;
    memcpy(p->model_name, text, sizeof text);
    p->model_doc = doc;
}

/* "[2]" behind the name of a vector. */
static unsigned size_here(ode_parser *p) {
    unsigned size = 1;
    if (!fp3_ode_accept(&p->in, "["))
        return size;
    const fp3_token at = p->in.next;
    long number = 0;
    const int is_name = at.kind == FP3_TOKEN_NAME && fp3_ode_find(p, at) == NULL;
    const int is_whole = !is_name && fp3_ode_whole(p, &number);
    if (is_name || (is_whole && (number < 2 || number > ODE_VECTOR)))
        fp3_ode_lost_at(
            &p->in, at,
            "a number from 2 to %d, the size of a vector (write a unit after the value)",
            ODE_VECTOR);
    else if (!is_whole)
        fp3_ode_give_up(&p->in, at);
    fp3_ode_expect(&p->in, "]", "']'");
    return is_whole ? (unsigned)number : size;
}

static void quantity_statement(ode_parser *p, ode_class class, int is_shared) {
    fp3_token name;
    if (!name_here(p, "a name", &name))
        return;
    unsigned size = size_here(p);
    int is_new = fp3_ode_is_new_name(p, name, size);
    ode_constant constant;
    fp3_ode_expect(&p->in, "=", "'=' and %s",
                   class == ODE_STATE ? "where the state starts" : "its value");
    ode_context context = class == ODE_STATE ? ODE_IN_START : ODE_IN_CONSTANT;
    fp3_ode_measured(p, context, size, &constant);
    char *doc = doc_here(p);
    if (is_new && doc)
        fp3_ode_add_quantity(p, name, class, size, is_shared, &constant, doc);
    free(doc);
}

static void time_statement(ode_parser *p, fp3_token keyword, ode_time *time) {
    ode_constant constant;
    fp3_token value_at = p->in.next;
    int length = (int)keyword.length;
    if (fp3_token_exists(time->at))
        fp3_ode_wrong(&p->in, keyword, "only one '%.*s' (line %u has one)", length, keyword.text,
                      time->at.location.line);
    if (fp3_ode_measured(p, ODE_IN_CONSTANT, 1, &constant)) {
        float single;
        const char *expected = fp3_number_step(constant.value[0], &single);
        if (constant.value[0] <= 0)
            fp3_ode_wrong(&p->in, value_at, "a %.*s above 0", length, keyword.text);
        else if (time == &p->step && expected)
            fp3_ode_wrong(&p->in, value_at, "%s", expected);
    }
    if (!fp3_token_exists(time->at))
        *time = (ode_time){constant.value[0], constant.dimension, keyword};
}

static void for_statement(ode_parser *p);

/* Which of a state's equations. */
typedef enum { FIRST, SECOND, CLOSED } which_equation;

/* The ' or '' behind the left side. */
static which_equation derivative_here(ode_parser *p, fp3_token name) {
    if (fp3_ode_accept(&p->in, "'"))
        return FIRST;
    if (!fp3_ode_accept(&p->in, "''"))
        fp3_ode_lost(&p->in, "' or '' after '%.*s[..]'", (int)name.length, name.text);
    return SECOND;
}

static void equation(ode_parser *p, fp3_token name, int is_closed) {
    unsigned start = 0, size = 0;
    const ode_symbol *s = fp3_ode_target(p, name, &start, &size);
    const which_equation which = is_closed ? CLOSED : derivative_here(p, name);
    ode_value value = fp3_ode_right_side(p, which == CLOSED ? ODE_IN_EXACT : ODE_IN_EQUATION, size);
    for (unsigned i = 0; s && i < size; i++) {
        ode_quantity *q = &p->states[s->first + start + i];
        ode_equation *e = which == FIRST ? &q->first : which == SECOND ? &q->second : &q->exact;
        if (fp3_token_exists(e->at)) {
            fp3_ode_wrong(&p->in, name, "only one equation like this (line %u has another)",
                          e->at.location.line);
            return;
        }
        *e = fp3_ode_equation(p, name, value.size ? value.expr[i] : FP3_NONE);
    }
}

static void exact_statement(ode_parser *p) {
    fp3_token name;
    if (name_here(p, "the name of a state", &name))
        equation(p, name, 1);
}

static void definition(ode_parser *p, fp3_token name, ode_class class) {
    fp3_definition *array = class == ODE_INVARIANT ? p->invariants : p->definitions;
    uint32_t *count = class == ODE_INVARIANT ? &p->invariant_count : &p->definition_count;
    int is_new = fp3_ode_is_new_name(p, name, 1), is_number = 1;
    const uint32_t from = p->expr_count;
    ode_value value =
        fp3_ode_right_side(p, class == ODE_INVARIANT ? ODE_IN_INVARIANT : ODE_IN_EQUATION, 0);
    if (is_new && value.size > 1)
        is_new = fp3_ode_is_new_name(p, name, value.size);
    if (!is_new)
        return;
    if (*count + value.size > ODE_DEFINITIONS) {
        fp3_ode_over(&p->in, name, "at most %d %s", ODE_DEFINITIONS,
                     class == ODE_INVARIANT ? "invariants" : "definitions");
        return;
    }
    fp3_ode_declare(p, name, class, 0, value);
    for (unsigned i = 0; i < value.size; i++) {
        fp3_definition *d = &array[(*count)++];
        *d = (fp3_definition){.expr = value.expr[i], .line = name.location.line};
        fp3_ode_scalar_name(name, value.size, i, d->name);
        is_number &= p->is_number[value.expr[i]];
    }
    if (is_number) /* values of params and states below may be made of it */
        fp3_ode_check_dimensions(p, from);
}

static void invariant_statement(ode_parser *p) {
    fp3_token name;
    if (name_here(p, "a name for the invariant", &name))
        definition(p, name, ODE_INVARIANT);
}

/* Whether what stands behind a name makes it the left side of an equation. */
static int begins_equation(const ode_parser *p) {
    return fp3_ode_at(&p->in, "'") || fp3_ode_at(&p->in, "''") || fp3_ode_at(&p->in, "[");
}

/* What stands in a `for`: an equation, a closed form, an event, a projection, or another `for`. */
static void repeated_statement(ode_parser *p) {
    const fp3_token first = p->in.next;
    const int is_name = first.kind == FP3_TOKEN_NAME;
    fp3_ode_advance(&p->in);
    if (!fp3_ode_may_repeat(p, first))
        return;
    if (fp3_token_is(first, "exact"))
        exact_statement(p);
    else if (fp3_ode_is_event(p, first))
        fp3_ode_event(p, first);
    else if (fp3_token_is(first, "for"))
        for_statement(p);
    else if (is_name && !fp3_ode_is_keyword(first) && begins_equation(p))
        equation(p, first, 0);
    else
        fp3_ode_lost_at(&p->in, first, "an equation q[i]' = ..., exact, when, at, project or for");
}

static void for_statement(ode_parser *p) {
    ode_range range;
    if (!fp3_ode_at_range(p)) {
        fp3_ode_lost(&p->in, "an index and its range, as in `for i in 1..4: q[i]' = ...`");
        return;
    }
    fp3_ode_range_open(p, &range);
    while (fp3_ode_range_pass(p, &range))
        repeated_statement(p);
}

/* A statement that begins with a name of its own. */
static void named_statement(ode_parser *p, fp3_token name) {
    const char *near = NULL;
    if (begins_equation(p)) {
        equation(p, name, 0);
        return;
    }
    if (fp3_ode_at(&p->in, "=")) {
        definition(p, name, ODE_DEFINITION);
        return;
    }
    fp3_ode_nearest_statement(name, &near);
    if (near) {
        fp3_ode_wrong(&p->in, name, "a statement (did you mean '%s'?)", near);
        fp3_ode_give_up(&p->in, name);
    } else {
        fp3_ode_lost(&p->in, "=, ' or '' after '%.*s'", name.length < 32 ? (int)name.length : 32,
                     name.text);
    }
}

void fp3_ode_statement(ode_parser *p) {
    fp3_token first = p->in.next;
    if (first.kind != FP3_TOKEN_NAME) {
        fp3_ode_lost(
            &p->in,
            "a statement: model, param, shared, state, step, span, exact, invariant, "
            "when, for, project, repeat, rest, kind, links, near, all, remember, or an equation");
        return;
    }
    p->context = ODE_IN_EQUATION;
    fp3_ode_advance(&p->in);
    if (!fp3_ode_may_repeat(p, first))
        return;
    if (fp3_token_is(first, "model"))
        model_statement(p, first);
    else if (fp3_token_is(first, "param") || fp3_token_is(first, "shared"))
        quantity_statement(p, ODE_PARAM, fp3_token_is(first, "shared"));
    else if (fp3_token_is(first, "state"))
        quantity_statement(p, ODE_STATE, 0);
    else if (fp3_token_is(first, "step"))
        time_statement(p, first, &p->step);
    else if (fp3_token_is(first, "span"))
        time_statement(p, first, &p->span);
    else if (fp3_token_is(first, "exact"))
        exact_statement(p);
    else if (fp3_token_is(first, "invariant"))
        invariant_statement(p);
    else if (fp3_ode_is_event(p, first))
        fp3_ode_event(p, first);
    else if (fp3_ode_is_repeat(p, first))
        fp3_ode_repeat(p, first);
    else if (fp3_token_is(first, "for"))
        for_statement(p);
    else if (fp3_token_is(first, "kind"))
        fp3_ode_kind(p, first);
    else if (fp3_ode_is_relation(first))
        fp3_ode_relation(p, first);
    else if (fp3_ode_is_remember(p, first))
        fp3_ode_remember(p);
    else
        named_statement(p, first);
    if (!fp3_ode_at_end(&p->in))
        fp3_ode_lost(&p->in, "an operator or the end of the line");
}
