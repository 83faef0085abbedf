/* SPDX-License-Identifier: Apache-2.0 */
/* relation.c - relations are declared; where they may not be used. */
#include "relation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "constant.h"
#include "dimension_check.h"
#include "evaluate.h"
#include "expression.h"
#include "neighbour.h"
#include "symbol.h"
#include "vector.h"
#include "word.h"

/* ---- declarations ---- */

static const struct {
    const char *word;
    fp3_relation_kind kind;
} kinds[] = {{"links", FP3_LINKS}, {"near", FP3_NEAR}, {"all", FP3_ALL}};
enum { KINDS = sizeof kinds / sizeof *kinds };

static unsigned kind_of(fp3_token word) {
    unsigned i = 0;
    while (i < KINDS && !fp3_token_is(word, kinds[i].word))
        i++;
    return i;
}

int fp3_ode_is_relation(fp3_token word) { return kind_of(word) < KINDS; }

static char *copied(ode_parser *p, const char *text) {
    char *copy = strdup(text);
    p->out_of_memory |= !copy;
    return copy;
}

/* "[2]" behind the name of a field that is a vector. */
static unsigned size_here(ode_parser *p) {
    const fp3_token at = p->in.next;
    long number = 1;
    if (!fp3_ode_accept(&p->in, "["))
        return 1;
    if (fp3_ode_whole(p, &number) && (number < 2 || number > ODE_LETTERS))
        fp3_ode_lost_at(&p->in, at, "a number from 2 to %d, the size of a vector", ODE_LETTERS);
    fp3_ode_expect(&p->in, "]", "']'");
    return number < 1 || number > ODE_LETTERS ? 1 : (unsigned)number;
}

/* "k = 10 [N/m]" */
static void field(ode_parser *p, fp3_relation *r) {
    const fp3_token name = p->in.next;
    ode_constant constant = {.dimension_text = ""};
    if (name.kind != FP3_TOKEN_NAME) {
        fp3_ode_lost(&p->in, "the name of a field, as in links springs(k = 10 [N/m])");
        return;
    }
    fp3_ode_advance(&p->in);
    const unsigned size = size_here(p);
    const int is_new = fp3_ode_is_new_name(p, name, size);
    if (is_new && fp3_ode_field(p, r, name))
        fp3_ode_wrong(&p->in, name, "a new name (this relation has such a field)");
    if (is_new && r->of_kind != FP3_NONE && fp3_ode_word_of(p, &p->kinds[r->of_kind], name))
        fp3_ode_wrong(&p->in, name, "a new name (kind '%s' has such a word)",
                      p->kinds[r->of_kind].name);
    fp3_ode_expect(&p->in, "=",
                   r->kind == FP3_LINKS ? "'=' and the default value of links"
                                        : "'= 0', which a new pair has");
    const fp3_token value_at = p->in.next;
    fp3_ode_measured(p, ODE_IN_CONSTANT, size, &constant);
    for (unsigned i = 0; r->kind == FP3_NEAR && i < size; i++)
        if (constant.value[i] != 0 || signbit(constant.value[i]))
            fp3_ode_wrong(&p->in, value_at, "0, which a new pair of near objects remembers");
    if (p->field_count + size > ODE_QUANTITIES) {
        fp3_ode_over(&p->in, name, "at most %d fields", ODE_QUANTITIES);
        return;
    }
    for (unsigned i = 0; i < size; i++) {
        ode_quantity *q = &p->fields[p->field_count++];
        *q = (ode_quantity){.at = name, .dimension = constant.dimension, .size = i == 0 ? size : 0};
        fp3_ode_scalar_name(name, size, i, q->quantity.name);
        q->quantity.dimension = copied(p, constant.dimension_text);
        q->quantity.doc = copied(p, "");
        q->quantity.value = constant.value[i];
        q->quantity.derivative = q->quantity.velocity = q->quantity.exact = q->quantity.start =
            FP3_NONE;
        q->quantity.line = name.location.line;
        r->field_count++;
    }
}

