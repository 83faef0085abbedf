/* SPDX-License-Identifier: Apache-2.0 */
/* others.c - see others.h. */
#include "others.h"

#include "base/number.h"
#include "language/evaluate.h"
#include "world/apply.h"
#include "world/values_own.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Whom the looked objects see by one relation: object i those of begin[i] .. begin[i + 1]-1. */
typedef struct {
    size_t *begin;
    uint32_t *other, *link; /* link: by which, if the relation has links */
} sight;

struct fp3_others {
    const fp3_model *model;
    const double *columns;
    size_t objects, looked;
    unsigned words; /* of which the program makes a field */
    sight sights[FP3_RELATIONS_MAX];
    const double *
        *fields;    /* of each field of the model, its column; NULL: all links have the default */
    double *params; /* rows of objects that are seen */
    uint32_t
        *row_of; /* of each object; FP3_NONE: none sees it, or no equation asks for its params */
    /* Of each expression, a bit for each relation whose terms it is part of: another neighbour
     * gives it another value. */
    unsigned char *terms;
};

/* ---- who sees whom ---- */

/* Of near objects: the distance, and what each object adds to it; NULL: nothing. */
typedef struct {
    double same;
    const double *radii;
} range;

static int is_near(const fp3_others *o, const fp3_relation *of, range r, size_t i, size_t j) {
    const double reach = r.radii ? r.radii[i] + r.radii[j] + r.same : r.same;
    double sum = 0;
    for (uint32_t k = 0; k < of->dimensions; k++) {
        const double *x = o->columns + (of->position + k) * o->objects;
        sum += (x[i] - x[j]) * (x[i] - x[j]);
    }
    return sum < reach * reach;
}

/* Puts an entry, or only counts it, while there is no room. */
static void put(sight *s, size_t object, size_t other, size_t link) {
    if (s->other) {
        s->other[s->begin[object]] = (uint32_t)other;
        s->link[s->begin[object]] = (uint32_t)link;
    }
    s->begin[object]++;
}

static void put_all(const fp3_others *o, const fp3_relation *of, const fp3_links *links,
                    range reach, sight *s) {
    for (size_t i = 0; links && i < links->count; i++)
        for (int end = 0; end < 2; end++) {
            const size_t object = end ? links->b[i] : links->a[i];
            if (object < o->looked)
                put(s, object, end ? links->a[i] : links->b[i], i);
        }
    for (size_t i = 0; of->kind != FP3_LINKS && i < o->looked; i++)
        for (size_t j = 0; j < o->objects; j++)
            if (j != i && (of->kind == FP3_ALL || is_near(o, of, reach, i, j)))
                put(s, i, j, 0);
}

/* From counts to where each object's entries begin. */
static size_t begin_from_counts(sight *s, size_t looked) {
    size_t sum = 0;
    for (size_t i = 0; i <= looked; i++) {
        const size_t count = s->begin[i];
        s->begin[i] = sum;
        sum += count;
    }
    return sum;
}

static fp3_status see_by(const fp3_others *o, const fp3_relation *of, const fp3_links *links,
                         range reach, sight *s, fp3_error *error) {
    s->begin = calloc(o->looked + 1, sizeof *s->begin);
    if (!s->begin)
        return fp3_no_memory(error);
    put_all(o, of, links, reach, s);
    const size_t count = begin_from_counts(s, o->looked);
    s->other = calloc(count + 1, sizeof *s->other);
    s->link = calloc(count + 1, sizeof *s->link);
    if (!s->other || !s->link)
        return fp3_no_memory(error);
    put_all(o, of, links, reach, s);
    memmove(s->begin + 1, s->begin, o->looked * sizeof *s->begin);
    s->begin[0] = 0;
    return FP3_OK;
}

static void find_fields(fp3_others *o, const fp3_relation *of, const fp3_links *links) {
    for (uint32_t k = of->first_field; k < of->first_field + of->field_count; k++)
        for (size_t i = 0; links && i < links->field_count; i++)
            if (!strcmp(links->names[i], o->model->fields[k].name))
                o->fields[k] = links->fields[i];
}

