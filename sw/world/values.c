/* SPDX-License-Identifier: Apache-2.0 */
/* values.c - values by name: from files, from name=value, for an object. */
#include "values.h"

#include <fp3/image.h>
#include <fp3/model.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "values_own.h"

#include "base/host.h"
#include "base/number.h"
#include "language/formula.h"

#define FORMULA_SIZE 65536
#define FORMULA_DEPTH 64 /* of values that are made of each other */

fp3_status fp3_params_make(fp3_params **params, fp3_error *error) {
    *params = calloc(1, sizeof **params);
    if (*params)
        (*params)->skin = -1;
    return *params ? FP3_OK : fp3_no_memory(error);
}

void fp3_values_skin(fp3_params *params, double skin) { params->skin = skin; }

/* ---- places ---- */

/* Keeps the path, and points at.path to what is kept. */
static fp3_status keep_path(fp3_params *params, fp3_value_place *at, fp3_error *error) {
    for (const fp3_value_file *f = params->files; at->path && f; f = f->next)
        if (strcmp(f->path, at->path) == 0) {
            at->path = f->path;
            return FP3_OK;
        }
    if (!at->path)
        return FP3_OK;
    fp3_value_file *made = malloc(sizeof *made + strlen(at->path) + 1);
    if (!made)
        return fp3_no_memory(error);
    made->next = params->files;
    params->files = made;
    at->path = strcpy(made->path, at->path);
    return FP3_OK;
}

fp3_status fp3_values_place(fp3_params *params, const char *path, unsigned line, fp3_error *error) {
    params->at = (fp3_value_place){path, line};
    return keep_path(params, &params->at, error);
}

fp3_value *fp3_values_find(const fp3_params *params, const char *name) {
    for (size_t i = 0; i < params->count; i++)
        if (strcmp(params->list[i].name, name) == 0)
            return &params->list[i];
    return NULL;
}

fp3_status fp3_value_wrong(const fp3_params *params, const char *name, fp3_error *error,
                           const char *format, ...) {
    char text[400];
    const fp3_value *param = fp3_values_find(params, name);
    const fp3_value_place at = param && param->at.path ? param->at : params->at;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return at.path ? fp3_fail_at(error, FP3_E_ARGUMENT, at.path, at.line, 0, "%s", text)
                   : fp3_fail(error, FP3_E_ARGUMENT, "%s", text);
}

/* ---- making ---- */

static fp3_status parse(fp3_value *v, fp3_error *error) {
    fp3_error why;
    const fp3_status status = v->formula ? fp3_formula_read(v->formula, &v->parsed, &why) : FP3_OK;
    return status == FP3_E_SYSTEM ? fp3_fail(error, status, "%s", why.text) : FP3_OK;
}

static void free_formula(fp3_value *v) {
    free(v->formula);
    fp3_formula_free(&v->parsed);
}

static double *copied(const double *column, size_t count, fp3_error *error) {
    double *made = malloc((count + 1) * sizeof *made);
    if (made)
        memcpy(made, column, count * sizeof *made);
    else
        fp3_no_memory(error);
    return made;
}

static fp3_status copy_into(const fp3_params *from, fp3_params *to, fp3_error *error) {
    fp3_status status = fp3_values_place(to, from->at.path, from->at.line, error);
    to->skin = from->skin;
    to->list = malloc((from->count + 1) * sizeof *to->list);
    if (!to->list)
        return fp3_no_memory(error);
    for (; !status && to->count < from->count; to->count++) {
        fp3_value *v = &to->list[to->count];
        *v = from->list[to->count];
        v->parsed = NULL;
        v->column = NULL;
        if (v->formula && !(v->formula = strdup(v->formula)))
            return fp3_no_memory(error);
        if (from->list[to->count].column &&
            !(v->column = copied(from->list[to->count].column, v->count, error)))
            status = FP3_E_SYSTEM;
        if (!status)
            status = parse(v, error);
        if (!status)
            status = keep_path(to, &v->at, error);
    }
    return status ? status : fp3_linked_copy(from->linked, &to->linked, error);
}

