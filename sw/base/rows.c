/* SPDX-License-Identifier: Apache-2.0 */
/* rows.c - see rows.h. */
#include "rows.h"

#include "file.h"
#include "number.h"
#include "path.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

fp3_status fp3_rows_open(fp3_rows *rows, const char *path, fp3_error *error) {
    *rows = (fp3_rows){.path = path};
    return fp3_file_open(path, &rows->file, error);
}

void fp3_rows_close(fp3_rows *rows) {
    if (rows->file)
        fclose(rows->file);
    free(rows->line);
    *rows = (fp3_rows){0};
}

/* ---- lines ---- */

static const char *skip_blanks(const char *p, const char *end) {
    while (p < end && (*p == ' ' || *p == '\t' || *p == '\r'))
        p++;
    return p;
}

static fp3_status read_line(fp3_rows *rows, int *is_there, fp3_error *error) {
    errno = 0;
    const ssize_t length = getline(&rows->line, &rows->room, rows->file);
    *is_there = length >= 0;
    if (length < 0)
        return ferror(rows->file) || errno ? fp3_path_fail(error, rows->path, "cannot read")
                                           : FP3_OK;
    rows->length = (size_t)length;
    if (!rows->number++ && !strncmp(rows->line, "\xef\xbb\xbf", 3)) /* a byte order mark */
        memmove(rows->line, rows->line + 3, (rows->length -= 3) + 1);
    const size_t text = strlen(rows->line);
    if (text != rows->length)
        return fp3_fail_at(error, FP3_E_ARGUMENT, rows->path, rows->number, (unsigned)text + 1,
                           "found a NUL, expected text");
    if (text && rows->line[text - 1] == '\n')
        rows->line[--rows->length] = 0;
    return FP3_OK;
}

fp3_status fp3_rows_next(fp3_rows *rows, int *is_there, fp3_error *error) {
    fp3_status status;
    const char *first;
    do {
        status = read_line(rows, is_there, error);
        if (status || !*is_there)
            return status;
        first = skip_blanks(rows->line, rows->line + rows->length);
    } while (!*first || *first == '#');
    fp3_rows_again(rows);
    return FP3_OK;
}

/* ---- values ---- */

size_t fp3_rows_count(const fp3_rows *rows) {
    size_t count = 1;
    for (const char *p = rows->line; (p = strchr(p, ',')); p++)
        count++;
    return count;
}

void fp3_rows_again(fp3_rows *rows) { rows->next = rows->line; }

fp3_token fp3_rows_value(fp3_rows *rows) {
    const char *end = strchrnul(rows->next, ',');
    const char *start = skip_blanks(rows->next, end);
    rows->next = *end ? end + 1 : NULL;
    while (end > start && skip_blanks(end - 1, end) == end)
        end--;
    return (fp3_token){.text = start,
                       .length = (size_t)(end - start),
                       .location = {rows->number, (unsigned)(start - rows->line) + 1},
                       .kind = FP3_TOKEN_NAME};
}

fp3_status fp3_rows_check(const fp3_rows *rows, size_t columns, fp3_error *error) {
    const size_t count = fp3_rows_count(rows);
    fp3_rows more = *rows;
    fp3_token at = {0};
    if (count < columns)
        return fp3_fail_at(
            error, FP3_E_ARGUMENT, rows->path, rows->number, (unsigned)rows->length + 1,
            "found %zu numbers, expected %zu: a number for each name of the head", count, columns);
    fp3_rows_again(&more);
    for (size_t i = 0; count > columns && i <= columns; i++)
        at = fp3_rows_value(&more);
    return count == columns
               ? FP3_OK
               : fp3_rows_wrong(rows, at, "the end of the line: the head has no more names", error);
}

fp3_status fp3_rows_wrong(const fp3_rows *rows, fp3_token at, const char *expected,
                          fp3_error *error) {
    char shown[FP3_TOKEN_SHOWN_SIZE];
    return fp3_fail_at(error, FP3_E_ARGUMENT, rows->path, at.location.line, at.location.column,
                       "found %s, expected %s", at.length ? fp3_token_shown(at, shown) : "nothing",
                       expected);
}

fp3_status fp3_rows_number(const fp3_rows *rows, fp3_token at, double *number, fp3_error *error) {
    char text[FP3_NUMBER_SIZE];
    const char *expected = fp3_number_copy(at, text);
    if (!expected)
        expected = fp3_number_read(text, number);
    return expected ? fp3_rows_wrong(rows, at, expected, error) : FP3_OK;
}

int fp3_rows_grow(void **list, size_t count, size_t size) {
    void *more = realloc(*list, count * size);
    if (more)
        *list = more;
    return more != NULL;
}