/* "cars" in links seats(cars, k = 1) and in all suns(planets): what has no value is no field. */
static int is_kind_next(ode_parser *p, const fp3_relation *r) {
    ode_lexer ahead = p->in.lexer;
    const fp3_token behind = fp3_ode_next(&ahead);
    return p->in.next.kind == FP3_TOKEN_NAME &&
           ((r->kind == FP3_ALL && !fp3_token_is(behind, "=") && !fp3_token_is(behind, "[")) ||
            fp3_token_is(behind, ",") || fp3_token_is(behind, ")") ||
            fp3_ode_kind_named(p, p->in.next) != FP3_NONE);
}

static void kind_here(ode_parser *p, fp3_relation *r) {
    const fp3_token name = p->in.next;
    r->of_kind = fp3_ode_kind_here(p, name);
    if (r->of_kind == FP3_NONE)
        return;
    if (memchr(name.text, '.', name.length))
        fp3_ode_lost(&p->in, "the kind alone");
    fp3_ode_advance(&p->in);
}

static void fields(ode_parser *p, fp3_relation *r) {
    if (!fp3_ode_accept(&p->in, "("))
        return;
    if (is_kind_next(p, r)) {
        kind_here(p, r);
        if (r->kind == FP3_ALL || !fp3_ode_accept(&p->in, ",")) {
            fp3_ode_expect(&p->in, ")", r->kind == FP3_ALL ? "')'" : "',' or ')'");
            return;
        }
    }
    if (r->kind == FP3_ALL)
        fp3_ode_lost(&p->in,
                     "a kind, as in all suns(planets): `all` keeps no fields; near with a reach "
                     "that takes all does, as in near %s(x, 1000, s = 0)",
                     r->name);
    do
        field(p, r);
    while (fp3_ode_accept(&p->in, ","));
    fp3_ode_expect(&p->in, ")", "',' or ')'");
}

/* ---- the reach ---- */

/* How a reach calls the neighbour, unless the model calls something else so. */
#define NEIGHBOUR "o"

/* Of what is not declared, a name with a dot is meant to be such a position. */
static int is_position_next(ode_parser *p) {
    const fp3_token name = p->in.next;
    const char *dot = name.kind == FP3_TOKEN_NAME ? memchr(name.text, '.', name.length) : NULL;
    if (name.kind != FP3_TOKEN_NAME || fp3_ode_kind_named(p, name) != FP3_NONE)
        return name.kind == FP3_TOKEN_NAME;
    const int is_neighbour = dot == name.text + strlen(NEIGHBOUR) && *name.text == *NEIGHBOUR;
    return dot && !is_neighbour && !fp3_ode_find(p, name);
}

/* Reads an expression in which o.R is a param of the neighbour. */
static ode_value of_both(ode_parser *p, const fp3_relation *r) {
    fp3_token name = p->in.next;
    name.kind = FP3_TOKEN_NAME;
    name.text = NEIGHBOUR;
    name.length = strlen(NEIGHBOUR);
    if (fp3_ode_occupied(p, name, 1) || p->relation_count == FP3_RELATIONS_MAX)
        return fp3_ode_expression(p, ODE_IN_START);
    p->relations[p->relation_count] = *r;
    const uint32_t symbol =
        fp3_ode_declare(p, name, ODE_NEIGHBOUR, p->relation_count, (ode_value){.size = 1});
    const ode_value value = fp3_ode_expression(p, ODE_IN_START);
    if (symbol != FP3_NONE)
        fp3_ode_undeclare(p, symbol);
    return value;
}

typedef struct {
    ode_parser *p;
    fp3_token at;
    uint32_t from;
    const char *varies;         /* of each expression from there on: with the object */
    uint32_t own, theirs, rest; /* params, and an expression; FP3_NONE: none yet */
    int is_good;
} addends;

