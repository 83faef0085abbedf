/* SPDX-License-Identifier: Apache-2.0 */
/* axes.c - see axes.h. */
#include "axes.h"

#include "base/unit.h"

#include <fp3/model.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- what there is ---- */

unsigned fp3_view_vector(const fp3_view_recording *r, const char *name, size_t length,
                         size_t columns[FP3_VIEW_AXES]) {
    unsigned count = 0;
    for (; count < FP3_VIEW_AXES; count++) {
        char part[128];
        if (length + 3 > sizeof part)
            return 0;
        snprintf(part, sizeof part, "%.*s_%c", (int)length, name, "xyz"[count]);
        columns[count] = fp3_view_find(r, part);
        if (columns[count] == FP3_VIEW_NO_COLUMN)
            break;
    }
    return count >= 2 ? count : 0;
}

size_t fp3_view_begins_vector(const fp3_view_recording *r, size_t column) {
    const char *name = r->columns[column].name;
    const size_t length = strlen(name);
    size_t columns[FP3_VIEW_AXES] = {0};
    if (length < 3 || strcmp(name + length - 2, "_x") != 0)
        return 0;
    return fp3_view_vector(r, name, length - 2, columns) ? length - 2 : 0;
}

/* ---- the position ---- */

static void take(fp3_view_axes *axes, const size_t *columns, unsigned count, const char *name,
                 size_t length) {
    memcpy(axes->columns, columns, count * sizeof *columns);
    axes->count = count;
    snprintf(axes->name, sizeof axes->name, "%.*s", (int)length, name);
}

static fp3_status take_names(fp3_view_recording *r, const char *names, fp3_view_axes *axes,
                             fp3_error *error) {
    char *copy = strdup(names), *rest = copy;
    fp3_status status = copy ? FP3_OK : fp3_no_memory(error);
    axes->count = 0;
    for (char *part; !status && (part = strsep(&rest, ","));)
        if (axes->count == FP3_VIEW_AXES)
            status = fp3_fail(error, FP3_E_ARGUMENT,
                              "--position: found '%s', expected one to three names", names);
        else
            status = fp3_view_want(r, part, &axes->columns[axes->count++], error);
    free(copy);
    snprintf(axes->name, sizeof axes->name, "%s", names);
    return status;
}

/* The recording says within what distance objects are near: in that, they have a position. */
static int take_near(const fp3_view_recording *r, fp3_view_axes *axes) {
    for (size_t i = 0; i < r->relation_count; i++) {
        const char *name = r->relations[i].position;
        size_t columns[FP3_VIEW_AXES] = {0};
        unsigned count = 0;
        while (*name && count < FP3_VIEW_AXES) {
            const size_t length = strcspn(name, ",");
            char part[128];
            snprintf(part, sizeof part, "%.*s", (int)length, name);
            if ((columns[count] = fp3_view_find(r, part)) == FP3_VIEW_NO_COLUMN)
                break;
            count++;
            name += length + (name[length] == ',');
        }
        if (!count || *name)
            continue;
        take(axes, columns, count, r->columns[columns[0]].name,
             count > 1 ? strlen(r->columns[columns[0]].name) - 2
                       : strlen(r->columns[columns[0]].name));
        return 1;
    }
    return 0;
}

/* The first vector that is a length, else the first whose velocity is known. */
static int take_vector(const fp3_view_recording *r, fp3_view_axes *axes) {
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < r->column_count; i++) {
            const fp3_view_column *c = &r->columns[i];
            const size_t length = fp3_view_begins_vector(r, i);
            size_t columns[FP3_VIEW_AXES] = {0};
            if (length && (pass ? *c->velocity != 0 : fp3_unit_is_length(c->unit))) {
                take(axes, columns, fp3_view_vector(r, c->name, length, columns), c->name, length);
                return 1;
            }
        }
    return 0;
}

/* The column that is the derivative of this one: as the recording says, or the only one in its unit
 * per time. */
