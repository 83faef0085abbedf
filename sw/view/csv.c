/* SPDX-License-Identifier: Apache-2.0 */
/* csv.c - a recording as CSV: a head with names and units, a row for each object of each snapshot.
 */
#include "reader.h"

#include "base/number.h"
#include "base/rows.h"
#include "base/scanner.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    fp3_view_reader reader;
    fp3_rows rows;
    int fields;       /* of each row */
    int step, object; /* fields */
    int time;         /* -1: there is none */
    size_t at;        /* snapshots that are kept */
    size_t held;      /* snapshots that there is room for */
    size_t *columns;  /* that each field is kept in; FP3_VIEW_NO_COLUMN: in none */
} csv;

/* Of the line that was read last; column 0: of all of it. */
static fp3_status fail(const fp3_view_recording *r, unsigned column, fp3_error *error,
                       const char *found, const char *expected) {
    const csv *self = (const csv *)r->reader;
    return fp3_fail_at(error, FP3_E_ARGUMENT, r->path, self->rows.number, column,
                       "found %s, expected %s", found, expected);
}

/* ---- the head ---- */

/* "x_x [m]" */
static fp3_status split_name(const fp3_view_recording *r, fp3_token at, char **name, char **unit,
                             fp3_error *error) {
    const csv *self = (const csv *)r->reader;
    const char *end = at.text + at.length, *bracket = memchr(at.text, '[', at.length);
    const char *stop = bracket ? bracket : end;
    while (stop > at.text && stop[-1] == ' ')
        stop--;
    *name = *unit = NULL;
    if (stop == at.text)
        return fp3_rows_wrong(&self->rows, at, "the head 'step,time,object,...' of a recording",
                              error);
    if (bracket && end[-1] != ']')
        return fp3_rows_wrong(&self->rows, at, "a unit in brackets, as in 'x [m]'", error);
    *name = strndup(at.text, (size_t)(stop - at.text));
    *unit = bracket ? strndup(bracket + 1, (size_t)(end - bracket - 2)) : strdup("");
    return *name && *unit ? FP3_OK : fp3_no_memory(error);
}

static fp3_status take_name(fp3_view_recording *r, fp3_token at, char *name, char *unit,
                            fp3_error *error) {
    csv *self = (csv *)r->reader;
    const int field = self->fields++;
    int *const place = !strcmp(name, "step")     ? &self->step
                       : !strcmp(name, "object") ? &self->object
                       : !strcmp(name, "time")   ? &self->time
                                                 : NULL;
    if ((place && *place >= 0) || fp3_view_find(r, name) != FP3_VIEW_NO_COLUMN) {
        free(name);
        free(unit);
        return fp3_rows_wrong(&self->rows, at, "a name that no other column has", error);
    }
    if (!place)
        return fp3_view_add(r, name, unit, field, error);
    *place = field;
    if (place == &self->time)
        r->time_unit = unit;
    else
        free(unit);
    free(name);
    return FP3_OK;
}

static fp3_status read_head(fp3_view_recording *r, fp3_error *error) {
    csv *self = (csv *)r->reader;
    int is_there;
    fp3_status status = fp3_rows_next(&self->rows, &is_there, error);
    if (!status && !is_there)
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: empty, expected a recording", r->path);
    while (!status && self->rows.next) {
        const fp3_token at = fp3_rows_value(&self->rows);
        char *name, *unit;
        status = split_name(r, at, &name, &unit, error);
        if (!status)
            status = take_name(r, at, name, unit, error);
        else {
            free(name);
            free(unit);
        }
        if (!status && self->fields == FP3_VIEW_COLUMNS_MOST)
            return fail(r, at.location.column, error, "4096 columns", "fewer");
    }
    if (!status && (self->step < 0 || self->object < 0 || !r->column_count))
        return fail(r, 0, error, "no recording",
                    "a head 'step,time,object,...' with columns 'step' and 'object' and others, as "
                    "fp3 run --output writes it");
    r->has_time = self->time >= 0;
    return status;
}

/* ---- rows ---- */

