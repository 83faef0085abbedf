/* SPDX-License-Identifier: Apache-2.0 */
/* table.h - numbers in columns with names, from a file of values with commas between them.
 *
 *     fp3_table points;
 *     fp3_status status = fp3_table_read("points.csv", &points, error);
 *     ... points.number[column * points.rows + row] ...
 *     fp3_table_close(&points);
 *
 * The first line is the head: names. base/rows.h says how lines are read.
 */
#ifndef FP3_ARRANGE_TABLE_H
#define FP3_ARRANGE_TABLE_H

#include <fp3/engine.h>
#include <fp3/image.h>

typedef struct {
    char *path;
    char (*names)[FP3_NAME_SIZE];
    size_t columns, rows;
    double *number;         /* column by column; all are finite */
    unsigned *line, *where; /* of each row; of each value its column in the line, row by row */
    unsigned head;          /* the line of the head */
} fp3_table;

/* FP3_E_ARGUMENT, with "path:line:column: found ..., expected ...". The caller closes *table, after
 * a failure too. */
fp3_status fp3_table_read(const char *path, fp3_table *table, fp3_error *error);
void fp3_table_close(fp3_table *table);

/* A table of links, with the columns a, b and fields; its memory besides the table's. */
typedef struct {
    fp3_links links;
    uint32_t *ends; /* all a, then all b */
    double *numbers;
    const char **names;
    const double **fields;
    size_t objects; /* one more than the highest number of an object; 0: no links */
} fp3_table_links;

/* How many objects there are at either end; 0: not known. */
typedef struct {
    size_t a, b;
    int is_across; /* the ends are of different groups, each counted in its own */
} fp3_table_ends;

/* The table must outlive *made, which the caller frees,
 * after a failure too. FP3_E_ARGUMENT: the first columns are not a and b, an unknown object, a link
 * of an object with itself, a field outside of FP32. */
fp3_status fp3_table_link(const fp3_table *table, const fp3_table_ends *ends, fp3_table_links *made,
                          fp3_error *error);
void fp3_table_links_free(fp3_table_links *made);

#endif
