/* SPDX-License-Identifier: Apache-2.0 */
/* asked.c - see asked.h. */
#include "asked.h"

#include "base/host.h"
#include "language/evaluate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COLUMN 4 /* numbers, in whose time a column is begun */

/* ---- what has to be computed ---- */

static int is_of_entry(fp3_expr_op op) {
    return op == FP3_EXPR_OTHER_STATE || op == FP3_EXPR_OTHER_PARAM || op == FP3_EXPR_FIELD;
}

/* Whether each entry may have another value. Of a sum over entries the object has one. */
static void mark_inner(const fp3_model *m, char *is_inner) {
    for (uint32_t i = 0; i < m->expr_count; i++) {
        const fp3_expr *e = &m->exprs[i];
        is_inner[i] = (char)is_of_entry(e->op);
        for (int k = 0; k < 3 && !fp3_expr_is_fold(e->op); k++)
            is_inner[i] |= e->operand[k] != FP3_NONE && is_inner[e->operand[k]];
    }
}

/* What the term reads: all that is inner, and the first of what is not. */
static void mark_read(const fp3_model *m, const char *is_inner, uint32_t term, char *is_read) {
    is_read[term] = 1;
    for (uint32_t i = term + 1; i-- > 0;)
        for (int k = 0; is_read[i] && is_inner[i] && k < 3; k++)
            if (m->exprs[i].operand[k] != FP3_NONE)
                is_read[m->exprs[i].operand[k]] = 1;
}

/* Marks of expressions while they are put in order. */
typedef struct {
    const fp3_model *m;
    char *is_inner, *is_needed, *is_read;
    uint32_t *depth; /* how many sums, one after the other, have to be there before */
} marks;

static void clear_read(marks *k) { memset(k->is_read, 0, k->m->expr_count + 1u); }

/* Backwards: what a sum reads of the object comes before the sum. */
static void find_needed(marks *k) {
    for (uint32_t i = k->m->expr_count; i-- > 0;) {
        const fp3_expr *e = &k->m->exprs[i];
        if (!k->is_needed[i])
            continue;
        if (!fp3_expr_is_fold(e->op)) {
            for (int n = 0; n < 3; n++)
                if (e->operand[n] != FP3_NONE)
                    k->is_needed[e->operand[n]] = 1;
            continue;
        }
        k->is_needed[e->operand[1]] = 1;
        clear_read(k);
        mark_read(k->m, k->is_inner, e->operand[0], k->is_read);
        for (uint32_t o = 0; o < i; o++)
            k->is_needed[o] |= k->is_read[o] && !k->is_inner[o];
    }
}

static void find_depths(marks *k) {
    for (uint32_t i = 0; i < k->m->expr_count; i++) {
        const fp3_expr *e = &k->m->exprs[i];
        const int is_fold = fp3_expr_is_fold(e->op);
        if (!k->is_needed[i])
            continue;
        clear_read(k);
        if (is_fold)
            mark_read(k->m, k->is_inner, e->operand[0], k->is_read);
        for (int n = is_fold; n < 3; n++)
            if (e->operand[n] != FP3_NONE)
                k->is_read[e->operand[n]] = 1;
        for (uint32_t o = 0; o < i; o++)
            if (k->is_read[o] && !k->is_inner[o] && k->depth[o] > k->depth[i])
                k->depth[i] = k->depth[o];
        k->depth[i] += (uint32_t)is_fold;
    }
}

/* What is read becomes the lists of the term. */
static fp3_status list_read(const marks *k, fp3_asked_term *term, fp3_error *error) {
    term->outer = calloc(k->m->expr_count + 1u, sizeof *term->outer);
    term->inner = calloc(k->m->expr_count + 1u, sizeof *term->inner);
    if (!term->outer || !term->inner)
        return fp3_no_memory(error);
    for (uint32_t i = 0; i < k->m->expr_count; i++)
        if (k->is_read[i] && k->is_inner[i])
            term->inner[term->inner_count++] = i;
        else if (k->is_read[i])
            term->outer[term->outer_count++] = i;
    return FP3_OK;
}

