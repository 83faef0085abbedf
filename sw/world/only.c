/* SPDX-License-Identifier: Apache-2.0 */
/* only.c - see only.h. */
#include "only.h"

#include "apply.h"
#include "values.h"
#include "values_own.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static const char expected[] =
    "numbers of objects, or texts \"FIRST..LAST\", as [0, 31] or \"0..31\"";

/* "0..31" */
static int read_range(const char *text, uint64_t *first, uint64_t *last) {
    int end = 0;
    return strspn(text, "0123456789.") == strlen(text) &&
           sscanf(text, "%9" SCNu64 "..%9" SCNu64 "%n", first, last, &end) == 2 && !text[end] &&
           *first <= *last;
}

static fp3_status mark(const fp3_settings *s, const config_setting_t *at, size_t objects,
                       char *is_meant) {
    const char *text = config_setting_get_string(at);
    uint64_t first = 0, last = 0;
    fp3_status status = FP3_OK;
    if (text && !read_range(text, &first, &last))
        return fp3_setting_wrong(s, at, "objects: found '%s', expected %s", text, expected);
    if (!text && !fp3_setting_is_number(at))
        return fp3_setting_expected(s, at, "objects", expected);
    if (!text) {
        status = fp3_setting_count(s, at, "objects", 0, objects - 1, &first);
        last = first;
    }
    if (!status && last >= objects)
        return fp3_setting_wrong(s, at, "objects: found '%s', expected numbers from 0 to %zu", text,
                                 objects - 1);
    for (uint64_t i = first; !status && i <= last; i++)
        is_meant[i] = 1;
    return status;
}

static fp3_status mark_all(const fp3_settings *s, const config_setting_t *from, size_t objects,
                           char *is_meant) {
    const config_setting_t *at = config_setting_get_member(from, "objects");
    fp3_status status = FP3_OK;
    if (!at)
        return fp3_setting_wrong(s, from, "expected objects, %s", expected);
    if (!fp3_setting_is_list(at))
        return mark(s, at, objects, is_meant);
    for (int i = 0; !status && i < config_setting_length(at); i++)
        status = mark(s, config_setting_get_elem(at, (unsigned)i), objects, is_meant);
    return status;
}

/* What all others have: what was given, or the model's default. */
static fp3_status find_default(const fp3_settings *s, const config_setting_t *at,
                               const fp3_program *program, double *value) {
    const fp3_model *model = program->model;
    const char *name = config_setting_name(at);
    const uint32_t named = model ? fp3_model_param(model, name) : FP3_NONE;
    const uint32_t param =
        named != FP3_NONE && fp3_model_is_foreign(model, named) ? FP3_NONE : named;
    const uint32_t state = model ? fp3_model_state(model, name) : FP3_NONE;
    if (param == FP3_NONE && (state == FP3_NONE || model->states[state].start != FP3_NONE))
        return fp3_setting_wrong(
            s, at,
            state == FP3_NONE && model
                ? "the model has no state or param '%s'"
                : "'%s' has no value for other objects, expected a value in set",
            name);
    *value = param != FP3_NONE ? model->params[param].value : model->states[state].value;
    return FP3_OK;
}

static fp3_status put(const fp3_settings *s, const config_setting_t *at,
                      const fp3_scene_group *group, const char *is_meant, double *column) {
    const char *name = config_setting_name(at);
    const int is_given = fp3_params_has(group->params, name);
    double number = 0, usual = 0;
    int is_spread;
    fp3_status status = fp3_setting_number(s, at, name, &number);
    if (!status && !is_given)
        status = find_default(s, at, group->program, &usual);
    const unsigned words = group->program->model ? fp3_program_words(group->program)
                                                 : fp3_values_words(group->program->image);
    for (size_t i = 0; !status && i < group->objects; i++) {
        const double last = (double)(group->objects - 1), share = last > 0 ? (double)i / last : 0;
        column[i] = is_meant[i] ? number : usual;
        if (!is_meant[i] && is_given)
            status =
                fp3_values_at(group->params, name, share, words, &column[i], &is_spread, s->error);
    }
    return status ? status
                  : fp3_values_column(group->params, name, column, group->objects, s->name,
                                      fp3_setting_line(at), s->error);
}

static fp3_status read_one(const fp3_settings *s, const config_setting_t *from,
                           const fp3_scene_group *group, char *is_meant, double *column) {
    static const char *const names[] = {"objects", "set", NULL};
    if (!config_setting_is_group(from))
        return fp3_setting_expected(s, from, "only", "a group, { objects = ...; set = { ... }; }");
    const config_setting_t *set = config_setting_get_member(from, "set");
    memset(is_meant, 0, group->objects);
    fp3_status status = fp3_setting_keys(s, from, "only", names);
    if (!status)
        status = mark_all(s, from, group->objects, is_meant);
    if (!status && (!set || !config_setting_is_group(set)))
        status = fp3_setting_wrong(s, set ? set : from,
                                   "expected set, a group of values, { name = number; ... }");
    for (int i = 0; !status && i < config_setting_length(set); i++)
        status = put(s, config_setting_get_elem(set, (unsigned)i), group, is_meant, column);
    return status;
}

fp3_status fp3_only_read(const fp3_settings *s, const config_setting_t *from,
                         const fp3_scene_group *group) {
    const config_setting_t *at = config_setting_get_member(from, "only");
    if (!at)
        return FP3_OK;
    char *is_meant = malloc(group->objects);
    double *column = malloc(group->objects * sizeof *column);
    fp3_status status = is_meant && column ? FP3_OK : fp3_no_memory(s->error);
    if (!status && !fp3_setting_is_list(at))
        status = read_one(s, at, group, is_meant, column);
    else
        for (int i = 0; !status && i < config_setting_length(at); i++)
            status = read_one(s, config_setting_get_elem(at, (unsigned)i), group, is_meant, column);
    free(is_meant);
    free(column);
    return status;
}
