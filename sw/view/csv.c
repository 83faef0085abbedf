/* SPDX-License-Identifier: Apache-2.0 */
/* csv.c - a recording as CSV: a head with names and units, a row for each object of each snapshot.
 */
#include "reader.h"

#include "base/file.h"
#include "base/path.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    fp3_view_reader reader;
    FILE *file;
    char *line; /* the one that was read last, without its end */
    size_t room;
    unsigned number;  /* of the line, from 1 */
    int fields;       /* of each row */
    int step, object; /* fields */
    int time;         /* -1: there is none */
    size_t at;        /* snapshots that are kept */
    size_t held;      /* snapshots that there is room for */
    size_t *columns;  /* that each field is kept in; FP3_VIEW_NO_COLUMN: in none */
} csv;

/* ---- lines and fields ---- */

static fp3_status fail(const fp3_view_recording *r, const char *at, fp3_error *error,
                       const char *found, const char *expected) {
    const csv *self = (const csv *)r->reader;
    return fp3_fail_at(error, FP3_E_ARGUMENT, r->path, self->number,
                       at ? (unsigned)(at - self->line) + 1 : 0, "found %s, expected %s", found,
                       expected);
}

/* *is_end: there is no further line. */
static fp3_status next_line(fp3_view_recording *r, int *is_end, fp3_error *error) {
    csv *self = (csv *)r->reader;
    errno = 0;
    ssize_t length = getline(&self->line, &self->room, self->file);
    *is_end = length < 0;
    if (length < 0)
        return ferror(self->file) || errno ? fp3_path_fail(error, r->path, "cannot read") : FP3_OK;
    self->number++;
    if (strlen(self->line) != (size_t)length)
        return fail(r, self->line + strlen(self->line), error, "a NUL", "text");
    while (length && (self->line[length - 1] == '\n' || self->line[length - 1] == '\r'))
        self->line[--length] = 0;
    return FP3_OK;
}

/* Of a field that begins here: what ends it. */
static char *field_end(char *at) { return at + strcspn(at, ","); }

/* ---- the head ---- */

/* "x_x [m]" */
static fp3_status split_name(const fp3_view_recording *r, const char *at, const char *end,
                             char **name, char **unit, fp3_error *error) {
    const char *bracket = memchr(at, '[', (size_t)(end - at));
    const char *stop = bracket ? bracket : end;
    while (stop > at && stop[-1] == ' ')
        stop--;
    *name = *unit = NULL;
    if (stop == at)
        return fail(r, at, error, "no name", "the head 'step,time,object,...' of a recording");
    if (bracket && end[-1] != ']')
        return fail(r, bracket, error, "'[' without ']'", "a unit in brackets");
    *name = strndup(at, (size_t)(stop - at));
    *unit = bracket ? strndup(bracket + 1, (size_t)(end - bracket - 2)) : strdup("");
    return *name && *unit ? FP3_OK : fp3_no_memory(error);
}

static fp3_status take_name(fp3_view_recording *r, const char *at, char *name, char *unit,
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
        return fail(r, at, error, "the same name again", "a name for each column");
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
    int is_end;
    fp3_status status = next_line(r, &is_end, error);
    if (!status && is_end)
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: empty, expected a recording", r->path);
    for (char *at = self->line; !status && at;) {
        char *end = field_end(at), *name, *unit;
        status = split_name(r, at, end, &name, &unit, error);
        if (!status)
            status = take_name(r, at, name, unit, error);
        else {
            free(name);
            free(unit);
        }
        if (!status && self->fields == FP3_VIEW_COLUMNS_MOST)
            return fail(r, at, error, "4096 columns", "fewer");
        at = *end ? end + 1 : NULL;
    }
    if (!status && (self->step < 0 || self->object < 0 || !r->column_count))
        return fail(r, NULL, error, "no recording",
                    "a head 'step,time,object,...' with columns 'step' and 'object' and others, as "
                    "fp3 run --output writes it");
    r->has_time = self->time >= 0;
    return status;
}

/* ---- rows ---- */

typedef struct {
    uint64_t step, object;
    double time;
} row;

static fp3_status read_count(const fp3_view_recording *r, const char *at, const char *end,
                             uint64_t *value, fp3_error *error) {
    char *stop;
    errno = 0;
    *value = strtoull(at, &stop, 10);
    return stop == end && *at >= '0' && *at <= '9' && !errno
               ? FP3_OK
               : fail(r, at, error, "no number", "a number in decimal digits");
}

static fp3_status read_number(const fp3_view_recording *r, const char *at, const char *end,
                              double *value, fp3_error *error) {
    char *stop;
    *value = strtod(at, &stop);
    return stop == end && at != end ? FP3_OK
                                    : fail(r, at, error, "no number", "a number, nan, inf or -inf");
}

