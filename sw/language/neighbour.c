/* SPDX-License-Identifier: Apache-2.0 */
/* neighbour.c - a fold over neighbours is one expression, whose term is read once. */
#include "neighbour.h"

#include <string.h>

#include "meaning.h"
#include "range.h"
#include "symbol.h"
#include "vector.h"

const ode_quantity *fp3_ode_field(const ode_parser *p, const fp3_relation *r, fp3_token name) {
    const char *dot = memchr(name.text, '.', name.length);
    if (dot)
        name.length = (size_t)(dot - name.text);
    for (uint32_t i = r->first_field; i < r->first_field + r->field_count; i++)
        if (p->fields[i].size && fp3_token_same(p->fields[i].at, name))
            return &p->fields[i];
    return NULL;
}

static const ode_symbol *relation_named(ode_parser *p, fp3_token name) {
    const ode_symbol *s = name.kind == FP3_TOKEN_NAME ? fp3_ode_find(p, name) : NULL;
    return s && s->class == ODE_RELATION ? s : NULL;
}

int fp3_ode_at_neighbours(ode_parser *p) {
    ode_lexer ahead = p->in.lexer;
    if (!fp3_ode_at_range(p))
        return 0;
    fp3_ode_next(&ahead);
    return relation_named(p, fp3_ode_next(&ahead)) != NULL;
}

/* The radii of both are added first, and then what is the same for all pairs: so both objects of a
 * pair find the same reach. */
static ode_value reach_of(ode_parser *p, fp3_token at, const fp3_relation *r) {
    const ode_value own = fp3_ode_leaves(p, at, FP3_EXPR_PARAM, r->radius, r->radius != FP3_NONE),
                    theirs = fp3_ode_foreign(p, at, r->their_radius, r->their_radius != FP3_NONE),
                    rest = {1, {(uint16_t)r->reach}};
    const int has_rest = p->exprs[r->reach].op != FP3_EXPR_NUMBER || p->exprs[r->reach].number != 0;
    ode_value sum = own;
    if (theirs.size)
        sum = sum.size ? fp3_ode_binary(p, at, FP3_EXPR_ADD, sum, theirs) : theirs;
    if (!sum.size)
        return rest;
    return has_rest ? fp3_ode_binary(p, at, FP3_EXPR_ADD, sum, rest) : sum;
}

/* The square of the distance to the neighbour is below that of the reach. */
static ode_value is_near(ode_parser *p, fp3_token at, const fp3_relation *r) {
    const ode_value theirs =
        r->of_kind == FP3_NONE
            ? fp3_ode_leaves(p, at, FP3_EXPR_OTHER_STATE, r->position, r->dimensions)
            : fp3_ode_foreign(p, at, r->theirs, r->dimensions);
    const ode_value own = fp3_ode_leaves(p, at, FP3_EXPR_STATE, r->position, r->dimensions);
    const ode_value way = fp3_ode_binary(p, at, FP3_EXPR_SUB, theirs, own);
    const ode_value far = reach_of(p, at, r);
    const ode_value square = r->dimensions > 1 ? fp3_ode_dot(p, at, way, way)
                                               : fp3_ode_binary(p, at, FP3_EXPR_MUL, way, way);
    return fp3_ode_binary(p, at, FP3_EXPR_LESS, square,
                          fp3_ode_binary(p, at, FP3_EXPR_MUL, far, far));
}

ode_value fp3_ode_where_near(ode_parser *p, fp3_token at, uint32_t relation, ode_value near,
                             ode_value otherwise) {
    const fp3_relation *r = &p->relations[relation];
    return r->kind == FP3_NEAR ? fp3_ode_select(p, at, is_near(p, at, r), near, otherwise) : near;
}

ode_fold fp3_ode_fold_named(fp3_token name) {
    static const char *const names[] = {"sum", "min", "max", "count", "any"};
    unsigned i = 0;
    while (i < ODE_NO_FOLD && !fp3_token_is(name, names[i]))
        i++;
    return (ode_fold)i;
}

static ode_value number(ode_parser *p, fp3_token at, double value) {
    return fp3_ode_leaf(p, at, FP3_EXPR_NUMBER, 0, value);
}

