/* SPDX-License-Identifier: Apache-2.0 */
/* arranged.c - see arranged.h. */
#include "arranged.h"

#include "base/path.h"
#include "links.h"
#include "machine/placement.h"
#include "only.h"
#include "values.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LETTERS "xyz"

/* Axes that a list of numbers may have, and a number alone. */
static fp3_status read_numbers(const fp3_settings *s, const config_setting_t *from,
                               const char *name, unsigned count, double *numbers) {
    static const char *const expected[] = {"", "a number", "2 numbers [x, y]",
                                           "3 numbers [x, y, z]"};
    const config_setting_t *at = config_setting_get_member(from, name);
    fp3_status status = FP3_OK;
    if (!at)
        return fp3_setting_wrong(s, from, "expected %s, %s", name, expected[count]);
    if (!fp3_setting_is_list(at) && count == 1)
        return fp3_setting_number(s, at, name, numbers);
    if (!fp3_setting_is_list(at) || (unsigned)config_setting_length(at) != count)
        return fp3_setting_expected(s, at, name, expected[count]);
    for (unsigned k = 0; !status && k < count; k++)
        status = fp3_setting_number(s, config_setting_get_elem(at, k), name, &numbers[k]);
    return status;
}

/* ---- how many objects ---- */

static fp3_status read_count(const fp3_settings *s, const config_setting_t *from, fp3_grid *grid,
                             uint64_t *objects) {
    static const char expected[] = "1 to 3 numbers of objects, one along each axis, as [32, 24]";
    const config_setting_t *at = config_setting_get_member(from, "count");
    fp3_status status = FP3_OK;
    if (!at)
        return fp3_setting_wrong(s, from, "expected count, %s", expected);
    const int is_list = fp3_setting_is_list(at);
    const int count = is_list ? config_setting_length(at) : 1;
    if (count < 1 || count > FP3_GRID_AXES)
        return fp3_setting_expected(s, at, "count", expected);
    grid->axes = (unsigned)count;
    *objects = 1;
    for (unsigned k = 0; !status && k < grid->axes; k++) {
        uint64_t found = 0;
        status = fp3_setting_count(s, is_list ? config_setting_get_elem(at, k) : at, "count", 1,
                                   FP3_HOST_OBJECTS, &found);
        grid->count[k] = (uint32_t)found;
        *objects *= found;
        if (!status && *objects > FP3_HOST_OBJECTS)
            status = fp3_setting_wrong(
                s, at, "count: found %" PRIu64 " objects, expected at most %" PRIu32, *objects,
                FP3_HOST_OBJECTS);
    }
    return status;
}

static fp3_status read_spacing(const fp3_settings *s, const config_setting_t *from,
                               fp3_grid *grid) {
    const config_setting_t *at = config_setting_get_member(from, "spacing");
    fp3_status status = FP3_OK;
    double all = 0;
    if (!at &&
        !config_setting_get_member(from, "position")) /* objects stand nowhere: links alone */
        for (unsigned k = 0; k < grid->axes; k++)
            grid->spacing[k] = 1;
    else if (at && fp3_setting_is_number(at)) {
        status = fp3_setting_number(s, at, "spacing", &all);
        for (unsigned k = 0; k < grid->axes; k++)
            grid->spacing[k] = all;
    } else
        status = read_numbers(s, from, "spacing", grid->axes, grid->spacing);
    for (unsigned k = 0; !status && k < grid->axes; k++)
        if (grid->spacing[k] == 0)
            status = fp3_setting_wrong(s, at, "spacing: found 0, expected a distance other than 0");
    return status;
}

static fp3_status read_grid(const fp3_settings *s, const config_setting_t *from, fp3_grid *grid,
                            uint64_t *objects) {
    static const char *const names[] = {"position", "count", "spacing", "origin", "along", NULL};
    if (!config_setting_is_group(from))
        return fp3_setting_expected(s, from, "grid",
                                    "a group, { position = ...; count = ...; ... }");
    fp3_status status = fp3_setting_keys(s, from, "grid", names);
    if (!status)
        status = read_count(s, from, grid, objects);
    return status ? status : read_spacing(s, from, grid);
}

static fp3_status read_points(const fp3_settings *s, const config_setting_t *from,
                              fp3_table *points, uint64_t *objects) {
    const char *name = NULL;
    fp3_error why = {.text = ""};
    fp3_status status = fp3_setting_text(s, from, "points", &name);
    if (status)
        return status;
    char *path = fp3_path_beside(s->name, name);
    if (!path)
        return fp3_no_memory(s->error);
    status = fp3_table_read(path, points, &why);
    free(path);
    if (status)
        return fp3_fail_at(s->error, status, s->name, fp3_setting_line(from), 0, "%s", why.text);
    *objects = points->rows;
    return points->rows ? FP3_OK
                        : fp3_setting_wrong(s, from,
                                            "points: '%s' has no object, expected a line "
                                            "of numbers for each",
                                            name);
}

