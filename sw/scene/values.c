/* values.c - values by name: from files, from name=value, for an object. */
#include "values.h"

#include <fp3/image.h>
#include <fp3/model.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    char name[FP3_NAME_SIZE];
    char of[FP3_NAME_SIZE]; /* "1/of" if not empty */
    double value, last;     /* of the first object and, if that is another one, of the last */
    int is_spread;
} value;

struct fp3_params {
    value *list;
    size_t count;
};

fp3_status fp3_params_make(fp3_params **params, fp3_error *error) {
    *params = calloc(1, sizeof **params);
    return *params ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
}

fp3_status fp3_params_copy(const fp3_params *from, fp3_params **params, fp3_error *error) {
    fp3_status status = fp3_params_make(params, error);
    if (status || !from->count)
        return status;
    (*params)->list = malloc(from->count * sizeof *from->list);
    if (!(*params)->list) {
        fp3_params_free(params);
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    }
    memcpy((*params)->list, from->list, from->count * sizeof *from->list);
    (*params)->count = from->count;
    return FP3_OK;
}

void fp3_params_free(fp3_params **params) {
    if (*params)
        free((*params)->list);
    free(*params);
    *params = NULL;
}

/* ---- putting ---- */

static value *find(const fp3_params *params, const char *name) {
    for (size_t i = 0; i < params->count; i++)
        if (strcmp(params->list[i].name, name) == 0)
            return &params->list[i];
    return NULL;
}

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
    return FP3_OK;
}

fp3_status fp3_params_put(fp3_params *params, const char *name, double number, fp3_error *error) {
    return put(params, name, (value){.value = number}, error);
}

fp3_status fp3_params_set(fp3_params *params, const char *text, fp3_error *error) {
    const char *equals = strchr(text, '=');
    char name[FP3_NAME_SIZE], *end;
    if (!equals || (size_t)(equals - text) >= sizeof name)
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is not name=value", text);
    memcpy(name, text, (size_t)(equals - text));
    name[equals - text] = '\0';
    double number = strtod(equals + 1, &end);
    if ((end == equals + 1 || *end) && fp3_constant_read(equals + 1, &number, NULL))
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s': '%s' is no number", text, equals + 1);
    return fp3_params_put(params, name, number, error);
}

/* ---- files ---- */

static int is_number(const config_setting_t *setting) {
    return setting && config_setting_is_number(setting);
}

static double number_of(const config_setting_t *setting) {
    return config_setting_type(setting) == CONFIG_TYPE_FLOAT
               ? config_setting_get_float(setting)
               : (double)config_setting_get_int64(setting);
}

typedef fp3_status put_fn(fp3_params *params, const config_setting_t *setting, fp3_error *error);

static fp3_status put_setting(fp3_params *params, const config_setting_t *setting,
                              fp3_error *error) {
    const char *name = config_setting_name(setting);
    if (is_number(setting))
        return fp3_params_put(params, name, number_of(setting), error);
    const char *text = config_setting_get_string(setting);
    if (text && strncmp(text, "1/", 2) == 0 && fp3_name_valid(text + 2)) {
        value reciprocal = {.value = 0};
        strcpy(reciprocal.of, text + 2);
        return put(params, name, reciprocal, error);
    }
    return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is neither a number nor \"1/name\"", name);
}

static fp3_status put_spread(fp3_params *params, const config_setting_t *setting,
                             fp3_error *error) {
    const char *name = config_setting_name(setting);
    const config_setting_t *first = NULL, *last = NULL;
    if (config_setting_is_aggregate(setting) && config_setting_length(setting) == 2) {
        first = config_setting_get_elem(setting, 0);
        last = config_setting_get_elem(setting, 1);
    }
    if (!is_number(first) || !is_number(last) || config_setting_is_group(setting))
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is no pair of numbers [FIRST, LAST]", name);
    return put(params, name,
               (value){.value = number_of(first), .last = number_of(last), .is_spread = 1}, error);
}

static fp3_status put_all(fp3_params *params, const config_setting_t *from, const char *path,
                          put_fn *put_one, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (int i = 0; !status && i < config_setting_length(from); i++) {
        const config_setting_t *setting = config_setting_get_elem(from, (unsigned)i);
        fp3_error why;
        status = put_one(params, setting, &why);
        if (status)
            fp3_fail(error, status, "%s:%d: %s", path, config_setting_source_line(setting),
                     why.text);
    }
    return status;
}

fp3_status fp3_values_read(fp3_params *params, const config_setting_t *from, const char *path,
                           fp3_error *error) {
    return put_all(params, from, path, put_setting, error);
}

fp3_status fp3_values_spread(fp3_params *params, const config_setting_t *from, const char *path,
                             fp3_error *error) {
    return put_all(params, from, path, put_spread, error);
}

fp3_status fp3_params_load(fp3_params *params, const char *path, fp3_error *error) {
    fp3_status status = FP3_OK;
    config_t config;
    config_init(&config);
    if (!config_read_file(&config, path)) {
        const int line = config_error_line(&config);
        status = config_error_type(&config) == CONFIG_ERR_FILE_IO
                     ? fp3_fail(error, FP3_E_ARGUMENT, "%s: cannot be read", path)
                     : fp3_fail(error, FP3_E_ARGUMENT, "%s:%d: %s", path, line,
                                config_error_text(&config));
    }
    if (!status)
        status = fp3_values_read(params, config_root_setting(&config), path, error);
    config_destroy(&config);
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

fp3_status fp3_values_at(const fp3_params *params, const char *name, double share, double *number,
                         int *is_spread, fp3_error *error) {
    const value *param = find(params, name);
    if (!param)
        return fp3_fail(error, FP3_E_ARGUMENT, "parameter '%s' has no value", name);
    if (!param->of[0]) {
        *number = number_at(param, share);
        *is_spread = param->is_spread;
        return FP3_OK;
    }
    const value *of = find(params, param->of);
    if (!of || of->of[0])
        return fp3_fail(error, FP3_E_ARGUMENT, "parameter '%s' is 1/%s, and '%s' is no number",
                        name, param->of, param->of);
    *is_spread = of->is_spread;
    /* In double, then to FP32: the same as rounding once, for 53 >= 2 * 24 + 2. */
    *number = 1.0 / (double)(float)number_at(of, share);
    return FP3_OK;
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
            return fp3_fail(error, FP3_E_ARGUMENT, "the program has no parameter '%s'",
                            params->list[i].name);
    }
    return FP3_OK;
}
