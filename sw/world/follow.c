/* SPDX-License-Identifier: Apache-2.0 */
/* follow.c - see follow.h. */
#include "follow.h"

#include "base/number.h"

#include <stdlib.h>
#include <string.h>

#define BLOCK 512 /* objects whose params are gathered at once */

fp3_status fp3_follow_not(fp3_field *q, size_t first, size_t count, size_t objects,
                          fp3_error *error) {
    if (!q->follows)
        return FP3_OK;
    if (count == objects) {
        q->follows = 0;
        free(q->is_given);
        q->is_given = NULL;
        return FP3_OK;
    }
    if (!q->is_given)
        q->is_given = calloc(objects, 1);
    if (!q->is_given)
        return fp3_no_memory(error);
    memset(q->is_given + first, 1, count);
    return FP3_OK;
}

fp3_status fp3_follow_again(fp3_field *q, size_t first, size_t count, size_t objects,
                            fp3_error *error) {
    if (!q->followed)
        return FP3_OK;
    if (!q->follows) { /* all starts were written */
        q->is_given = malloc(objects);
        if (!q->is_given)
            return fp3_no_memory(error);
        memset(q->is_given, 1, objects);
    }
    q->follows = q->followed;
    if (q->is_given)
        memset(q->is_given + first, 0, count);
    return FP3_OK;
}

/* ---- computing ---- */

typedef struct {
    const fp3_fields_def *def;
    const fp3_field_table *table;
    unsigned words;              /* of a param */
    double *columns;             /* of the params, a block each */
    double *params;              /* of one object */
    double *initial;             /* the model's, which no start is made of */
    double *values;              /* of all expressions */
    const unsigned char *is_new; /* whose starts are computed; NULL: all */
} room;

static int is_in(const fp3_field *q, uint64_t params) {
    return q->kind == FP3_FIELD_PARAM && params >> q->index & 1;
}

/* Whether objects may differ in this value. Unknown if the engine has the only copy. */
static int may_differ(const fp3_field *q) { return q->column || !(q->is_kept || q->is_pending); }

/* The param as the program has it. */
static fp3_status gather(const room *r, const fp3_field *q, size_t first, size_t count) {
    double *column = r->columns + (size_t)q->index * BLOCK;
    float single[BLOCK];
    if (q->is_kept || q->is_pending) {
        for (size_t i = 0; i < count; i++)
            column[i] = fp3_number_given(fp3_field_at(q, first + i), r->words);
        return FP3_OK;
    }
    const fp3_status status =
        fp3_engine_read(r->def->engine, r->def->first + first, count, (uint32_t)q->place, single);
    for (size_t i = 0; !status && i < count; i++)
        column[i] = (double)single[i];
    return status;
}

static void evaluate(const room *r, size_t i) {
    for (uint32_t k = 0; k < r->table->model->param_count; k++)
        r->params[k] = r->columns[(size_t)k * BLOCK + i];
    fp3_model_evaluate(r->table->model, &(fp3_point){.params = r->params, .states = r->initial},
                       r->values);
}

static double start_of(const room *r, const fp3_field *q) {
    return r->values[r->table->model->states[q->index].start];
}

/* All objects have the same, but for those whose start is written. */
static void follow_same(const room *r, fp3_field *q) {
    evaluate(r, 0);
    q->uniform = start_of(r, q);
    for (size_t i = 0; q->column && i < r->def->objects; i++)
        if (!q->is_given || !q->is_given[i])
            q->column[i] = q->uniform;
}

static fp3_status need_column(const room *r, fp3_field *q, fp3_error *error) {
    if (!q->column) {
        q->column = malloc(r->def->objects * sizeof *q->column);
        for (size_t i = 0; q->column && i < r->def->objects; i++)
            q->column[i] = q->uniform;
    }
    return q->column ? FP3_OK : fp3_no_memory(error);
}

static void follow_each(const room *r, uint64_t written, size_t first, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (r->is_new && !r->is_new[first + i])
            continue;
        evaluate(r, i);
        for (uint32_t k = 0; k < r->table->count; k++) {
            fp3_field *q = &r->table->list[k];
            if ((q->follows & written) && !(q->is_given && q->is_given[first + i]))
                q->column[first + i] = start_of(r, q);
        }
    }
}

static fp3_status gather_all(const room *r, uint64_t params, size_t first, size_t count) {
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; !status && k < r->table->count; k++)
        if (is_in(&r->table->list[k], params))
            status = gather(r, &r->table->list[k], first, count);
    return status;
}

static fp3_status follow_all(const room *r, uint64_t written, uint64_t params, int may_all_differ,
                             fp3_error *error) {
    const size_t objects = may_all_differ ? r->def->objects : 1;
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; may_all_differ && !status && k < r->table->count; k++)
        if (r->table->list[k].follows & written)
            status = need_column(r, &r->table->list[k], error);
    for (size_t i = 0; !status && i < objects; i += BLOCK) {
        const size_t count = objects - i < BLOCK ? objects - i : BLOCK;
        if (r->is_new && !memchr(r->is_new + i, 1, count))
            continue;
        status = gather_all(r, params, i, count);
        if (!status && may_all_differ)
            follow_each(r, written, i, count);
    }
    for (uint32_t k = 0; !may_all_differ && !status && k < r->table->count; k++)
        if (r->table->list[k].follows & written)
            follow_same(r, &r->table->list[k]);
    return status;
}

static fp3_status follow_those(const fp3_fields_def *def, const fp3_field_table *table,
                               uint64_t written, const unsigned char *is_new, fp3_error *error) {
    const fp3_model *model = table->model;
    uint64_t params = 0;
    int may_all_differ = is_new != NULL;
    for (uint32_t k = 0; k < table->count; k++)
        params |= table->list[k].follows & written ? table->list[k].follows : 0;
    if (!params)
        return FP3_OK;
    for (uint32_t k = 0; k < table->count; k++)
        may_all_differ |= is_in(&table->list[k], params) && may_differ(&table->list[k]);
    const size_t columns = (size_t)model->param_count * BLOCK;
    double *all = calloc(columns + model->param_count + model->state_count + model->expr_count + 1u,
                         sizeof *all);
    if (!all)
        return fp3_no_memory(error);
    const room r = {.def = def,
                    .table = table,
                    .words = def->compiled->arithmetic == FP3_DOUBLE_SINGLE ? 2 : 1,
                    .columns = all,
                    .params = all + columns,
                    .initial = all + columns + model->param_count,
                    .values = all + columns + model->param_count + model->state_count,
                    .is_new = is_new};
    const fp3_status status = follow_all(&r, written, params, may_all_differ, error);
    free(all);
    return status;
}

fp3_status fp3_follow_new(const fp3_fields_def *def, const fp3_field_table *table,
                          const unsigned char *is_new, fp3_error *error) {
    return follow_those(def, table, UINT64_MAX, is_new, error);
}

fp3_status fp3_follow(const fp3_fields_def *def, const fp3_field_table *table, uint64_t written,
                      fp3_derive *derive, fp3_error *error) {
    const fp3_status status = follow_those(def, table, written, NULL, error);
    for (uint32_t k = 0; !status && k < table->count; k++)
        if (table->list[k].follows & written)
            fp3_derive_note(derive, &table->list[k], 0, def->objects);
    return status;
}
