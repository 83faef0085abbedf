/* values.c - values by name: from files, from name=value, for an object. */
#include "values.h"

#include <fp3/image.h>
#include <fp3/model.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "text/number.h"

/* Where a value was set. */
typedef struct {
    const char *path; /* one of the files of the params; NULL: nowhere */
    unsigned line;
} place;

typedef struct {
    char name[FP3_NAME_SIZE];
    char of[FP3_NAME_SIZE]; /* "1/of" if not empty */
    double value, last;     /* of the first object and, if that is another one, of the last */
    int is_spread;
    place at;
} value;

typedef struct file {
    struct file *next;
    char path[];
} file;

struct fp3_params {
    value *list;
    size_t count;
    file *files;
    place at; /* of values that have none */
};

fp3_status fp3_params_make(fp3_params **params, fp3_error *error) {
    *params = calloc(1, sizeof **params);
    return *params ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
}

/* ---- places ---- */

/* Keeps the path, and points at.path to what is kept. */
static fp3_status keep_path(fp3_params *params, place *at, fp3_error *error) {
    for (const file *f = params->files; at->path && f; f = f->next)
        if (strcmp(f->path, at->path) == 0) {
            at->path = f->path;
            return FP3_OK;
        }
    if (!at->path)
        return FP3_OK;
    file *made = malloc(sizeof *made + strlen(at->path) + 1);
    if (!made)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    made->next = params->files;
    params->files = made;
    at->path = strcpy(made->path, at->path);
    return FP3_OK;
}

fp3_status fp3_values_place(fp3_params *params, const char *path, unsigned line, fp3_error *error) {
    params->at = (place){path, line};
    return keep_path(params, &params->at, error);
}

static value *find(const fp3_params *params, const char *name) {
    for (size_t i = 0; i < params->count; i++)
        if (strcmp(params->list[i].name, name) == 0)
            return &params->list[i];
    return NULL;
}

fp3_status fp3_value_wrong(const fp3_params *params, const char *name, fp3_error *error,
                           const char *format, ...) {
    char text[400];
    const value *param = find(params, name);
    const place at = param && param->at.path ? param->at : params->at;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return at.path ? fp3_fail(error, FP3_E_ARGUMENT, "%s:%u: %s", at.path, at.line, text)
                   : fp3_fail(error, FP3_E_ARGUMENT, "%s", text);
}

/* ---- making ---- */

static fp3_status copy_into(const fp3_params *from, fp3_params *to, fp3_error *error) {
    fp3_status status = fp3_values_place(to, from->at.path, from->at.line, error);
    to->list = malloc((from->count + 1) * sizeof *to->list);
    if (!to->list)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    for (; !status && to->count < from->count; to->count++) {
        to->list[to->count] = from->list[to->count];
        status = keep_path(to, &to->list[to->count].at, error);
    }
    return status;
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
        file *next = p->files->next;
        free(p->files);
        p->files = next;
    }
    if (p)
        free(p->list);
    free(p);
    *params = NULL;
}

/* ---- putting ---- */

/* Adds or replaces, by this name. */
static fp3_status put(fp3_params *params, const char *name, value what, fp3_error *error) {
    if (!fp3_name_valid(name))
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is no name", name);
    value *param = find(params, name);
    if (!param) {
        value *list = realloc(params->list, (params->count + 1) * sizeof *list);
        if (!list)
            return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
        params->list = list;
        param = &list[params->count++];
    }
    strcpy(what.name, name);
    *param = what;
    return keep_path(params, &param->at, error);
}

fp3_status fp3_params_put(fp3_params *params, const char *name, double number, fp3_error *error) {
    return put(params, name, (value){.value = number}, error);
}

/* A number, or else a formula of numbers. */
static fp3_status read_number(const char *set, const char *text, double *number, fp3_error *error) {
    const fp3_number_locale locale = fp3_number_locale_enter();
    const char *expected = fp3_number_read(text, number);
    fp3_number_locale_leave(locale);
    fp3_error why;
    if (!expected || !fp3_constant_read(text, number, &why))
        return FP3_OK;
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
    char name[FP3_NAME_SIZE];
    double number = 0;
    const char *is = split(text, name);
    if (!is)
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is not name=value", text);
    fp3_status status = read_number(text, is, &number, error);
    return status ? status : fp3_params_put(params, name, number, error);
}

fp3_status fp3_params_spread(fp3_params *params, const char *text, fp3_error *error) {
    char name[FP3_NAME_SIZE];
    value pair = {.is_spread = 1};
    const char *first = split(text, name), *colon = first ? strchr(first, ':') : NULL;
    if (!colon)
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is not name=first:last", text);
    char *copy = strndup(first, (size_t)(colon - first));
    fp3_status status = copy ? read_number(text, copy, &pair.value, error)
                             : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
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
                           const config_setting_t *setting, value what) {
    fp3_error why;
    what.at = (place){s->name, fp3_setting_line(setting)};
    const fp3_status status = put(params, config_setting_name(setting), what, &why);
    if (status == FP3_E_ARGUMENT)
        return fp3_setting_wrong(s, setting, "%s", why.text);
    return status ? fp3_fail(s->error, status, "%s", why.text) : FP3_OK;
}

