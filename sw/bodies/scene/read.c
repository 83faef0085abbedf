/* SPDX-License-Identifier: Apache-2.0 */
/* read.c - see read.h. */
#include "read.h"

#include "base/nearest.h"
#include "base/path.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const counters[FP3_COUNTERS] = {"i", "j", "k"};
static const char *const cells[2] = {"column", "row"}; /* of a height */

/* ---- formulas ---- */

/* splitmix64 (Steele, Lea, Flood, 2014): 0 to 1, without 1. */
static double draw(uint64_t *random) {
    uint64_t z = *random += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

/* An fp3_name_fn. */
static fp3_status value_of(void *user, const char *name, double *value, fp3_error *error) {
    fp3_reader *r = user;
    char all[160] = "n, random";
    for (unsigned i = 0; i < r->counters; i++)
        if (!strcmp(name, counters[i])) {
            *value = r->counter[i];
            return FP3_OK;
        }
    for (size_t i = 0; r->points && i < r->points->columns; i++)
        if (!strcmp(name, r->points->names[i])) {
            *value = r->points->number[i * r->points->rows + r->row];
            return FP3_OK;
        }
    if (!strcmp(name, "n")) {
        *value = r->number;
        return FP3_OK;
    }
    if (!strcmp(name, "random")) {
        *value = draw(&r->random);
        return FP3_OK;
    }
    if (r->has_corner && !strcmp(name, "corner")) {
        *value = r->corner;
        return FP3_OK;
    }
    for (int k = 0; r->has_cell && k < 2; k++)
        if (!strcmp(name, cells[k])) {
            *value = r->cell[k];
            return FP3_OK;
        }
    for (unsigned i = 0; i < r->counters; i++)
        snprintf(all + strlen(all), sizeof all - strlen(all), ", %s", counters[i]);
    if (r->has_corner)
        snprintf(all + strlen(all), sizeof all - strlen(all), ", corner");
    if (r->has_cell)
        snprintf(all + strlen(all), sizeof all - strlen(all), ", column, row");
    for (size_t i = 0; r->points && i < r->points->columns; i++)
        snprintf(all + strlen(all), sizeof all - strlen(all), ", %s", r->points->names[i]);
    return fp3_fail(error, FP3_E_ARGUMENT, "found '%s', expected a name of this entry: %s", name,
                    all);
}

/* Parsing takes longer than all else, so each text is parsed once for all copies. */
static fp3_status find(fp3_reader *r, const char *text, size_t length, fp3_formula **formula,
                       fp3_error *why) {
    for (size_t i = 0; i < r->formula_count; i++)
        if (r->formulas[i].text == text) {
            *formula = r->formulas[i].formula;
            return FP3_OK;
        }
    fp3_status status = fp3_bodies_grow((void **)&r->formulas, &r->formula_room,
                                        sizeof *r->formulas, r->formula_count + 1, r->in->error);
    char *copy = status ? NULL : strndup(text, length);
    if (!status && !copy)
        status = fp3_no_memory(why);
    if (!status)
        status = fp3_formula_read(copy, formula, why);
    free(copy);
    if (!status)
        r->formulas[r->formula_count++] = (fp3_read_formula){text, *formula};
    return status;
}

fp3_status fp3_read_formula_part(fp3_reader *r, const config_setting_t *at, const char *what,
                                 const char *text, size_t length, double *value) {
    fp3_formula *formula = NULL;
    fp3_error why = {.text = ""};
    fp3_status status = find(r, text, length, &formula, &why);
    if (!status)
        status = fp3_formula_value(formula, value_of, r, value, &why);
    return status
               ? fp3_setting_wrong(r->in, at, "%s: \"%.*s\": %s", what, (int)length, text, why.text)
               : FP3_OK;
}

static void forget_formulas(fp3_reader *r) {
    for (size_t i = 0; i < r->formula_count; i++)
        fp3_formula_free(&r->formulas[i].formula);
    r->formula_count = 0;
}

void fp3_reader_close(fp3_reader *r) {
    forget_formulas(r);
    free(r->formulas);
    r->formulas = NULL;
}

/* ---- values ---- */

fp3_status fp3_read_number(fp3_reader *r, const config_setting_t *at, const char *what,
                           double *value) {
    const char *text = config_setting_get_string(at);
    if (text)
        return fp3_read_formula_part(r, at, what, text, strlen(text), value);
    if (!fp3_setting_is_number(at))
        return fp3_setting_expected(r->in, at, what, "a number, or a formula in quotes");
    return fp3_setting_number(r->in, at, what, value);
}

fp3_status fp3_read_numbers(fp3_reader *r, const config_setting_t *at, const char *what,
                            unsigned count, double *numbers) {
    static const char *const expected[] = {
        [2] = "two numbers, as [0, 1.5], or with formulas (0, \"i + 1\")",
        [3] = "three numbers, as [0, 1.5, 0], or with formulas (0, \"i + 1\", 0)",
        [4] = "four numbers, as [1, 0, 0, 0]"};
    fp3_status status = FP3_OK;
    if (!fp3_setting_is_list(at) || (unsigned)config_setting_length(at) != count)
        return fp3_setting_expected(r->in, at, what, expected[count]);
    for (unsigned k = 0; !status && k < count; k++)
        status = fp3_read_number(r, config_setting_get_elem(at, k), what, &numbers[k]);
    return status;
}

fp3_status fp3_read_point(fp3_reader *r, const config_setting_t *at, const char *what,
                          double *point) {
    return fp3_read_numbers(r, at, what, r->dimensions, point);
}

fp3_status fp3_read_value(fp3_reader *r, const config_setting_t *group, const char *name,
                          double *value) {
    const config_setting_t *at = config_setting_get_member(group, name);
    return at ? fp3_read_number(r, at, name, value) : FP3_OK;
}

fp3_status fp3_read_place(fp3_reader *r, const config_setting_t *group, const char *name,
                          double *place) {
    const config_setting_t *at = config_setting_get_member(group, name);
    return at ? fp3_read_point(r, at, name, place) : FP3_OK;
}

fp3_status fp3_read_turn(fp3_reader *r, const config_setting_t *group, double q[4]) {
    const config_setting_t *at = config_setting_get_member(group, "q");
    return at ? fp3_read_numbers(r, at, "q", 4, q) : FP3_OK;
}

fp3_status fp3_read_fits(const fp3_reader *r, const config_setting_t *group,
                         const char *const *plane, const char *const *space) {
    const int is_space = r->dimensions == 3;
    for (const char *const *name = is_space ? plane : space; *name; name++) {
        const config_setting_t *at = config_setting_get_member(group, *name);
        if (at)
            return fp3_setting_wrong(r->in, at,
                                     "%s: %s alone has it, and the scene has dimensions = %u",
                                     *name, is_space ? "a plane" : "space", r->dimensions);
    }
    return FP3_OK;
}

fp3_status fp3_read_flag(fp3_reader *r, const config_setting_t *group, const char *name,
                         int *flag) {
    const config_setting_t *at = config_setting_get_member(group, name);
    return at ? fp3_setting_flag(r->in, at, name, flag) : FP3_OK;
}

/* ---- counts ---- */

static fp3_status read_count(fp3_reader *r, const config_setting_t *at, const char *what,
                             size_t *count) {
    double found = 0;
    fp3_status status = fp3_read_number(r, at, what, &found);
    if (!status && !(found >= 0 && found <= FP3_BODIES_SCENE_MOST && floor(found) == found))
        status = fp3_setting_wrong(r->in, at, "%s is %.9g, expected a whole number from 0 to %d",
                                   what, found, FP3_BODIES_SCENE_MOST);
    *count = status ? 0 : (size_t)found;
    return status;
}

/* ---- files ---- */

fp3_status fp3_read_path(fp3_reader *r, const char *name, const char **path) {
    fp3_bodies_scene *scene = r->scene;
    char *made = fp3_path_beside(r->in->name, name);
    fp3_status status =
        made ? fp3_bodies_grow((void **)&scene->files, &scene->file_room, sizeof *scene->files,
                               scene->file_count + 1, r->in->error)
             : fp3_no_memory(r->in->error);
    if (status) {
        free(made);
        return status;
    }
    *path = scene->files[scene->file_count++] = made;
    return FP3_OK;
}

fp3_status fp3_read_failed(const fp3_reader *r, const config_setting_t *at, fp3_status status,
                           const fp3_error *why) {
    return fp3_fail_at(r->in->error, status, r->in->name, fp3_setting_line(at), 0, "%s", why->text);
}

static fp3_status read_table(fp3_reader *r, const config_setting_t *at, const char *name,
                             fp3_table *table) {
    const char *path = NULL;
    fp3_error why = {.text = ""};
    fp3_status status = fp3_read_path(r, name, &path);
    if (status)
        return status;
    status = fp3_table_read(path, table, &why);
    return status ? fp3_read_failed(r, at, status, &why) : FP3_OK;
}

/* ---- corners ---- */

static fp3_status corners_of_file(fp3_reader *r, const config_setting_t *at, const char *what,
                                  const char *name, double **corners, size_t *count) {
    static const char *const axes[] = {"x", "y", "z"};
    fp3_table table = {0};
    fp3_status status = read_table(r, at, name, &table);
    for (size_t k = 0; !status && k < r->dimensions; k++)
        if (table.columns != r->dimensions || strcmp(table.names[k], axes[k]) != 0)
            status = fp3_setting_wrong(r->in, at,
                                       "%s: '%s' has no head %s, expected that and a line of "
                                       "numbers for each corner",
                                       what, name, r->dimensions == 3 ? "x,y,z" : "x,y");
    if (!status && !(*corners = malloc((r->dimensions * table.rows + 1) * sizeof **corners)))
        status = fp3_no_memory(r->in->error);
    for (size_t i = 0; !status && i < r->dimensions * table.rows; i++)
        (*corners)[i] = table.number[i % r->dimensions * table.rows + i / r->dimensions];
    *count = status ? 0 : table.rows;
    fp3_table_close(&table);
    return status;
}

/* Whether one formula makes them all. */
static fp3_status check_made(fp3_reader *r, const config_setting_t *at, const char *what,
                             const config_setting_t **point) {
    static const char *const names[] = {"count", "at", NULL};
    fp3_status status = fp3_setting_keys(r->in, at, what, names);
    *point = config_setting_get_member(at, "at");
    if (!status && (!*point || !config_setting_get_member(at, "count")))
        status = fp3_setting_wrong(r->in, at,
                                   "%s: expected count, the number of corners, and at, "
                                   "where they are, with the name corner",
                                   what);
    return status;
}

fp3_status fp3_read_corners(fp3_reader *r, const config_setting_t *at, const char *what,
                            double **corners, size_t *count) {
    const char *name = config_setting_get_string(at);
    const config_setting_t *made = NULL;
    fp3_status status = FP3_OK;
    *corners = NULL;
    *count = 0;
    if (name)
        return corners_of_file(r, at, what, name, corners, count);
    if (config_setting_is_group(at)) {
        status = check_made(r, at, what, &made);
        if (!status)
            status = read_count(r, config_setting_get_member(at, "count"), "count", count);
    } else if (fp3_setting_is_list(at))
        *count = (size_t)config_setting_length(at);
    else
        status = fp3_setting_expected(r->in, at, what,
                                      "corners, as ( [0, 0], [1, 0], [0, 1] ), { count = 6; at = "
                                      "(\"cos(pi*corner/3)\", \"sin(pi*corner/3)\"); }, or a file");
    if (!status && !(*corners = malloc((r->dimensions * *count + 1) * sizeof **corners)))
        status = fp3_no_memory(r->in->error);
    r->has_corner = made != NULL;
    for (size_t i = 0; !status && i < *count; i++) {
        r->corner = (double)i;
        status = fp3_read_point(r, made ? made : config_setting_get_elem(at, (unsigned)i), what,
                                *corners + r->dimensions * i);
    }
    r->has_corner = 0;
    return status;
}

/* ---- copies ---- */

typedef struct {
    const config_setting_t *entry, *count; /* count: NULL: there is none */
    unsigned levels;
    fp3_copy_fn *one;
    void *user;
    size_t made;
} copies;

static fp3_status too_many(const fp3_reader *r, const copies *c) {
    return fp3_setting_wrong(r->in, c->entry, "expected at most %d copies", FP3_BODIES_SCENE_MOST);
}

static fp3_status copy(fp3_reader *r, copies *c) {
    if (c->made >= FP3_BODIES_SCENE_MOST)
        return too_many(r, c);
    r->number = (double)c->made++;
    return c->one(r, c->entry, c->user);
}

/* Counters of the outer levels are names in the numbers of the inner ones. */
static fp3_status copy_level(fp3_reader *r, copies *c, unsigned level) {
    size_t count = 0;
    if (level == c->levels)
        return copy(r, c);
    const config_setting_t *at =
        fp3_setting_is_list(c->count) ? config_setting_get_elem(c->count, level) : c->count;
    r->counters = level;
    fp3_status status = read_count(r, at, "count", &count);
    for (size_t i = 0; !status && i < count; i++) {
        r->counters = level + 1;
        r->counter[level] = (double)i;
        status = copy_level(r, c, level + 1);
    }
    r->counters = level;
    return status;
}

static fp3_status copy_rows(fp3_reader *r, copies *c, const config_setting_t *at) {
    fp3_table table = {0};
    const char *name = NULL;
    fp3_status status = fp3_setting_text(r->in, at, "points", &name);
    if (!status && c->count)
        status = fp3_setting_wrong(r->in, c->count,
                                   "count: the file of points says how many "
                                   "there are");
    if (!status)
        status = read_table(r, at, name, &table);
    r->points = &table;
    for (r->row = 0; !status && r->row < table.rows; r->row++)
        status = copy(r, c);
    r->points = NULL;
    fp3_table_close(&table);
    return status;
}

/* How many there will be, if all counts are numbers; else 0. */
static double product_of(const fp3_reader *r, const copies *c) {
    double all = 1, one;
    for (unsigned level = 0; level < c->levels; level++) {
        const config_setting_t *at =
            fp3_setting_is_list(c->count) ? config_setting_get_elem(c->count, level) : c->count;
        if (!fp3_setting_is_number(at) || fp3_setting_number(r->in, at, "count", &one))
            return 0;
        all *= one;
    }
    return all;
}

fp3_status fp3_read_copies(fp3_reader *r, const config_setting_t *entry, size_t number,
                           fp3_copy_fn *one, void *user) {
    copies c = {.entry = entry,
                .count = config_setting_get_member(entry, "count"),
                .one = one,
                .user = user};
    const config_setting_t *points = config_setting_get_member(entry, "points");
    c.levels = !c.count                       ? 0
               : fp3_setting_is_list(c.count) ? (unsigned)config_setting_length(c.count)
                                              : 1;
    if (c.count && (c.levels < 1 || c.levels > FP3_COUNTERS))
        return fp3_setting_wrong(r->in, c.count,
                                 "count: found %u numbers, expected 1 to %d, as (40, \"40 - i\")",
                                 c.levels, FP3_COUNTERS);
    if (c.levels > 1 && product_of(r, &c) > FP3_BODIES_SCENE_MOST)
        return too_many(r, &c);
    r->random = r->seed + (number + 1) * UINT64_C(0xd1342543de82ef95);
    r->counters = 0;
    const fp3_status status = points ? copy_rows(r, &c, points) : copy_level(r, &c, 0);
    forget_formulas(r);
    return status;
}

/* ---- what the world refuses ---- */

/* "body 0: x[0] is ..." names the setting x: which copy it is, is known better here. */
fp3_status fp3_read_refused(const fp3_reader *r, const config_setting_t *group, const char *what,
                            fp3_status status) {
    const char *text = r->scene->why.text;
    char name[32] = "";
    static const char *const one[] = {"body 0: ", "joint 0: ", "joint 0 "};
    for (size_t i = 0; i < sizeof one / sizeof *one; i++)
        text += strncmp(text, one[i], strlen(one[i])) ? 0 : strlen(one[i]);
    snprintf(name, sizeof name, "%.*s", (int)strcspn(text, " [:"), text);
    const config_setting_t *at =
        *name && config_setting_is_group(group) ? config_setting_get_member(group, name) : NULL;
    return fp3_fail_at(r->in->error, status, r->in->name, fp3_setting_line(at ? at : group), 0,
                       "%s%s%s", what, *what ? ": " : "", text);
}