/* All needed sums of this depth over the neighbours of the relation. */
static fp3_status add_term(fp3_asked *a, marks *k, uint32_t depth, uint32_t relation,
                           fp3_error *error) {
    fp3_asked_term *term = &a->terms[a->term_count];
    *term = (fp3_asked_term){.relation = relation, .entry = FP3_NONE};
    term->folds = calloc(k->m->expr_count + 1u, sizeof *term->folds);
    if (!term->folds)
        return fp3_no_memory(error);
    clear_read(k);
    for (uint32_t i = 0; i < k->m->expr_count; i++) {
        const fp3_expr *e = &k->m->exprs[i];
        if (!k->is_needed[i] || !fp3_expr_is_fold(e->op) || e->index != relation ||
            k->depth[i] != depth)
            continue;
        term->folds[term->fold_count++] = i;
        mark_read(k->m, k->is_inner, e->operand[0], k->is_read);
    }
    if (!term->fold_count) {
        free(term->folds);
        *term = (fp3_asked_term){0};
        return FP3_OK;
    }
    a->exprs[a->count] = term->folds[0];
    a->term_of[a->count++] = a->term_count++;
    return list_read(k, term, error);
}

/* By depth: first the sums, then what is made of them. */
static fp3_status put_in_order(fp3_asked *a, marks *k, fp3_error *error) {
    uint32_t deepest = 0;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < k->m->expr_count; i++)
        deepest = k->depth[i] > deepest ? k->depth[i] : deepest;
    for (uint32_t depth = 0; !status && depth <= deepest; depth++) {
        for (uint32_t r = 0; !status && depth && r < k->m->relation_count; r++)
            status = add_term(a, k, depth, r, error);
        for (uint32_t i = 0; !status && i < k->m->expr_count; i++)
            if (k->is_needed[i] && k->depth[i] == depth && !fp3_expr_is_fold(k->m->exprs[i].op)) {
                a->term_of[a->count] = FP3_NONE;
                a->exprs[a->count++] = i;
            }
    }
    return status;
}

static fp3_status find(fp3_asked *a, marks *k, const uint32_t *exprs, uint32_t count,
                       uint32_t relation, fp3_error *error) {
    fp3_status status = FP3_OK;
    mark_inner(k->m, k->is_inner);
    if (relation != FP3_NONE) {
        a->terms[0] = (fp3_asked_term){.relation = relation, .entry = exprs[0]};
        a->term_count = 1;
        mark_read(k->m, k->is_inner, exprs[0], k->is_read);
        status = list_read(k, &a->terms[0], error);
        for (uint32_t i = 0; i < k->m->expr_count; i++)
            k->is_needed[i] = (char)(k->is_read[i] && !k->is_inner[i]);
    }
    for (uint32_t i = 0; relation == FP3_NONE && i < count; i++)
        k->is_needed[exprs[i]] = 1;
    if (status)
        return status;
    find_needed(k);
    find_depths(k);
    return put_in_order(a, k, error);
}

static fp3_status open(const fp3_model *m, const uint32_t *exprs, uint32_t count, uint32_t relation,
                       fp3_asked *a, fp3_error *error) {
    const size_t n = m->expr_count + 1u;
    marks k = {.m = m,
               .is_inner = calloc(n, 1),
               .is_needed = calloc(n, 1),
               .is_read = calloc(n, 1),
               .depth = calloc(n, sizeof *k.depth)};
    *a = (fp3_asked){.model = m,
                     .exprs = calloc(n, sizeof *a->exprs),
                     .term_of = calloc(n, sizeof *a->term_of),
                     .terms = calloc(n + 1, sizeof *a->terms)};
    const int is_room =
        k.is_inner && k.is_needed && k.is_read && k.depth && a->exprs && a->term_of && a->terms;
    const fp3_status status =
        is_room ? find(a, &k, exprs, count, relation, error) : fp3_no_memory(error);
    free(k.is_inner);
    free(k.is_needed);
    free(k.is_read);
    free(k.depth);
    return status;
}