fp3_status fp3_params_copy(const fp3_params *from, fp3_params **params, fp3_error *error) {
    fp3_status status = fp3_params_make(params, error);
    if (!status)
        status = copy_into(from, *params, error);
    if (status)
        fp3_params_free(params);
    return status;
}

void fp3_params_free(fp3_params **params) {
    fp3_params *p = *params;
    while (p && p->files) {
        fp3_value_file *next = p->files->next;
        free(p->files);
        p->files = next;
    }
    for (size_t i = 0; p && i < p->count; i++) {
        free_formula(&p->list[i]);
        free(p->list[i].column);
    }
    if (p) {
        fp3_linked_free(&p->linked);
        free(p->list);
    }
    free(p);
    *params = NULL;
}

/* ---- putting ---- */

/* Adds or replaces, by this name; but a number does not replace a formula. Takes what.formula and
 * what.column, except after a failure. */
static fp3_status put_value(fp3_params *params, const char *name, fp3_value what,
                            fp3_error *error) {
    fp3_value *param = fp3_values_find(params, name);
    if (!param) {
        fp3_value *list = realloc(params->list, (params->count + 1) * sizeof *list);
        if (!list)
            return fp3_no_memory(error);
        params->list = list;
        param = &list[params->count++];
        *param = (fp3_value){.formula = NULL};
    }
    strcpy(what.name, name);
    free(param->column);
    if (what.formula)
        free_formula(param);
    else {
        what.formula = param->formula;
        what.parsed = param->parsed;
    }
    *param = what;
    return FP3_OK;
}

static fp3_status put(fp3_params *params, const char *name, fp3_value what, fp3_error *error) {
    fp3_status status = fp3_name_valid(name)
                            ? parse(&what, error)
                            : fp3_fail(error, FP3_E_ARGUMENT, "'%s' is no name", name);
    if (!status)
        status = keep_path(params, &what.at, error);
    if (!status)
        status = put_value(params, name, what, error);
    if (status)
        free_formula(&what);
    return status;
}

fp3_status fp3_params_put(fp3_params *params, const char *name, double number, fp3_error *error) {
    return put(params, name, (fp3_value){.value = number, .has_number = 1}, error);
}

fp3_status fp3_values_column(fp3_params *params, const char *name, const double *column,
                             size_t count, const char *path, unsigned line, fp3_error *error) {
    fp3_value what = {.has_number = 1, .is_spread = 1, .count = count, .at = {path, line}};
    what.column = copied(column, count, error);
    const fp3_status status = what.column ? put(params, name, what, error) : FP3_E_SYSTEM;
    if (status)
        free(what.column);
    return status;
}

/* A number, or else a formula of numbers. */
static fp3_status read_number(const char *set, const char *text, double *number, fp3_error *error) {
    FP3_HOST;
    const char *expected = fp3_number_read(text, number);
    fp3_error why;
    const fp3_status status = expected ? fp3_constant_read(text, number, &why) : FP3_OK;
    if (!status || status == FP3_E_SYSTEM)
        return status ? fp3_fail(error, status, "'%s': %s", set, why.text) : FP3_OK;
    return fp3_fail(error, FP3_E_ARGUMENT, "'%s': '%s' is no number: %s", set, text, why.text);
}

/* The name in front of the = of text, and what is behind it, or NULL. */
static const char *split(const char *text, char name[FP3_NAME_SIZE]) {
    const char *equals = strchr(text, '=');
    if (!equals || (size_t)(equals - text) >= FP3_NAME_SIZE)
        return NULL;
    memcpy(name, text, (size_t)(equals - text));
    name[equals - text] = '\0';
    return equals + 1;
}

fp3_status fp3_params_set(fp3_params *params, const char *text, fp3_error *error) {
    FP3_HOST;
    char name[FP3_NAME_SIZE];
    double number = 0;
    const char *is = split(text, name);
    if (!is)
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is not name=value", text);
    fp3_status status = read_number(text, is, &number, error);
    return status ? status : fp3_params_put(params, name, number, error);
}

