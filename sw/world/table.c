/* SPDX-License-Identifier: Apache-2.0 */
/* table.c - see table.h. */
#include "table.h"

#include "base/file.h"
#include "base/number.h"
#include "base/token.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A line that has something to say. */
typedef struct {
    const char *start, *end, *next; /* next: of the value after this one; NULL: there is none */
    unsigned line;
} cursor;

typedef struct {
    const char *at, *end; /* of the file that is left */
    unsigned line;
} source;

static const char *skip_blanks(const char *p, const char *end) {
    while (p < end && (*p == ' ' || *p == '\t' || *p == '\r'))
        p++;
    return p;
}

/* Whether there is one. */
static int next_line(source *s, cursor *c) {
    while (s->at < s->end) {
        const char *newline = memchr(s->at, '\n', (size_t)(s->end - s->at));
        *c = (cursor){s->at, newline ? newline : s->end, s->at, ++s->line};
        s->at = newline ? newline + 1 : s->end;
        const char *first = skip_blanks(c->start, c->end);
        if (first < c->end && *first != '#')
            return 1;
    }
    return 0;
}

/* The next value of the line, without blanks around it. */
static fp3_token next_value(cursor *c) {
    const char *start = skip_blanks(c->next, c->end);
    const char *comma = memchr(c->next, ',', (size_t)(c->end - c->next));
    const char *end = comma ? comma : c->end;
    start = start < end ? start : end;
    while (end > start && skip_blanks(end - 1, end) == end)
        end--;
    c->next = comma ? comma + 1 : NULL;
    return (fp3_token){.text = start,
                       .length = (size_t)(end - start),
                       .location = {c->line, (unsigned)(start - c->start) + 1},
                       .kind = FP3_TOKEN_NAME};
}

static fp3_status wrong(const fp3_table *t, fp3_token at, const char *expected, fp3_error *error) {
    char shown[FP3_TOKEN_SHOWN_SIZE];
    return fp3_fail_at(error, FP3_E_ARGUMENT, t->path, at.location.line, at.location.column,
                       "found %s, expected %s", at.length ? fp3_token_shown(at, shown) : "nothing",
                       expected);
}

/* ---- the head ---- */

static fp3_status read_name(fp3_table *t, fp3_token at, fp3_error *error) {
    char *name = t->names[t->columns];
    if (at.length >= FP3_NAME_SIZE)
        return wrong(t, at, "a name of at most 31 characters", error);
    memcpy(name, at.text, at.length);
    name[at.length] = '\0';
    if (strlen(name) != at.length || !fp3_name_valid(name))
        return wrong(t, at, "the name of a column", error);
    for (size_t i = 0; i < t->columns; i++)
        if (strcmp(t->names[i], name) == 0)
            return wrong(t, at, "a name that no other column has", error);
    t->columns++;
    return FP3_OK;
}

static fp3_status read_head(fp3_table *t, source *s, fp3_error *error) {
    cursor c;
    size_t most = 1;
    fp3_status status = FP3_OK;
    if (!next_line(s, &c))
        return fp3_fail_at(error, FP3_E_ARGUMENT, t->path, 1, 1,
                           "found nothing, expected a line of names, with commas between them");
    for (const char *p = c.start; p < c.end; p++)
        most += *p == ',';
    t->head = c.line;
    t->names = calloc(most, sizeof *t->names);
    if (!t->names)
        return fp3_no_memory(error);
    while (!status && c.next)
        status = read_name(t, next_value(&c), error);
    return status;
}

/* ---- the rows ---- */

static fp3_status read_number(fp3_table *t, fp3_token at, double *number, fp3_error *error) {
    char text[FP3_NUMBER_SIZE];
    const char *expected = fp3_number_copy(at, text);
    if (!expected)
        expected = fp3_number_read(text, number);
    if (!expected && !isfinite(*number))
        expected = "a finite number";
    return expected ? wrong(t, at, expected, error) : FP3_OK;
}

static fp3_status read_row(fp3_table *t, cursor *c, size_t room, fp3_error *error) {
    size_t i = 0;
    t->line[t->rows] = c->line;
    for (; c->next; i++) {
        const fp3_token at = next_value(c);
        if (i == t->columns)
            return wrong(t, at, "the end of the line: the head has no more names", error);
        t->where[t->rows * t->columns + i] = at.location.column;
        const fp3_status status = read_number(t, at, &t->number[i * room + t->rows], error);
        if (status)
            return status;
    }
    if (i < t->columns)
        return fp3_fail_at(
            error, FP3_E_ARGUMENT, t->path, c->line, (unsigned)(c->end - c->start) + 1,
            "found %zu numbers, expected %zu: a number for each name of the head", i, t->columns);
    t->rows++;
    return FP3_OK;
}