typedef struct {
    uint64_t step, object;
    double time;
    int is_none; /* before the first row */
} row;

static fp3_status read_count(const fp3_rows *rows, fp3_token at, uint64_t *value,
                             fp3_error *error) {
    char text[FP3_NUMBER_SIZE], *stop;
    const int is_read = !fp3_number_copy(at, text);
    errno = 0;
    *value = is_read ? strtoull(text, &stop, 10) : 0;
    return is_read && fp3_is_digit(*text) && !*stop && !errno
               ? FP3_OK
               : fp3_rows_wrong(rows, at, "a number in decimal digits", error);
}

/* What a row is of; its values come later, when there is room for them. */
static fp3_status read_place(csv *self, row *of, fp3_error *error) {
    fp3_rows *rows = &self->rows;
    fp3_status status = fp3_rows_check(rows, (size_t)self->fields, error);
    for (int field = 0; !status && rows->next; field++) {
        const fp3_token at = fp3_rows_value(rows);
        if (field == self->step)
            status = read_count(rows, at, &of->step, error);
        else if (field == self->object)
            status = read_count(rows, at, &of->object, error);
        else if (field == self->time)
            status = fp3_rows_number(rows, at, &of->time, error);
    }
    return status;
}

/* Into the snapshot that is read. */
static fp3_status read_values(fp3_view_recording *r, uint64_t object, fp3_error *error) {
    csv *self = (csv *)r->reader;
    fp3_status status = FP3_OK;
    fp3_rows_again(&self->rows);
    for (int field = 0; !status && self->rows.next; field++) {
        const size_t column = self->columns[field];
        const fp3_token at = fp3_rows_value(&self->rows);
        double wide;
        if (column == FP3_VIEW_NO_COLUMN)
            continue;
        status = fp3_rows_number(&self->rows, at, &wide, error);
        float *value = &r->columns[column].values[self->at * r->objects + object];
        if (!status && !fp3_view_narrow(wide, value))
            status = fp3_rows_wrong(&self->rows, at,
                                    "a number in the range of FP32, or none of this column: "
                                    "leave it out with --observe",
                                    error);
    }
    return status;
}

/* ---- room ---- */

static fp3_status make_room(fp3_view_recording *r, fp3_error *error) {
    csv *self = (csv *)r->reader;
    if (self->at < self->held)
        return FP3_OK;
    const size_t held = self->held ? 2 * self->held : 1;
    fp3_status status = fp3_view_check_size(r, self->at + 1, r->objects, error);
    int is_good = fp3_rows_grow((void **)&r->steps, held, sizeof *r->steps) &&
                  fp3_rows_grow((void **)&r->times, held, sizeof *r->times);
    for (size_t i = 0; !status && i < r->column_count; i++)
        if (r->columns[i].is_wanted && !r->columns[i].is_made)
            is_good &=
                fp3_rows_grow((void **)&r->columns[i].values, held * r->objects, sizeof(float));
    self->held = held;
    return status || is_good ? status : fp3_no_memory(error);
}

/* ---- snapshots ---- */

/* How many objects there are is known when the first snapshot ends, so until then there is room for
 * twice as many as were seen. */
static fp3_status grow_objects(fp3_view_recording *r, uint64_t object, fp3_error *error) {
    csv *self = (csv *)r->reader;
    if (object < r->objects)
        return FP3_OK;
    r->objects = r->objects ? 2 * r->objects : 64;
    self->held = 0;
    return make_room(r, error);
}

static fp3_status check_row(const fp3_view_recording *r, const row *now, const row *before,
                            uint64_t expected, fp3_error *error) {
    char found[80], wanted[80];
    if (now->object == expected &&
        (expected == 0 ? now->step > before->step || before->is_none : now->step == before->step))
        return FP3_OK;
    snprintf(found, sizeof found, "step %" PRIu64 " of object %" PRIu64, now->step, now->object);
    snprintf(wanted, sizeof wanted, "%s of object %" PRIu64,
             expected ? "the same step" : "a later step", expected);
    return fail(r, 1, error, found, wanted);
}

