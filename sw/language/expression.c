/* SPDX-License-Identifier: Apache-2.0 */
/* expression.c - by recursive descent: each function reads what binds at least as tightly as its
 * name says. */
#include "expression.h"

#include <assert.h>
#include <math.h>

#include "function.h"
#include "keyword.h"
#include "meaning.h"
#include "neighbour.h"
#include "number.h"
#include "range.h"
#include "symbol.h"
#include "vector.h"
#include "word.h"

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

/* "(0)" after the name of a state. */
static ode_value start_of(ode_parser *p, fp3_token name, const ode_symbol *s, unsigned start,
                          unsigned size) {
    if (p->context != ODE_IN_EXACT)
        fp3_ode_lost(&p->in, "an operator (the start of a state is allowed only in 'exact')");
    fp3_ode_advance(&p->in);
    fp3_ode_expect(&p->in, "0", "0, as in v(0)");
    fp3_ode_expect(&p->in, ")", "')'");
    return fp3_ode_leaves(p, name, FP3_EXPR_INITIAL, s->first + start, size);
}

static ode_value time_now(ode_parser *p, fp3_token name) {
    if (p->context > ODE_IN_START)
        return fp3_ode_leaf(p, name, FP3_EXPR_TIME, 0, 0);
    fp3_ode_wrong(&p->in, name,
                  "a value that is known before the start (t is the time since then)");
    return nothing;
}

/* "i in 1..4: terms", one after the other, from the left. */
static ode_value terms(ode_parser *p, fp3_token at, const ode_function *f) {
    ode_range range;
    ode_value all = nothing;
    unsigned count = 0;
    int is_good = 1;
    fp3_ode_range_open(p, &range);
    while (fp3_ode_range_pass(p, &range)) {
        const ode_value term = expression(p);
        if (p->skipping)
            continue;
        is_good &= term.size > 0;
        all = count++ ? fp3_ode_binary(p, at, f->op, all, term) : term;
    }
    if (!is_good || !range.is_good || count)
        return is_good ? all : nothing;
    if (f->rule == ODE_OF_TERMS)
        return fp3_ode_leaf(p, at, FP3_EXPR_NUMBER, 0, f->op == FP3_EXPR_MUL);
    fp3_ode_wrong(&p->in, at, "a term for '%s' (there is none)", f->name);
    return nothing;
}

/* ", 0", behind the term of a least or a most. */
static ode_value begins_with(ode_parser *p, fp3_token at) {
    fp3_ode_expect(&p->in, ",", "an operator or ',' and the value that '%.*s' begins with",
                   (int)at.length, at.text);
    return expression(p);
}

/* What follows the '('. */
static ode_value over_neighbours(ode_parser *p, fp3_token at) {
    ode_neighbours n;
    if (!fp3_ode_neighbours_open(p, at, &n))
        return nothing;
    const ode_value term = n.has_term ? expression(p) : nothing;
    fp3_ode_neighbours_behind(p, &n);
    const int begins = n.fold == ODE_LEAST || n.fold == ODE_MOST;
    return fp3_ode_neighbours_close(p, &n, term, begins ? begins_with(p, at) : nothing);
}

/* Likewise. */
static ode_value over_group(ode_parser *p, fp3_token at) {
    ode_group g;
    return fp3_ode_group_open(p, at, &g) ? fp3_ode_group_close(p, &g, expression(p)) : nothing;
}

/* "o.x" */
static ode_value of_neighbour(ode_parser *p, fp3_token name, const fp3_relation *r) {
    unsigned start, size;
    fp3_token part;
    if (!fp3_ode_neighbours_part(p, name, &part))
        return nothing;
    const ode_quantity *field = fp3_ode_field(p, r, part);
    if (field)
        return fp3_ode_neighbours_field(p, name, part, field);
    if (r->of_kind != FP3_NONE) {
        const uint32_t first = fp3_ode_word(p, r->of_kind, part, &size);
        return first == FP3_NONE ? nothing : fp3_ode_foreign(p, part, first, size);
    }
    const ode_symbol *s = fp3_ode_part(p, part, &start, &size);
    return s ? fp3_ode_neighbours_value(p, part, r, s, start, size) : nothing;
}

/* "? a : b", or ", a, b)" of select, whose condition begins at expression `from`. A condition of
 * numbers is decided here and now, and then only one choice counts. */
