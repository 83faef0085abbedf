/* SPDX-License-Identifier: Apache-2.0 */
/* table.c - see table.h. */
#include "table.h"

#include "base/number.h"
#include "base/rows.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the head ---- */

static fp3_status take_name(fp3_table *t, const fp3_rows *rows, fp3_token at, fp3_error *error) {
    char *name = t->names[t->columns];
    if (at.length >= FP3_NAME_SIZE)
        return fp3_rows_wrong(rows, at, "a name of at most 31 characters", error);
    memcpy(name, at.text, at.length);
    name[at.length] = '\0';
    if (!fp3_name_valid(name))
        return fp3_rows_wrong(rows, at, "the name of a column", error);
    for (size_t i = 0; i < t->columns; i++)
        if (strcmp(t->names[i], name) == 0)
            return fp3_rows_wrong(rows, at, "a name that no other column has", error);
    t->columns++;
    return FP3_OK;
}

static fp3_status read_head(fp3_table *t, fp3_rows *rows, fp3_error *error) {
    int is_there;
    fp3_status status = fp3_rows_next(rows, &is_there, error);
    if (status || !is_there)
        return status ? status
                      : fp3_fail_at(error, FP3_E_ARGUMENT, t->path, 1, 1,
                                    "found nothing, expected a line of names, with commas "
                                    "between them");
    t->head = rows->number;
    t->names = calloc(fp3_rows_count(rows), sizeof *t->names);
    if (!t->names)
        return fp3_no_memory(error);
    while (!status && rows->next)
        status = take_name(t, rows, fp3_rows_value(rows), error);
    return status;
}

/* ---- the rows ---- */

/* For twice as many rows. */
static fp3_status make_room(fp3_table *t, size_t *room, fp3_error *error) {
    *room = *room ? 2 * *room : 64;
    return fp3_rows_grow((void **)&t->number, *room * t->columns, sizeof *t->number) &&
                   fp3_rows_grow((void **)&t->line, *room, sizeof *t->line) &&
                   fp3_rows_grow((void **)&t->where, *room * t->columns, sizeof *t->where)
               ? FP3_OK
               : fp3_no_memory(error);
}

static fp3_status take_numbers(fp3_table *t, fp3_rows *rows, fp3_error *error) {
    fp3_status status = fp3_rows_check(rows, t->columns, error);
    t->line[t->rows] = rows->number;
    for (size_t i = t->rows * t->columns; !status && rows->next; i++) {
        const fp3_token at = fp3_rows_value(rows);
        t->where[i] = at.location.column;
        status = fp3_rows_number(rows, at, &t->number[i], error);
        if (!status && !isfinite(t->number[i]))
            status = fp3_rows_wrong(rows, at, "a finite number", error);
    }
    t->rows++;
    return status;
}

/* From row by row to column by column. */
static fp3_status turn(fp3_table *t, fp3_error *error) {
    double *turned = malloc((t->rows * t->columns + 1) * sizeof *turned);
    if (!turned)
        return fp3_no_memory(error);
    for (size_t i = 0; i < t->columns; i++)
        for (size_t row = 0; row < t->rows; row++)
            turned[i * t->rows + row] = t->number[row * t->columns + i];
    free(t->number);
    t->number = turned;
    return FP3_OK;
}

static fp3_status read_rows(fp3_table *t, fp3_rows *rows, fp3_error *error) {
    int is_there;
    size_t room = 0;
    fp3_status status;
    while (!(status = fp3_rows_next(rows, &is_there, error)) && is_there) {
        if (t->rows == room)
            status = make_room(t, &room, error);
        if (!status)
            status = take_numbers(t, rows, error);
        if (status)
            return status;
    }
    return status ? status : turn(t, error);
}

fp3_status fp3_table_read(const char *path, fp3_table *t, fp3_error *error) {
    fp3_rows rows = {0};
    *t = (fp3_table){.path = strdup(path)};
    fp3_status status = t->path ? fp3_rows_open(&rows, t->path, error) : fp3_no_memory(error);
    if (!status)
        status = read_head(t, &rows, error);
    if (!status)
        status = read_rows(t, &rows, error);
    fp3_rows_close(&rows);
    return status;
}

