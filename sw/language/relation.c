/* relation.c - relations are declared, and a sum over neighbours is one expression whose term is read once. */
#include "relation.h"

#include <stdlib.h>
#include <string.h>

#include "constant.h"
#include "dimension_check.h"
#include "expression.h"
#include "meaning.h"
#include "symbol.h"
#include "vector.h"

static const ode_value nothing = {0};

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

static const ode_quantity *field_of(const ode_parser *p, const fp3_relation *r, fp3_token name) {
    for (uint32_t i = r->first_field; i < r->first_field + r->field_count; i++)
        if (fp3_token_is(name, p->fields[i].quantity.name))
            return &p->fields[i];
    return NULL;
}

/* "k = 10 [N/m]" */
static void field(ode_parser *p, fp3_relation *r) {
    const fp3_token name = p->in.next;
    ode_constant constant;
    if (name.kind != FP3_TOKEN_NAME) {
        fp3_ode_lost(&p->in, "the name of a field, as in links springs(k = 10 [N/m])");
        return;
    }
    fp3_ode_advance(&p->in);
    const int is_new = fp3_ode_is_new_name(p, name, 1);
    if (is_new && field_of(p, r, name))
        fp3_ode_wrong(&p->in, name, "a new name (this relation has such a field)");
    fp3_ode_expect(&p->in, "=", "'=' and the value of links that do not say it");
    fp3_ode_measured(p, ODE_IN_CONSTANT, 1, &constant);
    if (p->field_count == ODE_QUANTITIES) {
        fp3_ode_over(&p->in, name, "at most %d fields of links", ODE_QUANTITIES);
        return;
    }
    ode_quantity *q = &p->fields[p->field_count++];
    *q = (ode_quantity){.at = name, .dimension = constant.dimension};
    fp3_ode_scalar_name(name, 1, 0, q->quantity.name);
    q->quantity.dimension = copied(p, constant.dimension_text);
    q->quantity.doc = copied(p, "");
    q->quantity.value = constant.value[0];
    q->quantity.derivative = q->quantity.velocity = q->quantity.exact = q->quantity.start =
        FP3_NONE;
    q->quantity.line = name.location.line;
    r->field_count++;
}

static void fields(ode_parser *p, fp3_relation *r) {
    if (!fp3_ode_accept(&p->in, "("))
        return;
    do
        field(p, r);
    while (fp3_ode_accept(&p->in, ","));
    fp3_ode_expect(&p->in, ")", "',' or ')'");
}

static int is_shared(const ode_parser *p, uint32_t from) {
    for (uint32_t i = from; i < p->expr_count; i++)
        if (p->exprs[i].op == FP3_EXPR_PARAM && !p->params[p->exprs[i].index].quantity.is_shared)
            return 0;
    return 1;
}

/* "(x, 0.2)": a state, and the distance up to which others count. */
static void reach(ode_parser *p, fp3_relation *r) {
    unsigned start = 0, size = 0;
    fp3_ode_expect(&p->in, "(",
                   "'(', the position and how far it reaches, as in near touch(x, 0.2)");
    const fp3_token name = p->in.next;
    fp3_ode_advance(&p->in);
    const ode_symbol *s = name.kind == FP3_TOKEN_NAME ? fp3_ode_part(p, name, &start, &size) : NULL;
    if (name.kind != FP3_TOKEN_NAME || (s && s->class != ODE_STATE) || size > ODE_LETTERS)
        fp3_ode_lost_at(&p->in, name, "the position: a state, a number or a vector of 2 or 3");
    fp3_ode_expect(&p->in, ",", "',' and how far it reaches");
    const fp3_token at = p->in.next;
    const uint32_t from = p->expr_count;
    const ode_value value = fp3_ode_expression(p, ODE_IN_START);
    fp3_ode_expect(&p->in, ")", "an operator or ')'");
    if (!s || !value.size || p->in.is_lost)
        return;
    fp3_ode_check_dimensions(p, from);
    if (value.size > 1 || !is_shared(p, from) ||
        !fp3_ode_dimension_fits(&p->dimensions[value.expr[0]], &p->states[s->first].dimension)) {
        fp3_ode_wrong(&p->in, at, "a distance in the unit of '%.*s', of numbers and shared params",
                      (int)name.length, name.text);
        return;
    }
    r->reach = value.expr[0];
    r->position = s->first + start;
    r->dimensions = size;
}

void fp3_ode_relation(ode_parser *p, fp3_token word) {
    const fp3_token name = p->in.next;
    fp3_relation made = {.kind = kinds[kind_of(word)].kind,
                         .first_field = p->field_count,
                         .reach = FP3_NONE,
                         .line = word.location.line};
    if (name.kind != FP3_TOKEN_NAME) {
        fp3_ode_lost(&p->in, "a name, as in %s springs", kinds[kind_of(word)].word);
        return;
    }
    fp3_ode_advance(&p->in);
    const int is_new = fp3_ode_is_new_name(p, name, 1);
    fp3_ode_scalar_name(name, 1, 0, made.name);
    if (made.kind == FP3_LINKS)
        fields(p, &made);
    else if (made.kind == FP3_NEAR)
        reach(p, &made);
    if (p->relation_count == FP3_RELATIONS_MAX) {
        fp3_ode_over(&p->in, name, "at most %d relations", FP3_RELATIONS_MAX);
        return;
    }
    if (is_new)
        fp3_ode_declare(p, name, ODE_RELATION, p->relation_count, (ode_value){.size = 1});
    p->relations[p->relation_count++] = made;
}

/* ---- neighbours ---- */

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

