/* SPDX-License-Identifier: Apache-2.0 */
/* relations.c - see relations.h. */
#include "relations.h"

#include "base/nearest.h"
#include "base/number.h"
#include "compiler/start.h"
#include "engine/common/inside.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const fp3_model *model_of(const fp3_relations *r) {
    return r->to.compiled ? fp3_start_model(r->to.compiled) : NULL;
}

/* NULL: the program has none of this name. */
static const fp3_list *list_named(const fp3_relations *r, const char *name) {
    const fp3_lists *lists = &fp3_engine_layout(r->to.engine)->groups[r->to.group].lists;
    const fp3_symbol *s = fp3_image_find(r->to.image, name, FP3_CLASSES_OBJECT);
    for (uint32_t i = 0; s && i < lists->shape.list_count; i++)
        if (lists->lists[i].reg == s->index)
            return &lists->lists[i];
    return NULL;
}

int fp3_relations_list(const fp3_relations *r, const char *name) {
    const fp3_list *found = list_named(r, name);
    return found ? (int)(found - fp3_engine_layout(r->to.engine)->groups[r->to.group].lists.lists)
                 : -1;
}

__attribute__((format(printf, 3, 4))) static fp3_status
refuse(const fp3_linked *l, fp3_error *error, const char *format, ...) {
    char text[400];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return fp3_fail(error, FP3_E_ARGUMENT, "%s%slinks of '%s': %s", l->place ? l->place : "",
                    l->place ? ": " : "", l->relation, text);
}

/* ---- fields ---- */

/* How many words a program has of a value. */
static uint32_t words_of(const fp3_relations *r) {
    return r->to.compiled && r->to.compiled->arithmetic == FP3_DOUBLE_SINGLE ? 2 : 1;
}

/* The fields that equations read, or that entries remember, a bit each: the words of an entry. */
static fp3_status fields_read(const fp3_model *model, uint64_t *fields, fp3_error *error) {
    char *is_needed = calloc(model->expr_count + 1u, 1);
    *fields = 0;
    if (!is_needed)
        return fp3_no_memory(error);
    for (uint32_t i = 0; i < model->state_count; i++)
        if (model->states[i].derivative != FP3_NONE)
            is_needed[model->states[i].derivative] = 1;
    for (uint32_t i = 0; i < model->assignment_count; i++)
        is_needed[model->assignments[i].expr] = 1;
    for (uint32_t i = 0; i < model->memory_count; i++)
        is_needed[model->memories[i].expr] = 1;
    for (uint32_t i = 0; i < model->event_count; i++) {
        is_needed[model->events[i].condition] = 1;
        if (model->events[i].armed != FP3_NONE)
            is_needed[model->events[i].armed] = 1;
    }
    for (uint32_t i = model->expr_count; i-- > 0;) {
        const fp3_expr *e = &model->exprs[i];
        for (int k = 0; is_needed[i] && k < 3; k++)
            if (e->operand[k] != FP3_NONE)
                is_needed[e->operand[k]] = 1;
        if (is_needed[i] && e->op == FP3_EXPR_FIELD)
            *fields |= UINT64_C(1) << e->index;
    }
    for (uint32_t i = 0; i < model->memory_count; i++)
        *fields |= UINT64_C(1) << model->memories[i].field;
    free(is_needed);
    return FP3_OK;
}

/* Where the words of an entry come from. */
typedef struct {
    const double *column; /* NULL: there is none */
    double missing;       /* where the column has a NaN, or is missing */
} source;

static size_t column_named(const fp3_links *links, const char *name) {
    size_t i = 0;
    while (i < links->field_count && strcmp(links->names[i], name) != 0)
        i++;
    return i;
}

