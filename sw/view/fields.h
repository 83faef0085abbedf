/* SPDX-License-Identifier: Apache-2.0 */
/* fields.h - what objects can be coloured by: each value, and the length of each vector, with their
 * ranges. */
#ifndef FP3_VIEW_FIELDS_H
#define FP3_VIEW_FIELDS_H

#include "axes.h"

typedef struct {
    const char *name; /* the column's, or the vector's */
    int length;       /* of the name */
    const char *unit;
    size_t columns[FP3_VIEW_AXES];
    unsigned count;     /* of columns; above 1: the length of the vector */
    double least, most; /* colours go from here to there: all that is finite (both 0 if nothing is),
                           or what was asked for */
} fp3_view_field;

typedef struct {
    fp3_view_field *list;
    size_t count;
    size_t colour; /* field of the axes' colour, or FP3_VIEW_NO_COLUMN */
} fp3_view_fields;

/* Of what is loaded. The caller frees *fields, after a failure too. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_view_fields_find(const fp3_view_recording *r, const fp3_view_axes *axes,
                                fp3_view_fields *fields, fp3_error *error);
/* Leaves {0}, which may be freed as well. */
void fp3_view_fields_free(fp3_view_fields *fields);

/* Of value `at`, which is snapshot * objects + object. */
double fp3_view_field_value(const fp3_view_recording *r, const fp3_view_field *field, size_t at);

#endif
