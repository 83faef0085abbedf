/* SPDX-License-Identifier: Apache-2.0 */
/* links.c - see links.h. */
#include "links.h"

#include "base/host.h"
#include "base/nearest.h"
#include "base/number.h"
#include "base/path.h"
#include "table.h"
#include "values_own.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- settings ---- */

#define SKIN_MOST 1000
#define FIELDS 32 /* of a block of links that settings give */

/* Columns that a block of settings adds to its links. */
typedef struct {
    const char *names[FIELDS];
    const double *fields[FIELDS];
    size_t count;
    double *made[FIELDS]; /* to be freed */
    size_t made_count;
} columns;

static fp3_status add(const fp3_settings *s, const config_setting_t *at, columns *c,
                      const char *name, const double *field) {
    if (c->count == FIELDS)
        return fp3_setting_wrong(s, at, "found more than %d fields of links", FIELDS);
    c->names[c->count] = name;
    c->fields[c->count++] = field;
    return FP3_OK;
}

/* `set`: the same number for all links of the block. */
static fp3_status read_set(const fp3_settings *s, const config_setting_t *from, size_t links,
                           columns *c) {
    const config_setting_t *set = config_setting_get_member(from, "set");
    fp3_status status = FP3_OK;
    if (set && !config_setting_is_group(set))
        return fp3_setting_expected(s, set, "set", "a group of values, { name = number; ... }");
    for (int i = 0; set && !status && i < config_setting_length(set); i++) {
        const config_setting_t *at = config_setting_get_elem(set, (unsigned)i);
        const char *name = config_setting_name(at);
        double number = 0;
        float word = 0;
        status = fp3_setting_number(s, at, name, &number);
        const char *expected = status ? NULL : fp3_number_written(number, &word);
        if (expected)
            status = fp3_setting_expected(s, at, name, expected);
        double *column = status ? NULL : malloc((links + 1) * sizeof *column);
        if (!status && !column)
            status = fp3_no_memory(s->error);
        for (size_t k = 0; column && k < links; k++)
            column[k] = number;
        if (!status)
            status = add(s, at, c, name, column);
        if (status)
            free(column);
        else
            c->made[c->made_count++] = column;
    }
    return status;
}

static fp3_status read_kind(const fp3_settings *s, const config_setting_t *at, unsigned *kinds) {
    const char *name = NULL;
    unsigned kind = 0;
    fp3_status status = fp3_setting_text(s, at, "grid", &name);
    while (!status && kind < FP3_GRID_KINDS && strcmp(fp3_grid_kind_name(kind), name) != 0)
        kind++;
    if (!status && kind == FP3_GRID_KINDS)
        return fp3_setting_wrong(
            s, at, "grid: found '%s', expected \"structural\", \"shear\" or \"bending\"", name);
    *kinds |= 1u << kind;
    return status;
}

static fp3_status read_kinds(const fp3_settings *s, const config_setting_t *at, unsigned *kinds) {
    fp3_status status = FP3_OK;
    if (!fp3_setting_is_list(at))
        return read_kind(s, at, kinds);
    for (int i = 0; !status && i < config_setting_length(at); i++)
        status = read_kind(s, config_setting_get_elem(at, (unsigned)i), kinds);
    return status;
}

fp3_status fp3_links_note(fp3_scene_group *group, const char *path, fp3_error *error) {
    char **files = realloc(group->files, (group->file_count + 1) * sizeof *files);
    if (files)
        group->files = files;
    if (!files || !(files[group->file_count] = strdup(path)))
        return fp3_no_memory(error);
    group->file_count++;
    return FP3_OK;
}

/* ---- one block ---- */

/* The relation of this name in the model; NULL: an image has lists alone, whose names the load
 * checks. */
static fp3_status find_relation(const fp3_settings *s, const config_setting_t *at,
                                const fp3_model *model, const char *name, const fp3_relation **of) {
    const char *near = NULL;
    const fp3_token wanted = {.text = name, .length = strlen(name)};
    *of = NULL;
    for (uint32_t i = 0; model && i < model->relation_count; i++) {
        fp3_nearest(wanted, model->relations[i].name, &near);
        if (strcmp(model->relations[i].name, name) == 0)
            *of = &model->relations[i];
    }
    if (model && (!*of || (*of)->kind != FP3_LINKS))
        return fp3_setting_wrong(s, at, "relation: found '%s', expected links of the model%s%s%s",
                                 name, near && !*of ? " (did you mean '" : "",
                                 near && !*of ? near : "", near && !*of ? "'?)" : "");
    return FP3_OK;
}

static fp3_status check_field(const fp3_settings *s, const config_setting_t *at,
                              const fp3_model *model, const fp3_relation *of, const char *name) {
    for (uint32_t k = 0; of && k < of->field_count; k++)
        if (strcmp(model->fields[of->first_field + k].name, name) == 0)
            return FP3_OK;
    return of ? fp3_setting_wrong(s, at, "links '%s' have no field '%s'", of->name, name) : FP3_OK;
}