static fp3_status check_names(const fp3_linked *l, const fp3_model *model, const fp3_relation *of,
                              fp3_error *error) {
    for (size_t i = 0; i < l->links.field_count; i++) {
        const char *name = l->links.names[i], *near = NULL;
        const fp3_token wanted = {.text = name, .length = strlen(name)};
        uint32_t k = of->first_field;
        const uint32_t end = k + of->field_count;
        for (; k < end && strcmp(model->fields[k].name, name) != 0; k++)
            fp3_nearest(wanted, model->fields[k].name, &near);
        if (k == end)
            return refuse(l, error, "the model has no field '%s' of theirs%s%s%s", name,
                          near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
    }
    return FP3_OK;
}

static fp3_status sources_of_model(const fp3_linked *l, const fp3_list *list, uint32_t words,
                                   const fp3_model *model, const fp3_relation *of,
                                   source sources[FP3_FIELDS_MAX], fp3_error *error) {
    uint64_t read;
    uint32_t count = 0;
    const fp3_status status = fields_read(model, &read, error);
    if (status)
        return status;
    for (uint32_t k = of->first_field; k < of->first_field + of->field_count; k++) {
        const size_t i = column_named(&l->links, model->fields[k].name);
        float single;
        source made = {i < l->links.field_count ? l->links.fields[i] : NULL,
                       model->fields[k].value};
        const char *expected = fp3_number_single(model->fields[k].value, &single);
        if (expected)
            return refuse(l, error, "field '%s' is %g, expected %s", model->fields[k].name,
                          model->fields[k].value, expected);
        if (read >> k & 1)
            sources[count++] = made;
    }
    return count * words == list->fields
               ? FP3_OK
               : refuse(l, error,
                        "the program reads %" PRIu32 " of the %" PRIu32 " fields that the "
                        "equations have: remove from the model what no observed state needs",
                        list->fields / words, count);
}

static fp3_status sources_of_image(const fp3_linked *l, const fp3_list *list,
                                   source sources[FP3_FIELDS_MAX], fp3_error *error) {
    if (l->links.field_count != list->fields)
        return refuse(l, error,
                      "found %zu columns of fields, expected %" PRIu32
                      ", in the order in which the program reads them",
                      l->links.field_count, list->fields);
    for (uint32_t k = 0; k < list->fields; k++)
        sources[k] = (source){l->links.fields[k], 0};
    return FP3_OK;
}

/* ---- kinds ---- */

/* 1 + the group whose objects a relation sees, as the program was loaded; 0: its own.
 * FP3_E_ARGUMENT: there is no such group. */
static fp3_status kind_of(const fp3_relations *r, const fp3_relation *of, size_t *kind,
                          fp3_error *error) {
    const fp3_members *group = &fp3_engine_layout(r->to.engine)->groups[r->to.group];
    const fp3_model *model = model_of(r);
    *kind = 0;
    if (!of || of->of_kind == FP3_NONE)
        return FP3_OK;
    const fp3_kind *k = &model->kinds[of->of_kind];
    for (uint32_t i = 0; i < group->foreign_count; i++)
        for (uint32_t p = k->first; p < k->first + k->count; p++) /* not every one is read */
            if (strcmp(group->foreign[i].word, model->params[p].name) == 0)
                *kind = group->foreign[i].group + 1;
    return *kind
               ? FP3_OK
               : fp3_fail(error, FP3_E_ARGUMENT,
                          "'%s' (line %" PRIu32
                          " of the model) sees objects of another group, '%s', and there is none: "
                          "a scene has groups of this name",
                          of->name, of->line, k->name);
}

/* ---- entries ---- */

static size_t others_of(const fp3_relations *r, size_t kind) {
    return fp3_engine_layout(r->to.engine)->groups[kind - 1].objects;
}

/* Each end is counted in its own group. */
static fp3_status check_across(const fp3_linked *l, size_t objects, size_t others,
                               fp3_error *error) {
    const fp3_links *links = &l->links;
    for (size_t i = 0; i < links->count; i++)
        if (links->a[i] >= objects || links->b[i] >= others)
            return refuse(l, error,
                          "link %zu joins object %" PRIu32 " with %" PRIu32
                          " of the other group, expected objects of 0 to %zu and of 0 to %zu",
                          i, links->a[i], links->b[i], objects - 1, others - 1);
    return links->count <= INT32_MAX ? FP3_OK : refuse(l, error, "more than 2^31 links");
}

static fp3_status check_objects(const fp3_linked *l, size_t objects, fp3_error *error) {
    const fp3_links *links = &l->links;
    for (size_t i = 0; i < links->count; i++)
        if (links->a[i] >= objects || links->b[i] >= objects || links->a[i] == links->b[i])
            return refuse(l, error,
                          "link %zu joins object %" PRIu32 " with %" PRIu32
                          ", expected two objects of 0 to %zu",
                          i, links->a[i], links->b[i], objects - 1);
    return links->count <= INT32_MAX ? FP3_OK : refuse(l, error, "more than 2^31 links");
}

/* The words of an entry: so many of each of its fields. */
typedef struct {
    uint32_t fields, words;
} entry_form;

/* What rounding has taken off a number is its second word. */
static void put_number(double number, uint32_t count, float *words) {
    words[0] = (float)number;
    if (count > 1)
        words[1] = (float)(number - (double)words[0]);
}

/* begin[i + 1] counts on as entries of object i are put; ends: 1 of a link to another group, which
 * has its own relation. */
static void put_entries(const fp3_links *links, const source *sources, const entry_form *form,
                        int ends, uint32_t *begin, uint32_t *other, float *words) {
    for (size_t i = 0; i < links->count; i++)
        for (int end = 0; end < ends; end++) {
            const uint32_t at = begin[(end ? links->b[i] : links->a[i]) + 1]++;
            other[at] = end ? links->a[i] : links->b[i];
            for (uint32_t k = 0; k < form->fields; k++) {
                const double number = sources[k].column ? sources[k].column[i] : NAN;
                put_number(isnan(number) ? sources[k].missing : number, form->words,
                           &words[((size_t)at * form->fields + k) * form->words]);
            }
        }
}

static int joins(const fp3_links *links, size_t i, uint32_t one, uint32_t other) {
    return (links->a[i] == one && links->b[i] == other) ||
           (links->a[i] == other && links->b[i] == one);
}

/* A pair that is given twice would have twice the force. begin and other: entries of all links. */
static fp3_status check_pairs(const fp3_linked *l, size_t objects, const uint32_t *begin,
                              const uint32_t *other, fp3_error *error) {
    const fp3_links *links = &l->links;
    uint32_t *seen = calloc(objects, sizeof *seen); /* 1 + the object that had it last */
    uint32_t object = 0, twice = UINT32_MAX;
    if (!seen)
        return fp3_no_memory(error);
    for (uint32_t k = 0; twice == UINT32_MAX && k < 2 * links->count; k++) {
        while (k >= begin[object + 1])
            object++;
        twice = seen[other[k]] == object + 1 ? other[k] : twice;
        seen[other[k]] = object + 1;
    }
    free(seen);
    if (twice == UINT32_MAX)
        return FP3_OK;
    size_t first = 0, second;
    while (!joins(links, first, object, twice))
        first++;
    for (second = first + 1; !joins(links, second, object, twice);)
        second++;
    return refuse(l, error,
                  "link %zu joins objects %" PRIu32 " and %" PRIu32
                  ", as link %zu does: expected each pair once",
                  second, links->a[second], links->b[second], first);
}

/* A pair of objects of two groups that is given twice. */
static fp3_status check_pairs_across(const fp3_linked *l, size_t others, const uint32_t *begin,
                                     const uint32_t *other, fp3_error *error) {
    const fp3_links *links = &l->links;
    uint32_t *seen = calloc(others, sizeof *seen), object = 0; /* 1 + the object that had it last */
    fp3_status status = seen ? FP3_OK : fp3_no_memory(error);
    for (uint32_t k = 0; !status && k < links->count; k++) {
        while (k >= begin[object + 1])
            object++;
        if (seen[other[k]] == object + 1)
            status = refuse(l, error,
                            "object %" PRIu32 " and object %" PRIu32
                            " of the other group are joined twice: expected each pair once",
                            object, other[k]);
        seen[other[k]] = object + 1;
    }
    free(seen);
    return status;
}

static fp3_status give(const fp3_relations *r, const fp3_linked *l, const source *sources,
                       const entry_form *form, size_t kind, fp3_error *error) {
    const fp3_links *links = &l->links;
    const size_t objects = r->to.objects, entries = 2 * links->count;
    const int ends = kind ? 1 : 2;
    uint32_t *begin = calloc(objects + 2, sizeof *begin);
    uint32_t *other = malloc((entries + 1) * sizeof *other);
    float *words = malloc((entries * form->fields * form->words + 1) * sizeof *words);
    fp3_status status = begin && other && words ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; !status && i < links->count; i++) {
        begin[links->a[i] + 2]++;
        if (!kind)
            begin[links->b[i] + 2]++;
    }
    for (size_t i = 2; !status && i < objects + 2; i++)
        begin[i] += begin[i - 1];
    if (!status) {
        put_entries(links, sources, form, ends, begin, other, words);
        if (kind)
            status = check_pairs_across(l, others_of(r, kind), begin, other, error);
        else if (model_of(r))
            status = check_pairs(l, objects, begin, other, error);
    }
    if (!status)
        status = fp3_engine_set_neighbours(
            r->to.engine, r->to.group, l->relation,
            &(fp3_neighbours){.begin = begin, .other = other, .fields = words, .kind = kind});
    free(begin);
    free(other);
    free(words);
    return status;
}