static size_t velocity_of(const fp3_view_recording *r, size_t column) {
    const fp3_view_column *c = &r->columns[column];
    size_t found = FP3_VIEW_NO_COLUMN, count = 0;
    char unit[160];
    if (*c->velocity)
        return fp3_view_find(r, c->velocity);
    snprintf(unit, sizeof unit, "%s/%s", c->unit, r->time_unit);
    for (size_t i = 0; *r->time_unit && i < r->column_count; i++)
        if (!strcmp(r->columns[i].unit, unit)) {
            found = i;
            count++;
        }
    return count == 1 ? found : FP3_VIEW_NO_COLUMN;
}

/* A number that is a position is drawn beside its velocity: the phase plane. */
static int take_scalar(const fp3_view_recording *r, fp3_view_axes *axes) {
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < r->column_count; i++) {
            const fp3_view_column *c = &r->columns[i];
            const size_t velocity = velocity_of(r, i);
            if (!(pass ? *c->velocity != 0 : fp3_unit_is_length(c->unit)) ||
                velocity == FP3_VIEW_NO_COLUMN)
                continue;
            take(axes, (const size_t[]){i, velocity}, 2, c->name, strlen(c->name));
            return 1;
        }
    return 0;
}

static fp3_status choose_position(fp3_view_recording *r, const char *wish, fp3_view_axes *axes,
                                  fp3_error *error) {
    size_t columns[FP3_VIEW_AXES] = {0};
    char names[300];
    unsigned count = wish ? fp3_view_vector(r, wish, strlen(wish), columns) : 0;
    if (count)
        take(axes, columns, count, wish, strlen(wish));
    else if (wish)
        return take_names(r, wish, axes, error);
    else if (!take_near(r, axes) && !take_vector(r, axes) && !take_scalar(r, axes))
        return fp3_fail(
            error, FP3_E_ARGUMENT,
            "%s: no position found: no vector (name_x, name_y) has the unit of a length. There "
            "are %s: name one to three as axes, with --position NAME,NAME",
            r->path, fp3_view_names(r, names, sizeof names));
    for (unsigned k = 0; k < axes->count; k++)
        r->columns[axes->columns[k]].is_wanted = 1;
    return FP3_OK;
}

/* ---- size and colour ---- */

/* Whether a name is one of those with commas between them. */
static int is_among(const char *name, const char *names) {
    const size_t length = strlen(name);
    for (; *names; names += strcspn(names, ",") + (strchr(names, ',') != NULL))
        if (strcspn(names, ",") == length && !strncmp(name, names, length))
            return 1;
    return 0;
}

/* A reach is a length along the axes that it is measured in, and no other. */
static int is_measured_in(const fp3_view_recording *r, const fp3_view_relation *of,
                          const fp3_view_axes *axes) {
    for (unsigned k = 0; k < axes->count; k++)
        if (!is_among(r->columns[axes->columns[k]].name, of->position))
            return 0;
    return 1;
}

static fp3_status choose_size(fp3_view_recording *r, const char *wish, fp3_view_axes *axes,
                              fp3_error *error) {
    fp3_error none;
    axes->radius_of = FP3_VIEW_NO_COLUMN;
    if (wish && !fp3_constant_read(wish, &axes->radius, &none))
        return isfinite(axes->radius) && axes->radius > 0
                   ? FP3_OK
                   : fp3_fail(error, FP3_E_ARGUMENT,
                              "--size: found '%s', expected a radius above 0", wish);
    if (wish)
        return fp3_view_want(r, wish, &axes->radius_of, error);
    /* Balls of one size touch where the distance is twice their radius. */
    for (size_t i = 0; i < r->relation_count && axes->radius == 0; i++)
        if (is_measured_in(r, &r->relations[i], axes))
            axes->radius = r->relations[i].reach / 2;
    return FP3_OK;
}