void fp3_table_close(fp3_table *t) {
    free(t->path);
    free(t->names);
    free(t->number);
    free(t->line);
    free(t->where);
    *t = (fp3_table){0};
}

__attribute__((format(printf, 5, 6))) static fp3_status
wrong(const fp3_table *t, size_t row, size_t column, fp3_error *error, const char *format, ...) {
    char text[400];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return fp3_fail_at(error, FP3_E_ARGUMENT, t->path, t->line[row],
                       t->where[row * t->columns + column], "%s", text);
}

/* ---- links ---- */

static fp3_status take_object(const fp3_table *t, size_t row, size_t column, size_t most,
                              fp3_table_links *made, fp3_error *error) {
    const double number = t->number[column * t->rows + row];
    const double end = most ? (double)most - 1 : UINT32_MAX - 1.0;
    if (!(number >= 0 && number <= end && floor(number) == number))
        return wrong(t, row, column, error,
                     "found object %.17g, expected a whole number from 0 to %.0f", number, end);
    made->ends[column * t->rows + row] = (uint32_t)number;
    if ((size_t)number >= made->objects)
        made->objects = (size_t)number + 1;
    return FP3_OK;
}

static fp3_status take_row(const fp3_table *t, size_t row, const fp3_table_ends *ends,
                           fp3_table_links *made, fp3_error *error) {
    fp3_status status = take_object(t, row, 0, ends->a, made, error);
    if (!status)
        status = take_object(t, row, 1, ends->b, made, error);
    if (!status && !ends->is_across && made->ends[row] == made->ends[t->rows + row])
        return wrong(t, row, 1, error, "found object %" PRIu32 " again, expected another object",
                     made->ends[row]);
    for (size_t i = 2; !status && i < t->columns; i++) {
        const double number = t->number[i * t->rows + row];
        float word;
        const char *expected = fp3_number_written(number, &word);
        made->numbers[(i - 2) * t->rows + row] = number;
        if (expected)
            return wrong(t, row, i, error, "%s is %.9g, expected %s", t->names[i], number,
                         expected);
    }
    return status;
}

fp3_status fp3_table_link(const fp3_table *t, const fp3_table_ends *ends, fp3_table_links *made,
                          fp3_error *error) {
    *made = (fp3_table_links){0};
    if (t->columns < 2 || strcmp(t->names[0], "a") != 0 || strcmp(t->names[1], "b") != 0)
        return fp3_fail_at(error, FP3_E_ARGUMENT, t->path, t->head, 1,
                           "expected a head of a,b and the names of fields: the objects of each "
                           "link, and its values");
    const size_t fields = t->columns - 2;
    made->ends = malloc((2 * t->rows + 1) * sizeof *made->ends);
    made->numbers = malloc((fields * t->rows + 1) * sizeof *made->numbers);
    made->names = calloc(fields + 1, sizeof *made->names);
    made->fields = calloc(fields + 1, sizeof *made->fields);
    if (!made->ends || !made->numbers || !made->names || !made->fields)
        return fp3_no_memory(error);
    fp3_status status = FP3_OK;
    for (size_t row = 0; !status && row < t->rows; row++)
        status = take_row(t, row, ends, made, error);
    for (size_t i = 0; i < fields; i++) {
        made->names[i] = t->names[i + 2];
        made->fields[i] = &made->numbers[i * t->rows];
    }
    made->links = (fp3_links){.count = t->rows,
                              .a = made->ends,
                              .b = made->ends + t->rows,
                              .names = made->names,
                              .fields = made->fields,
                              .field_count = fields};
    return status;
}

void fp3_table_links_free(fp3_table_links *made) {
    free(made->ends);
    free(made->numbers);
    free(made->names);
    free(made->fields);
    *made = (fp3_table_links){0};
}
