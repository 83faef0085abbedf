/* params.c - parameter files and --set. */
#include "params.h"

#include <fp3/model.h>
#include <libconfig.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void fp3_params_free(fp3_params *params) {
    free(params->list);
    *params = (fp3_params){0};
}

static fp3_param *find(const fp3_params *params, const char *name) {
    for (size_t i = 0; i < params->count; i++)
        if (strcmp(params->list[i].name, name) == 0)
            return &params->list[i];
    return NULL;
}

/* Adds or replaces, by this name. */
static fp3_status put(fp3_params *params, const char *name, fp3_param value, fp3_error *error) {
    if (!fp3_name_valid(name))
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is no name", name);
    fp3_param *param = find(params, name);
    if (!param) {
        fp3_param *list = realloc(params->list, (params->count + 1) * sizeof *list);
        if (!list)
            return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
        params->list = list;
        param = &list[params->count++];
    }
    strcpy(value.name, name);
    *param = value;
    return FP3_OK;
}

fp3_status fp3_params_put(fp3_params *params, const char *name, double value, fp3_error *error) {
    return put(params, name, (fp3_param){.value = value}, error);
}

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
        fp3_param param = {.value = 0};
        strcpy(param.of, text + 2);
        return put(params, name, param, error);
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
               (fp3_param){.value = number_of(first), .last = number_of(last), .is_spread = 1},
               error);
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

fp3_status fp3_params_read(fp3_params *params, const config_setting_t *from, const char *path,
                           fp3_error *error) {
    return put_all(params, from, path, put_setting, error);
}

fp3_status fp3_params_spread(fp3_params *params, const config_setting_t *from, const char *path,
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
        status = fp3_params_read(params, config_root_setting(&config), path, error);
    config_destroy(&config);
    return status;
}

fp3_status fp3_params_set(fp3_params *params, const char *text, fp3_error *error) {
    const char *equals = strchr(text, '=');
    char name[FP3_NAME_SIZE], *end;
    if (!equals || (size_t)(equals - text) >= sizeof name)
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is not name=value", text);
    memcpy(name, text, (size_t)(equals - text));
    name[equals - text] = '\0';
    double value = strtod(equals + 1, &end);
    if ((end == equals + 1 || *end) && fp3_constant_read(equals + 1, &value, NULL))
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s': '%s' is no number", text, equals + 1);
    return fp3_params_put(params, name, value, error);
}

/* Of an object, 0 for the first and 1 for the last. */
static double value_at(const fp3_param *param, double share) {
    return param->is_spread ? (1 - share) * param->value + share * param->last : param->value;
}

static fp3_status get(fp3_params *params, const char *name, double share, double *value,
                      int *is_spread, fp3_error *error) {
    fp3_param *param = find(params, name);
    if (!param)
        return fp3_fail(error, FP3_E_ARGUMENT, "parameter '%s' has no value", name);
    param->is_used = 1;
    *value = value_at(param, share);
    *is_spread = param->is_spread;
    if (!param->of[0])
        return FP3_OK;
    fp3_param *of = find(params, param->of);
    if (!of || of->of[0])
        return fp3_fail(error, FP3_E_ARGUMENT, "parameter '%s' is 1/%s, and '%s' is no number",
                        name, param->of, param->of);
    of->is_used = 1;
    *is_spread = of->is_spread;
    /* In double, then to FP32: the same as rounding once, for 53 >= 2 * 24 + 2. */
    *value = 1.0 / (double)(float)value_at(of, share);
    return FP3_OK;
}

fp3_status fp3_params_at(fp3_params *params, const char *name, double share, double *value,
                         int *is_spread, fp3_error *error) {
    return get(params, name, share, value, is_spread, error);
}

int fp3_params_has(const fp3_params *params, const char *name) {
    for (size_t i = 0; i < params->count; i++)
        if (strcmp(params->list[i].name, name) == 0)
            return 1;
    return 0;
}

void fp3_params_begin(fp3_params *params) {
    for (size_t i = 0; i < params->count; i++)
        params->list[i].is_used = 0;
}