fp3_status fp3_asked_open(const fp3_model *model, const uint32_t *exprs, uint32_t count,
                          fp3_asked *asked, fp3_error *error) {
    return open(model, exprs, count, FP3_NONE, asked, error);
}

fp3_status fp3_asked_open_entries(const fp3_model *model, uint32_t expr, uint32_t relation,
                                  fp3_asked *asked, fp3_error *error) {
    return open(model, &expr, 1, relation, asked, error);
}

void fp3_asked_close(fp3_asked *asked) {
    for (uint32_t i = 0; i < asked->term_count; i++) {
        free(asked->terms[i].outer);
        free(asked->terms[i].inner);
        free(asked->terms[i].folds);
    }
    free(asked->exprs);
    free(asked->term_of);
    free(asked->terms);
    *asked = (fp3_asked){0};
}

double *fp3_asked_room(const fp3_model *model) {
    return calloc((model->expr_count + 1u) * (size_t)(FP3_ASKED_OBJECTS + FP3_ASKED_PAIRS),
                  sizeof(double));
}

/* ---- values, column by column ---- */

/* Powers as products, which take a tenth of the time. */
static double power(double a, double b) {
    return b == 2 ? a * a : b == 3 ? a * a * a : b == 1.5 ? a * sqrt(a) : pow(a, b);
}

static void compute(const fp3_expr *e, const double *values, size_t stride, size_t count,
                    double *column) {
    const double *v[3] = {0};
    for (unsigned k = 0; k < fp3_ode_operands(e->op); k++)
        v[k] = values + e->operand[k] * stride;
    const double *a = v[0], *b = v[1], *c = v[2];
    const fp3_expr alike = {.op = e->op, .operand = {0, 1, 2}, .number = e->number};
    switch (e->op) {
#define X(OP, VALUE)                                                                               \
    case FP3_EXPR_##OP:                                                                            \
        for (size_t i = 0; i < count; i++)                                                         \
            column[i] = (VALUE);                                                                   \
        break;
        X(NUMBER, e->number)
        X(NEGATE, -a[i])
        X(ADD, a[i] + b[i])
        X(SUB, a[i] - b[i])
        X(MUL, a[i] * b[i])
        X(DIV, a[i] / b[i])
        X(SQRT, sqrt(a[i]))
        X(MIN, a[i] < b[i] ? a[i] : b[i])
        X(MAX, b[i] < a[i] ? a[i] : b[i])
        X(ABS, fabs(a[i]))
        X(LESS, a[i] < b[i])
        X(SELECT, a[i] != 0 ? b[i] : c[i])
        X(POWER, power(a[i], b[i]))
#undef X
    default:
        for (size_t i = 0; i < count; i++) {
            const double at[3] = {a ? a[i] : 0, b ? b[i] : 0, c ? c[i] : 0};
            column[i] = fp3_ode_compute(&alike, NULL, at);
        }
    }
}

/* Entries that are under way together. */
typedef struct {
    const fp3_asked_term *term;
    const fp3_moment *m;
    const fp3_crowd_group *g, *other;
    const fp3_relation *r;
    const fp3_crowd_sight *s;
    double *own;  /* columns of the objects */
    double *pair; /* columns of the entries, like those */
    size_t first, count;
    uint32_t at[FP3_ASKED_PAIRS], who[FP3_ASKED_PAIRS];
    size_t entry[FP3_ASKED_PAIRS];
    double *values; /* of the list's entries, which remember them; NULL: of sums */
    uint64_t cost;
} pairs;

static const double *source(const pairs *p, const fp3_expr *e) {
    return fp3_crowd_theirs(p->m->crowd, p->m->states, p->g, p->r, e->op == FP3_EXPR_OTHER_PARAM,
                            e->index);
}

/* A column of what the entries are given. */
static void read_column(const pairs *p, const fp3_expr *e, double *column) {
    if (e->op == FP3_EXPR_FIELD) {
        const double *field =
            p->s->fields + (e->index - p->r->first_field) * p->s->begin[p->g->objects];
        for (size_t i = 0; i < p->count; i++)
            column[i] = field[p->entry[i]];
        return;
    }
    const double *from = source(p, e);
    for (size_t i = 0; i < p->count; i++)
        column[i] = from[p->who[i]];
}

