/* parse_expression.c - expressions, by recursive descent; each function reads what binds at least
 * as tightly as its name says. */
#include <math.h>

#include "parse.h"

static const ode_value wrong = {0};

static ode_value unary(ode_parser *p);

/* 0 after a report; leave undoes it in any case. */
static int enter(ode_parser *p) {
    if (++p->depth > ODE_DEPTH)
        fp3_ode_lost(p, "an expression nested at most %d deep", ODE_DEPTH);
    return !p->is_lost;
}

static void leave(ode_parser *p) { p->depth--; }

static ode_value leaves(ode_parser *p, token at, fp3_expr_op op, uint32_t first, unsigned size) {
    ode_value value = {.size = size};
    for (unsigned i = 0; i < size; i++) {
        ode_value leaf = fp3_ode_leaf(p, at, op, first + i, 0);
        if (!leaf.size)
            return wrong;
        value.expr[i] = leaf.expr[0];
    }
    return value;
}

/* Whether what a name stands for may be used here; reports if not. */
static int may_stand(ode_parser *p, token name, const ode_symbol *s) {
    int has_state = s->kind == ODE_STATE ||
                    (s->kind == ODE_DEFINITION && s->value.size && p->has_state[s->value.expr[0]]);
    for (unsigned i = 1; s->kind == ODE_DEFINITION && i < s->value.size; i++)
        has_state |= p->has_state[s->value.expr[i]];
    if (s->kind == ODE_INVARIANT)
        fp3_ode_wrong(p, name, "a name that is defined (this is an invariant)");
    else if (p->context == ODE_IN_CONSTANT)
        fp3_ode_wrong(p, name, "a number (only states may start at what is made of params)");
    else if (p->context == ODE_IN_START && s->kind != ODE_PARAM)
        fp3_ode_wrong(p, name, "numbers and params, which are known before the start");
    else if (p->context == ODE_IN_EXACT && s->kind == ODE_STATE)
        fp3_ode_wrong(p, name, "t, params, or where a state starts, as %.*s(0)", (int)name.length,
                      name.text);
    else if (p->context == ODE_IN_EXACT && has_state)
        fp3_ode_wrong(p, name, "a definition without states (this is a closed form)");
    else
        return 1;
    return 0;
}

static ode_value symbol_value(ode_parser *p, token name, const ode_symbol *s, unsigned start,
                              unsigned size) {
    if (!may_stand(p, name, s))
        return wrong;
    if (s->kind == ODE_STATE || s->kind == ODE_PARAM)
        return leaves(p, name, s->kind == ODE_STATE ? FP3_EXPR_STATE : FP3_EXPR_PARAM,
                      s->first + start, size);
    ode_value value = {.size = size};
    for (unsigned i = 0; i < size; i++)
        value.expr[i] = s->value.expr[start + i];
    return value;
}

/* "(0)" after the name of a state. */
static ode_value start_of(ode_parser *p, token name, const ode_symbol *s, unsigned start,
                          unsigned size) {
    if (p->context != ODE_IN_EXACT)
        fp3_ode_lost(p, "an operator (the start of a state may stand in 'exact' alone)");
    fp3_ode_advance(p);
    if (!fp3_ode_accept(p, "0"))
        fp3_ode_lost(p, "0, as in v(0)");
    if (!fp3_ode_accept(p, ")"))
        fp3_ode_lost(p, "')'");
    return leaves(p, name, FP3_EXPR_INITIAL, s->first + start, size);
}

static ode_value time_now(ode_parser *p, token name) {
    if (p->context == ODE_IN_EXACT)
        return fp3_ode_leaf(p, name, FP3_EXPR_TIME, 0, 0);
    fp3_ode_wrong(p, name, "a name other than t, the time, which may stand in 'exact' alone");
    return wrong;
}