/* What the settings name. */
static fp3_status check_fields(const fp3_settings *s, const config_setting_t *from,
                               const fp3_model *model, const fp3_relation *of) {
    const config_setting_t *set = config_setting_get_member(from, "set");
    const config_setting_t *rest = config_setting_get_member(from, "rest");
    const char *field = rest ? config_setting_get_string(rest) : NULL;
    fp3_status status = field ? check_field(s, rest, model, of, field) : FP3_OK;
    for (int i = 0;
         set && config_setting_is_group(set) && !status && i < config_setting_length(set); i++) {
        const config_setting_t *at = config_setting_get_elem(set, (unsigned)i);
        status = check_field(s, at, model, of, config_setting_name(at));
    }
    return status;
}

/* With the columns of the settings behind its own. */
static fp3_status put(const fp3_settings *s, const config_setting_t *from, const char *relation,
                      fp3_links links, const char *path, columns *c, fp3_params *params) {
    fp3_error why = {.text = ""};
    char *place = NULL;
    fp3_status status = read_set(s, from, links.count, c);
    for (size_t i = 0; !status && i < links.field_count; i++)
        status = add(s, from, c, links.names[i], links.fields[i]);
    if (status)
        return status;
    links.names = c->names;
    links.fields = c->fields;
    links.field_count = c->count;
    if (asprintf(&place, "%s:%u%s%s", s->name, fp3_setting_line(from), path ? ": " : "",
                 path ? path : "") < 0)
        return fp3_no_memory(s->error);
    status = fp3_linked_put(&params->linked, relation, &links, 1, place, &why);
    free(place);
    return status == FP3_E_ARGUMENT ? fp3_setting_wrong(s, from, "%s", why.text)
           : status                 ? fp3_fail(s->error, status, "%s", why.text)
                                    : FP3_OK;
}

static fp3_status put_grid(const fp3_settings *s, const config_setting_t *from,
                           const char *relation, const fp3_grid *grid, columns *c,
                           fp3_params *params) {
    const config_setting_t *at = config_setting_get_member(from, "grid");
    const config_setting_t *rest = config_setting_get_member(from, "rest");
    const char *field = NULL;
    fp3_grid_links made = {0};
    unsigned kinds = 0;
    if (!grid)
        return fp3_setting_wrong(s, at, "grid: this group has no grid, so its links need a file");
    fp3_status status = read_kinds(s, at, &kinds);
    if (!status && rest)
        status = fp3_setting_text(s, rest, "rest", &field);
    if (!status)
        status = fp3_grid_link(grid, kinds, &made, s->error);
    if (!status && field)
        status = add(s, rest, c, field, made.length);
    if (!status)
        status = put(s, from, relation, made.links, NULL, c, params);
    fp3_grid_links_free(&made);
    return status;
}

/* What may stand in the columns a and b: objects of the group, or of it and of another, in the
 * order that `swap` says. */
static fp3_table_ends ends_of(const fp3_relation *of, const fp3_scene_group *group,
                              int is_swapped) {
    if (!of || of->of_kind == FP3_NONE)
        return (fp3_table_ends){.a = group->objects, .b = group->objects};
    return (fp3_table_ends){
        .a = is_swapped ? 0 : group->objects, .b = is_swapped ? group->objects : 0, .is_across = 1};
}

static fp3_status read_swap(const fp3_settings *s, const config_setting_t *from,
                            const fp3_relation *of, int *is_swapped) {
    const config_setting_t *at = config_setting_get_member(from, "swap");
    *is_swapped = 0;
    if (at && (!of || of->of_kind == FP3_NONE))
        return fp3_setting_wrong(s, at, "swap: the two ends of '%s' are objects of one group",
                                 of ? of->name : "a list");
    return at ? fp3_setting_flag(s, at, "swap", is_swapped) : FP3_OK;
}

static fp3_status put_file(const fp3_settings *s, const config_setting_t *from,
                           const fp3_relation *of, const char *relation, columns *c,
                           fp3_scene_group *group) {
    const config_setting_t *at = config_setting_get_member(from, "file");
    int is_swapped = 0;
    const char *name = NULL;
    fp3_table table = {0};
    fp3_table_links made = {0};
    fp3_error why = {.text = ""};
    if (config_setting_get_member(from, "rest"))
        return fp3_setting_wrong(s, config_setting_get_member(from, "rest"),
                                 "rest: only a grid knows the length of its links; expected a "
                                 "column in the file");
    fp3_status status = read_swap(s, from, of, &is_swapped);
    const fp3_table_ends ends = ends_of(of, group, is_swapped);
    if (!status)
        status = fp3_setting_text(s, at, "file", &name);
    char *path = status ? NULL : fp3_path_beside(s->name, name);
    if (status)
        return status;
    status = path ? fp3_table_read(path, &table, &why) : fp3_no_memory(&why);
    if (!status)
        status = fp3_table_link(&table, &ends, &made, &why);
    if (is_swapped) {
        const uint32_t *a = made.links.a;
        made.links.a = made.links.b;
        made.links.b = a;
    }
    if (status)
        fp3_fail_at(s->error, status, s->name, fp3_setting_line(at), 0, "%s", why.text);
    else
        status = put(s, from, relation, made.links, path, c, group->params);
    if (!status)
        status = fp3_links_note(group, path, s->error);
    fp3_table_links_free(&made);
    fp3_table_close(&table);
    free(path);
    return status;
}

