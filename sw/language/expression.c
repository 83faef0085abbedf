/* expression.c - by recursive descent: each function reads what binds at least as tightly as its
 * name says. */
#include "expression.h"

#include <assert.h>
#include <math.h>

#include "function.h"
#include "keyword.h"
#include "number.h"
#include "symbol.h"
#include "vector.h"

static const ode_value nothing = {0};

static ode_value expression(ode_parser *p);
static ode_value unary(ode_parser *p);

/* 0 after an error. Whatever it returns, leave undoes it. */
static int enter(ode_parser *p) {
    if (++p->depth > ODE_DEPTH)
        fp3_ode_lost(&p->in, "an expression nested at most %d deep", ODE_DEPTH);
    return !p->in.is_lost;
}

static void leave(ode_parser *p) {
    assert(p->depth > 0);
    p->depth--;
}

static ode_value leaves(ode_parser *p, fp3_token at, fp3_expr_op op, uint32_t first,
                        unsigned size) {
    ode_value value = {.size = size};
    for (unsigned i = 0; i < size; i++) {
        ode_value leaf = fp3_ode_leaf(p, at, op, first + i, 0);
        if (!leaf.size)
            return nothing;
        value.expr[i] = leaf.expr[0];
    }
    return value;
}

static int has_state(const ode_parser *p, const ode_symbol *s) {
    for (unsigned i = 0; s->class == ODE_DEFINITION && i < s->value.size; i++)
        if (p->has_state[s->value.expr[i]])
            return 1;
    return 0;
}

/* Whether what a name stands for may be used here. Reports it if not. */
static int may_stand(ode_parser *p, fp3_token name, const ode_symbol *s) {
    if (s->class == ODE_INVARIANT)
        fp3_ode_wrong(&p->in, name, "a name that is defined (this is an invariant)");
    else if (p->context == ODE_IN_CONSTANT)
        fp3_ode_wrong(&p->in, name, "a number (only the start of a state may use params)");
    else if (p->context == ODE_IN_START && s->class != ODE_PARAM)
        fp3_ode_wrong(&p->in, name, "numbers and params, which are known before the start");
    else if (p->context == ODE_IN_EXACT && s->class == ODE_STATE)
        fp3_ode_wrong(&p->in, name, "t, params, or the start of a state, as in %.*s(0)",
                      (int)name.length, name.text);
    else if (p->context == ODE_IN_EXACT && has_state(p, s))
        fp3_ode_wrong(&p->in, name, "a definition without states (this is a closed form)");
    else
        return 1;
    return 0;
}

static ode_value symbol_value(ode_parser *p, fp3_token name, const ode_symbol *s, unsigned start,
                              unsigned size) {
    if (!may_stand(p, name, s))
        return nothing;
    if (s->class == ODE_STATE || s->class == ODE_PARAM)
        return leaves(p, name, s->class == ODE_STATE ? FP3_EXPR_STATE : FP3_EXPR_PARAM,
                      s->first + start, size);
    ode_value value = {.size = size};
    for (unsigned i = 0; i < size; i++)
        value.expr[i] = s->value.expr[start + i];
    return value;
}

/* "(0)" after the name of a state. */
static ode_value start_of(ode_parser *p, fp3_token name, const ode_symbol *s, unsigned start,
                          unsigned size) {
    if (p->context != ODE_IN_EXACT)
        fp3_ode_lost(&p->in, "an operator (the start of a state is allowed only in 'exact')");
    fp3_ode_advance(&p->in);
    fp3_ode_expect(&p->in, "0", "0, as in v(0)");
    fp3_ode_expect(&p->in, ")", "')'");
    return leaves(p, name, FP3_EXPR_INITIAL, s->first + start, size);
}

static ode_value time_now(ode_parser *p, fp3_token name) {
    if (p->context != ODE_IN_CONSTANT && p->context != ODE_IN_START)
        return fp3_ode_leaf(p, name, FP3_EXPR_TIME, 0, 0);
    fp3_ode_wrong(&p->in, name,
                  "a value that is known before the start (t is the time since then)");
    return nothing;
}