static fp3_status read_rows(fp3_table *t, source *s, fp3_error *error) {
    size_t room = 1;
    cursor c;
    fp3_status status = FP3_OK;
    for (const char *p = s->at; p < s->end; p++)
        room += *p == '\n';
    t->number = malloc(room * t->columns * sizeof *t->number);
    t->line = malloc(room * sizeof *t->line);
    t->where = malloc(room * t->columns * sizeof *t->where);
    if (!t->number || !t->line || !t->where)
        return fp3_no_memory(error);
    while (!status && next_line(s, &c))
        status = read_row(t, &c, room, error);
    for (size_t i = 1; i < t->columns; i++) /* without the room of lines that say nothing */
        memmove(&t->number[i * t->rows], &t->number[i * room], t->rows * sizeof *t->number);
    return status;
}

fp3_status fp3_table_read(const char *path, fp3_table *t, fp3_error *error) {
    char *text = NULL;
    size_t size = 0;
    *t = (fp3_table){.path = strdup(path)};
    fp3_status status = t->path ? fp3_file_read(path, &text, &size, error) : fp3_no_memory(error);
    if (status)
        return status;
    const size_t mark = size >= 3 && !memcmp(text, "\xef\xbb\xbf", 3) ? 3 : 0;
    source s = {text + mark, text + size, 0};
    status = read_head(t, &s, error);
    if (!status)
        status = read_rows(t, &s, error);
    free(text);
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

fp3_status fp3_table_wrong(const fp3_table *t, size_t row, size_t column, fp3_error *error,
                           const char *format, ...) {
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
        return fp3_table_wrong(t, row, column, error,
                               "found object %.17g, expected a whole number from 0 to %.0f", number,
                               end);
    made->ends[column * t->rows + row] = (uint32_t)number;
    if ((size_t)number >= made->objects)
        made->objects = (size_t)number + 1;
    return FP3_OK;
}

static fp3_status take_row(const fp3_table *t, size_t row, size_t most, fp3_table_links *made,
                           fp3_error *error) {
    fp3_status status = take_object(t, row, 0, most, made, error);
    if (!status)
        status = take_object(t, row, 1, most, made, error);
    if (!status && made->ends[row] == made->ends[t->rows + row])
        return fp3_table_wrong(t, row, 1, error,
                               "found object %" PRIu32 " again, expected another one",
                               made->ends[row]);
    for (size_t i = 2; !status && i < t->columns; i++) {
        const double number = t->number[i * t->rows + row];
        const char *expected = fp3_number_written(number, &made->words[(i - 2) * t->rows + row]);
        if (expected)
            return fp3_table_wrong(t, row, i, error, "%s is %.9g, expected %s", t->names[i], number,
                                   expected);
    }
    return status;
}

fp3_status fp3_table_link(const fp3_table *t, size_t most, fp3_table_links *made,
                          fp3_error *error) {
    *made = (fp3_table_links){0};
    if (t->columns < 2 || strcmp(t->names[0], "a") != 0 || strcmp(t->names[1], "b") != 0)
        return fp3_fail_at(error, FP3_E_ARGUMENT, t->path, t->head, 1,
                           "expected a head of a,b and the names of fields: the objects of each "
                           "link, and its values");
    const size_t fields = t->columns - 2;
    made->ends = malloc((2 * t->rows + 1) * sizeof *made->ends);
    made->words = malloc((fields * t->rows + 1) * sizeof *made->words);
    made->names = calloc(fields + 1, sizeof *made->names);
    made->fields = calloc(fields + 1, sizeof *made->fields);
    if (!made->ends || !made->words || !made->names || !made->fields)
        return fp3_no_memory(error);
    fp3_status status = FP3_OK;
    for (size_t row = 0; !status && row < t->rows; row++)
        status = take_row(t, row, most, made, error);
    for (size_t i = 0; i < fields; i++) {
        made->names[i] = t->names[i + 2];
        made->fields[i] = &made->words[i * t->rows];
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
    free(made->words);
    free(made->names);
    free(made->fields);
    *made = (fp3_table_links){0};
}