static fp3_status read_block(const fp3_settings *s, const config_setting_t *from,
                             const fp3_grid *grid, fp3_scene_group *group) {
    static const char *const names[] = {"relation", "grid", "file", "rest", "set", "swap", NULL};
    const fp3_model *model = group->program->model;
    const fp3_relation *of = NULL;
    const char *relation = NULL;
    columns c = {.count = 0};
    if (!config_setting_is_group(from))
        return fp3_setting_expected(s, from, "links",
                                    "a group, { relation = ...; grid = ... or file = ...; ... }");
    const config_setting_t *at = config_setting_get_member(from, "relation");
    const int has_grid = config_setting_get_member(from, "grid") != NULL;
    const int has_file = config_setting_get_member(from, "file") != NULL;
    fp3_status status = fp3_setting_keys(s, from, "links", names);
    if (!status && (!at || has_grid == has_file))
        status = fp3_setting_wrong(s, from,
                                   !at ? "expected relation, the name of links in the model"
                                       : "expected one of grid and file in links");
    if (!status)
        status = fp3_setting_text(s, at, "relation", &relation);
    if (!status)
        status = find_relation(s, at, model, relation, &of);
    if (!status)
        status = check_fields(s, from, model, of);
    if (!status && has_grid && of && of->of_kind != FP3_NONE)
        status = fp3_setting_wrong(s, from,
                                   "grid: links of '%s' lead to objects of another group, so they "
                                   "need a file",
                                   of->name);
    if (!status && has_grid)
        status = put_grid(s, from, relation, grid, &c, group->params);
    else if (!status)
        status = put_file(s, from, of, relation, &c, group);
    for (size_t i = 0; i < c.made_count; i++)
        free(c.made[i]);
    return status;
}

fp3_status fp3_links_read(const fp3_settings *s, const config_setting_t *from, const fp3_grid *grid,
                          fp3_scene_group *group) {
    const config_setting_t *at = config_setting_get_member(from, "links");
    fp3_status status = FP3_OK;
    if (!at)
        return FP3_OK;
    if (!fp3_setting_is_list(at))
        return read_block(s, at, grid, group);
    for (int i = 0; !status && i < config_setting_length(at); i++)
        status = read_block(s, config_setting_get_elem(at, (unsigned)i), grid, group);
    return status;
}

/* ---- lists ---- */

fp3_status fp3_skin_read(const fp3_settings *s, const config_setting_t *from,
                         const fp3_scene_group *group) {
    const config_setting_t *at = config_setting_get_member(from, "skin");
    const fp3_model *model = group->program->model;
    int is_any = 0;
    if (!at)
        return FP3_OK;
    for (uint32_t i = 0; model && i < model->relation_count; i++)
        is_any |= model->relations[i].kind == FP3_NEAR;
    if (!is_any)
        return fp3_setting_wrong(s, at, "skin: the program has no relation `near` of a model");
    const fp3_status status = fp3_setting_number(s, at, "skin", &group->params->skin);
    if (!status && !(group->params->skin >= 0 && group->params->skin <= SKIN_MOST))
        return fp3_setting_expected(s, at, "skin", "a share of the reach, 0 to 1000");
    return status;
}

/* ---- without a scene ---- */

fp3_status fp3_params_link(fp3_params *params, const char *relation, const fp3_links *links,
                           fp3_error *error) {
    FP3_HOST;
    return fp3_linked_put(&params->linked, relation, links, 0, NULL, error);
}

fp3_status fp3_params_link_file(fp3_params *params, const char *text, size_t most, size_t *objects,
                                fp3_error *error) {
    FP3_HOST;
    const char *equals = strchr(text, '=');
    char relation[FP3_NAME_SIZE];
    fp3_table table = {0};
    fp3_table_links made = {0};
    *objects = 0;
    if (!equals || (size_t)(equals - text) >= FP3_NAME_SIZE)
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is not relation=file", text);
    snprintf(relation, sizeof relation, "%.*s", (int)(equals - text), text);
    fp3_status status = fp3_table_read(equals + 1, &table, error);
    if (!status)
        status = fp3_table_link(&table, &(fp3_table_ends){.a = most, .b = most}, &made, error);
    if (!status)
        status = fp3_linked_put(&params->linked, relation, &made.links, 0, equals + 1, error);
    *objects = made.objects;
    fp3_table_links_free(&made);
    fp3_table_close(&table);
    return status;
}