static const double *column_of(const pairs *p, uint32_t expr) {
    return p->pair + (size_t)expr * FP3_ASKED_PAIRS;
}

static void add(const pairs *p, uint32_t fold) {
    const fp3_expr *e = &p->g->model->exprs[fold];
    const double *term = column_of(p, e->operand[0]);
    double *total = p->own + (size_t)fold * FP3_ASKED_OBJECTS;
    for (size_t i = 0; e->op == FP3_EXPR_TOTAL && i < p->count; i++)
        total[p->at[i]] += term[i];
    for (size_t i = 0; e->op == FP3_EXPR_LEAST && i < p->count; i++)
        if (term[i] < total[p->at[i]])
            total[p->at[i]] = term[i];
    for (size_t i = 0; e->op == FP3_EXPR_MOST && i < p->count; i++)
        if (term[i] > total[p->at[i]])
            total[p->at[i]] = term[i];
}

static void flush(pairs *p) {
    const fp3_asked_term *t = p->term;
    for (uint32_t k = 0; p->count && k < t->outer_count; k++) {
        const double *from = fp3_asked_column(p->own, t->outer[k]);
        double *to = p->pair + (size_t)t->outer[k] * FP3_ASKED_PAIRS;
        for (size_t i = 0; i < p->count; i++)
            to[i] = from[p->at[i]];
    }
    for (uint32_t k = 0; p->count && k < t->inner_count; k++) {
        const fp3_expr *e = &p->g->model->exprs[t->inner[k]];
        double *to = p->pair + (size_t)t->inner[k] * FP3_ASKED_PAIRS;
        if (is_of_entry(e->op))
            read_column(p, e, to);
        else
            compute(e, p->pair, FP3_ASKED_PAIRS, p->count, to);
    }
    for (uint32_t k = 0; k < t->fold_count; k++)
        add(p, t->folds[k]);
    for (size_t i = 0; p->values && i < p->count; i++)
        p->values[p->entry[i]] = column_of(p, t->entry)[i];
    p->cost += (p->count + COLUMN) * (t->outer_count + t->inner_count + t->fold_count + 1);
    p->count = 0;
}

static void enter(pairs *p, size_t object, size_t who, size_t entry) {
    if (!p->other->is_alive[who])
        return;
    p->at[p->count] = (uint32_t)(object - p->first);
    p->who[p->count] = (uint32_t)who;
    p->entry[p->count++] = entry;
    if (p->count == FP3_ASKED_PAIRS)
        flush(p);
}

/* Candidates that are too far away have a term that changes nothing, as the language says; it need
 * not be computed. What they remember has to become 0. */
typedef struct {
    const double *own[3], *theirs[3], *radius, *their_radius;
    unsigned dimensions;
} reach;

static reach reach_of(const pairs *p) {
    const fp3_relation *r = p->r;
    reach n = {.dimensions = r->kind == FP3_NEAR ? r->dimensions : 0};
    const uint32_t theirs = r->of_kind == FP3_NONE ? r->position : r->theirs;
    for (unsigned k = 0; k < n.dimensions; k++) {
        n.own[k] = p->m->states[p->m->group] + (r->position + k) * p->g->objects;
        n.theirs[k] = fp3_crowd_theirs(p->m->crowd, p->m->states, p->g, r, 0, theirs + k);
    }
    if (n.dimensions && r->radius != FP3_NONE)
        n.radius = p->g->params + r->radius * p->g->objects;
    if (n.dimensions && r->their_radius != FP3_NONE)
        n.their_radius = fp3_crowd_theirs(p->m->crowd, p->m->states, p->g, r, 1, r->their_radius);
    return n;
}

static int is_near(const reach *n, double same, size_t i, size_t j) {
    double sum = 0;
    const double far =
        (n->radius ? n->radius[i] : 0) + (n->their_radius ? n->their_radius[j] : 0) + same;
    for (unsigned k = 0; k < n->dimensions; k++) {
        const double d = n->theirs[k][j] - n->own[k][i];
        sum += d * d;
    }
    return sum < far * far;
}