static fp3_status link_one(const fp3_relations *r, const fp3_linked *l, fp3_error *error) {
    const fp3_model *model = model_of(r);
    const fp3_list *list = list_named(r, l->relation);
    const fp3_relation *of = NULL;
    source sources[FP3_FIELDS_MAX];
    for (uint32_t i = 0; model && i < model->relation_count; i++)
        if (strcmp(model->relations[i].name, l->relation) == 0)
            of = &model->relations[i];
    if (model && (!of || of->kind != FP3_LINKS))
        return refuse(l, error,
                      of ? "the model finds the objects of '%s' by itself"
                         : "the model has no relation '%s'",
                      l->relation);
    if (!model && !list)
        return refuse(l, error, "the program has no list of neighbours of this name");
    size_t kind = 0;
    fp3_status status = kind_of(r, of, &kind, error);
    if (!status)
        status = kind ? check_across(l, r->to.objects, others_of(r, kind), error)
                      : check_objects(l, r->to.objects, error);
    if (!status && of)
        status = check_names(l, model, of, error);
    if (status || !list) /* no equation has the relation */
        return status;
    const uint32_t words = words_of(r);
    const entry_form form = {list->fields / words, words};
    status = of ? sources_of_model(l, list, words, model, of, sources, error)
                : sources_of_image(l, list, sources, error);
    return status ? status : give(r, l, sources, &form, kind, error);
}