/* What is the same for all objects, and at most one param of each of the two. */
static void add(addends *a, uint32_t expr) {
    const fp3_expr e = a->p->exprs[expr];
    const int varies = expr >= a->from && a->varies[expr - a->from];
    uint32_t *param = e.op == FP3_EXPR_OTHER_PARAM ? &a->theirs : &a->own;
    if (!varies) {
        ode_value sum = {1, {(uint16_t)expr}};
        if (a->rest != FP3_NONE)
            sum =
                fp3_ode_binary(a->p, a->at, FP3_EXPR_ADD, (ode_value){1, {(uint16_t)a->rest}}, sum);
        a->rest = sum.size ? sum.expr[0] : a->rest;
    } else if (e.op == FP3_EXPR_PARAM || e.op == FP3_EXPR_OTHER_PARAM) {
        a->is_good &= *param == FP3_NONE;
        *param = e.index;
    } else {
        a->is_good = 0;
    }
}

static void split(addends *a, uint32_t expr) {
    while (expr >= a->from && a->varies[expr - a->from] && a->p->exprs[expr].op == FP3_EXPR_ADD) {
        split(a, a->p->exprs[expr].operand[1]);
        expr = a->p->exprs[expr].operand[0];
    }
    add(a, expr);
}

/* Of each expression from `from` on, whether objects have different values of it. NULL: out of
 * memory. */
static char *find_what_varies(const ode_parser *p, uint32_t from) {
    char *varies = calloc(p->expr_count - from + 1u, 1);
    for (uint32_t i = from; varies && i < p->expr_count; i++) {
        const fp3_expr *e = &p->exprs[i];
        varies[i - from] = e->op == FP3_EXPR_OTHER_PARAM || e->op == FP3_EXPR_OTHER_STATE ||
                           e->op == FP3_EXPR_FIELD ||
                           (e->op == FP3_EXPR_PARAM && !p->params[e->index].quantity.is_shared);
        for (unsigned k = 0; k < fp3_ode_operands(e->op); k++)
            if (e->operand[k] >= from)
                varies[i - from] |= varies[e->operand[k] - from];
    }
    return varies;
}

/* Whether it is made of states of the neighbour. */
static int refuse_states(ode_parser *p, uint32_t from) {
    for (uint32_t i = from; i < p->expr_count; i++)
        if (p->exprs[i].op == FP3_EXPR_OTHER_STATE) {
            fp3_ode_wrong(
                &p->in, p->expr_at[i],
                "a param of the neighbour ('%s' is a state: who is near is found before a "
                "step, by what the step does not change)",
                p->states[p->exprs[i].index].quantity.name);
            return 1;
        }
    return 0;
}

/* The parts of a reach; 0: it has no such parts. */
static int take_reach(ode_parser *p, fp3_token at, uint32_t from, uint32_t expr, fp3_relation *r) {
    char *varies = find_what_varies(p, from);
    addends a = {p, at, from, varies, FP3_NONE, FP3_NONE, FP3_NONE, 1};
    if (varies)
        split(&a, expr);
    else
        p->out_of_memory = 1;
    free(varies);
    if (!varies || !a.is_good || (r->of_kind == FP3_NONE && a.own != a.theirs))
        return 0;
    if (a.rest == FP3_NONE) {
        const ode_value none = fp3_ode_leaf(p, at, FP3_EXPR_NUMBER, 0, 0);
        a.rest = none.size ? none.expr[0] : FP3_NONE;
    }
    r->radius = a.own;
    r->their_radius = a.theirs;
    r->reach = a.rest;
    return 1;
}