/* A param of each object. */
static fp3_status read_radii(const fp3_others *o, fp3_object_values *values, uint32_t param,
                             double **radii, fp3_error *error) {
    const size_t last = o->objects - 1;
    *radii = malloc((o->objects + 1) * sizeof **radii);
    fp3_status status = *radii ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; !status && i < o->objects; i++) {
        status = fp3_object_values_at(values, last ? (double)i / (double)last : 0, error);
        (*radii)[i] = status ? 0 : values->params[param];
    }
    return status;
}

static fp3_status see(fp3_others *o, const fp3_params *params, fp3_object_values *values,
                      fp3_error *error) {
    const fp3_model *m = o->model;
    double *of_params = calloc(m->expr_count + m->state_count + 1u, sizeof *of_params);
    if (!of_params)
        return fp3_no_memory(error);
    fp3_model_evaluate(
        m, &(fp3_point){.params = values->params, .states = of_params + m->expr_count}, of_params);
    fp3_status status = FP3_OK;
    for (uint32_t r = 0; !status && r < m->relation_count; r++) {
        const fp3_relation *of = &m->relations[r];
        const fp3_linked *linked =
            of->kind == FP3_LINKS ? fp3_linked_find(params->linked, of->name) : NULL;
        const fp3_links *links = linked ? &linked->links : NULL;
        find_fields(o, of, links);
        double *radii = NULL;
        if (of->kind == FP3_NEAR && of->radius != FP3_NONE)
            status = read_radii(o, values, of->radius, &radii, error);
        const range reach = {of->kind == FP3_NEAR ? of_params[of->reach] : 0, radii};
        if (!status)
            status = see_by(o, of, links, reach, &o->sights[r], error);
        free(radii);
    }
    free(of_params);
    return status;
}

/* ---- what is known of those that are seen ---- */

static int asks_for_params(const fp3_model *m) {
    for (uint32_t i = 0; i < m->expr_count; i++)
        if (m->exprs[i].op == FP3_EXPR_OTHER_PARAM)
            return 1;
    return 0;
}

static uint32_t number_rows(fp3_others *o) {
    uint32_t rows = 0;
    for (size_t i = 0; i < o->objects; i++)
        o->row_of[i] = FP3_NONE;
    for (uint32_t r = 0; asks_for_params(o->model) && r < o->model->relation_count; r++)
        for (size_t k = 0; k < o->sights[r].begin[o->looked]; k++)
            if (o->row_of[o->sights[r].other[k]] == FP3_NONE)
                o->row_of[o->sights[r].other[k]] = rows++;
    return rows;
}

static fp3_status take_params(fp3_others *o, fp3_object_values *values, fp3_error *error) {
    const uint32_t count = o->model->param_count;
    o->row_of = malloc((o->objects + 1) * sizeof *o->row_of);
    if (!o->row_of)
        return fp3_no_memory(error);
    const size_t rows = number_rows(o), last = o->objects - 1;
    o->params = calloc(rows * count + 1, sizeof *o->params);
    fp3_status status = o->params ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; !status && i < o->objects; i++) {
        if (o->row_of[i] == FP3_NONE)
            continue;
        status = fp3_object_values_at(values, last ? (double)i / (double)last : 0, error);
        if (!status)
            memcpy(o->params + (size_t)o->row_of[i] * count, values->params,
                   count * sizeof *o->params);
    }
    return status;
}

static void mark_terms(fp3_others *o) {
    const fp3_model *m = o->model;
    char *varies = (char *)(o->terms + m->expr_count); /* with the neighbour */
    for (uint32_t i = 0; i < m->expr_count; i++) {
        const fp3_expr *e = &m->exprs[i];
        varies[i] = e->op == FP3_EXPR_OTHER_STATE || e->op == FP3_EXPR_OTHER_PARAM ||
                    e->op == FP3_EXPR_FIELD;
        for (unsigned k = 0; !fp3_expr_is_fold(e->op) && k < fp3_ode_operands(e->op); k++)
            varies[i] |= varies[e->operand[k]];
    }
    for (uint32_t i = m->expr_count; i-- > 0;) {
        const fp3_expr *e = &m->exprs[i];
        const unsigned char of = fp3_expr_is_fold(e->op) ? 1u << e->index : o->terms[i];
        for (unsigned k = 0; k < fp3_ode_operands(e->op); k++)
            o->terms[e->operand[k]] |= varies[e->operand[k]] ? of : 0;
    }
}