fp3_status fp3_relations_link(const fp3_relations *r, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (const fp3_linked *l = r->linked; !status && l; l = l->next)
        status = link_one(r, l, error);
    return status;
}

fp3_status fp3_relations_load(fp3_relations *r, fp3_error *error) {
    const fp3_model *model = model_of(r);
    memset(r->is_given, 0, sizeof r->is_given);
    fp3_status status = fp3_relations_link(r, error);
    for (uint32_t i = 0; !status && model && i < model->relation_count; i++) {
        const fp3_relation *of = &model->relations[i];
        size_t kind = 0;
        if (!list_named(r, of->name))
            continue;
        status = kind_of(r, of, &kind, error);
        if (!status && of->kind == FP3_ALL)
            status = fp3_engine_set_neighbours(r->to.engine, r->to.group, of->name,
                                               &(fp3_neighbours){.kind = kind});
    }
    return status;
}

/* ---- near ---- */

/* The second words of positions that are sums of two. */
static void name_low(const fp3_compiled *c, const fp3_relation *of, fp3_near *near) {
    for (uint32_t i = 0; i < c->input_count; i++)
        for (uint32_t k = 0; k < of->dimensions; k++) {
            if (c->inputs[i].low_of == of->position + k)
                near->low[k] = c->inputs[i].name;
            if (of->of_kind != FP3_NONE && fp3_start_low_param(c, i) == of->theirs + k)
                near->their_low[k] = c->inputs[i].name;
        }
}