/* Where the values of a row go: into the snapshot that is read, if it is kept. */
static fp3_status take_value(fp3_view_recording *r, int field, const char *at, const char *end,
                             uint64_t object, int is_kept, fp3_error *error) {
    const csv *self = (const csv *)r->reader;
    const size_t column = self->columns[field];
    double wide;
    if (column == FP3_VIEW_NO_COLUMN || !is_kept)
        return FP3_OK;
    fp3_status status = read_number(r, at, end, &wide, error);
    float *value = &r->columns[column].values[self->at * r->objects + object];
    if (!status && !fp3_view_narrow(wide, value))
        status = fail(r, at, error, "a number beyond the range of FP32",
                      "one that can be shown: leave the column out with --observe");
    return status;
}

/* What a row is of; its values come later, when there is room for them. */
static fp3_status read_place(fp3_view_recording *r, row *of, fp3_error *error) {
    csv *self = (csv *)r->reader;
    fp3_status status = FP3_OK;
    int field = 0;
    for (char *at = self->line; !status && at; field++) {
        char *end = field_end(at);
        if (field == self->step)
            status = read_count(r, at, end, &of->step, error);
        else if (field == self->object)
            status = read_count(r, at, end, &of->object, error);
        else if (field == self->time)
            status = read_number(r, at, end, &of->time, error);
        at = *end ? end + 1 : NULL;
    }
    if (!status && field != self->fields)
        return fail(r, self->line, error, "a row of another length",
                    "as many fields as the head has");
    return status;
}

static fp3_status read_values(fp3_view_recording *r, uint64_t object, int is_kept,
                              fp3_error *error) {
    csv *self = (csv *)r->reader;
    fp3_status status = FP3_OK;
    int field = 0;
    for (char *at = self->line; !status && at; field++) {
        char *end = field_end(at);
        status = take_value(r, field, at, end, object, is_kept, error);
        at = *end ? end + 1 : NULL;
    }
    return status;
}

/* ---- room ---- */

static int grow_list(void **list, size_t count, size_t size) {
    void *more = realloc(*list, count * size);
    if (more)
        *list = more;
    return more != NULL;
}

static fp3_status make_room(fp3_view_recording *r, fp3_error *error) {
    csv *self = (csv *)r->reader;
    if (self->at < self->held)
        return FP3_OK;
    const size_t held = self->held ? 2 * self->held : 1;
    fp3_status status = fp3_view_check_size(r, self->at + 1, r->objects, error);
    int is_good = grow_list((void **)&r->steps, held, sizeof *r->steps) &&
                  grow_list((void **)&r->times, held, sizeof *r->times);
    for (size_t i = 0; !status && i < r->column_count; i++)
        if (r->columns[i].is_wanted && !r->columns[i].is_made)
            is_good &= grow_list((void **)&r->columns[i].values, held * r->objects, sizeof(float));
    self->held = held;
    return status || is_good ? status : fp3_fail(error, FP3_E_SYSTEM, "%s: out of memory", r->path);
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
    const csv *self = (const csv *)r->reader;
    if (now->object == expected &&
        (expected == 0 ? now->step > before->step || self->number == 2 : now->step == before->step))
        return FP3_OK;
    snprintf(found, sizeof found, "step %" PRIu64 " of object %" PRIu64, now->step, now->object);
    snprintf(wanted, sizeof wanted, "%s of object %" PRIu64,
             expected ? "the same step" : "a later step", expected);
    return fail(r, self->line, error, found, wanted);
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
        return fail(r, self->line, error, "the next step", "all objects of the one before");
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
    fp3_status status = read_place(r, &now, error);
    if (!status && now.object == 0)
        status = begin_snapshot(r, p, &now, every, error);
    if (!status)
        status = check_row(r, &now, &p->before, p->next, error);
    if (!status && !p->is_counted)
        status = grow_objects(r, now.object, error);
    if (!status && p->is_counted && now.object >= r->objects)
        status = fail(r, ((csv *)r->reader)->line, error, "one object more",
                      "as many as the first step has");
    if (!status)
        status = read_values(r, now.object, (p->snapshots - 1) % every == 0, error);
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
    progress p = {0};
    int is_end = 0;
    fp3_status status = find_columns(r, error);
    r->objects = 0;
    while (!status && !(status = next_line(r, &is_end, error)) && !is_end)
        status = take_row(r, &p, every, error);
    if (status)
        return status;
    if (!p.snapshots)
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: no snapshot is in it", r->path);
    if (!p.is_counted)
        r->objects = p.next;
    if (p.next != r->objects)
        return fail(r, NULL, error, "the end of the file", "all objects of the last step");
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
    if (self->file)
        fclose(self->file);
    free(self->line);
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
    fp3_status status = fp3_file_open(r->path, &self->file, error);
    return status ? status : read_head(r, error);
}
