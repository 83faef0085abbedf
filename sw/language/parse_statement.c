/* parse_statement.c - what each statement of a model says. */
#include <stdlib.h>
#include <string.h>

#include "parse.h"

/* A text behind a statement, malloc'ed; "" where there is none. */
static char *doc_here(ode_parser *p) {
    token t = p->next;
    size_t size = 0;
    if (t.kind == TOKEN_BAD && t.length && *t.text == '"') {
        fp3_ode_lost(p, "a text that ends with '\"' on its line");
    } else if (t.kind == TOKEN_TEXT) {
        if (fp3_ode_text_valid(t))
            size = t.length - 2;
        else
            fp3_ode_wrong(p, t, "a text in UTF-8 without control characters");
        fp3_ode_advance(p);
    }
    char *doc = calloc(size + 1, 1);
    if (!doc)
        p->out_of_memory = 1;
    else
        memcpy(doc, t.text + 1, size);
    return doc;
}

static void model_statement(ode_parser *p, token keyword) {
    token name = p->next;
    char text[FP3_NAME_SIZE] = "";
    if (p->model_at.line)
        fp3_ode_wrong(p, keyword, "no second name of the model (line %u has one)",
                      p->model_at.line);
    if (name.kind != TOKEN_NAME) {
        fp3_ode_lost(p, "the name of the model");
        return;
    }
    if (name.length < sizeof text)
        memcpy(text, name.text, name.length);
    if (!fp3_name_valid(text))
        fp3_ode_wrong(p, name, "a name of at most %d letters, digits and _", FP3_NAME_SIZE - 1);
    fp3_ode_advance(p);
    char *doc = doc_here(p);
    if (p->model_at.line) {
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
    if (!fp3_ode_accept(p, "["))
        return size;
    if (fp3_ode_accept(p, "2"))
        size = 2;
    else if (fp3_ode_accept(p, "3"))
        size = 3;
    else
        fp3_ode_lost(p, "2 or 3, the size of a vector (a unit stands behind the value)");
    if (!fp3_ode_accept(p, "]"))
        fp3_ode_lost(p, "']'");
    return size;
}

static void declare(ode_parser *p, token at, ode_kind kind, uint32_t first, ode_value value) {
    p->symbols[p->symbol_count++] =
        (ode_symbol){.at = at, .kind = kind, .first = first, .value = value};
}

static char *copied(ode_parser *p, const char *text) {
    char *copy = strdup(text);
    p->out_of_memory |= !copy;
    return copy;
}

static void add_quantity(ode_parser *p, token at, ode_kind kind, unsigned size, int is_shared,
                         const ode_constant *constant, const char *doc) {
    ode_quantity *array = kind == ODE_STATE ? p->states : p->params;
    uint32_t *count = kind == ODE_STATE ? &p->state_count : &p->param_count;
    if (*count + size > ODE_QUANTITIES) {
        fp3_ode_over(p, at, "at most %d %s", ODE_QUANTITIES,
                     kind == ODE_STATE ? "states" : "params, shared ones included");
        return;
    }
    declare(p, at, kind, *count, (ode_value){.size = size});
    for (unsigned i = 0; i < size; i++) {
        ode_quantity *q = &array[(*count)++];
        *q = (ode_quantity){.at = at, .unit = constant->unit};
        fp3_ode_scalar_name(at, size, i, q->quantity.name);
        q->quantity.unit = copied(p, constant->unit_text);
        q->quantity.doc = copied(p, doc);
        q->quantity.value = constant->value[i];
        q->quantity.is_shared = is_shared;
        q->quantity.derivative = q->quantity.velocity = q->quantity.exact = FP3_NONE;
        q->quantity.line = at.line;
    }
}

static void quantity_statement(ode_parser *p, ode_kind kind, int is_shared) {
    token name = p->next;
    if (name.kind != TOKEN_NAME) {
        fp3_ode_lost(p, "a name");
        return;
    }
    fp3_ode_advance(p);
    unsigned size = size_here(p);
    int is_new = fp3_ode_is_new_name(p, name, size);
    ode_constant constant;
    if (!fp3_ode_accept(p, "="))
        fp3_ode_lost(p, "'=' and %s", kind == ODE_STATE ? "where the state starts" : "its value");
    ode_context context = kind == ODE_STATE ? ODE_IN_START : ODE_IN_CONSTANT;
    fp3_ode_constant(p, context, size, ODE_WITH_UNIT, &constant);
    char *doc = doc_here(p);
    if (is_new && doc)
        add_quantity(p, name, kind, size, is_shared, &constant, doc);
    free(doc);
}

static void time_statement(ode_parser *p, token keyword, ode_time *time) {
    ode_constant constant;
    token value_at = p->next;
    int length = (int)keyword.length;
    if (time->at.line)
        fp3_ode_wrong(p, keyword, "no second '%.*s' (line %u has one)", length, keyword.text,
                      time->at.line);
    if (fp3_ode_constant(p, ODE_IN_CONSTANT, 1, ODE_WITH_UNIT, &constant) && constant.value[0] <= 0)
        fp3_ode_wrong(p, value_at, "a %.*s above 0", length, keyword.text);
    if (!time->at.line)
        *time = (ode_time){constant.value[0], constant.unit, keyword};
}

/* "= expression" of that size; the value's own size is 0 after a report. */
static ode_value right_side(ode_parser *p, ode_context context, unsigned size) {
    token equals = p->next;
    if (!fp3_ode_accept(p, "="))
        fp3_ode_lost(p, "'='");
    ode_value value = fp3_ode_expression(p, context);
    if (p->is_lost)
        return (ode_value){0}; /* half of it was read */
    if (!value.size || !size || value.size == size)
        return value;
    fp3_ode_wrong(p, equals, "%s on both sides (on the right is %s)", fp3_ode_shape(size),
                  fp3_ode_shape(value.size));
    return (ode_value){0};
}

/* The state, or component of one, that an equation is for. NULL after a report. */
static const ode_symbol *target_of(ode_parser *p, token name, unsigned *start, unsigned *size) {
    const ode_symbol *s = fp3_ode_resolve(p, name, start, size);
    if (s && s->kind == ODE_STATE)
        return s;
    if (s)
        fp3_ode_wrong(p, name, "a state (line %u declares something else)", s->at.line);
    *size = 0;
    return NULL;
}

/* Which of a state's equations. */
typedef enum { FIRST, SECOND, CLOSED } equation_kind;

static void equation(ode_parser *p, token name, equation_kind kind) {
    unsigned start = 0, size = 0;
    const ode_symbol *s = target_of(p, name, &start, &size);
    ode_value value = right_side(p, kind == CLOSED ? ODE_IN_EXACT : ODE_IN_EQUATION, size);
    for (unsigned i = 0; s && i < size; i++) {
        ode_quantity *q = &p->states[s->first + start + i];
        ode_equation *e = kind == FIRST ? &q->first : kind == SECOND ? &q->second : &q->exact;
        if (e->at.line) {
            fp3_ode_wrong(p, name, "one such equation of it (line %u has another)", e->at.line);
            return;
        }
        *e = (ode_equation){name, value.size ? value.expr[i] : FP3_NONE};
    }
}

static void exact_statement(ode_parser *p) {
    token name = p->next;
    if (name.kind != TOKEN_NAME) {
        fp3_ode_lost(p, "the name of a state");
        return;
    }
    fp3_ode_advance(p);
    equation(p, name, CLOSED);
}

static void definition(ode_parser *p, token name, ode_kind kind) {
    fp3_definition *array = kind == ODE_INVARIANT ? p->invariants : p->definitions;
    uint32_t *count = kind == ODE_INVARIANT ? &p->invariant_count : &p->definition_count;
    int is_new = fp3_ode_is_new_name(p, name, 1);
    ode_value value = right_side(p, kind == ODE_INVARIANT ? ODE_IN_INVARIANT : ODE_IN_EQUATION, 0);
    if (is_new && value.size > 1)
        is_new = fp3_ode_is_new_name(p, name, value.size);
    if (!is_new)
        return;
    if (*count + ODE_VECTOR > ODE_DEFINITIONS) {
        fp3_ode_over(p, name, "fewer than %d %s", ODE_DEFINITIONS,
                     kind == ODE_INVARIANT ? "invariants" : "definitions");
        return;
    }
    declare(p, name, kind, 0, value);
    for (unsigned i = 0; i < value.size; i++) {
        fp3_definition *d = &array[(*count)++];
        *d = (fp3_definition){.expr = value.expr[i], .line = name.line};
        fp3_ode_scalar_name(name, value.size, i, d->name);
    }
}

static void invariant_statement(ode_parser *p) {
    token name = p->next;
    if (name.kind != TOKEN_NAME) {
        fp3_ode_lost(p, "a name for the invariant");
        return;
    }
    fp3_ode_advance(p);
    definition(p, name, ODE_INVARIANT);
}

/* A statement that begins with a name of its own. */
static void named_statement(ode_parser *p, token name) {
    const char *near = NULL;
    if (fp3_ode_at(p, "'") || fp3_ode_at(p, "''")) {
        equation_kind kind = fp3_ode_at(p, "'") ? FIRST : SECOND;
        fp3_ode_advance(p);
        equation(p, name, kind);
        return;
    }
    if (fp3_ode_at(p, "=")) {
        definition(p, name, ODE_DEFINITION);
        return;
    }
    fp3_ode_nearest_statement(name, &near);
    if (near) {
        fp3_ode_wrong(p, name, "a statement (did you mean '%s'?)", near);
        fp3_ode_give_up(p, name);
    } else {
        fp3_ode_lost(p, "=, ' or '' after '%.*s'", name.length < 32 ? (int)name.length : 32,
                     name.text);
    }
}

void fp3_ode_statement(ode_parser *p) {
    token first = p->next;
    if (first.kind != TOKEN_NAME) {
        fp3_ode_lost(p, "a statement: model, param, shared, state, step, span, exact, invariant, "
                        "or an equation");
        return;
    }
    p->context = ODE_IN_EQUATION;
    fp3_ode_advance(p);
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
    else
        named_statement(p, first);
    fp3_ode_expect_end(p);
}
