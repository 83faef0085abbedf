/* SPDX-License-Identifier: Apache-2.0 */
/* ground.c - ground of triangles in a scene: meshes and heights. */
#include "obj.h"
#include "read.h"

#include "base/rows.h"
#include "bodies/shapes/shape3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- meshes ---- */

/* Three whole numbers, each of a point. */
static fp3_status read_triangle(fp3_reader *r, const config_setting_t *at, uint32_t corner[3]) {
    double number[3];
    fp3_status status = fp3_read_numbers(r, at, "triangles", 3, number);
    for (int k = 0; !status && k < 3; k++) {
        if (!(number[k] >= 0 && number[k] < UINT32_MAX && floor(number[k]) == number[k]))
            return fp3_setting_wrong(
                r->in, at, "triangles: found %.9g, expected the numbers of three points, from 0 on",
                number[k]);
        corner[k] = (uint32_t)number[k];
    }
    return status;
}

static fp3_status read_lists(fp3_reader *r, const config_setting_t *at, fp3_obj *mesh) {
    static const char *const names[] = {"points", "triangles", NULL};
    const config_setting_t *points = config_setting_get_member(at, "points"),
                           *triangles = config_setting_get_member(at, "triangles");
    fp3_status status = fp3_setting_keys(r->in, at, "mesh", names);
    if (!status && (!points || !triangles || !fp3_setting_is_list(triangles)))
        return fp3_setting_wrong(r->in, at,
                                 "mesh: expected points = ([X, Y, Z], ...) and triangles = ([0, 1, "
                                 "2], ...), by the numbers of points");
    if (!status)
        status = fp3_read_corners(r, points, "points", &mesh->point, &mesh->points);
    const size_t count = status ? 0 : (size_t)config_setting_length(triangles);
    if (!status && !(mesh->triangle = malloc((count + 1) * sizeof *mesh->triangle)))
        status = fp3_no_memory(r->in->error);
    for (; !status && mesh->triangles < count; mesh->triangles++)
        status = read_triangle(r, config_setting_get_elem(triangles, (unsigned)mesh->triangles),
                               mesh->triangle[mesh->triangles]);
    return status;
}

static fp3_status read_file(fp3_reader *r, const config_setting_t *at, const char *name,
                            fp3_obj *mesh) {
    const char *path = NULL;
    fp3_error why = {.text = ""};
    fp3_status status = fp3_read_path(r, name, &path);
    if (status)
        return status;
    status = fp3_obj_read(path, mesh, &why);
    return status ? fp3_read_failed(r, at, status, &why) : FP3_OK;
}

fp3_status fp3_read_mesh(fp3_reader *r, const config_setting_t *from, uint64_t handle,
                         const fp3_shape_def *surface) {
    const config_setting_t *at = config_setting_get_member(from, "mesh");
    const char *name = config_setting_get_string(at);
    fp3_obj mesh = {0};
    fp3_status status = name ? read_file(r, at, name, &mesh)
                        : config_setting_is_group(at)
                            ? read_lists(r, at, &mesh)
                            : fp3_setting_expected(r->in, at, "mesh",
                                                   "a file of Wavefront's format, as "
                                                   "\"hill.obj\", or { points = ...; "
                                                   "triangles = ...; }");
    if (!status) {
        status = fp3_bodies_attach_mesh(r->scene->bodies, handle, mesh.point, mesh.points,
                                        mesh.triangle ? mesh.triangle[0] : NULL, mesh.triangles,
                                        surface);
        status = status ? fp3_read_refused(r, from, "mesh", status) : FP3_OK;
    }
    fp3_obj_free(&mesh);
    return status;
}

/* ---- heights ---- */

typedef struct {
    double *height;
    size_t columns, rows, room;
} grid;

static fp3_status make_room(fp3_reader *r, grid *g, size_t count) {
    if (count <= g->room)
        return FP3_OK;
    const size_t room = count > 2 * g->room ? count : 2 * g->room;
    if (!fp3_rows_grow((void **)&g->height, room, sizeof *g->height))
        return fp3_no_memory(r->in->error);
    g->room = room;
    return FP3_OK;
}

/* A line is a row; all have as many numbers. */
static fp3_status take_line(fp3_reader *r, fp3_rows *rows, grid *g, fp3_error *why) {
    const size_t count = fp3_rows_count(rows);
    g->columns = g->rows ? g->columns : count;
    if (count != g->columns)
        return fp3_fail_at(why, FP3_E_ARGUMENT, rows->path, rows->number, 0,
                           "found %zu heights, expected %zu, as in the first line", count,
                           g->columns);
    fp3_status status = make_room(r, g, (g->rows + 1) * g->columns);
    for (size_t i = g->rows * g->columns; !status && rows->next; i++) {
        const fp3_token value = fp3_rows_value(rows);
        status = fp3_rows_number(rows, value, &g->height[i], why);
        if (!status && !(fabs(g->height[i]) <= (double)FP3_LARGEST3))
            status = fp3_rows_wrong(rows, value, "a height from -1e6 to 1e6", why);
    }
    g->rows++;
    return status;
}

