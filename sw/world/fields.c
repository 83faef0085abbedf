/* SPDX-License-Identifier: Apache-2.0 */
/* fields.c - see fields.h. */
#include "fields.h"

#include "derive.h"
#include "field.h"
#include "follow.h"

#include "compiler/value/known.h"
#include "engine/common/inside.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK 1024 /* numbers that are rounded at once */

struct fp3_fields {
    fp3_fields_def def;
    fp3_field_table table;
    fp3_derive *derive;    /* NULL: of an image */
    int has_moved;         /* since the start */
    uint64_t written;      /* params, a bit each, that starts do not follow yet */
    unsigned char *is_new; /* of each object: born since the last step; NULL: no one ever was */
    size_t new_count;      /* of these */
    int is_start_due;      /* their starts do not follow params yet */
    float block[BLOCK];
};

fp3_status fp3_fields_open(const fp3_fields_def *def, fp3_fields **fields, fp3_error *error) {
    fp3_fields *q = *fields = calloc(1, sizeof *q);
    if (!q)
        return fp3_no_memory(error);
    q->def = *def;
    fp3_status status = fp3_field_list(def->image, def->compiled, def->h, &q->table, error);
    q->table.needs_finite |= fp3_engine_config(def->engine)->finite != 0;
    if (!status && def->compiled)
        status = fp3_derive_open(&q->def, &q->table, &q->derive, error);
    if (status)
        fp3_fields_close(fields);
    return status;
}

void fp3_fields_close(fp3_fields **fields) {
    fp3_fields *q = *fields;
    if (!q)
        return;
    fp3_derive_close(&q->derive);
    fp3_field_close(&q->table);
    free(q->is_new);
    free(q);
    *fields = NULL;
}

/* ---- numbers ---- */

static double number_at(fp3_numbers values, size_t i) {
    return values.single ? (double)values.single[i] : values.wide[i];
}

static fp3_status refuse(const fp3_field *of, size_t object, int is_all, double value,
                         const char *expected, fp3_error *error) {
    value = isnan(value) ? (double)NAN : value; /* printf would show the sign */
    if (is_all)
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is %.9g: expected %s", of->name, value,
                        expected);
    return fp3_fail(error, FP3_E_ARGUMENT, "object %zu: '%s' is %.9g: expected %s", object,
                    of->name, value, expected);
}

/* That an input has room in FP32 is seen where it is computed. */
static fp3_status check_finite(const fp3_field *of, size_t number, size_t count, fp3_numbers values,
                               fp3_error *error) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite(number_at(values, i)))
            return refuse(of, number + i, 0, number_at(values, i), "a finite number", error);
    return FP3_OK;
}

static int is_any_infinite(const float *values, size_t count) {
    uint32_t found = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        found |= ((bits & 0x7f800000u) + 0x00800000u) >> 31;
    }
    return (int)found;
}

/* ---- the engine's registers ---- */

/* part 0: the values in FP32; 1: the rest, rounded; 2: zeros. */
static fp3_status put(fp3_fields *q, const fp3_field *of, int reg, int part, size_t first,
                      size_t count, fp3_numbers values, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t done = 0; !status && done < count; done += BLOCK) {
        const size_t now = count - done < BLOCK ? count - done : BLOCK;
        for (size_t i = 0; !status && i < now; i++) {
            const double value = number_at(values, done + i);
            const char *expected = part ? NULL : fp3_field_word(&q->table, of, value, &q->block[i]);
            if (part)
                q->block[i] = part == 1 ? (float)fp3_known_low(value) : 0;
            if (expected)
                status = refuse(of, q->def.number + first + done + i, 0, value, expected, error);
        }
        if (!status)
            status = fp3_engine_write(q->def.engine, q->def.first + first + done, now,
                                      (uint32_t)reg, q->block);
    }
    return status;
}

/* Singles that need no look are written as they lie. */
static fp3_status put_numbers(fp3_fields *q, const fp3_field *of, size_t first, size_t count,
                              fp3_numbers values, fp3_error *error) {
    const int is_plain = of->kind == FP3_FIELD_STATE || of->kind == FP3_FIELD_PARAM;
    if (values.single && is_plain &&
        !(q->table.needs_finite && is_any_infinite(values.single, count)))
        return fp3_engine_write(q->def.engine, q->def.first + first, count, (uint32_t)of->place,
                                values.single);
    return put(q, of, of->place, 0, first, count, values, error);
}