/* What follows the name of a function. */
static ode_value call(ode_parser *p, fp3_token name, const ode_function *f) {
    ode_value argument[ODE_ARGUMENTS] = {{0}};
    assert(f->arguments <= ODE_ARGUMENTS);
    fp3_ode_expect(&p->in, "(", "'(' after '%s'", f->name);
    for (unsigned i = 0; i < f->arguments; i++) {
        if (i > 0)
            fp3_ode_expect(&p->in, ",", "',' ('%s' has %u arguments)", f->name, f->arguments);
        argument[i] = expression(p);
    }
    fp3_ode_expect(&p->in, ")", "an operator or ')' ('%s' has %u argument%s)", f->name,
                   f->arguments, f->arguments > 1 ? "s" : "");
    return fp3_ode_apply(p, name, f, argument);
}

static void no_function(ode_parser *p, fp3_token name) {
    const char *near = fp3_ode_nearest_function(name);
    if (near)
        fp3_ode_wrong(&p->in, name, "a function (did you mean '%s'?)", near);
    else
        fp3_ode_wrong(&p->in, name, "a function");
    fp3_ode_give_up(&p->in, name);
}

static ode_value named(ode_parser *p) {
    fp3_token name = p->in.next;
    if (fp3_ode_is_keyword(name) && !fp3_token_is(name, "t") && !fp3_token_is(name, "pi")) {
        fp3_ode_lost(&p->in, "a number, a name or '('");
        return nothing;
    }
    fp3_ode_advance(&p->in);
    const ode_function *function = fp3_ode_function(name);
    if (function)
        return call(p, name, function);
    if (fp3_token_is(name, "t"))
        return time_now(p, name);
    if (fp3_token_is(name, "pi"))
        return fp3_ode_leaf(p, name, FP3_EXPR_NUMBER, 0, M_PI);
    const int is_call = fp3_ode_at(&p->in, "(");
    unsigned start, size;
    if (is_call && !fp3_ode_find(p, name)) {
        no_function(p, name);
        return nothing;
    }
    const ode_symbol *s = fp3_ode_resolve(p, name, &start, &size);
    if (!s)
        return nothing;
    if (is_call && s->class == ODE_STATE)
        return start_of(p, name, s, start, size);
    if (is_call)
        fp3_ode_lost(&p->in, "an operator ('%.*s' is not a function)", (int)s->at.length,
                     s->at.text);
    return symbol_value(p, name, s, start, size);
}

/* The rest of a vector whose first component has been read. */
static ode_value vector(ode_parser *p, fp3_token open, ode_value part) {
    ode_value value = {.size = 0};
    unsigned size = 0;
    int is_good = 1;
    for (;; part = expression(p)) {
        if (part.size > 1)
            fp3_ode_wrong(&p->in, open, "a vector of numbers (there is %s in it)",
                          fp3_ode_shape(part.size));
        is_good &= part.size == 1;
        if (size < ODE_VECTOR)
            value.expr[size] = part.expr[0];
        size++;
        if (!fp3_ode_accept(&p->in, ","))
            break;
    }
    if (size > ODE_VECTOR)
        fp3_ode_wrong(&p->in, open, "a vector of 2 or 3 (this is one of %u)", size);
    value.size = is_good && size <= ODE_VECTOR ? size : 0;
    return value;
}

static ode_value bracketed(ode_parser *p) {
    fp3_token open = p->in.next;
    fp3_ode_advance(&p->in);
    ode_value value = expression(p);
    if (fp3_ode_at(&p->in, ","))
        value = vector(p, open, value);
    fp3_ode_expect(&p->in, ")", "an operator or ')'");
    return value;
}

static ode_value primary(ode_parser *p) {
    fp3_token at = p->in.next;
    double number = 0;
    if (at.kind == FP3_TOKEN_NUMBER) {
        const char *expected = fp3_ode_number(at, &number);
        if (expected) {
            fp3_ode_wrong(&p->in, at, "%s", expected);
            fp3_ode_advance(&p->in);
            return nothing;
        }
        fp3_ode_advance(&p->in);
        return fp3_ode_leaf(p, at, FP3_EXPR_NUMBER, 0, number);
    }
    if (at.kind == FP3_TOKEN_NAME)
        return named(p);
    if (fp3_ode_at(&p->in, "("))
        return bracketed(p);
    fp3_ode_lost(&p->in, "a number, a name or '('");
    return nothing;
}

static ode_value power(ode_parser *p) {
    ode_value base = primary(p);
    fp3_token at = p->in.next;
    if (!fp3_ode_accept(&p->in, "^"))
        return base;
    ode_value exponent = enter(p) ? unary(p) : nothing;
    leave(p);
    return fp3_ode_binary(p, at, FP3_EXPR_POWER, base, exponent);
}