static fp3_status read_value(const fp3_settings *s, const config_setting_t *setting, value *what) {
    const char *name = config_setting_name(setting), *text = config_setting_get_string(setting);
    if (text && strncmp(text, "1/", 2) == 0 && fp3_name_valid(text + 2)) {
        strcpy(what->of, text + 2);
        return FP3_OK;
    }
    if (!fp3_setting_is_number(setting))
        return fp3_setting_expected(s, setting, name, "a number or \"1/name\"");
    return fp3_setting_number(s, setting, name, &what->value);
}

static fp3_status read_pair(const fp3_settings *s, const config_setting_t *setting, value *what) {
    const char *name = config_setting_name(setting);
    what->is_spread = 1;
    if (!fp3_setting_is_list(setting) || config_setting_length(setting) != 2)
        return fp3_setting_expected(s, setting, name, "a pair of numbers [FIRST, LAST]");
    fp3_status status =
        fp3_setting_number(s, config_setting_get_elem(setting, 0), name, &what->value);
    if (!status)
        status = fp3_setting_number(s, config_setting_get_elem(setting, 1), name, &what->last);
    return status;
}

typedef fp3_status read_fn(const fp3_settings *s, const config_setting_t *setting, value *what);

static fp3_status put_all(fp3_params *params, const fp3_settings *s, const config_setting_t *from,
                          read_fn *read_one) {
    fp3_status status = FP3_OK;
    for (int i = 0; !status && i < config_setting_length(from); i++) {
        const config_setting_t *setting = config_setting_get_elem(from, (unsigned)i);
        value what = {.value = 0};
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
    fp3_settings s;
    fp3_status status = fp3_settings_load(path, FP3_E_ARGUMENT, &s, error);
    if (!status)
        status = fp3_values_read(params, &s, s.root);
    fp3_settings_close(&s);
    return status;
}

/* ---- asking ---- */

size_t fp3_params_count(const fp3_params *params) { return params->count; }

int fp3_params_has(const fp3_params *params, const char *name) {
    return find(params, name) != NULL;
}

/* Of an object, 0 for the first and 1 for the last. */
static double number_at(const value *v, double share) {
    return v->is_spread ? (1 - share) * v->value + share * v->last : v->value;
}

/* 1 / number, which an FP32 number must be and not 0. */
static fp3_status reciprocal(const fp3_params *params, const value *param, double number,
                             double *is, fp3_error *error) {
    float single;
    const char *expected = fp3_number_single(number, &single);
    if (!expected && single == 0)
        expected = "a number other than 0";
    if (expected)
        return fp3_value_wrong(params, param->of, error,
                               "parameter '%s' is 1/%s, and '%s' is %g: expected %s", param->name,
                               param->of, param->of, number, expected);
    /* In double, then to FP32: the same as rounding once, for 53 >= 2 * 24 + 2. */
    *is = 1.0 / (double)single;
    return FP3_OK;
}

fp3_status fp3_values_at(const fp3_params *params, const char *name, double share, double *number,
                         int *is_spread, fp3_error *error) {
    const value *param = find(params, name);
    if (!param)
        return fp3_value_wrong(params, name, error, "parameter '%s' has no value", name);
    if (!param->of[0]) {
        *number = number_at(param, share);
        *is_spread = param->is_spread;
        return FP3_OK;
    }
    const value *of = find(params, param->of);
    if (!of || of->of[0])
        return fp3_value_wrong(params, name, error, "parameter '%s' is 1/%s, and '%s' is no number",
                               name, param->of, param->of);
    *is_spread = of->is_spread;
    return reciprocal(params, param, number_at(of, share), number, error);
}

fp3_status fp3_params_get(const fp3_params *params, const char *name, double *number,
                          fp3_error *error) {
    int is_spread;
    return fp3_values_at(params, name, 0, number, &is_spread, error);
}

fp3_status fp3_values_check(const fp3_params *params, fp3_values_has_fn *has, const void *of,
                            fp3_error *error) {
    for (size_t i = 0; i < params->count; i++) {
        int is_used = has(of, params->list[i].name);
        for (size_t j = 0; !is_used && j < params->count; j++)
            is_used = strcmp(params->list[j].of, params->list[i].name) == 0 &&
                      has(of, params->list[j].name);
        if (!is_used)
            return fp3_value_wrong(params, params->list[i].name, error,
                                   "the program has no parameter '%s'", params->list[i].name);
    }
    return FP3_OK;
}