static fp3_status set_reach(fp3_relations *r, uint32_t number, double reach, fp3_error *error) {
    const fp3_model *model = model_of(r);
    const fp3_relation *of = &model->relations[number];
    const int has_radii = of->radius != FP3_NONE || of->their_radius != FP3_NONE;
    fp3_near near = {.dimensions = of->dimensions, .reach = reach, .skin = reach * r->skin};
    if ((reach == r->reach[number] && r->is_given[number]) || !list_named(r, of->name))
        return FP3_OK;
    if (!has_radii && !(reach >= FP3_NEAR_LEAST && reach <= FP3_NEAR_MOST))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "the reach of '%s' is %g, expected a distance from 2^-50 to 2^63", of->name,
                        reach);
    for (uint32_t k = 0; k < of->dimensions; k++)
        near.position[k] = model->states[of->position + k].name;
    for (uint32_t k = 0; of->of_kind != FP3_NONE && k < of->dimensions; k++)
        near.theirs[k] = model->params[of->theirs + k].name;
    if (has_radii) {
        near.radius = of->radius == FP3_NONE ? NULL : model->params[of->radius].name;
        near.their_radius = of->of_kind == FP3_NONE || of->their_radius == FP3_NONE
                                ? NULL
                                : model->params[of->their_radius].name;
        near.skin = 0;
        near.share = r->skin;
    }
    name_low(r->to.compiled, of, &near);
    fp3_status status = kind_of(r, of, &near.kind, error);
    if (!status)
        status = fp3_engine_set_near(r->to.engine, r->to.group, of->name, &near);
    if (!status)
        r->reach[number] = reach;
    r->is_given[number] = !status;
    return status;
}

fp3_status fp3_relations_reach(fp3_relations *r, const double *params, fp3_error *error) {
    const fp3_model *model = model_of(r);
    if (!model || !model->relation_count)
        return FP3_OK;
    double *values =
        calloc(model->expr_count + model->param_count + model->state_count + 1u, sizeof *values);
    if (!values)
        return fp3_no_memory(error);
    double *given = values + model->expr_count;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < model->param_count; i++)
        given[i] = fp3_number_given(params[i], 1);
    fp3_model_evaluate(model, &(fp3_point){.params = given, .states = given + model->param_count},
                       values);
    for (uint32_t i = 0; !status && i < model->relation_count; i++)
        if (model->relations[i].kind == FP3_NEAR)
            status = set_reach(r, i, values[model->relations[i].reach], error);
    free(values);
    return status;
}

/* ---- what is missing ---- */

/* "a,b,k,rest" */
static void say_columns(const fp3_model *model, const fp3_relation *of, char text[200]) {
    size_t size = (size_t)snprintf(text, 200, "a,b");
    for (uint32_t k = of->first_field; k < of->first_field + of->field_count && size < 200; k++)
        size += (size_t)snprintf(text + size, 200 - size, ",%s", model->fields[k].name);
}

fp3_status fp3_relations_check(const fp3_relations *r, const char *how, fp3_error *error) {
    const fp3_model *model = model_of(r);
    const fp3_lists *lists = &fp3_engine_layout(r->to.engine)->groups[r->to.group].lists;
    char columns[200];
    for (uint32_t i = 0; model && i < model->relation_count; i++) {
        const fp3_list *list = list_named(r, model->relations[i].name);
        if (!list || list->is_there)
            continue;
        say_columns(model, &model->relations[i], columns);
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "%sobjects are linked by '%s' (line %" PRIu32
                        " of the model), and no links are given: %s, with columns %s",
                        fp3_engine_prefix(r->to.group, fp3_engine_groups(r->to.engine)).text,
                        model->relations[i].name, model->relations[i].line, how, columns);
    }
    for (uint32_t i = 0; !model && i < lists->shape.list_count; i++) {
        const char *name = fp3_image_name(r->to.image, lists->lists[i].reg);
        if (!lists->lists[i].is_there)
            return fp3_fail(
                error, FP3_E_ARGUMENT,
                "the list of neighbours '%s' is not given, and an image does not say which "
                "objects are near: %s, or run the model",
                name ? name : "?", how);
    }
    return FP3_OK;
}