static ode_value choice(ode_parser *p, fp3_token at, ode_value condition, uint32_t from,
                        const ode_function *select) {
    const int is_decided = fp3_ode_is_number(p, condition);
    const unsigned is_true = is_decided && p->values[condition.expr[0]] != 0;
    if (is_decided)
        fp3_ode_forget(p, from);
    p->skipping += is_decided && !is_true;
    const ode_value a = expression(p);
    p->skipping -= is_decided && !is_true;
    if (select)
        fp3_ode_expect(&p->in, ",", "',' ('%s' has %u arguments)", select->name, select->arguments);
    else
        fp3_ode_expect(&p->in, ":", "an operator or ':'");
    p->skipping += is_true;
    const ode_value b = expression(p);
    p->skipping -= is_true;
    return !is_decided ? fp3_ode_select(p, at, condition, a, b) : is_true ? a : b;
}

static ode_value arguments(ode_parser *p, fp3_token name, const ode_function *f) {
    ode_value argument[ODE_ARGUMENTS] = {{0}};
    assert(f->arguments <= ODE_ARGUMENTS);
    if (fp3_ode_at_neighbours(p))
        return over_neighbours(p, name);
    if (fp3_ode_has_terms(f) && fp3_ode_at_group(p))
        return over_group(p, name);
    if (fp3_ode_has_terms(f) && fp3_ode_at_range(p))
        return terms(p, name, f);
    const uint32_t from = p->expr_count;
    for (unsigned i = 0; i < f->arguments; i++) {
        if (i > 0)
            fp3_ode_expect(&p->in, ",", "',' ('%s' has %u arguments)", f->name, f->arguments);
        if (i == 1 && f->op == FP3_EXPR_SELECT)
            return choice(p, name, argument[0], from, f);
        argument[i] = expression(p);
        if (argument[0].size != 1 && fp3_ode_has_terms(f) && fp3_ode_at(&p->in, ")"))
            return fp3_ode_fold(p, name, f->op, argument[0]);
    }
    return fp3_ode_apply(p, name, f, argument);
}

/* What follows the name of a function. */
static ode_value call(ode_parser *p, fp3_token name, const ode_function *f) {
    fp3_ode_expect(&p->in, "(", "'(' after '%s'", f->name);
    const ode_value value = arguments(p, name, f);
    fp3_ode_expect(&p->in, ")", "an operator or ')' ('%s' has %u argument%s)", f->name,
                   f->arguments, f->arguments > 1 ? "s" : "");
    return value;
}

static void no_function(ode_parser *p, fp3_token name) {
    const char *near = fp3_ode_nearest_function(name);
    if (near)
        fp3_ode_wrong(&p->in, name, "a function (did you mean '%s'?)", near);
    else
        fp3_ode_wrong(&p->in, name, "a function");
    fp3_ode_give_up(&p->in, name);
}

/* `count` and `any`, which a model may also have as names of its own. */
static ode_value counted(ode_parser *p, fp3_token name) {
    fp3_ode_advance(&p->in);
    if (!fp3_ode_at_neighbours(p)) {
        fp3_ode_lost(&p->in, "neighbours, as in %.*s(o in touch)", (int)name.length, name.text);
        return nothing;
    }
    const ode_value value = over_neighbours(p, name);
    fp3_ode_expect(&p->in, ")", "an operator or ')'");
    return value;
}

/* Whether what is read is computed when a step has been made, which has a beginning and a length.
 */
static int is_behind_step(const ode_parser *p) { return p->is_in_projection || p->is_in_remember; }