static ode_value named(ode_parser *p) {
    token name = p->next;
    if (fp3_ode_is_keyword(name) && !fp3_token_is(name, "t") && !fp3_token_is(name, "pi")) {
        fp3_ode_lost(p, "a number, a name or '('");
        return wrong;
    }
    fp3_ode_advance(p);
    if (fp3_ode_is_function(name))
        return fp3_ode_call(p, name);
    if (fp3_token_is(name, "t"))
        return time_now(p, name);
    if (fp3_token_is(name, "pi"))
        return fp3_ode_leaf(p, name, FP3_EXPR_NUMBER, 0, M_PI);
    int component, is_call = fp3_ode_at(p, "(");
    unsigned start, size;
    if (is_call && !fp3_ode_find(p, fp3_ode_base(name, &component))) {
        fp3_ode_no_function(p, name);
        return wrong;
    }
    const ode_symbol *s = fp3_ode_resolve(p, name, &start, &size);
    if (!s)
        return wrong;
    if (is_call && s->kind == ODE_STATE)
        return start_of(p, name, s, start, size);
    if (is_call)
        fp3_ode_lost(p, "an operator ('%.*s' is no function)", (int)s->at.length, s->at.text);
    return symbol_value(p, name, s, start, size);
}

/* The components from the first on, which has been read. */
static ode_value vector(ode_parser *p, token open, ode_value part) {
    ode_value value = {.size = 0};
    unsigned size = 0;
    int is_good = 1;
    for (;; part = fp3_ode_subexpression(p)) {
        if (part.size > 1)
            fp3_ode_wrong(p, open, "a vector of numbers (there is %s in it)",
                          fp3_ode_shape(part.size));
        is_good &= part.size == 1;
        if (size < ODE_VECTOR)
            value.expr[size] = part.expr[0];
        size++;
        if (!fp3_ode_accept(p, ","))
            break;
    }
    if (size > ODE_VECTOR)
        fp3_ode_wrong(p, open, "a vector of 2 or 3 (this is one of %u)", size);
    value.size = is_good && size <= ODE_VECTOR ? size : 0;
    return value;
}

static ode_value bracketed(ode_parser *p) {
    token open = p->next;
    fp3_ode_advance(p);
    ode_value value = fp3_ode_subexpression(p);
    if (fp3_ode_at(p, ","))
        value = vector(p, open, value);
    if (!fp3_ode_accept(p, ")"))
        fp3_ode_lost(p, "an operator or ')'");
    return value;
}

static ode_value primary(ode_parser *p) {
    token at = p->next;
    double number = 0;
    if (at.kind == TOKEN_NUMBER) {
        const char *expected = fp3_ode_number(at, &number);
        if (expected) {
            fp3_ode_wrong(p, at, "%s", expected);
            fp3_ode_advance(p);
            return wrong;
        }
        fp3_ode_advance(p);
        return fp3_ode_leaf(p, at, FP3_EXPR_NUMBER, 0, number);
    }
    if (at.kind == TOKEN_NAME)
        return named(p);
    if (fp3_ode_at(p, "("))
        return bracketed(p);
    fp3_ode_lost(p, "a number, a name or '('");
    return wrong;
}

static ode_value power(ode_parser *p) {
    ode_value base = primary(p);
    token at = p->next;
    if (!fp3_ode_accept(p, "^"))
        return base;
    ode_value exponent = enter(p) ? unary(p) : wrong;
    leave(p);
    return fp3_ode_binary(p, at, FP3_EXPR_POWER, base, exponent);
}

static ode_value unary(ode_parser *p) {
    token at = p->next;
    if (!fp3_ode_accept(p, "-"))
        return power(p);
    uint32_t from = p->expr_count;
    ode_value value = enter(p) ? unary(p) : wrong;
    leave(p);
    /* A number with a sign is a number. */
    if (value.size == 1 && value.expr[0] >= from && p->exprs[value.expr[0]].op == FP3_EXPR_NUMBER) {
        p->exprs[value.expr[0]].number *= -1;
        return value;
    }
    return fp3_ode_unary(p, at, FP3_EXPR_NEGATE, value);
}

