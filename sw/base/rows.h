/* SPDX-License-Identifier: Apache-2.0 */
/* rows.h - a file of values with commas between them, line by line, of any size.
 *
 *     fp3_rows rows;
 *     int is_there;
 *     fp3_status status = fp3_rows_open(&rows, "points.csv", error);
 *     while (!status && !(status = fp3_rows_next(&rows, &is_there, error)) && is_there)
 *         while (!status && rows.next)
 *             status = fp3_rows_number(&rows, fp3_rows_value(&rows), &number, error);
 *     fp3_rows_close(&rows);
 *
 * Blanks around values, empty lines and lines that begin with # are ignored.
 */
#ifndef FP3_ROWS_H
#define FP3_ROWS_H

#include "token.h"

#include <fp3/status.h>
#include <stdio.h>

typedef struct {
    const char *path; /* the caller's */
    FILE *file;
    char *line;
    size_t room, length; /* of the line */
    const char *next;    /* of the value after this one; NULL: the line has no more */
    unsigned number;     /* of the line, from 1 */
} fp3_rows;

/* The caller closes *rows, after a failure too. */
fp3_status fp3_rows_open(fp3_rows *rows, const char *path, fp3_error *error);
void fp3_rows_close(fp3_rows *rows);

/* The next line that has values, until the file ends. */
fp3_status fp3_rows_next(fp3_rows *rows, int *is_there, fp3_error *error);
/* How many values the line has. */
size_t fp3_rows_count(const fp3_rows *rows);
/* FP3_E_ARGUMENT: the line has another number of values than the head. */
fp3_status fp3_rows_check(const fp3_rows *rows, size_t columns, fp3_error *error);
/* The next value of the line, without blanks around it; before it rows->next is not NULL. */
fp3_token fp3_rows_value(fp3_rows *rows);
/* Its values once more, from the first on. */
void fp3_rows_again(fp3_rows *rows);

/* FP3_E_ARGUMENT, with "path:line:column: found ..., expected ...". */
fp3_status fp3_rows_wrong(const fp3_rows *rows, fp3_token at, const char *expected,
                          fp3_error *error);
/* A number as fp3_number_read reads it. */
fp3_status fp3_rows_number(const fp3_rows *rows, fp3_token at, double *number, fp3_error *error);

/* Makes room in a list that begins as NULL, as values come. 0: out of memory; it is as it was. */
int fp3_rows_grow(void **list, size_t count, size_t size);

#endif