fp3_status fp3_arranged_read(const fp3_settings *s, const config_setting_t *from, fp3_arranged *a,
                             uint64_t *objects) {
    const config_setting_t *given = config_setting_get_member(from, "objects");
    uint64_t rows = 0;
    fp3_status status = FP3_OK;
    *a = (fp3_arranged){.grid_at = config_setting_get_member(from, "grid"),
                        .random_at = config_setting_get_member(from, "random"),
                        .points_at = config_setting_get_member(from, "points")};
    *objects = 0;
    if (a->grid_at && a->random_at)
        return fp3_setting_wrong(s, a->random_at, "found grid and random, expected one of them");
    if ((a->grid_at || a->points_at) && given)
        return fp3_setting_wrong(s, given, "objects: %s says how many there are",
                                 a->grid_at ? "the grid" : "the file of points");
    if (a->grid_at)
        status = read_grid(s, a->grid_at, &a->grid, objects);
    if (!status && a->points_at)
        status = read_points(s, a->points_at, &a->points, &rows);
    if (!status && a->grid_at && a->points_at && rows != *objects)
        return fp3_setting_wrong(s, a->points_at,
                                 "points: found %" PRIu64 " lines of numbers, expected %" PRIu64
                                 ", one for each object of the grid",
                                 rows, *objects);
    *objects = a->grid_at ? *objects : rows;
    return status;
}

void fp3_arranged_close(fp3_arranged *a) { fp3_table_close(&a->points); }

/* ---- where they are ---- */

static int has_state(const fp3_program *program, const char *name) {
    return program->model
               ? fp3_model_state(program->model, name) != FP3_NONE
               : fp3_image_find(program->image, name, FP3_CLASS(FP3_SYMBOL_STATE)) != NULL;
}

/* The components of a position, 1 to 3. */
typedef struct {
    char name[FP3_GRID_AXES][FP3_NAME_SIZE + 2];
    unsigned count;
} position;

static fp3_status read_position(const fp3_settings *s, const config_setting_t *from,
                                const fp3_program *program, position *p) {
    const config_setting_t *at = config_setting_get_member(from, "position");
    const char *name = NULL;
    if (!at)
        return fp3_setting_wrong(s, from, "expected position, the name of a state");
    fp3_status status = fp3_setting_text(s, at, "position", &name);
    if (status)
        return status;
    p->count = 0;
    for (unsigned k = 0; k < FP3_GRID_AXES; k++) {
        snprintf(p->name[k], sizeof p->name[k], "%.*s_%c", FP3_NAME_SIZE - 3, name, LETTERS[k]);
        if (p->count == k && has_state(program, p->name[k]))
            p->count++;
    }
    if (!p->count && has_state(program, name)) {
        snprintf(p->name[0], sizeof p->name[0], "%s", name);
        p->count = 1;
    }
    return p->count ? FP3_OK
                    : fp3_setting_wrong(s, at,
                                        "position: found '%s', expected a state: a number, or "
                                        "a vector with the components _x, _y, _z",
                                        name);
}

static fp3_status put_column(const fp3_settings *s, const config_setting_t *at,
                             const fp3_scene_group *group, const char *name, const double *column) {
    return fp3_values_column(group->params, name, column, group->objects, s->name,
                             fp3_setting_line(at), s->error);
}

/* Which component each axis of the grid runs along: "xz". */
static fp3_status read_along(const fp3_settings *s, const config_setting_t *from,
                             const fp3_grid *grid, const position *p,
                             unsigned along[FP3_GRID_AXES]) {
    const config_setting_t *at = config_setting_get_member(from, "along");
    const char *letters = LETTERS;
    unsigned seen = 0;
    fp3_status status = at ? fp3_setting_text(s, at, "along", &letters) : FP3_OK;
    if (status)
        return status;
    if (at && strlen(letters) != grid->axes)
        return fp3_setting_wrong(s, at,
                                 "along: found '%s', expected a letter for each of the %u "
                                 "axes of the grid, as \"xz\"",
                                 letters, grid->axes);
    for (unsigned k = 0; k < grid->axes; k++) {
        const char *letter = letters[k] ? strchr(LETTERS, letters[k]) : NULL;
        along[k] = letter ? (unsigned)(letter - LETTERS) : FP3_GRID_AXES;
        if (along[k] >= p->count || seen >> along[k] & 1)
            return fp3_setting_wrong(s, at ? at : from,
                                     "the grid has %u axes, along '%.*s', and the position has %u "
                                     "component%s%s",
                                     grid->axes, (int)grid->axes, letters, p->count,
                                     p->count == 1 ? "" : "s",
                                     along[k] < p->count ? ", each for one axis" : "");
        seen |= 1u << along[k];
    }
    return FP3_OK;
}

