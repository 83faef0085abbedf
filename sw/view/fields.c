/* SPDX-License-Identifier: Apache-2.0 */
/* fields.c - see fields.h. */
#include "fields.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

double fp3_view_field_value(const fp3_view_recording *r, const fp3_view_field *field, size_t at) {
    double sum = 0;
    if (field->count == 1)
        return (double)r->columns[field->columns[0]].values[at];
    for (unsigned k = 0; k < field->count; k++) {
        const double part = (double)r->columns[field->columns[k]].values[at];
        sum += part * part; /* of floats: no double is too small for it */
    }
    return sqrt(sum);
}

static void find_range(const fp3_view_recording *r, fp3_view_field *field) {
    int is_any = 0;
    for (size_t at = 0; at < r->snapshots * r->objects; at++) {
        const double value = fp3_view_field_value(r, field, at);
        if (!isfinite(value))
            continue;
        field->least = is_any && field->least < value ? field->least : value;
        field->most = is_any && field->most > value ? field->most : value;
        is_any = 1;
    }
}

static int is_loaded(const fp3_view_recording *r, const fp3_view_field *field) {
    for (unsigned k = 0; k < field->count; k++)
        if (!r->columns[field->columns[k]].values)
            return 0;
    return 1;
}

static void add(const fp3_view_recording *r, const fp3_view_axes *axes, fp3_view_field field,
                fp3_view_fields *fields) {
    if (!is_loaded(r, &field))
        return;
    find_range(r, &field);
    if (axes->colour && (int)strlen(axes->colour) == field.length &&
        !strncmp(axes->colour, field.name, (size_t)field.length))
        fields->colour = fields->count;
    fields->list[fields->count++] = field;
}

fp3_status fp3_view_fields_find(const fp3_view_recording *r, const fp3_view_axes *axes,
                                fp3_view_fields *fields, fp3_error *error) {
    fields->list = calloc(2 * r->column_count, sizeof *fields->list);
    fields->colour = FP3_VIEW_NO_COLUMN;
    if (!fields->list)
        return fp3_no_memory(error);
    for (size_t i = 0; i < r->column_count; i++) {
        const fp3_view_column *c = &r->columns[i];
        const size_t length = fp3_view_begins_vector(r, i);
        fp3_view_field vector = {.name = c->name, .length = (int)length, .unit = c->unit};
        vector.count = length ? fp3_view_vector(r, c->name, length, vector.columns) : 0;
        if (vector.count)
            add(r, axes, vector, fields);
        add(r, axes, (fp3_view_field){c->name, (int)strlen(c->name), c->unit, {i}, 1, 0, 0},
            fields);
    }
    return FP3_OK;
}

void fp3_view_fields_free(fp3_view_fields *fields) {
    free(fields->list);
    memset(fields, 0, sizeof *fields);
}