/* `prev(x)`; a model may also have the name as one of its own. */
static ode_value before(ode_parser *p) {
    unsigned start, size;
    fp3_ode_advance(&p->in);
    const fp3_token name = p->in.next;
    const int is_name = name.kind == FP3_TOKEN_NAME;
    if (is_name)
        fp3_ode_advance(&p->in);
    const ode_symbol *s = is_name ? fp3_ode_part(p, name, &start, &size) : NULL;
    if (!is_name || (s && s->class != ODE_STATE))
        fp3_ode_lost_at(&p->in, name, "the name of a state, as in prev(x)");
    if (!s || s->class != ODE_STATE)
        return nothing;
    fp3_ode_expect(&p->in, ")", "')'");
    return fp3_ode_leaves(p, name, FP3_EXPR_BEFORE, s->first + start, size);
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
    if (fp3_token_is(name, FP3_NAME_STEP) && is_behind_step(p))
        return fp3_ode_leaf(p, name, FP3_EXPR_STEP, 0, 0);
    unsigned start, size;
    if (fp3_ode_at(&p->in, "(") && !fp3_ode_find(p, name)) {
        if (fp3_token_is(name, "prev") && is_behind_step(p))
            return before(p);
        if (fp3_ode_fold_named(name) != ODE_NO_FOLD)
            return counted(p, name);
        no_function(p, name);
        return nothing;
    }
    const ode_symbol *other = fp3_ode_find(p, name);
    if (other && other->class == ODE_NEIGHBOUR)
        return of_neighbour(p, name, &p->relations[other->first]);
    const ode_symbol *s = fp3_ode_part(p, name, &start, &size);
    if (!s)
        return nothing;
    const int is_call = fp3_ode_at(&p->in, "(");
    if (is_call && s->class == ODE_STATE)
        return start_of(p, name, s, start, size);
    if (is_call)
        fp3_ode_lost(&p->in, "an operator ('%.*s' is not a function)", (int)s->at.length,
                     s->at.text);
    return fp3_ode_stands_for(p, name, s, start, size);
}

/* The rest of a vector whose first component has been read. */
static ode_value listed(ode_parser *p, fp3_token open, ode_value part) {
    ode_components all = {.is_good = 1};
    fp3_ode_append(p, open, part, &all);
    while (fp3_ode_accept(&p->in, ","))
        fp3_ode_append(p, open, expression(p), &all);
    return fp3_ode_vector_of(p, open, &all);
}

/* "i in 1..4: i^2", a vector of a component for each. */
static ode_value ranged(ode_parser *p, fp3_token open) {
    ode_components all = {.is_good = 1};
    ode_range range;
    fp3_ode_range_open(p, &range);
    while (fp3_ode_range_pass(p, &range)) {
        const ode_value part = expression(p);
        if (!p->skipping)
            fp3_ode_append(p, open, part, &all);
    }
    return range.is_good ? fp3_ode_vector_of(p, open, &all) : nothing;
}

