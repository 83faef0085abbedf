/* SPDX-License-Identifier: Apache-2.0 */
/* invariants.c - see invariants.h. */
#include "invariants.h"

#include "language/evaluate.h"
#include "world/apply.h"
#include "world/values_own.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A word of a kind in the group that has it. */
typedef struct {
    int is_state;
    uint32_t index;
} word;

typedef struct {
    const fp3_invariant_group *of;
    const fp3_model *model;         /* NULL: the program is none */
    double *params;                 /* a row for each object */
    size_t seen[FP3_RELATIONS_MAX]; /* of each relation, whom it sees: a group */
    word *words;                    /* of each param that is a word of a kind */
    double *values, *sizes;         /* of expressions */
    uint32_t *own, *both; /* of the term that is summed: what changes with the pair, and the rest */
    uint32_t own_count, both_count;
    char *needed, *varies;
} member;

struct fp3_invariants {
    member *members;
    size_t member_count;
    const char **names;
    size_t count;
};

/* ---- what groups have ---- */

static fp3_status take_params(member *m, fp3_error *error) {
    const size_t count = m->model->param_count, last = m->of->objects - 1;
    fp3_object_values values = {0};
    m->params = calloc(m->of->objects * count + 1, sizeof *m->params);
    fp3_status status = m->params
                            ? fp3_object_values_open(m->of->program, m->of->params, &values, error)
                            : fp3_no_memory(error);
    for (size_t i = 0; !status && i < m->of->objects; i++) {
        status = fp3_object_values_at(&values, last ? (double)i / (double)last : 0, error);
        if (!status)
            memcpy(m->params + i * count, values.params, count * sizeof *values.params);
    }
    fp3_object_values_free(&values);
    return status;
}

static size_t group_named(const fp3_invariants *v, const char *name) {
    for (size_t i = 0; i < v->member_count; i++)
        if (v->members[i].model && v->members[i].of->name && !strcmp(v->members[i].of->name, name))
            return i;
    return SIZE_MAX;
}

static void find_words(fp3_invariants *v, member *m) {
    for (uint32_t k = 0; k < m->model->kind_count; k++) {
        const fp3_kind *kind = &m->model->kinds[k];
        const size_t group = group_named(v, kind->name);
        for (uint32_t p = kind->first; group != SIZE_MAX && p < kind->first + kind->count; p++) {
            const fp3_model *other = v->members[group].model;
            const char *name = m->model->params[p].name + strlen(kind->name) + 1;
            const uint32_t state = fp3_model_state(other, name);
            m->words[p] =
                (word){state != FP3_NONE, state != FP3_NONE ? state : fp3_model_param(other, name)};
        }
    }
}

/* Whom each relation sees. Of a kind that no group is, programs have no objects. */
static void find_seen(fp3_invariants *v, member *m) {
    for (uint32_t r = 0; r < m->model->relation_count; r++) {
        const uint32_t kind = m->model->relations[r].of_kind;
        m->seen[r] = kind == FP3_NONE ? (size_t)(m - v->members)
                                      : group_named(v, m->model->kinds[kind].name);
    }
}

static fp3_status open_member(fp3_invariants *v, member *m, fp3_error *error) {
    const uint32_t exprs = m->model->expr_count;
    m->words = calloc(m->model->param_count + 1u, sizeof *m->words);
    m->values = calloc(2u * exprs + 1u, sizeof *m->values);
    m->own = calloc(2u * exprs + 1u, sizeof *m->own);
    m->needed = calloc(2u * exprs + 1u, 1);
    if (!m->words || !m->values || !m->own || !m->needed)
        return fp3_no_memory(error);
    m->sizes = m->values + exprs;
    m->both = m->own + exprs;
    m->varies = m->needed + exprs;
    find_words(v, m);
    find_seen(v, m);
    return take_params(m, error);
}

static fp3_status add_name(fp3_invariants *v, const char **units, const fp3_definition *one,
                           const char *group, fp3_error *error) {
    for (size_t i = 0; i < v->count; i++)
        if (!strcmp(v->names[i], one->name))
            return !strcmp(units[i], one->unit)
                       ? FP3_OK
                       : fp3_fail(error, FP3_E_ARGUMENT,
                                  "invariant '%s' is in [%s], and in [%s] in group '%s', which it "
                                  "is added to",
                                  one->name, units[i], one->unit, group ? group : "");
    v->names[v->count] = one->name;
    units[v->count++] = one->unit;
    return FP3_OK;
}