/* The same for all objects. */
static fp3_status put_same(fp3_fields *q, const fp3_field *of, double value, fp3_error *error) {
    float word;
    const char *expected = fp3_field_word(&q->table, of, value, &word);
    fp3_status status = expected ? refuse(of, 0, 1, value, expected, error) : FP3_OK;
    if (!status && of->is_shared)
        return fp3_engine_write_shared_of(q->def.engine, q->def.group, (uint32_t)of->place, 1,
                                          &word);
    for (size_t i = 0; i < BLOCK; i++)
        q->block[i] = word;
    for (size_t i = 0; !status && i < q->def.objects; i += BLOCK)
        status = fp3_engine_write(q->def.engine, q->def.first + i,
                                  q->def.objects - i < BLOCK ? q->def.objects - i : BLOCK,
                                  (uint32_t)of->place, q->block);
    return status;
}

static fp3_status settle_one(fp3_fields *q, fp3_field *of, fp3_error *error) {
    const fp3_status status = of->is_pending ? put_same(q, of, of->uniform, error) : FP3_OK;
    of->is_pending = of->is_pending && status;
    return status;
}

/* ---- a state on its way ---- */

/* It goes on from here: no step behind it has lost anything. */
static fp3_status move(fp3_fields *q, fp3_field *of, size_t first, size_t count, fp3_numbers values,
                       fp3_error *error) {
    if (q->table.has_before)
        return fp3_fail(
            error, FP3_E_ARGUMENT,
            "'%s' of objects that have moved: this integrator also keeps their positions one "
            "step before, which are known only at the start",
            of->name);
    if (of->place < 0)
        return fp3_fail(error, FP3_E_ARGUMENT, "the program has no state '%s': it is not observed",
                        of->name);
    fp3_status status = put_numbers(q, of, first, count, values, error);
    if (!status && of->low >= 0)
        status = put(q, of, of->low, 1, first, count, values, error);
    if (!status && of->lost >= 0)
        status = put(q, of, of->lost, 2, first, count, values, error);
    return status;
}

/* ---- writing ---- */

/* Of objects that are not new. */
static int is_on_its_way(const fp3_fields *q, const fp3_field *of) {
    return q->has_moved && q->table.model && of->kind == FP3_FIELD_STATE;
}

static int is_new(const fp3_fields *q, size_t object) { return q->new_count && q->is_new[object]; }

/* How many objects from here on are new, or are not, like the first of them. */
static size_t alike(const fp3_fields *q, size_t first, size_t count) {
    size_t n = q->new_count && count ? 1 : count;
    while (n < count && !q->is_new[first + n] == !q->is_new[first])
        n++;
    return n;
}

/* What objects start with that are born on the way is computed for them alone. */
static void begin_anew(fp3_fields *q, size_t first, size_t count) {
    for (size_t i = first; q->new_count && q->derive && i < first + count; i++)
        if (q->is_new[i])
            fp3_derive_born(q->derive, i);
}

static void note(fp3_fields *q, const fp3_field *of) {
    if (q->table.model && of->kind == FP3_FIELD_PARAM)
        q->written |= (uint64_t)1 << of->index;
    q->is_start_due = 1;
}

static fp3_status follow_new(fp3_fields *q, fp3_error *error) {
    if (!q->new_count || !q->is_start_due)
        return FP3_OK;
    begin_anew(q, 0, q->def.objects);
    const fp3_status status = fp3_follow_new(&q->def, &q->table, q->is_new, error);
    q->is_start_due = status != FP3_OK;
    return status;
}

/* Once objects have moved, the next start follows, but for those that are new. */
static fp3_status follow(fp3_fields *q, fp3_error *error) {
    if (q->has_moved || !q->written)
        return q->table.model ? follow_new(q, error) : FP3_OK;
    const fp3_status status = fp3_follow(&q->def, &q->table, q->written, q->derive, error);
    q->written = status ? q->written : 0;
    return status;
}

static fp3_status check_step(const fp3_fields *q, double h, fp3_error *error) {
    if (!q->has_moved || !q->table.model)
        return FP3_OK;
    return q->table.has_count ? fp3_fail(error, FP3_E_ARGUMENT,
                                         "'h' becomes %.9g after the first step: the equations "
                                         "have t, which is counted in steps of h",
                                         h)
           : q->table.has_before
               ? fp3_fail(error, FP3_E_ARGUMENT,
                          "'h' becomes %.9g after the first step: this integrator keeps the "
                          "positions one step before",
                          h)
               : FP3_OK;
}