/* ", balls.x": the position of those of another kind. */
static void their_position(ode_parser *p, fp3_relation *r, const ode_symbol *own, unsigned start,
                           unsigned own_size) {
    const fp3_token name = p->in.next;
    fp3_token part;
    unsigned size = 0;
    r->of_kind = fp3_ode_kind_here(p, name);
    if (r->of_kind == FP3_NONE)
        return;
    fp3_ode_advance(&p->in);
    if (!memchr(name.text, '.', name.length))
        fp3_ode_lost_at(&p->in, name, "their position, a word of the kind, as in %.*s.x",
                        (int)name.length, name.text);
    if (p->in.is_lost || !fp3_ode_neighbours_part(p, name, &part))
        return;
    r->theirs = fp3_ode_word(p, r->of_kind, part, &size);
    fp3_ode_expect(&p->in, ",", "',' and the reach");
    if (r->theirs == FP3_NONE || !own)
        return;
    if (size != own_size)
        fp3_ode_wrong(&p->in, name, "a position as the own one is, %s (this is %s)",
                      fp3_ode_shape(own_size), fp3_ode_shape(size));
    else if (!fp3_ode_dimension_fits(&p->params[r->theirs].dimension,
                                     &p->states[own->first + start].dimension))
        fp3_ode_wrong(&p->in, name, "a position in the unit of '%s'",
                      p->states[own->first + start].quantity.name);
}

/* "(x, 0.2)" or "(x, R + o.R)": a state, and the distance up to which others count. */
static void reach(ode_parser *p, fp3_relation *r) {
    unsigned start = 0, size = 0;
    fp3_ode_expect(&p->in, "(", "'(', the position and the reach, as in near touch(x, 0.2)");
    const fp3_token name = p->in.next;
    fp3_ode_advance(&p->in);
    const ode_symbol *s = name.kind == FP3_TOKEN_NAME ? fp3_ode_part(p, name, &start, &size) : NULL;
    if (name.kind != FP3_TOKEN_NAME || (s && s->class != ODE_STATE) || size > ODE_LETTERS)
        fp3_ode_lost_at(&p->in, name, "the position: a state, a number or a vector of 2 or 3");
    fp3_ode_expect(&p->in, ",", "',' and the reach");
    if (is_position_next(p))
        their_position(p, r, s, start, size);
    const fp3_token at = p->in.next;
    const uint32_t from = p->expr_count;
    const ode_value value = of_both(p, r);
    while (!p->in.is_lost && fp3_ode_accept(&p->in, ","))
        field(p, r);
    fp3_ode_expect(&p->in, ")", "an operator, ',' or ')'");
    if (!s || !value.size || p->in.is_lost)
        return;
    fp3_ode_check_dimensions(p, from);
    if (refuse_states(p, from))
        return;
    const uint32_t more = p->expr_count;
    if (value.size > 1 ||
        !fp3_ode_dimension_fits(&p->dimensions[value.expr[0]], &p->states[s->first].dimension) ||
        !take_reach(p, at, from, value.expr[0], r)) {
        fp3_ode_wrong(&p->in, at,
                      "a distance in the unit of '%.*s', of numbers and shared params, to which %s",
                      (int)name.length, name.text,
                      r->of_kind == FP3_NONE
                          ? "one param of both objects may be added, as in R + o.R"
                          : "a param of either object may be added, as in R + o.R");
        return;
    }
    fp3_ode_check_dimensions(p, more);
    r->position = s->first + start;
    r->dimensions = size;
}

void fp3_ode_relation(ode_parser *p, fp3_token word) {
    const fp3_token name = p->in.next;
    fp3_relation made = {.kind = kinds[kind_of(word)].kind,
                         .first_field = p->field_count,
                         .reach = FP3_NONE,
                         .radius = FP3_NONE,
                         .their_radius = FP3_NONE,
                         .line = word.location.line,
                         .of_kind = FP3_NONE,
                         .theirs = FP3_NONE};
    if (name.kind != FP3_TOKEN_NAME) {
        fp3_ode_lost(&p->in, "a name, as in %s springs", kinds[kind_of(word)].word);
        return;
    }
    fp3_ode_advance(&p->in);
    const int is_new = fp3_ode_is_new_name(p, name, 1);
    fp3_ode_scalar_name(name, 1, 0, made.name);
    if (made.kind == FP3_NEAR)
        reach(p, &made);
    else
        fields(p, &made);
    if (p->relation_count == FP3_RELATIONS_MAX) {
        fp3_ode_over(&p->in, name, "at most %d relations", FP3_RELATIONS_MAX);
        return;
    }
    if (is_new)
        fp3_ode_declare(p, name, ODE_RELATION, p->relation_count, (ode_value){.size = 1});
    p->relations[p->relation_count++] = made;
}