static fp3_status choose_colour(fp3_view_recording *r, const char *wish, fp3_view_axes *axes,
                                fp3_error *error) {
    size_t columns[FP3_VIEW_AXES] = {0}, column = FP3_VIEW_NO_COLUMN;
    const size_t velocity = fp3_view_find(r, r->columns[axes->columns[0]].velocity);
    const size_t length = velocity == FP3_VIEW_NO_COLUMN ? 0 : fp3_view_begins_vector(r, velocity);
    snprintf(axes->speed, sizeof axes->speed, "%.*s", (int)length,
             length ? r->columns[velocity].name : "");
    axes->colour = wish ? wish : axes->speed[0] && axes->count > 1 ? axes->speed : NULL;
    if (!axes->colour)
        return FP3_OK;
    const unsigned count = fp3_view_vector(r, axes->colour, strlen(axes->colour), columns);
    for (unsigned k = 0; k < count; k++)
        r->columns[columns[k]].is_wanted = 1;
    return count ? FP3_OK : fp3_view_want(r, axes->colour, &column, error);
}

/* ---- shapes ---- */

/* Bodies in a plane have an angle, bodies in space a quaternion. */
static void choose_shapes(fp3_view_recording *r, fp3_view_axes *axes) {
    static const char *const places[] = {"x_x", "x_y", "x_z"};
    static const char *const turns[][4] = {{"angle"}, {"q_w", "q_x", "q_y", "q_z"}};
    const int in_space = axes->count == 3;
    axes->turns = in_space ? 4 : 1;
    axes->asleep = fp3_view_find(r, "at_rest");
    axes->has_shapes = r->shape_count && axes->count >= 2;
    for (unsigned k = 0; k < axes->count && axes->has_shapes; k++)
        axes->has_shapes = axes->columns[k] == fp3_view_find(r, places[k]);
    for (unsigned k = 0; k < axes->turns; k++) {
        axes->turn[k] = fp3_view_find(r, turns[in_space][k]);
        axes->has_shapes = axes->has_shapes && axes->turn[k] != FP3_VIEW_NO_COLUMN;
    }
    for (unsigned k = 0; k < axes->turns && axes->has_shapes; k++)
        r->columns[axes->turn[k]].is_wanted = 1;
    if (axes->has_shapes && axes->asleep != FP3_VIEW_NO_COLUMN)
        r->columns[axes->asleep].is_wanted = 1;
}

/* ---- all ---- */

static fp3_status want_observed(fp3_view_recording *r, const char *names, fp3_error *error) {
    char *copy = names ? strdup(names) : NULL, *rest = copy;
    fp3_status status = names && !copy ? fp3_no_memory(error) : FP3_OK;
    size_t columns[FP3_VIEW_AXES] = {0}, column;
    for (size_t i = 0; !names && i < r->column_count; i++)
        r->columns[i].is_wanted = 1;
    for (char *part; !status && copy && (part = strsep(&rest, ","));) {
        const unsigned count = fp3_view_vector(r, part, strlen(part), columns);
        for (unsigned k = 0; k < count; k++)
            r->columns[columns[k]].is_wanted = 1;
        if (!count)
            status = fp3_view_want(r, part, &column, error);
    }
    free(copy);
    column = fp3_view_find(r, "life"); /* who is not there is not shown */
    if (!status && column != FP3_VIEW_NO_COLUMN)
        r->columns[column].is_wanted = 1;
    return status;
}

fp3_status fp3_view_choose(fp3_view_recording *r, const fp3_view_wishes *wishes,
                           fp3_view_axes *axes, fp3_error *error) {
    memset(axes, 0, sizeof *axes);
    fp3_status status = want_observed(r, wishes->observed, error);
    if (!status)
        status = choose_position(r, wishes->position, axes, error);
    if (!status)
        choose_shapes(r, axes);
    if (!status)
        status = choose_size(r, wishes->size, axes, error);
    if (!status)
        status = choose_colour(r, wishes->colour, axes, error);
    axes->has_one_scale = 1;
    for (unsigned k = 1; !status && k < axes->count; k++)
        axes->has_one_scale &=
            !strcmp(r->columns[axes->columns[k]].unit, r->columns[axes->columns[0]].unit);
    if (!status && (axes->radius > 0 || axes->radius_of != FP3_VIEW_NO_COLUMN) &&
        !axes->has_one_scale) {
        if (wishes->size)
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "--size: the axes of '%s' have different units, so a radius has no "
                            "length there",
                            axes->name);
        axes->radius = 0;
    }
    return status;
}