int fp3_ode_neighbours_open(ode_parser *p, fp3_token at, ode_neighbours *n) {
    const fp3_token name = p->in.next;
    fp3_ode_advance(&p->in);
    fp3_ode_expect(&p->in, "in", "in");
    const ode_symbol *s = relation_named(p, p->in.next);
    *n = (ode_neighbours){
        .at = at, .fold = fp3_ode_fold_named(at), .relation = s ? s->first : 0, .symbol = FP3_NONE};
    fp3_ode_advance(&p->in);
    n->has_term = (n->fold != ODE_COUNT && n->fold != ODE_ANY) || !fp3_ode_at(&p->in, ")");
    if (n->has_term)
        fp3_ode_expect(&p->in, ":", "':' and a term for each neighbour");
    if (n->fold == ODE_NO_FOLD) {
        fp3_ode_lost_at(&p->in, at, "sum, min, max, count or any, which go over neighbours");
        return 0;
    }
    if (p->is_in_sum || p->context != ODE_IN_EQUATION) {
        fp3_ode_lost_at(&p->in, at,
                        p->is_in_sum ? "a term without another sum over neighbours"
                                     : "a sum over neighbours in an equation only");
        return 0;
    }
    if (fp3_ode_is_new_name(p, name, 1))
        n->symbol = fp3_ode_declare(p, name, ODE_NEIGHBOUR, n->relation, (ode_value){.size = 1});
    p->is_in_sum = 1;
    return 1;
}

void fp3_ode_neighbours_behind(ode_parser *p, const ode_neighbours *n) {
    p->is_in_sum = 0;
    if (n->symbol != FP3_NONE)
        fp3_ode_undeclare(p, n->symbol);
}

/* A neighbour that may be farther than the reach gives what the fold begins with: -0 changes no sum
 * that begins with -0, and no number changes the least or the most of itself and others. */
ode_value fp3_ode_neighbours_close(ode_parser *p, const ode_neighbours *n, ode_value term,
                                   ode_value start) {
    static const ode_value nothing = {0};
    static const fp3_expr_op ops[] = {[ODE_SUM] = FP3_EXPR_TOTAL,
                                      [ODE_LEAST] = FP3_EXPR_LEAST,
                                      [ODE_MOST] = FP3_EXPR_MOST,
                                      [ODE_COUNT] = FP3_EXPR_TOTAL,
                                      [ODE_ANY] = FP3_EXPR_TOTAL};
    const fp3_relation *r = &p->relations[n->relation];
    const int is_counted = n->fold == ODE_COUNT || n->fold == ODE_ANY;
    const ode_value none = number(p, n->at, -0.0);
    if (!n->has_term)
        term = number(p, n->at, 1);
    if (!term.size || p->in.is_lost || (r->kind == FP3_NEAR && r->reach == FP3_NONE))
        return nothing;
    if (is_counted && n->has_term)
        term = fp3_ode_select(p, n->at, term, number(p, n->at, 1), none);
    if (ops[n->fold] == FP3_EXPR_TOTAL) {
        start.size = term.size;
        for (unsigned i = 0; i < term.size; i++)
            start.expr[i] = none.expr[0];
    }
    term = fp3_ode_where_near(p, n->at, n->relation, term, start);
    const ode_value all = fp3_ode_total(p, n->at, ops[n->fold], n->relation, term, start);
    if (n->fold == ODE_ANY)
        return fp3_ode_binary(p, n->at, FP3_EXPR_LESS, number(p, n->at, 0), all);
    /* The sum of nothing is -0, and nobody counts to that. */
    return n->fold == ODE_COUNT ? fp3_ode_binary(p, n->at, FP3_EXPR_ADD, all, number(p, n->at, 0))
                                : all;
}

/* ---- all objects ---- */

int fp3_ode_at_group(const ode_parser *p) {
    ode_lexer ahead = p->in.lexer;
    const fp3_token behind = fp3_ode_next(&ahead);
    return fp3_token_is(p->in.next, "objects") ? fp3_token_is(behind, ":")
           : fp3_token_is(p->in.next, "pairs")
               ? behind.kind == FP3_TOKEN_NAME && !fp3_token_is(behind, "in")
               : 0;
}

/* "o in springs" behind `pairs`. */
static int pairs_open(ode_parser *p, ode_group *g) {
    const fp3_token name = p->in.next;
    fp3_ode_advance(&p->in);
    fp3_ode_expect(&p->in, "in", "in");
    const ode_symbol *s = relation_named(p, p->in.next);
    if (!s) {
        fp3_ode_lost(&p->in, "the name of a relation, as in sum(pairs %.*s in springs: ...)",
                     (int)name.length, name.text);
        return 0;
    }
    g->relation = s->first;
    fp3_ode_advance(&p->in);
    if (fp3_ode_is_new_name(p, name, 1))
        g->symbol = fp3_ode_declare(p, name, ODE_NEIGHBOUR, g->relation, (ode_value){.size = 1});
    return 1;
}