static fp3_status find_names(fp3_invariants *v, fp3_error *error) {
    size_t most = 0;
    for (size_t i = 0; i < v->member_count; i++)
        most += v->members[i].model ? v->members[i].model->group_invariant_count : 0;
    const char **units = calloc(most + 1, sizeof *units);
    v->names = calloc(most + 1, sizeof *v->names);
    fp3_status status = units && v->names ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; !status && i < v->member_count; i++)
        for (uint32_t k = 0;
             !status && v->members[i].model && k < v->members[i].model->group_invariant_count; k++)
            status = add_name(v, units, &v->members[i].model->group_invariants[k],
                              v->members[i].of->name, error);
    free(units);
    return status;
}

fp3_status fp3_invariants_open(const fp3_invariant_group *groups, size_t count, fp3_invariants **of,
                               fp3_error *error) {
    fp3_invariants *v = *of = calloc(1, sizeof *v);
    if (!v)
        return fp3_no_memory(error);
    v->members = calloc(count + 1, sizeof *v->members);
    v->member_count = v->members ? count : 0;
    for (size_t i = 0; i < v->member_count; i++)
        v->members[i] = (member){.of = &groups[i], .model = groups[i].program->model};
    fp3_status status = v->members ? find_names(v, error) : fp3_no_memory(error);
    for (size_t i = 0; !status && v->count && i < count; i++)
        status = v->members[i].model ? open_member(v, &v->members[i], error) : FP3_OK;
    if (status)
        fp3_invariants_close(of);
    return status;
}

void fp3_invariants_close(fp3_invariants **of) {
    fp3_invariants *v = *of;
    if (!v)
        return;
    for (size_t i = 0; i < v->member_count; i++) {
        free(v->members[i].params);
        free(v->members[i].words);
        free(v->members[i].values);
        free(v->members[i].own);
        free(v->members[i].needed);
    }
    free(v->members);
    free((void *)v->names);
    free(v);
    *of = NULL;
}

size_t fp3_invariants_count(const fp3_invariants *v) { return v->count; }

const char *fp3_invariants_name(const fp3_invariants *v, size_t number) { return v->names[number]; }

/* ---- one term ---- */

static double word_of(const member *other, word w, size_t object) {
    return w.is_state ? other->of->columns[w.index * other->of->objects + object]
                      : other->params[object * other->model->param_count + w.index];
}

/* The objects of a term: of a sum over objects they are the same, and over pairs they may be linked
 * by a link. */
typedef struct {
    size_t object, other;
    const fp3_links *links;
    size_t link;
    const member *theirs;
} pair;

static double field_of(const member *m, uint32_t field, const pair *of) {
    const fp3_quantity *q = &m->model->fields[field];
    for (size_t i = 0; of->links && i < of->links->field_count; i++)
        if (!strcmp(of->links->names[i], q->name) && !isnan(of->links->fields[i][of->link]))
            return of->links->fields[i][of->link];
    return q->value;
}

static double compute(const member *m, const fp3_expr *e, const pair *of) {
    const fp3_point at = {.t = m->of->t};
    switch (e->op) {
    case FP3_EXPR_STATE:
        return m->of->columns[e->index * m->of->objects + of->object];
    case FP3_EXPR_PARAM:
        return m->params[of->object * m->model->param_count + e->index];
    case FP3_EXPR_OTHER_STATE:
        return m->of->columns[e->index * m->of->objects + of->other];
    case FP3_EXPR_OTHER_PARAM:
        return fp3_model_is_foreign(m->model, e->index)
                   ? word_of(of->theirs, m->words[e->index], of->other)
                   : m->params[of->other * m->model->param_count + e->index];
    case FP3_EXPR_FIELD:
        return field_of(m, e->index, of);
    default:
        return fp3_ode_compute(e, &at, m->values);
    }
}

static void compute_list(member *m, const uint32_t *list, uint32_t count, const pair *of) {
    for (uint32_t i = 0; i < count; i++)
        m->values[list[i]] = compute(m, &m->model->exprs[list[i]], of);
}

/* Marks what an expression is made of, but for what a sum over objects is made of. */
static void mark(member *m, uint32_t expr) {
    memset(m->needed, 0, m->model->expr_count);
    m->needed[expr] = 1;
    for (uint32_t i = expr + 1; i-- > 0;) {
        const fp3_expr *e = &m->model->exprs[i];
        for (unsigned k = 0; m->needed[i] && e->op != FP3_EXPR_OBJECTS && e->op != FP3_EXPR_PAIRS &&
                             k < fp3_ode_operands(e->op);
             k++)
            m->needed[e->operand[k]] = 1;
    }
}