/* ---- invariants ---- */

/* What an expression is made of. */
enum {
    HAS_FOLD = 1,   /* a sum over neighbours */
    HAS_GROUP = 2,  /* a sum over all objects, or over pairs */
    HAS_OBJECT = 4, /* what one object has, outside such a sum */
    HAS_MEMORY = 8  /* what pairs remember */
};

static int made_of(const ode_parser *p, uint32_t expr) {
    const fp3_expr *e = &p->exprs[expr];
    switch (e->op) {
    case FP3_EXPR_STATE:
    case FP3_EXPR_OTHER_STATE:
    case FP3_EXPR_OTHER_PARAM:
        return HAS_OBJECT;
    case FP3_EXPR_PARAM:
        return p->params[e->index].quantity.is_shared ? 0 : HAS_OBJECT;
    case FP3_EXPR_FIELD:
        for (uint32_t i = 0; i < p->memory_count; i++)
            if (p->memories[i].field == e->index)
                return HAS_OBJECT | HAS_MEMORY;
        return HAS_OBJECT;
    default:
        return fp3_expr_is_fold(e->op) ? HAS_FOLD : 0;
    }
}

static char *find_made_of(const ode_parser *p) {
    char *made = calloc(p->expr_count + 1u, 1);
    for (uint32_t i = 0; made && i < p->expr_count; i++) {
        made[i] = (char)made_of(p, i);
        for (int k = 0; k < 3; k++)
            made[i] |=
                (char)(p->exprs[i].operand[k] != FP3_NONE ? made[p->exprs[i].operand[k]] : 0);
        if (p->exprs[i].op == FP3_EXPR_OBJECTS || p->exprs[i].op == FP3_EXPR_PAIRS)
            made[i] = (char)((made[i] & ~HAS_OBJECT) | HAS_GROUP);
    }
    return made;
}

/* The leaf that makes an expression be made of this. */
static fp3_token where(const ode_parser *p, const char *made, uint32_t expr, int of) {
    for (int is_deeper = 1; is_deeper;) {
        is_deeper = 0;
        for (int k = 0; !is_deeper && k < 3; k++) {
            const uint32_t operand = p->exprs[expr].operand[k];
            if (operand == FP3_NONE || !(made[operand] & of))
                continue;
            expr = operand;
            is_deeper = 1;
        }
    }
    return p->expr_at[expr];
}

static void check_invariant(ode_parser *p, const char *made, uint32_t expr) {
    static const char expected[] =
        "an invariant without a sum over neighbours (of all objects: sum(objects: ...) and "
        "sum(pairs o in NAME: ...))";
    const int is = made[expr];
    if (is & HAS_FOLD)
        fp3_ode_wrong(&p->in, p->expr_at[expr], expected);
    else if (is & HAS_GROUP && is & HAS_OBJECT)
        fp3_ode_wrong(&p->in, where(p, made, expr, HAS_OBJECT),
                      "what all objects share, as this invariant is of all of them; or put it into "
                      "sum(objects: ...)");
    else if (is & HAS_MEMORY)
        fp3_ode_wrong(&p->in, where(p, made, expr, HAS_MEMORY),
                      "a field that keeps its value (what pairs remember stays in the engine)");
}

void fp3_ode_finish_invariants(ode_parser *p) {
    const uint32_t count = p->invariant_count;
    char *made = find_made_of(p);
    p->out_of_memory |= !made;
    p->invariant_count = 0;
    for (uint32_t i = 0; made && i < count; i++) {
        const fp3_definition one = p->invariants[i];
        check_invariant(p, made, one.expr);
        if (made[one.expr] & HAS_GROUP)
            p->group_invariants[p->group_invariant_count++] = one;
        else
            p->invariants[p->invariant_count++] = one;
    }
    free(made);
}