fp3_status fp3_others_open(const fp3_program *program, const fp3_params *params, size_t objects,
                           size_t looked, const double *columns, fp3_others **others,
                           fp3_error *error) {
    fp3_others *o = *others = calloc(1, sizeof *o);
    fp3_object_values values = {0};
    if (!o)
        return fp3_no_memory(error);
    o->model = program->model;
    o->columns = columns;
    o->objects = objects;
    o->looked = looked;
    o->words = fp3_program_words(program);
    o->terms = calloc(2u * o->model->expr_count + 1u, 1);
    o->fields = calloc(o->model->field_count + 1u, sizeof *o->fields);
    fp3_status status = o->terms && o->fields
                            ? fp3_object_values_open(program, params, &values, error)
                            : fp3_no_memory(error);
    if (!status)
        status = fp3_object_values_at(&values, 0, error);
    if (!status)
        status = see(o, params, &values, error);
    if (!status)
        status = take_params(o, &values, error);
    fp3_object_values_free(&values);
    if (status)
        fp3_others_close(others);
    else
        mark_terms(o);
    return status;
}

void fp3_others_close(fp3_others **others) {
    fp3_others *o = *others;
    if (!o)
        return;
    for (uint32_t r = 0; r < FP3_RELATIONS_MAX; r++) {
        free(o->sights[r].begin);
        free(o->sights[r].other);
        free(o->sights[r].link);
    }
    free(o->fields);
    free(o->params);
    free(o->row_of);
    free(o->terms);
    free(o);
    *others = NULL;
}

/* ---- values ---- */

static double field_of(const fp3_others *o, uint32_t field, uint32_t link) {
    const double given = o->fields[field] ? o->fields[field][link] : NAN;
    return fp3_number_given(isnan(given) ? o->model->fields[field].value : given, o->words);
}

/* Of one expression of the term, for an entry. */
static double of_entry(const fp3_others *o, const sight *s, size_t entry, const fp3_expr *e,
                       const fp3_point *point, const double *values) {
    const size_t other = s->other[entry];
    switch (e->op) {
    case FP3_EXPR_OTHER_STATE:
        return o->columns[e->index * o->objects + other];
    case FP3_EXPR_OTHER_PARAM:
        return o->params[(size_t)o->row_of[other] * o->model->param_count + e->index];
    case FP3_EXPR_FIELD:
        return field_of(o, e->index, s->link[entry]);
    default:
        return fp3_ode_compute(e, point, values);
    }
}

/* Who asks for values, and how. */
typedef struct {
    const fp3_others *o;
    size_t object;
    const fp3_point *point;
    fp3_others_fn *had;
    const void *user;
    double *values;
} asked;

static void store(const asked *by, uint32_t expr, double value) {
    by->values[expr] = by->had ? by->had(by->user, expr, value) : value;
}

static double folded(const asked *by, const fp3_expr *fold) {
    const fp3_others *o = by->o;
    const sight *s = &o->sights[fold->index];
    const int sign = fold->op == FP3_EXPR_MOST ? -1 : 1;
    double all = by->values[fold->operand[1]];
    for (size_t k = s->begin[by->object]; k < s->begin[by->object + 1]; k++) {
        for (uint32_t i = 0; i <= fold->operand[0]; i++)
            if (o->terms[i] >> fold->index & 1)
                store(by, i, of_entry(o, s, k, &o->model->exprs[i], by->point, by->values));
        const double term = by->values[fold->operand[0]];
        all = fold->op == FP3_EXPR_TOTAL ? all + term : sign * fmin(sign * all, sign * term);
    }
    return all;
}

void fp3_others_evaluate(const fp3_others *o, size_t object, const fp3_point *point,
                         fp3_others_fn *had, const void *user, double *values) {
    const asked by = {o, object, point, had, user, values};
    for (uint32_t i = 0; i < o->model->expr_count; i++) {
        const fp3_expr *e = &o->model->exprs[i];
        if (!o->terms[i])
            store(&by, i,
                  fp3_expr_is_fold(e->op) ? folded(&by, e) : fp3_ode_compute(e, point, values));
    }
}