/* What the term is made of: own, which is computed once for each object, and both. */
static void find_term(member *m, uint32_t term) {
    mark(m, term);
    m->own_count = m->both_count = 0;
    for (uint32_t i = 0; i <= term; i++) {
        const fp3_expr *e = &m->model->exprs[i];
        m->varies[i] = e->op == FP3_EXPR_OTHER_STATE || e->op == FP3_EXPR_OTHER_PARAM ||
                       e->op == FP3_EXPR_FIELD;
        for (unsigned k = 0; m->needed[i] && k < fp3_ode_operands(e->op); k++)
            m->varies[i] |= m->varies[e->operand[k]];
        if (m->needed[i] && m->varies[i])
            m->both[m->both_count++] = i;
        else if (m->needed[i])
            m->own[m->own_count++] = i;
    }
}

/* ---- sums ---- */

typedef struct {
    member *m;
    uint32_t term;
    pair at;
    fp3_invariant sum;
} summing;

static void begin(summing *s, size_t object) {
    s->at.object = object;
    compute_list(s->m, s->m->own, s->m->own_count, &s->at);
}

static void add(summing *s, size_t other) {
    s->at.other = other;
    compute_list(s->m, s->m->both, s->m->both_count, &s->at);
    const double value = s->m->values[s->term];
    s->sum.value += value;
    s->sum.size += fabs(value);
}

/* Of the own group a pair is found from the object with the lower number. */
static size_t first_other(const summing *s) { return s->at.theirs == s->m ? s->at.object + 1 : 0; }

static void sum_all(summing *s) {
    for (size_t i = 0; i < s->m->of->objects; i++) {
        begin(s, i);
        for (size_t j = first_other(s); j < s->at.theirs->of->objects; j++)
            add(s, j);
    }
}

static void sum_links(summing *s, const char *relation) {
    const fp3_linked *linked = fp3_linked_find(s->m->of->params->linked, relation);
    s->at.links = linked ? &linked->links : NULL;
    for (size_t i = 0; linked && i < linked->links.count; i++) {
        s->at.link = i;
        begin(s, linked->links.a[i]);
        add(s, linked->links.b[i]);
    }
}

/* ---- near objects ---- */

/* An object by the first component of its position. */
typedef struct {
    double x;
    size_t object;
} place;

static int by_x(const void *one, const void *other) {
    const place *a = one, *b = other;
    return a->x < b->x ? -1 : a->x > b->x ? 1 : a->object < b->object ? -1 : a->object > b->object;
}

static double own_position(const member *m, const fp3_relation *r, uint32_t k, size_t object) {
    return m->of->columns[(r->position + k) * m->of->objects + object];
}

static double their_position(const summing *s, const fp3_relation *r, uint32_t k, size_t object) {
    return r->of_kind == FP3_NONE ? own_position(s->m, r, k, object)
                                  : word_of(s->at.theirs, s->m->words[r->theirs + k], object);
}

/* What an object adds to the reach. */
static double own_radius(const member *m, const fp3_relation *r, size_t object) {
    return r->radius == FP3_NONE ? 0 : m->params[object * m->model->param_count + r->radius];
}

static double their_radius(const summing *s, const fp3_relation *r, size_t object) {
    return r->their_radius == FP3_NONE ? 0
           : r->of_kind == FP3_NONE
               ? s->m->params[object * s->m->model->param_count + r->their_radius]
               : word_of(s->at.theirs, s->m->words[r->their_radius], object);
}

/* The part of the reach that all pairs share. */
static double reach_of(summing *s, const fp3_relation *r) {
    member *m = s->m;
    find_term(m, r->reach);
    compute_list(m, m->own, m->own_count, &(pair){0});
    return m->values[r->reach];
}

/* From the first place of at least x on. */
static size_t find_place(const place *list, size_t count, double x) {
    size_t low = 0, high = count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        *(list[middle].x < x ? &low : &high) = list[middle].x < x ? middle + 1 : middle;
    }
    return low;
}

static void add_if_near(summing *s, const fp3_relation *r, size_t other, double reach) {
    double square = 0;
    for (uint32_t k = 0; k < r->dimensions; k++) {
        const double way = their_position(s, r, k, other) - own_position(s->m, r, k, s->at.object);
        square += way * way;
    }
    if (square < reach * reach)
        add(s, other);
}

static fp3_status sum_near(summing *s, const fp3_relation *r, fp3_error *error) {
    const size_t count = s->at.theirs->of->objects;
    const double same = reach_of(s, r);
    double widest = 0;
    place *list = calloc(count + 1, sizeof *list);
    if (!list)
        return fp3_no_memory(error);
    for (size_t j = 0; j < count; j++) {
        const double x = their_position(s, r, 0, j);
        list[j] = (place){isnan(x) ? INFINITY : x, j};
        widest = fmax(widest, their_radius(s, r, j));
    }
    qsort(list, count, sizeof *list, by_x);
    find_term(s->m, s->term);
    for (size_t i = 0; i < s->m->of->objects; i++) {
        const double x = own_position(s->m, r, 0, i), own = own_radius(s->m, r, i);
        const double most = own + widest + same;
        begin(s, i);
        for (size_t k = find_place(list, count, x - most); k < count && list[k].x <= x + most; k++)
            if (list[k].object >= first_other(s))
                add_if_near(s, r, list[k].object, own + their_radius(s, r, list[k].object) + same);
    }
    free(list);
    return FP3_OK;
}