fp3_status fp3_params_spread(fp3_params *params, const char *text, fp3_error *error) {
    FP3_HOST;
    char name[FP3_NAME_SIZE];
    fp3_value pair = {.is_spread = 1};
    const char *first = split(text, name), *colon = first ? strchr(first, ':') : NULL;
    if (!colon)
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is not name=first:last", text);
    char *copy = strndup(first, (size_t)(colon - first));
    fp3_status status = copy ? read_number(text, copy, &pair.value, error) : fp3_no_memory(error);
    free(copy);
    if (!status)
        status = read_number(text, colon + 1, &pair.last, error);
    if (!status && !(isfinite(pair.value) && isfinite(pair.last)))
        status = fp3_fail(error, FP3_E_ARGUMENT, "'%s': found %g, expected finite numbers", text,
                          isfinite(pair.value) ? pair.last : pair.value);
    return status ? status : put(params, name, pair, error);
}

/* ---- files ---- */

/* The error with its place in front. */
static fp3_status put_from(fp3_params *params, const fp3_settings *s,
                           const config_setting_t *setting, fp3_value what) {
    fp3_error why;
    what.at = (fp3_value_place){s->name, fp3_setting_line(setting)};
    const fp3_status status = put(params, config_setting_name(setting), what, &why);
    if (status == FP3_E_ARGUMENT)
        return fp3_setting_wrong(s, setting, "%s", why.text);
    return status ? fp3_fail(s->error, status, "%s", why.text) : FP3_OK;
}

static fp3_status read_value(const fp3_settings *s, const config_setting_t *setting,
                             fp3_value *what) {
    const char *name = config_setting_name(setting), *text = config_setting_get_string(setting);
    if (text && strlen(text) >= FORMULA_SIZE)
        return fp3_setting_expected(s, setting, name, "a number or a shorter formula");
    if (text) {
        what->formula = strdup(text);
        return what->formula ? FP3_OK : fp3_no_memory(s->error);
    }
    what->has_number = 1;
    if (!fp3_setting_is_number(setting))
        return fp3_setting_expected(s, setting, name, "a number or a formula in quotes");
    return fp3_setting_number(s, setting, name, &what->value);
}

static fp3_status read_pair(const fp3_settings *s, const config_setting_t *setting,
                            fp3_value *what) {
    const char *name = config_setting_name(setting);
    what->is_spread = what->has_number = 1;
    if (!fp3_setting_is_list(setting) || config_setting_length(setting) != 2)
        return fp3_setting_expected(s, setting, name, "a pair of numbers [FIRST, LAST]");
    fp3_status status =
        fp3_setting_number(s, config_setting_get_elem(setting, 0), name, &what->value);
    if (!status)
        status = fp3_setting_number(s, config_setting_get_elem(setting, 1), name, &what->last);
    return status;
}

typedef fp3_status read_fn(const fp3_settings *s, const config_setting_t *setting, fp3_value *what);

static fp3_status put_all(fp3_params *params, const fp3_settings *s, const config_setting_t *from,
                          read_fn *read_one) {
    fp3_status status = FP3_OK;
    for (int i = 0; !status && i < config_setting_length(from); i++) {
        const config_setting_t *setting = config_setting_get_elem(from, (unsigned)i);
        fp3_value what = {.value = 0};
        status = read_one(s, setting, &what);
        if (!status)
            status = put_from(params, s, setting, what);
    }
    return status;
}

fp3_status fp3_values_read(fp3_params *params, const fp3_settings *s,
                           const config_setting_t *from) {
    return put_all(params, s, from, read_value);
}

fp3_status fp3_values_spread(fp3_params *params, const fp3_settings *s,
                             const config_setting_t *from) {
    return put_all(params, s, from, read_pair);
}

fp3_status fp3_params_load(fp3_params *params, const char *path, fp3_error *error) {
    FP3_HOST;
    fp3_settings s;
    fp3_status status = fp3_settings_load(path, FP3_E_ARGUMENT, &s, error);
    if (!status)
        status = fp3_values_read(params, &s, s.root);
    fp3_settings_close(&s);
    return status;
}