fp3_status fp3_fields_check(const fp3_fields *q, size_t first, size_t count, fp3_error *error) {
    if (first <= q->def.objects && count <= q->def.objects - first)
        return FP3_OK;
    return fp3_fail(error, FP3_E_ARGUMENT, "object %zu, count %zu: there are %zu objects", first,
                    count, q->def.objects);
}

/* Each object has a place for its own value. */
static fp3_status need_column(fp3_fields *q, fp3_field *of, fp3_error *error) {
    if (of->column)
        return FP3_OK;
    of->column = malloc(q->def.objects * sizeof *of->column);
    if (!of->column)
        return fp3_no_memory(error);
    for (size_t i = 0; i < q->def.objects; i++)
        of->column[i] = of->uniform;
    return FP3_OK;
}

static fp3_status keep(fp3_fields *q, fp3_field *of, size_t first, size_t count, fp3_numbers values,
                       fp3_error *error) {
    fp3_status status = check_finite(of, q->def.number + first, count, values, error);
    if (!status)
        status = need_column(q, of, error);
    if (status)
        return status;
    for (size_t i = 0; i < count; i++)
        of->column[first + i] = number_at(values, i);
    fp3_derive_note(q->derive, of, first, count);
    begin_anew(q, first, count);
    return FP3_OK;
}

/* A start of objects that are new; where the engine has it alone, it has it at once. */
static fp3_status start(fp3_fields *q, fp3_field *of, size_t first, size_t count,
                        fp3_numbers values, fp3_error *error) {
    fp3_status status = keep(q, of, first, count, values, error);
    if (!status && of->place >= 0)
        status = put_numbers(q, of, first, count, values, error);
    return status ? status : fp3_follow_not(of, first, count, q->def.objects, error);
}

/* States of objects of which some are on their way, and others new. */
static fp3_status write_states(fp3_fields *q, fp3_field *of, size_t first, size_t count,
                               fp3_numbers values, fp3_error *error) {
    fp3_status status =
        q->new_count ? check_finite(of, q->def.number + first, count, values, error) : FP3_OK;
    for (int is_last = 0; !status && is_last < 2; is_last++) /* those first that may be refused */
        for (size_t i = 0, n; !status && i < count; i += n) {
            n = alike(q, first + i, count - i);
            if (is_new(q, first + i) == is_last)
                status = (is_last ? start : move)(q, of, first + i, n, fp3_numbers_from(values, i),
                                                  error);
        }
    return status;
}

fp3_status fp3_fields_write(fp3_fields *q, const char *name, size_t first, size_t count,
                            fp3_numbers values, fp3_error *error) {
    fp3_field *of = fp3_field_find(&q->table, name, error);
    if (!of)
        return FP3_E_ARGUMENT;
    fp3_status status = fp3_fields_check(q, first, count, error);
    if (status || !count)
        return status;
    if (of->is_shared)
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is one number for all objects", name);
    if (is_on_its_way(q, of))
        return write_states(q, of, first, count, values, error);
    if (of->is_kept)
        status = keep(q, of, first, count, values, error);
    else if (count < q->def.objects)
        status = settle_one(q, of, error);
    if (!status && !of->is_kept)
        status = put_numbers(q, of, first, count, values, error);
    if (status)
        return status;
    of->is_pending = 0;
    note(q, of);
    return fp3_follow_not(of, first, count, q->def.objects, error);
}

/* A state of all objects. */
static fp3_status set_states(fp3_fields *q, fp3_field *of, double value, fp3_error *error) {
    double same[BLOCK];
    fp3_status status = FP3_OK;
    for (size_t i = 0; i < BLOCK; i++)
        same[i] = value;
    for (size_t i = 0; !status && i < q->def.objects; i += BLOCK)
        status = write_states(q, of, i, q->def.objects - i < BLOCK ? q->def.objects - i : BLOCK,
                              (fp3_numbers){.wide = same}, error);
    return status;
}