/* ---- values ---- */

static fp3_status sum_up(fp3_invariants *v, member *m, const fp3_expr *e, fp3_invariant *sum,
                         fp3_error *error) {
    summing s = {.m = m, .term = e->operand[0]};
    fp3_status status = FP3_OK;
    find_term(m, s.term);
    if (e->op == FP3_EXPR_OBJECTS) {
        for (size_t i = 0; i < m->of->objects; i++) {
            begin(&s, i);
            add(&s, i);
        }
    } else if (m->seen[e->index] != SIZE_MAX) {
        const fp3_relation *r = &m->model->relations[e->index];
        s.at.theirs = &v->members[m->seen[e->index]];
        if (r->kind == FP3_ALL)
            sum_all(&s);
        else if (r->kind == FP3_LINKS)
            sum_links(&s, r->name);
        else
            status = sum_near(&s, r, error);
    }
    *sum = s.sum;
    return status;
}

static double size_of(const member *m, uint32_t expr) {
    const fp3_expr *e = &m->model->exprs[expr];
    const double *size = m->sizes;
    switch (e->op) {
    case FP3_EXPR_ADD:
    case FP3_EXPR_SUB:
        return size[e->operand[0]] + size[e->operand[1]];
    case FP3_EXPR_NEGATE:
        return size[e->operand[0]];
    case FP3_EXPR_MUL:
        return size[e->operand[0]] * size[e->operand[1]];
    case FP3_EXPR_DIV:
        return size[e->operand[0]] / fabs(m->values[e->operand[1]]);
    default:
        return fabs(m->values[expr]);
    }
}

/* A sum uses m->values, too, but has its own expressions there, or what all objects share. */
static fp3_status find_one(fp3_invariants *v, member *m, uint32_t expr, fp3_invariant *found,
                           fp3_error *error) {
    fp3_status status = FP3_OK;
    mark(m, expr);
    for (uint32_t i = 0; !status && i <= expr; i++) {
        const fp3_expr *e = &m->model->exprs[i];
        if (!m->needed[i])
            continue;
        if (e->op == FP3_EXPR_OBJECTS || e->op == FP3_EXPR_PAIRS) {
            fp3_invariant sum;
            status = sum_up(v, m, e, &sum, error);
            m->values[i] = sum.value;
            m->sizes[i] = sum.size;
            mark(m, expr);
        } else {
            m->values[i] = compute(m, e, &(pair){0});
            m->sizes[i] = size_of(m, i);
        }
    }
    found->value += m->values[expr];
    found->size += m->sizes[expr];
    return status;
}

double fp3_invariants_work(const fp3_invariants *v) {
    double work = 0;
    for (size_t i = 0; i < v->member_count; i++) {
        const member *m = &v->members[i];
        for (uint32_t e = 0;
             m->model && m->model->group_invariant_count && e < m->model->expr_count; e++) {
            const fp3_relation *r = &m->model->relations[m->model->exprs[e].index];
            if (m->model->exprs[e].op == FP3_EXPR_PAIRS && r->kind != FP3_LINKS &&
                m->seen[r - m->model->relations] != SIZE_MAX)
                work += (double)m->of->objects *
                        (double)v->members[m->seen[r - m->model->relations]].of->objects;
        }
    }
    return work;
}

fp3_status fp3_invariants_find(fp3_invariants *v, fp3_invariant *found, fp3_error *error) {
    fp3_status status = FP3_OK;
    memset(found, 0, v->count * sizeof *found);
    for (size_t i = 0; i < v->member_count; i++) {
        member *m = &v->members[i];
        for (uint32_t k = 0; !status && m->model && k < m->model->group_invariant_count; k++) {
            const fp3_definition *one = &m->model->group_invariants[k];
            size_t number = 0;
            while (strcmp(v->names[number], one->name) != 0)
                number++;
            status = find_one(v, m, one->expr, &found[number], error);
        }
    }
    return status;
}

double fp3_invariant_change(const fp3_invariant *first, const fp3_invariant *last) {
    const double change = last->value - first->value;
    return change == 0 ? 0 : change / fmax(first->size, last->size);
}