static ode_value unary(ode_parser *p) {
    fp3_token at = p->in.next;
    if (!fp3_ode_accept(&p->in, "-"))
        return power(p);
    uint32_t from = p->expr_count;
    ode_value value = enter(p) ? unary(p) : nothing;
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
        fp3_token at = p->in.next;
        if (fp3_ode_accept(&p->in, "*"))
            value = fp3_ode_binary(p, at, FP3_EXPR_MUL, value, unary(p));
        else if (fp3_ode_accept(&p->in, "/"))
            value = fp3_ode_binary(p, at, FP3_EXPR_DIV, value, unary(p));
        else
            return value;
    }
}

static ode_value sum(ode_parser *p) {
    ode_value value = product(p);
    for (;;) {
        fp3_token at = p->in.next;
        if (fp3_ode_accept(&p->in, "+"))
            value = fp3_ode_binary(p, at, FP3_EXPR_ADD, value, product(p));
        else if (fp3_ode_accept(&p->in, "-"))
            value = fp3_ode_binary(p, at, FP3_EXPR_SUB, value, product(p));
        else
            return value;
    }
}

static const struct {
    const char *symbol;
    fp3_expr_op op;
    int is_swapped, is_negated;
} comparisons[] = {
    {"<", FP3_EXPR_LESS, 0, 0},   {"<=", FP3_EXPR_LESS_EQUAL, 0, 0},
    {">", FP3_EXPR_LESS, 1, 0},   {">=", FP3_EXPR_LESS_EQUAL, 1, 0},
    {"==", FP3_EXPR_EQUAL, 0, 0}, {"!=", FP3_EXPR_EQUAL, 0, 1},
};
enum { COMPARISONS = sizeof comparisons / sizeof *comparisons };

/* Which comparison is next; COMPARISONS if there is none. */
static unsigned at_comparison(const ode_parser *p) {
    unsigned i = 0;
    while (i < COMPARISONS && !fp3_ode_at(&p->in, comparisons[i].symbol))
        i++;
    return i;
}

static ode_value comparison(ode_parser *p) {
    ode_value a = sum(p);
    const unsigned i = at_comparison(p);
    if (i == COMPARISONS)
        return a;
    fp3_token at = p->in.next;
    fp3_ode_advance(&p->in);
    ode_value b = sum(p);
    if (at_comparison(p) < COMPARISONS)
        fp3_ode_lost(&p->in, "'and' between two comparisons");
    const ode_value result = comparisons[i].is_swapped
                                 ? fp3_ode_binary(p, at, comparisons[i].op, b, a)
                                 : fp3_ode_binary(p, at, comparisons[i].op, a, b);
    return comparisons[i].is_negated ? fp3_ode_unary(p, at, FP3_EXPR_NOT, result) : result;
}

static ode_value negation(ode_parser *p) {
    fp3_token at = p->in.next;
    if (!fp3_ode_accept(&p->in, "not"))
        return comparison(p);
    ode_value value = enter(p) ? negation(p) : nothing;
    leave(p);
    return fp3_ode_unary(p, at, FP3_EXPR_NOT, value);
}

static ode_value conjunction(ode_parser *p) {
    ode_value value = negation(p);
    for (fp3_token at = p->in.next; fp3_ode_accept(&p->in, "and"); at = p->in.next)
        value = fp3_ode_binary(p, at, FP3_EXPR_AND, value, negation(p));
    return value;
}

static ode_value disjunction(ode_parser *p) {
    ode_value value = conjunction(p);
    for (fp3_token at = p->in.next; fp3_ode_accept(&p->in, "or"); at = p->in.next)
        value = fp3_ode_binary(p, at, FP3_EXPR_OR, value, conjunction(p));
    return value;
}

static ode_value expression(ode_parser *p) {
    ode_value value = enter(p) ? disjunction(p) : nothing;
    fp3_token at = p->in.next;
    if (fp3_ode_accept(&p->in, "?")) {
        ode_value a = expression(p);
        fp3_ode_expect(&p->in, ":", "an operator or ':'");
        value = fp3_ode_select(p, at, value, a, expression(p));
    }
    leave(p);
    return value;
}

ode_value fp3_ode_expression(ode_parser *p, ode_context context) {
    p->context = context;
    return expression(p);
}