static ode_value product(ode_parser *p) {
    ode_value value = unary(p);
    for (;;) {
        token at = p->next;
        if (fp3_ode_accept(p, "*"))
            value = fp3_ode_binary(p, at, FP3_EXPR_MUL, value, unary(p));
        else if (fp3_ode_accept(p, "/"))
            value = fp3_ode_binary(p, at, FP3_EXPR_DIV, value, unary(p));
        else
            return value;
    }
}

static ode_value sum(ode_parser *p) {
    ode_value value = product(p);
    for (;;) {
        token at = p->next;
        if (fp3_ode_accept(p, "+"))
            value = fp3_ode_binary(p, at, FP3_EXPR_ADD, value, product(p));
        else if (fp3_ode_accept(p, "-"))
            value = fp3_ode_binary(p, at, FP3_EXPR_SUB, value, product(p));
        else
            return value;
    }
}

static int at_comparison(const ode_parser *p) {
    return fp3_ode_at(p, "<") || fp3_ode_at(p, "<=") || fp3_ode_at(p, ">") || fp3_ode_at(p, ">=") ||
           fp3_ode_at(p, "==") || fp3_ode_at(p, "!=");
}

static ode_value comparison(ode_parser *p) {
    ode_value a = sum(p);
    if (!at_comparison(p))
        return a;
    token at = p->next;
    fp3_ode_advance(p);
    ode_value b = sum(p), result;
    if (at_comparison(p))
        fp3_ode_lost(p, "'and' between two comparisons");
    if (fp3_token_is(at, "<"))
        result = fp3_ode_binary(p, at, FP3_EXPR_LESS, a, b);
    else if (fp3_token_is(at, "<="))
        result = fp3_ode_binary(p, at, FP3_EXPR_LESS_EQUAL, a, b);
    else if (fp3_token_is(at, ">"))
        result = fp3_ode_binary(p, at, FP3_EXPR_LESS, b, a);
    else if (fp3_token_is(at, ">="))
        result = fp3_ode_binary(p, at, FP3_EXPR_LESS_EQUAL, b, a);
    else
        result = fp3_ode_binary(p, at, FP3_EXPR_EQUAL, a, b);
    return fp3_token_is(at, "!=") ? fp3_ode_unary(p, at, FP3_EXPR_NOT, result) : result;
}

static ode_value negation(ode_parser *p) {
    token at = p->next;
    if (!fp3_ode_accept(p, "not"))
        return comparison(p);
    ode_value value = enter(p) ? negation(p) : wrong;
    leave(p);
    return fp3_ode_unary(p, at, FP3_EXPR_NOT, value);
}

static ode_value conjunction(ode_parser *p) {
    ode_value value = negation(p);
    for (token at = p->next; fp3_ode_accept(p, "and"); at = p->next)
        value = fp3_ode_binary(p, at, FP3_EXPR_AND, value, negation(p));
    return value;
}

static ode_value disjunction(ode_parser *p) {
    ode_value value = conjunction(p);
    for (token at = p->next; fp3_ode_accept(p, "or"); at = p->next)
        value = fp3_ode_binary(p, at, FP3_EXPR_OR, value, conjunction(p));
    return value;
}

ode_value fp3_ode_subexpression(ode_parser *p) {
    ode_value value = enter(p) ? disjunction(p) : wrong;
    token at = p->next;
    if (fp3_ode_accept(p, "?")) {
        ode_value a = fp3_ode_subexpression(p);
        if (!fp3_ode_accept(p, ":"))
            fp3_ode_lost(p, "an operator or ':'");
        value = fp3_ode_select(p, at, value, a, fp3_ode_subexpression(p));
    }
    leave(p);
    return value;
}

ode_value fp3_ode_expression(ode_parser *p, ode_context context) {
    p->context = context;
    return fp3_ode_subexpression(p);
}