static fp3_status heights_of_file(fp3_reader *r, const config_setting_t *at, const char *name,
                                  grid *g) {
    const char *path = NULL;
    fp3_error why = {.text = ""};
    fp3_rows rows = {0};
    int is_there = 1;
    fp3_status status = fp3_read_path(r, name, &path);
    if (status)
        return status;
    status = fp3_rows_open(&rows, path, &why);
    while (!status && !(status = fp3_rows_next(&rows, &is_there, &why)) && is_there)
        status = take_line(r, &rows, g, &why);
    fp3_rows_close(&rows);
    return status ? fp3_read_failed(r, at, status, &why) : FP3_OK;
}

static fp3_status heights_of_list(fp3_reader *r, const config_setting_t *at, grid *g) {
    fp3_status status = FP3_OK;
    g->rows = (size_t)config_setting_length(at);
    for (size_t j = 0; !status && j < g->rows; j++) {
        const config_setting_t *row = config_setting_get_elem(at, (unsigned)j);
        const size_t count = fp3_setting_is_list(row) ? (size_t)config_setting_length(row) : 0;
        g->columns = j ? g->columns : count;
        if (!count || count != g->columns)
            return fp3_setting_wrong(r->in, row,
                                     "heights: expected rows of as many numbers, as ([0, 0, 0.5], "
                                     "[0, 1, 0])");
        status = make_room(r, g, g->rows * count);
        for (size_t i = 0; !status && i < count; i++)
            status = fp3_read_number(r, config_setting_get_elem(row, (unsigned)i), "heights",
                                     &g->height[j * count + i]);
    }
    return status;
}

static fp3_status heights_of_formula(fp3_reader *r, const config_setting_t *at, grid *g) {
    static const char *const names[] = {"count", "at", NULL};
    const config_setting_t *count = config_setting_get_member(at, "count"),
                           *formula = config_setting_get_member(at, "at");
    double size[2] = {0};
    fp3_status status = fp3_setting_keys(r->in, at, "heights", names);
    if (!status && (!count || !formula))
        return fp3_setting_wrong(r->in, at,
                                 "heights: expected count = [COLUMNS, ROWS] and at, the height, "
                                 "with the names column and row");
    if (!status)
        status = fp3_read_numbers(r, count, "count", 2, size);
    for (int k = 0; !status && k < 2; k++)
        if (!(size[k] >= 2 && size[k] <= 10000 && floor(size[k]) == size[k]) ||
            size[0] * size[1] > FP3_BODIES_SCENE_MOST)
            return fp3_setting_wrong(r->in, count,
                                     "count: found %.9g and %.9g, expected two whole numbers from "
                                     "2 to 10000, and at most %d heights",
                                     size[0], size[1], FP3_BODIES_SCENE_MOST);
    g->columns = (size_t)size[0];
    g->rows = (size_t)size[1];
    if (!status)
        status = make_room(r, g, g->columns * g->rows);
    r->has_cell = 1;
    for (size_t i = 0; !status && i < g->columns * g->rows; i++) {
        r->cell[0] = (double)(i % g->columns);
        r->cell[1] = (double)(i / g->columns);
        status = fp3_read_number(r, formula, "at", &g->height[i]);
    }
    r->has_cell = 0;
    return status;
}

fp3_status fp3_read_heights(fp3_reader *r, const config_setting_t *from, uint64_t handle,
                            const fp3_shape_def *surface) {
    const config_setting_t *at = config_setting_get_member(from, "heights"),
                           *spacing = config_setting_get_member(from, "spacing");
    const char *name = config_setting_get_string(at);
    double d[2] = {1, 1};
    grid g = {0};
    fp3_status status = spacing ? fp3_read_numbers(r, spacing, "spacing", 2, d) : FP3_OK;
    if (!status)
        status = name                          ? heights_of_file(r, at, name, &g)
                 : config_setting_is_group(at) ? heights_of_formula(r, at, &g)
                 : fp3_setting_is_list(at)
                     ? heights_of_list(r, at, &g)
                     : fp3_setting_expected(r->in, at, "heights",
                                            "rows of numbers, { count = [COLUMNS, ROWS]; at = "
                                            "\"sin(column)\"; }, or a file");
    if (!status) {
        status = fp3_bodies_attach_heights(r->scene->bodies, handle, g.columns, g.rows, d[0], d[1],
                                           g.height, surface);
        status = status ? fp3_read_refused(r, from, "heights", status) : FP3_OK;
    }
    free(g.height);
    return status;
}