int fp3_ode_group_open(ode_parser *p, fp3_token at, ode_group *g) {
    const int is_of_objects = fp3_token_is(p->in.next, "objects");
    *g = (ode_group){
        .at = at, .op = is_of_objects ? FP3_EXPR_OBJECTS : FP3_EXPR_PAIRS, .symbol = FP3_NONE};
    if (p->is_in_sum || p->context != ODE_IN_INVARIANT || !fp3_token_is(at, "sum")) {
        fp3_ode_lost_at(&p->in, at,
                        p->is_in_sum ? "a term without another sum"
                        : p->context != ODE_IN_INVARIANT
                            ? "a sum over all objects in an invariant only"
                            : "sum, which alone goes over all objects");
        return 0;
    }
    fp3_ode_advance(&p->in);
    if (!is_of_objects && !pairs_open(p, g))
        return 0;
    fp3_ode_expect(&p->in, ":", "':' and a term for each %s", is_of_objects ? "object" : "pair");
    p->is_in_sum = 1;
    return 1;
}

ode_value fp3_ode_group_close(ode_parser *p, const ode_group *g, ode_value term) {
    p->is_in_sum = 0;
    if (g->symbol != FP3_NONE)
        fp3_ode_undeclare(p, g->symbol);
    return fp3_ode_sum_of_group(p, g->at, g->op, g->relation, term);
}

/* ---- what is said of a neighbour ---- */

/* Such words are in the records of guests, so they are params of the program. */
ode_value fp3_ode_foreign(ode_parser *p, fp3_token at, uint32_t first, unsigned size) {
    fp3_ode_leaves(p, at, FP3_EXPR_PARAM, first, size);
    return fp3_ode_leaves(p, at, FP3_EXPR_OTHER_PARAM, first, size);
}

int fp3_ode_neighbours_part(ode_parser *p, fp3_token name, fp3_token *part) {
    const char *dot = memchr(name.text, '.', name.length);
    if (!dot) {
        fp3_ode_lost_at(&p->in, name, "a state, param or field of the neighbour, as in %.*s.x",
                        (int)name.length, name.text);
        return 0;
    }
    *part = name;
    part->length -= (size_t)(dot + 1 - name.text);
    part->location.column += (unsigned)(dot + 1 - name.text);
    part->text = dot + 1;
    return 1;
}

ode_value fp3_ode_neighbours_field(ode_parser *p, fp3_token name, fp3_token part,
                                   const ode_quantity *field) {
    const uint32_t first = (uint32_t)(field - p->fields);
    const char *dot = memchr(part.text, '.', part.length);
    if (!dot)
        return fp3_ode_leaves(p, name, FP3_EXPR_FIELD, first, field->size);
    const unsigned letter = (unsigned)(dot[1] - 'x');
    const size_t behind = part.length - (size_t)(dot + 1 - part.text);
    if (behind == 1 && field->size > 1 && dot[1] >= 'x' && letter < field->size)
        return fp3_ode_leaf(p, name, FP3_EXPR_FIELD, first + letter, 0);
    fp3_ode_wrong(&p->in, name, "a component that the field has (it is %s)",
                  fp3_ode_shape(field->size));
    return (ode_value){0};
}

ode_value fp3_ode_neighbours_value(ode_parser *p, fp3_token name, const fp3_relation *r,
                                   const ode_symbol *s, unsigned start, unsigned size) {
    static const ode_value nothing = {0};
    if (s->class != ODE_STATE && s->class != ODE_PARAM) {
        fp3_ode_wrong(&p->in, name, "a state, a param or a field of '%s'", r->name);
        return nothing;
    }
    const int is_shared = s->class == ODE_PARAM && p->params[s->first].quantity.is_shared;
    if (s->class == ODE_PARAM && !is_shared) /* a word of the record: a param of the program */
        fp3_ode_leaves(p, name, FP3_EXPR_PARAM, s->first + start, size);
    return fp3_ode_leaves(p, name,
                          s->class == ODE_STATE ? FP3_EXPR_OTHER_STATE
                          : is_shared           ? FP3_EXPR_PARAM
                                                : FP3_EXPR_OTHER_PARAM,
                          s->first + start, size);
}