/* The square of the distance to the neighbour is below that of the reach. */
static ode_value is_near(ode_parser *p, fp3_token at, const fp3_relation *r) {
    const ode_value theirs =
        fp3_ode_leaves(p, at, FP3_EXPR_OTHER_STATE, r->position, r->dimensions);
    const ode_value own = fp3_ode_leaves(p, at, FP3_EXPR_STATE, r->position, r->dimensions);
    const ode_value way = fp3_ode_binary(p, at, FP3_EXPR_SUB, theirs, own);
    const ode_value far = {1, {(uint16_t)r->reach}};
    const ode_value square = r->dimensions > 1 ? fp3_ode_dot(p, at, way, way)
                                               : fp3_ode_binary(p, at, FP3_EXPR_MUL, way, way);
    return fp3_ode_binary(p, at, FP3_EXPR_LESS, square,
                          fp3_ode_binary(p, at, FP3_EXPR_MUL, far, far));
}

/* What is added up of a neighbour that may be farther than the reach: the term, or -0, which changes no sum. */
static ode_value where_near(ode_parser *p, fp3_token at, const fp3_relation *r, ode_value term) {
    const ode_value near = is_near(p, at, r);
    ode_value none = {.size = term.size};
    for (unsigned i = 0; i < term.size; i++)
        none.expr[i] = fp3_ode_leaf(p, at, FP3_EXPR_NUMBER, 0, -0.0).expr[0];
    return fp3_ode_select(p, at, near, term, none);
}

ode_value fp3_ode_over_neighbours(ode_parser *p, fp3_token sum) {
    const fp3_token name = p->in.next;
    fp3_ode_advance(&p->in);
    fp3_ode_expect(&p->in, "in", "in");
    const ode_symbol *s = relation_named(p, p->in.next);
    const uint32_t relation = s ? s->first : 0;
    fp3_ode_advance(&p->in);
    fp3_ode_expect(&p->in, ":", "':' and what is added up for each neighbour");
    if (p->is_in_sum || p->context != ODE_IN_EQUATION) {
        fp3_ode_lost_at(&p->in, sum,
                        p->is_in_sum ? "a term without another sum over neighbours"
                                     : "a sum over neighbours in an equation only");
        return nothing;
    }
    const int is_new = fp3_ode_is_new_name(p, name, 1);
    const uint32_t symbol =
        is_new ? fp3_ode_declare(p, name, ODE_NEIGHBOUR, relation, (ode_value){.size = 1})
               : FP3_NONE;
    p->is_in_sum = 1;
    ode_value term = fp3_ode_inner(p);
    p->is_in_sum = 0;
    if (is_new)
        fp3_ode_undeclare(p, symbol);
    const fp3_relation *r = &p->relations[relation];
    if (!term.size || p->in.is_lost || (r->kind == FP3_NEAR && r->reach == FP3_NONE))
        return nothing;
    if (r->kind == FP3_NEAR)
        term = where_near(p, sum, r, term);
    return fp3_ode_total(p, sum, relation, term);
}

ode_value fp3_ode_of_neighbour(ode_parser *p, fp3_token name, const ode_symbol *neighbour) {
    const fp3_relation *r = &p->relations[neighbour->first];
    const char *dot = memchr(name.text, '.', name.length);
    unsigned start = 0, size = 0;
    if (!dot) {
        fp3_ode_lost_at(&p->in, name, "a state, param or field of the neighbour, as in %.*s.x",
                        (int)name.length, name.text);
        return nothing;
    }
    fp3_token part = name;
    part.length -= (size_t)(dot + 1 - name.text);
    part.location.column += (unsigned)(dot + 1 - name.text);
    part.text = dot + 1;
    const ode_quantity *of_link = field_of(p, r, part);
    if (of_link)
        return fp3_ode_leaf(p, name, FP3_EXPR_FIELD, (uint32_t)(of_link - p->fields), 0);
    const ode_symbol *s = fp3_ode_part(p, part, &start, &size);
    if (!s)
        return nothing;
    if (s->class != ODE_STATE && s->class != ODE_PARAM) {
        fp3_ode_wrong(&p->in, part, "a state, a param or a field of '%s'", r->name);
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

/* ---- what has no neighbours ---- */

static void check_events(ode_parser *p, const ode_event *events, uint32_t count,
                         const char *has_sum, const char *what) {
    for (uint32_t i = 0; i < count; i++) {
        const ode_event *e = &events[i];
        int has = (e->condition != FP3_NONE && has_sum[e->condition]) ||
                  (e->unless != FP3_NONE && has_sum[e->unless]);
        for (uint32_t k = e->first; k < e->first + e->count; k++)
            has |= p->assignments[k].to.expr != FP3_NONE && has_sum[p->assignments[k].to.expr];
        if (has)
            fp3_ode_wrong(&p->in, e->at, "%s without a sum over neighbours", what);
    }
}

void fp3_ode_check_sums(ode_parser *p) {
    static const char invariant[] = "an invariant without a sum over neighbours";
    char *has_sum = calloc(p->expr_count + 1u, 1);
    if (!has_sum) {
        p->out_of_memory = 1;
        return;
    }
    for (uint32_t i = 0; i < p->expr_count; i++) {
        has_sum[i] = p->exprs[i].op == FP3_EXPR_TOTAL;
        for (int k = 0; k < 3; k++)
            has_sum[i] |= p->exprs[i].operand[k] != FP3_NONE && has_sum[p->exprs[i].operand[k]];
    }
    check_events(p, p->events, p->event_count, has_sum, "an event");
    check_events(p, p->projections, p->projection_count, has_sum, "a projection");
    for (uint32_t i = 0; i < p->invariant_count; i++)
        if (has_sum[p->invariants[i].expr])
            fp3_ode_wrong(&p->in, p->expr_at[p->invariants[i].expr], invariant);
    free(has_sum);
}