fp3_status fp3_params_end(const fp3_params *params, fp3_error *error) {
    for (size_t i = 0; i < params->count; i++)
        if (!params->list[i].is_used)
            return fp3_fail(error, FP3_E_ARGUMENT, "the program has no parameter '%s'",
                            params->list[i].name);
    return FP3_OK;
}

fp3_status fp3_params_get(fp3_params *params, const char *name, double *value, fp3_error *error) {
    int is_spread;
    return get(params, name, 0, value, &is_spread, error);
}

/* The bits of a register or constant: an FP32 number, or the number of a step. */
static fp3_status word_of(const char *name, double value, int is_slept, uint32_t *bits,
                          fp3_error *error) {
    const float number = (float)value;
    if (is_slept && !(value >= 0 && value <= UINT32_MAX && floor(value) == value))
        return fp3_fail(error, FP3_E_ARGUMENT, "parameter '%s' is the number of a step, not %g",
                        name, value);
    if (isfinite(value) && !isfinite(number))
        return fp3_fail(error, FP3_E_ARGUMENT, "parameter '%s' is too large: %g", name, value);
    if (is_slept)
        *bits = (uint32_t)value;
    else
        memcpy(bits, &number, sizeof *bits);
    return FP3_OK;
}

/* What a symbol is for an object; is_spread: also for the others. */
static fp3_status word_at(fp3_params *params, const fp3_symbol *symbol, int is_slept, double share,
                          float *word, int *is_spread, fp3_error *error) {
    double value = 0;
    uint32_t bits = 0;
    fp3_status status = get(params, symbol->name, share, &value, is_spread, error);
    if (!status)
        status = word_of(symbol->name, value, is_slept, &bits, error);
    memcpy(word, &bits, sizeof *word);
    return status;
}

static fp3_status apply_shared(fp3_params *params, const fp3_params_target *to,
                               const fp3_symbol *symbol, fp3_error *error) {
    float word;
    int is_spread = 0;
    fp3_status status = word_at(params, symbol, 0, 0, &word, &is_spread, error);
    if (!status && is_spread)
        status = fp3_fail(error, FP3_E_ARGUMENT,
                          "parameter '%s' is spread, and the program has one for all objects",
                          symbol->name);
    return status ? status
                  : fp3_engine_write_shared_of(to->engine, to->group, symbol->index, 1, &word);
}

static fp3_status apply_object(fp3_params *params, const fp3_params_target *to,
                               const fp3_symbol *symbol, fp3_error *error) {
    const int is_slept = symbol->symbol_class == FP3_SYMBOL_STATE &&
                         (int)symbol->index == fp3_image_slept(to->image);
    float word = 0;
    int is_spread = 1;
    fp3_status status = FP3_OK;
    if (is_slept && !find(params, symbol->name))
        return FP3_OK;
    for (size_t i = 0; !status && i < to->objects; i++) {
        const double share = to->objects > 1 ? (double)i / (double)(to->objects - 1) : 0;
        if (is_spread)
            status = word_at(params, symbol, is_slept, share, &word, &is_spread, error);
        if (!status)
            status = fp3_engine_write(to->engine, to->first + i, 1, symbol->index, &word);
    }
    return status;
}

fp3_status fp3_params_apply_to(fp3_params *params, const fp3_params_target *to, fp3_error *error) {
    fp3_status status = FP3_OK;
    fp3_params_begin(params);
    for (uint32_t i = 0; i < to->image->symbol_count && !status; i++) {
        const fp3_symbol *symbol = &to->image->symbols[i];
        if (symbol->symbol_class == FP3_SYMBOL_SHARED)
            status = apply_shared(params, to, symbol, error);
        else if (FP3_CLASS(symbol->symbol_class) & FP3_CLASSES_HOST)
            status = apply_object(params, to, symbol, error);
    }
    return status ? status : fp3_params_end(params, error);
}

fp3_status fp3_params_apply(fp3_params *params, fp3_engine *engine, const fp3_image *image,
                            fp3_error *error) {
    const fp3_params_target all = {engine, image, 0, 0, fp3_engine_objects(engine)};
    return fp3_params_apply_to(params, &all, error);
}
