/* SPDX-License-Identifier: Apache-2.0 */
/* recorded.c - see recorded.h. */
#include "recorded.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- columns ---- */

fp3_status fp3_view_add(fp3_view_recording *r, char *name, char *unit, int source,
                        fp3_error *error) {
    fp3_view_column *columns =
        name ? realloc(r->columns, (r->column_count + 1) * sizeof *columns) : NULL;
    if (columns)
        r->columns = columns;
    fp3_view_column made = {.name = name,
                            .unit = unit ? unit : strdup(""),
                            .doc = strdup(""),
                            .velocity = strdup(""),
                            .source = source};
    if (columns && made.unit && made.doc && made.velocity) {
        r->columns[r->column_count++] = made;
        return FP3_OK;
    }
    free(made.name);
    free(made.unit);
    free(made.doc);
    free(made.velocity);
    return fp3_no_memory(error);
}

size_t fp3_view_find(const fp3_view_recording *r, const char *name) {
    for (size_t i = 0; i < r->column_count; i++)
        if (!strcmp(r->columns[i].name, name))
            return i;
    return FP3_VIEW_NO_COLUMN;
}

const char *fp3_view_names(const fp3_view_recording *r, char *text, size_t size) {
    size_t used = 0;
    text[0] = 0;
    for (size_t i = 0; i < r->column_count && used < size; i++) {
        const fp3_view_column *c = &r->columns[i];
        if (!c->is_made)
            used += (size_t)snprintf(text + used, size - used, "%s%s%s%s%s", used ? ", " : "",
                                     c->name, *c->unit ? " [" : "", c->unit, *c->unit ? "]" : "");
    }
    return text;
}

static int can_be_made(const fp3_view_recording *r, const char *name) {
    return !strcmp(name, "object") || (!strcmp(name, "time") && r->has_time);
}

static fp3_status make_column(fp3_view_recording *r, const char *name, fp3_error *error) {
    const int is_time = !strcmp(name, "time");
    fp3_status status =
        fp3_view_add(r, strdup(name), is_time ? strdup(r->time_unit) : NULL, -1, error);
    if (!status)
        r->columns[r->column_count - 1].is_made = 1;
    return status;
}

fp3_status fp3_view_want(fp3_view_recording *r, const char *name, size_t *column,
                         fp3_error *error) {
    char names[300];
    *column = fp3_view_find(r, name);
    if (*column == FP3_VIEW_NO_COLUMN && can_be_made(r, name)) {
        fp3_status status = make_column(r, name, error);
        if (status)
            return status;
        *column = r->column_count - 1;
    }
    if (*column == FP3_VIEW_NO_COLUMN)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "%s: no value is called '%s': there are %s, and object%s", r->path, name,
                        fp3_view_names(r, names, sizeof names), r->has_time ? " and time" : "");
    r->columns[*column].is_wanted = 1;
    return FP3_OK;
}

/* ---- values ---- */

int fp3_view_narrow(double wide, float *value) {
    *value = (float)wide;
    return !isfinite(wide) || isfinite(*value);
}

fp3_status fp3_view_check_size(const fp3_view_recording *r, uint64_t snapshots, uint64_t objects,
                               fp3_error *error) {
    uint64_t columns = 0;
    for (size_t i = 0; i < r->column_count; i++)
        columns += (uint64_t)(r->columns[i].is_wanted != 0);
    if (!columns || objects <= FP3_VIEW_VALUES_MOST / columns / (snapshots ? snapshots : 1))
        return FP3_OK;
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "%s: %" PRIu64 " objects, %" PRIu64 " values of each and %" PRIu64
                    " snapshots are more than the %" PRIu64
                    " numbers that can be shown: choose fewer with --every and --observe",
                    r->path, objects, columns, snapshots, FP3_VIEW_VALUES_MOST);
}

/* ---- the end ---- */

static void free_relations(fp3_view_recording *r) {
    for (size_t i = 0; i < r->relation_count; i++) {
        free(r->relations[i].name);
        free(r->relations[i].pairs);
        free(r->relations[i].position);
    }
}

void fp3_view_recorded_free(fp3_view_recording *r) {
    for (size_t i = 0; i < r->column_count; i++) {
        free(r->columns[i].name);
        free(r->columns[i].unit);
        free(r->columns[i].doc);
        free(r->columns[i].velocity);
        free(r->columns[i].values);
    }
    free_relations(r);
    free(r->shapes);
    free(r->corners);
    free(r->triangles);
    free(r->edges);
    free(r->joints);
    free(r->contacts);
    free(r->columns);
    free(r->model);
    free(r->doc);
    free(r->integrator);
    free(r->engine);
    free(r->configuration);
    free(r->time_unit);
    free(r->steps);
    free(r->times);
}