/* A snapshot is all objects of one step. */
typedef struct {
    row before;
    uint64_t next;      /* object */
    uint64_t snapshots; /* that began */
    int is_counted;     /* r->objects is how many there are */
} progress;

static fp3_status begin_snapshot(fp3_view_recording *r, progress *p, const row *now, uint64_t every,
                                 fp3_error *error) {
    csv *self = (csv *)r->reader;
    if (p->snapshots == 1 && !p->is_counted) {
        r->objects = p->next;
        p->is_counted = 1;
        self->held = 1;
    }
    if (p->is_counted && p->next != r->objects)
        return fail(r, 1, error, "the next step", "all objects of the snapshot before");
    const int was_kept = p->snapshots && (p->snapshots - 1) % every == 0;
    self->at += (size_t)was_kept;
    p->next = 0;
    if (p->snapshots++ % every != 0)
        return FP3_OK;
    fp3_status status = p->is_counted ? make_room(r, error) : grow_objects(r, 0, error);
    if (!status) {
        r->steps[self->at] = now->step;
        r->times[self->at] = now->time;
    }
    return status;
}

static fp3_status take_row(fp3_view_recording *r, progress *p, uint64_t every, fp3_error *error) {
    row now = {0};
    fp3_status status = read_place((csv *)r->reader, &now, error);
    if (!status && now.object == 0)
        status = begin_snapshot(r, p, &now, every, error);
    if (!status)
        status = check_row(r, &now, &p->before, p->next, error);
    if (!status && !p->is_counted)
        status = grow_objects(r, now.object, error);
    if (!status && p->is_counted && now.object >= r->objects)
        status = fail(r, 1, error, "one object more", "as many as the first step has");
    if (!status && (p->snapshots - 1) % every == 0)
        status = read_values(r, now.object, error);
    p->before = now;
    p->next++;
    return status;
}

/* Now it is known which are wanted. */
static fp3_status find_columns(fp3_view_recording *r, fp3_error *error) {
    csv *self = (csv *)r->reader;
    self->columns = malloc((size_t)self->fields * sizeof *self->columns);
    if (!self->columns)
        return fp3_no_memory(error);
    for (int i = 0; i < self->fields; i++)
        self->columns[i] = FP3_VIEW_NO_COLUMN;
    for (size_t i = 0; i < r->column_count; i++)
        if (r->columns[i].is_wanted && !r->columns[i].is_made)
            self->columns[r->columns[i].source] = i;
    return FP3_OK;
}

static fp3_status csv_load(fp3_view_recording *r, uint64_t every, fp3_error *error) {
    csv *self = (csv *)r->reader;
    progress p = {.before = {.is_none = 1}};
    int is_there;
    fp3_status status = find_columns(r, error);
    r->objects = 0;
    while (!status && !(status = fp3_rows_next(&self->rows, &is_there, error)) && is_there)
        status = take_row(r, &p, every, error);
    if (status)
        return status;
    if (!p.snapshots)
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: the recording has no snapshot", r->path);
    if (!p.is_counted)
        r->objects = p.next;
    if (p.next != r->objects)
        return fail(r, 0, error, "the end of the file", "all objects of the last step");
    r->snapshots = self->at + ((p.snapshots - 1) % every == 0);
    if (!r->has_time) {
        free(r->times);
        r->times = NULL;
    }
    return FP3_OK;
}

/* ---- opening and closing ---- */

static void csv_close(fp3_view_reader *reader) {
    csv *self = (csv *)reader;
    fp3_rows_close(&self->rows);
    free(self->columns);
    free(self);
}

fp3_status fp3_view_csv_open(fp3_view_recording *r, fp3_error *error) {
    csv *self = calloc(1, sizeof *self);
    if (!self)
        return fp3_no_memory(error);
    self->reader = (fp3_view_reader){csv_load, csv_close};
    self->step = self->object = self->time = -1;
    r->reader = &self->reader;
    fp3_status status = fp3_rows_open(&self->rows, r->path, error);
    return status ? status : read_head(r, error);
}