/* All entries of the objects that live. */
static void go(pairs *p, size_t count) {
    const reach n = reach_of(p);
    for (size_t i = p->first; i < p->first + count; i++) {
        if (!p->g->is_alive[i])
            continue;
        if (!p->s->begin) {
            for (size_t j = 0; j < p->other->objects; j++)
                if (p->other != p->g || j != i)
                    enter(p, i, j, 0);
            continue;
        }
        for (size_t e = p->s->begin[i]; e < p->s->begin[i + 1]; e++)
            if (p->r->kind != FP3_NEAR || is_near(&n, p->s->reach, i, p->s->who[e]))
                enter(p, i, p->s->who[e], e);
    }
    flush(p);
}

static pairs pairs_of(const fp3_asked *a, const fp3_moment *m, uint32_t term, size_t first,
                      double *room) {
    pairs p = {.term = &a->terms[term], .m = m, .g = &m->crowd->groups[m->group], .first = first};
    p.r = &a->model->relations[p.term->relation];
    p.s = &p.g->sights[p.term->relation];
    p.other = &m->crowd->groups[p.s->group];
    p.own = room;
    p.pair = room + (a->model->expr_count + 1u) * (size_t)FP3_ASKED_OBJECTS;
    return p;
}

static void read_own(const fp3_expr *e, const fp3_moment *m, size_t first, size_t count,
                     double *column) {
    const fp3_crowd_group *g = &m->crowd->groups[m->group];
    const double *from = e->op == FP3_EXPR_STATE    ? m->states[m->group]
                         : e->op == FP3_EXPR_BEFORE ? m->before
                                                    : g->params;
    if (e->op == FP3_EXPR_TIME || e->op == FP3_EXPR_STEP)
        for (size_t i = 0; i < count; i++)
            column[i] = e->op == FP3_EXPR_STEP ? m->h : m->t + g->offset[first + i];
    else
        memcpy(column, from + e->index * g->objects + first, count * sizeof *column);
}

static int is_own(fp3_expr_op op) {
    return op == FP3_EXPR_STATE || op == FP3_EXPR_PARAM || op == FP3_EXPR_TIME ||
           op == FP3_EXPR_STEP || op == FP3_EXPR_BEFORE;
}

static uint64_t sums(const fp3_asked *a, const fp3_moment *m, uint32_t term, size_t first,
                     size_t count, double *room) {
    pairs p = pairs_of(a, m, term, first, room);
    for (uint32_t k = 0; k < p.term->fold_count; k++) {
        const uint32_t fold = p.term->folds[k];
        memcpy(room + (size_t)fold * FP3_ASKED_OBJECTS,
               fp3_asked_column(room, a->model->exprs[fold].operand[1]), count * sizeof *room);
    }
    go(&p, count);
    return p.cost;
}

static uint64_t own_values(const fp3_asked *a, const fp3_moment *m, size_t first, size_t count,
                           double *room) {
    uint64_t cost = (count + COLUMN) * a->count;
    for (uint32_t k = 0; k < a->count; k++) {
        const fp3_expr *e = &a->model->exprs[a->exprs[k]];
        double *column = room + (size_t)a->exprs[k] * FP3_ASKED_OBJECTS;
        if (is_own(e->op)) {
            read_own(e, m, first, count, column);
        } else if (a->term_of[k] == FP3_NONE) {
            compute(e, room, FP3_ASKED_OBJECTS, count, column);
        } else {
            cost += sums(a, m, a->term_of[k], first, count, room);
        }
    }
    return cost;
}

uint64_t fp3_asked_values(const fp3_asked *asked, const fp3_moment *m, size_t first, size_t count,
                          double *room) {
    return own_values(asked, m, first, count, room);
}

uint64_t fp3_asked_entries(const fp3_asked *asked, const fp3_moment *m, size_t first, size_t count,
                           double *room, double *values) {
    const uint64_t cost = own_values(asked, m, first, count, room);
    pairs p = pairs_of(asked, m, 0, first, room);
    p.values = values;
    go(&p, count);
    return cost + p.cost;
}