fp3_status fp3_fields_set(fp3_fields *q, const char *name, double value, fp3_error *error) {
    fp3_field *of = fp3_field_find(&q->table, name, error);
    float word;
    if (!of)
        return FP3_E_ARGUMENT;
    const char *expected = q->table.needs_finite && !isfinite(value) ? "a finite number"
                           : of->kind == FP3_FIELD_STEP || !of->is_kept
                               ? fp3_field_word(&q->table, of, value, &word)
                               : NULL;
    if (expected)
        return refuse(of, 0, 1, value, expected, error);
    fp3_status status = of->kind == FP3_FIELD_STEP ? check_step(q, value, error) : FP3_OK;
    if (status || is_on_its_way(q, of))
        return status ? status : set_states(q, of, value, error);
    status = fp3_follow_not(of, 0, q->def.objects, q->def.objects, error);
    if (status)
        return status;
    note(q, of);
    free(of->column);
    of->column = NULL;
    of->uniform = value;
    of->is_pending = !of->is_kept;
    if (of->is_kept)
        fp3_derive_note(q->derive, of, 0, q->def.objects);
    begin_anew(q, 0, q->def.objects);
    return FP3_OK;
}

/* A field of each row, which has `width` numbers. */
static fp3_status write_gathered(fp3_fields *q, const fp3_quantity *of, size_t first, size_t count,
                                 const double *rows, uint32_t width, double *column,
                                 fp3_error *error) {
    for (size_t i = 0; i < count; i++)
        column[i] = rows[i * width];
    return of->is_shared
               ? fp3_fields_set(q, of->name, rows[0], error)
               : fp3_fields_write(q, of->name, first, count, (fp3_numbers){.wide = column}, error);
}

fp3_status fp3_fields_write_rows(fp3_fields *q, size_t first, size_t count, const double *params,
                                 const double *initial, fp3_error *error) {
    const fp3_model *model = q->table.model;
    double *column = calloc(count + 1, sizeof *column);
    fp3_status status = column ? FP3_OK : fp3_no_memory(error);
    for (uint32_t i = 0; !status && i < model->param_count; i++)
        if (!fp3_model_is_foreign(model, i))
            status = write_gathered(q, &model->params[i], first, count, params + i,
                                    model->param_count, column, error);
    for (uint32_t i = 0; initial && !status && i < model->state_count; i++)
        status = write_gathered(q, &model->states[i], first, count, initial + i, model->state_count,
                                column, error);
    free(column);
    return status;
}

/* ---- reading ---- */

static fp3_status read_engine(fp3_fields *q, const fp3_field *of, size_t first, size_t count,
                              float *single, double *wide) {
    fp3_status status = FP3_OK;
    if (single)
        return fp3_engine_read(q->def.engine, q->def.first + first, count, (uint32_t)of->place,
                               single);
    for (size_t done = 0; !status && done < count; done += BLOCK) {
        const size_t now = count - done < BLOCK ? count - done : BLOCK;
        status = fp3_engine_read(q->def.engine, q->def.first + first + done, now,
                                 (uint32_t)of->place, q->block);
        for (size_t i = 0; !status && i < now; i++)
            wide[done + i] = (double)q->block[i];
        if (!status && of->low >= 0)
            status = fp3_engine_read(q->def.engine, q->def.first + first + done, now,
                                     (uint32_t)of->low, q->block);
        for (size_t i = 0; !status && of->low >= 0 && i < now; i++)
            wide[done + i] += (double)q->block[i];
    }
    return status;
}

/* As the engine gets it: in FP32, or its two words. */
static double as_words(const fp3_field *of, double value) {
    return (double)(float)value + (of->low >= 0 ? fp3_known_low(value) : 0);
}

static fp3_status read_part(fp3_fields *q, const fp3_field *of, size_t first, size_t count,
                            float *single, double *wide, fp3_error *error) {
    const int is_moved = is_on_its_way(q, of) && !is_new(q, first);
    if (is_moved && of->place < 0)
        return fp3_fail(error, FP3_E_ARGUMENT, "the program has no state '%s': it is not observed",
                        of->name);
    if (is_moved || !(of->is_kept || of->is_pending))
        return read_engine(q, of, first, count, single, wide);
    for (size_t i = 0; i < count; i++) {
        const double value = as_words(of, fp3_field_at(of, first + i));
        single ? (void)(single[i] = (float)value) : (void)(wide[i] = value);
    }
    return FP3_OK;
}

fp3_status fp3_fields_read(fp3_fields *q, const char *name, size_t first, size_t count,
                           float *single, double *wide, fp3_error *error) {
    const fp3_field *of = fp3_field_find(&q->table, name, error);
    if (!of)
        return FP3_E_ARGUMENT;
    fp3_status status = fp3_fields_check(q, first, count, error);
    if (status || !count)
        return status;
    status = follow(q, error);
    if (status)
        return status;
    if (!q->table.model && of->is_shared && !of->is_pending) {
        float word = 0;
        status =
            fp3_engine_read_shared_of(q->def.engine, q->def.group, (uint32_t)of->place, 1, &word);
        for (size_t i = 0; i < count; i++)
            single ? (void)(single[i] = word) : (void)(wide[i] = (double)word);
        return status;
    }
    for (size_t i = 0, n; !status && i < count; i += n) {
        n = is_on_its_way(q, of) ? alike(q, first + i, count - i) : count;
        status = read_part(q, of, first + i, n, single ? single + i : NULL, wide ? wide + i : NULL,
                           error);
    }
    return status;
}