static fp3_status place_grid(const fp3_settings *s, const fp3_arranged *a,
                             const fp3_scene_group *group, double *column) {
    static const char *const where[] = {"origin", "along"};
    const config_setting_t *at = a->grid_at;
    position p;
    for (int i = 0; i < 2 && !config_setting_get_member(at, "position"); i++)
        if (config_setting_get_member(at, where[i]))
            return fp3_setting_wrong(s, at,
                                     "%s: expected position, too: the state that is "
                                     "placed",
                                     where[i]);
    if (!config_setting_get_member(at, "position"))
        return FP3_OK;
    unsigned along[FP3_GRID_AXES] = {0};
    double origin[FP3_GRID_AXES] = {0};
    fp3_status status = read_position(s, at, group->program, &p);
    if (!status)
        status = read_along(s, at, &a->grid, &p, along);
    if (!status && config_setting_get_member(at, "origin"))
        status = read_numbers(s, at, "origin", p.count, origin);
    for (unsigned c = 0; !status && c < p.count; c++) {
        for (size_t i = 0; i < group->objects; i++) {
            uint32_t place[FP3_GRID_AXES];
            fp3_grid_at(&a->grid, i, place);
            column[i] = origin[c];
            for (unsigned k = 0; k < a->grid.axes; k++)
                if (along[k] == c)
                    column[i] += place[k] * a->grid.spacing[k];
        }
        status = put_column(s, at, group, p.name[c], column);
    }
    return status;
}

static fp3_status read_fill(const fp3_settings *s, const config_setting_t *from, fp3_fill *fill) {
    const config_setting_t *apart = config_setting_get_member(from, "apart");
    const config_setting_t *seed = config_setting_get_member(from, "seed");
    fp3_status status = read_numbers(s, from, "from", fill->axes, fill->from);
    if (!status)
        status = read_numbers(s, from, "to", fill->axes, fill->to);
    for (unsigned k = 0; !status && k < fill->axes; k++)
        if (!(fill->to[k] > fill->from[k]))
            status = fp3_setting_wrong(s, config_setting_get_member(from, "to"),
                                       "to: found %g, expected a number above that of from, %g",
                                       fill->to[k], fill->from[k]);
    if (!status && !apart)
        status = fp3_setting_wrong(s, from, "expected apart, the least distance of two objects");
    if (!status)
        status = fp3_setting_number(s, apart, "apart", &fill->apart);
    if (!status && fill->apart < 0)
        status = fp3_setting_expected(s, apart, "apart", "a distance of 0 or more");
    return status || !seed ? status
                           : fp3_setting_count(s, seed, "seed", 0, UINT64_MAX, &fill->seed);
}

static fp3_status place_random(const fp3_settings *s, fp3_arranged *a, uint64_t draw,
                               const fp3_scene_group *group, double *columns) {
    static const char *const names[] = {"position", "from", "to", "apart", "seed", NULL};
    fp3_fill *fill = &a->fill;
    position p;
    size_t placed = 0;
    const config_setting_t *at = a->random_at;
    if (!config_setting_is_group(at))
        return fp3_setting_expected(s, at, "random",
                                    "a group, { position = ...; from = ...; ... }");
    fp3_status status = fp3_setting_keys(s, at, "random", names);
    if (!status)
        status = read_position(s, at, group->program, &p);
    if (status)
        return status;
    fill->axes = p.count;
    fill->objects = group->objects;
    double *const column[] = {columns, columns + group->objects, columns + 2 * group->objects};
    status = read_fill(s, at, fill);
    fill->seed += draw;
    if (!status)
        status = fp3_fill_box(fill, column, &placed, s->error);
    if (!status && placed < fill->objects)
        return fp3_setting_wrong(
            s, at,
            "random: %zu of %zu objects found a place that is %g apart from "
            "others; expected fewer objects, a larger box or a smaller distance",
            placed, fill->objects, fill->apart);
    for (unsigned k = 0; !status && k < p.count; k++)
        status = put_column(s, at, group, p.name[k], column[k]);
    return status;
}

static fp3_status place_points(const fp3_settings *s, const fp3_arranged *a,
                               const fp3_scene_group *group) {
    const fp3_table *t = &a->points;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < t->columns; i++)
        status = fp3_values_column(group->params, t->names[i], &t->number[i * t->rows], t->rows,
                                   t->path, t->head, s->error);
    return status;
}

static fp3_status place(const fp3_settings *s, fp3_arranged *a, uint64_t draw,
                        const fp3_scene_group *group) {
    double *columns = malloc(FP3_FILL_AXES * group->objects * sizeof *columns);
    fp3_status status = FP3_OK;
    if (!columns)
        status = fp3_no_memory(s->error);
    else if (a->grid_at)
        status = place_grid(s, a, group, columns);
    else if (a->random_at)
        status = place_random(s, a, draw, group, columns);
    free(columns);
    return status ? status : place_points(s, a, group);
}

fp3_status fp3_arranged_apply(const fp3_settings *s, const config_setting_t *from, uint64_t draw,
                              fp3_arranged *a, fp3_scene_group *group) {
    fp3_status status = place(s, a, draw, group);
    if (!status && a->points_at)
        status = fp3_links_note(group, a->points.path, s->error);
    if (!status)
        status = fp3_links_read(s, from, a->grid_at ? &a->grid : NULL, group);
    if (!status)
        status = fp3_skin_read(s, from, group);
    return status ? status : fp3_only_read(s, from, group);
}