static ode_value bracketed(ode_parser *p) {
    fp3_token open = p->in.next;
    fp3_ode_advance(&p->in);
    ode_value value = fp3_ode_at_range(p) ? ranged(p, open) : expression(p);
    if (fp3_ode_at(&p->in, ","))
        value = listed(p, open, value);
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

/* A whole exponent is one number, however it is written: units and derivatives of powers depend on
 * it. */
static ode_value exponent_of(ode_parser *p, ode_value value, uint32_t from) {
    const double number = fp3_ode_is_number(p, value) ? p->values[value.expr[0]] : NAN;
    if (number != floor(number) || isinf(number) || p->exprs[value.expr[0]].op == FP3_EXPR_NUMBER)
        return value;
    const fp3_token at = p->expr_at[value.expr[0]];
    fp3_ode_forget(p, from);
    return fp3_ode_leaf(p, at, FP3_EXPR_NUMBER, 0, number);
}

static ode_value power(ode_parser *p) {
    ode_value base = primary(p);
    fp3_token at = p->in.next;
    if (!fp3_ode_accept(&p->in, "^"))
        return base;
    const uint32_t from = p->expr_count;
    ode_value exponent = enter(p) ? unary(p) : nothing;
    leave(p);
    return fp3_ode_binary(p, at, FP3_EXPR_POWER, base, exponent_of(p, exponent, from));
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
        p->values[value.expr[0]] = p->exprs[value.expr[0]].number *= -1;
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
    const uint32_t from = p->expr_count;
    ode_value value = enter(p) ? disjunction(p) : nothing;
    fp3_token at = p->in.next;
    if (fp3_ode_accept(&p->in, "?"))
        value = choice(p, at, value, from, NULL);
    leave(p);
    return value;
}

ode_value fp3_ode_expression(ode_parser *p, ode_context context) {
    p->context = context;
    return expression(p);
}

/* ---- ranges and indices ---- */

/* Reads a number made of numbers and indices. 0 after an error, and where it is skipped. */
static int plain(ode_parser *p, double *number) {
    const fp3_token at = p->in.next;
    const uint32_t from = p->expr_count;
    const ode_context around = p->context;
    const ode_value value = fp3_ode_expression(p, ODE_IN_INDEX);
    p->context = around;
    if (value.size > 1)
        fp3_ode_wrong(&p->in, at, "a number (this is %s)", fp3_ode_shape(value.size));
    fp3_ode_forget(p, from);
    if (value.size == 1)
        *number = p->values[value.expr[0]];
    return value.size == 1;
}

int fp3_ode_whole(ode_parser *p, long *number) {
    enum { MOST = 1000000 };
    const fp3_token at = p->in.next;
    double value = 0;
    if (!plain(p, &value))
        return 0;
    *number = fabs(value) <= MOST ? (long)value : 0;
    if ((double)*number == value)
        return 1;
    fp3_ode_wrong(&p->in, at, "a whole number of at most %d (this is %.9g)", MOST, value);
    return 0;
}

/* "[i + 1]" behind a name; no symbol: that is wrong. 0 after an error. */
static int component_here(ode_parser *p, const ode_symbol *s, unsigned *start, unsigned *size) {
    long number = 1;
    fp3_ode_advance(&p->in);
    const fp3_token at = p->in.next;
    const int is_whole = fp3_ode_whole(p, &number);
    fp3_ode_expect(&p->in, "]", "an operator or ']'");
    if (!s || !*size)
        return s != NULL;
    const int is_inside = is_whole && number >= 1 && number <= (long)*size;
    if (is_whole && !is_inside && !p->skipping)
        fp3_ode_wrong(&p->in, at, "an index from 1 to %u for '%.*s' (this is %ld)", *size,
                      (int)s->at.length, s->at.text, number);
    *start = is_inside ? (unsigned)number - 1 : 0;
    *size = 1;
    return is_inside || p->skipping;
}

/* The index that may stand behind a name of this symbol. 0 after an error. */
static int indexed(ode_parser *p, const ode_symbol *s, fp3_token name, unsigned *start,
                   unsigned *size) {
    const int has_index = fp3_ode_at(&p->in, "[") && p->in.next.text == name.text + name.length;
    if (!has_index || (s && *size == 1 && p->context <= ODE_IN_START))
        return s != NULL; /* and then a bracket holds a unit */
    if (s && *size == 1) {
        fp3_ode_lost(&p->in, "an operator ('%.*s' is not a vector)", (int)name.length, name.text);
        return 0;
    }
    return component_here(p, s, start, size);
}

const ode_symbol *fp3_ode_part(ode_parser *p, fp3_token name, unsigned *start, unsigned *size) {
    const ode_symbol *s = fp3_ode_resolve(p, name, start, size);
    return indexed(p, s, name, start, size) ? s : NULL;
}

uint32_t fp3_ode_word(ode_parser *p, uint32_t kind, fp3_token name, unsigned *size) {
    ode_symbol s;
    unsigned start = 0;
    if (!fp3_ode_word_named(p, kind, name, &s))
        return FP3_NONE;
    const int has_part = fp3_ode_component(p, &s, name, &start, size);
    return indexed(p, has_part ? &s : NULL, name, &start, size) ? s.first + start : FP3_NONE;
}

/* "1..4" */
static int ends(ode_parser *p, fp3_token name, long *first, long *last) {
    const int length = (int)name.length;
    int is_good = fp3_ode_whole(p, first);
    fp3_ode_expect(&p->in, "..", "an operator or '..', as in %.*s in 1..4", length, name.text);
    const fp3_token at = p->in.next;
    is_good &= fp3_ode_whole(p, last);
    if (is_good && *last < *first - 1) {
        fp3_ode_wrong(&p->in, at, "a last number of at least %ld (%ld..%ld has none)", *first - 1,
                      *first, *first - 1);
        return 0;
    }
    return is_good;
}

void fp3_ode_range_open(ode_parser *p, ode_range *r) {
    const fp3_token name = p->in.next;
    long first = 0, last = 0;
    fp3_ode_advance(&p->in);
    fp3_ode_expect(&p->in, "in", "in");
    const int is_good = ends(p, name, &first, &last);
    fp3_ode_range_begin(p, name, r, is_good, first, last);
}

int fp3_ode_range_pass(ode_parser *p, ode_range *r) {
    double holds = 1;
    if (!fp3_ode_range_next(p, r))
        return 0;
    if (fp3_ode_accept(&p->in, ",") && !plain(p, &holds))
        holds = 0;
    fp3_ode_expect(&p->in, ":", "an operator, ':' or ',', as in `1..4: ` or `1..4, i != j: `");
    if (holds == 0)
        fp3_ode_range_skip(p, r);
    return 1;
}