fp3_status fp3_fields_get(fp3_fields *q, const char *name, double *value, fp3_error *error) {
    return fp3_fields_read(q, name, 0, 1, NULL, value, error);
}

/* ---- runs ---- */

fp3_status fp3_fields_settle(fp3_fields *q, fp3_error *error) {
    fp3_status status = follow(q, error);
    for (uint32_t i = 0; !status && i < q->table.count; i++)
        status = settle_one(q, &q->table.list[i], error);
    return status || !q->derive ? status : fp3_derive_settle(q->derive, error);
}

/* Where one word is all there is of it. */
fp3_status fp3_fields_column(fp3_fields *q, const char *name, const float **values,
                             fp3_error *error) {
    const fp3_field *of = fp3_field_find(&q->table, name, error);
    *values = NULL;
    if (!of)
        return FP3_E_ARGUMENT;
    const int is_word = of->kind == FP3_FIELD_STATE || of->kind == FP3_FIELD_PARAM;
    if (!is_word || of->is_shared || of->place < 0 || of->low >= 0)
        return FP3_OK;
    const fp3_status status = fp3_fields_settle(q, error);
    return status ? status : fp3_engine_column(q->def.engine, (uint32_t)of->place, values);
}

static void forget_new(fp3_fields *q) {
    if (q->new_count)
        memset(q->is_new, 0, q->def.objects);
    q->new_count = 0;
}

void fp3_fields_moved(fp3_fields *q) {
    q->has_moved = 1;
    forget_new(q);
    if (q->derive)
        fp3_derive_moved(q->derive);
}

void fp3_fields_restart(fp3_fields *q) {
    q->has_moved = 0;
    forget_new(q);
    for (uint32_t i = 0; i < q->table.count; i++) {
        fp3_field *of = &q->table.list[i];
        if (!q->table.model || of->kind != FP3_FIELD_COUNT)
            continue;
        of->uniform = 0;
        of->is_pending = 1;
    }
    if (q->derive)
        fp3_derive_restart(q->derive);
}

/* ---- births ---- */

/* These objects have the default. */
static fp3_status begin_with_usual(fp3_fields *q, fp3_field *of, size_t first, size_t count,
                                   fp3_error *error) {
    double same[BLOCK];
    fp3_status status = FP3_OK;
    if (of->is_shared ||
        (q->table.model && !of->is_kept && of->is_pending && of->uniform == of->usual))
        return FP3_OK;
    for (size_t i = 0; i < BLOCK && i < count; i++)
        same[i] = of->usual;
    if (of->is_kept)
        status = of->uniform == of->usual && !of->column ? FP3_OK : need_column(q, of, error);
    else
        status = settle_one(q, of, error);
    for (size_t i = 0, n; !status && i < count; i += n) {
        n = count - i < BLOCK ? count - i : BLOCK;
        if (of->column)
            memcpy(of->column + first + i, same, n * sizeof *same);
        if (of->place >= 0 && (of->kind == FP3_FIELD_STATE || !of->is_kept))
            status = put(q, of, of->place, 0, first + i, n, (fp3_numbers){.wide = same}, error);
    }
    return status ? status : fp3_follow_again(of, first, count, q->def.objects, error);
}

fp3_status fp3_fields_born(fp3_fields *q, size_t first, size_t count, fp3_error *error) {
    fp3_status status = FP3_OK;
    if (!q->is_new)
        q->is_new = calloc(q->def.objects, 1);
    if (!q->is_new)
        return fp3_no_memory(error);
    for (uint32_t i = 0; !status && i < q->table.count; i++)
        status = begin_with_usual(q, &q->table.list[i], first, count, error);
    for (size_t i = first; !status && i < first + count; i++) {
        q->new_count += q->has_moved && !q->is_new[i];
        q->is_new[i] = (unsigned char)q->has_moved;
        if (q->derive)
            fp3_derive_born(q->derive, i);
    }
    q->written = UINT64_MAX;
    q->is_start_due = 1;
    return status;
}
