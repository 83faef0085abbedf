/* params.c - parameter files and --set. */
#include "params.h"

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

/* Adds or replaces; of may be NULL. */
static fp3_status put(fp3_params *params, const char *name, const char *of, double value,
                      fp3_error *error) {
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
    *param = (fp3_param){.value = value};
    strcpy(param->name, name);
    if (of)
        strcpy(param->of, of);
    return FP3_OK;
}

static fp3_status put_setting(fp3_params *params, const config_setting_t *setting,
                              fp3_error *error) {
    const char *name = config_setting_name(setting);
    switch (config_setting_type(setting)) {
    case CONFIG_TYPE_INT:
    case CONFIG_TYPE_INT64:
        return put(params, name, NULL, (double)config_setting_get_int64(setting), error);
    case CONFIG_TYPE_FLOAT:
        return put(params, name, NULL, config_setting_get_float(setting), error);
    case CONFIG_TYPE_STRING: {
        const char *text = config_setting_get_string(setting);
        if (strncmp(text, "1/", 2) == 0 && fp3_name_valid(text + 2))
            return put(params, name, text + 2, 0, error);
    }
    }
    return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is neither a number nor \"1/name\"", name);
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
    const config_setting_t *root = config_root_setting(&config);
    for (int i = 0; !status && i < config_setting_length(root); i++) {
        const config_setting_t *setting = config_setting_get_elem(root, (unsigned)i);
        fp3_error why;
        status = put_setting(params, setting, &why);
        if (status)
            fp3_fail(error, status, "%s:%d: %s", path, config_setting_source_line(setting),
                     why.text);
    }
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
    const double value = strtod(equals + 1, &end);
    if (end == equals + 1 || *end)
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s': '%s' is no number", text, equals + 1);
    return put(params, name, NULL, value, error);
}

fp3_status fp3_params_get(fp3_params *params, const char *name, double *value, fp3_error *error) {
    fp3_param *param = find(params, name);
    if (!param)
        return fp3_fail(error, FP3_E_ARGUMENT, "parameter '%s' has no value", name);
    param->is_used = 1;
    *value = param->value;
    if (!param->of[0])
        return FP3_OK;
    fp3_param *of = find(params, param->of);
    if (!of || of->of[0])
        return fp3_fail(error, FP3_E_ARGUMENT, "parameter '%s' is 1/%s, and '%s' is no number",
                        name, param->of, param->of);
    of->is_used = 1;
    /* In double, then to FP32: the same as rounding once, for 53 >= 2 * 24 + 2. */
    *value = 1.0 / (double)(float)of->value;
    return FP3_OK;
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

static fp3_status apply(fp3_params *params, fp3_engine *engine, const fp3_symbol *symbol,
                        int is_slept, fp3_error *error) {
    double value = 0;
    uint32_t bits = 0;
    float word;
    if (is_slept && !find(params, symbol->name))
        return FP3_OK;
    fp3_status status = fp3_params_get(params, symbol->name, &value, error);
    if (!status)
        status = word_of(symbol->name, value, is_slept, &bits, error);
    memcpy(&word, &bits, sizeof word);
    return status ? status : fp3_engine_set(engine, symbol->name, word);
}

fp3_status fp3_params_apply(fp3_params *params, fp3_engine *engine, const fp3_image *image,
                            fp3_error *error) {
    const int slept = fp3_image_slept(image);
    fp3_status status = FP3_OK;
    for (size_t i = 0; i < params->count; i++)
        params->list[i].is_used = 0;
    for (uint32_t i = 0; i < image->symbol_count && !status; i++) {
        const fp3_symbol *symbol = &image->symbols[i];
        const int is_slept = symbol->kind == FP3_SYMBOL_STATE && (int)symbol->index == slept;
        if (FP3_KIND(symbol->kind) & FP3_KINDS_HOST)
            status = apply(params, engine, symbol, is_slept, error);
    }
    for (size_t i = 0; i < params->count && !status; i++)
        if (!params->list[i].is_used)
            status = fp3_fail(error, FP3_E_ARGUMENT, "the program has no parameter '%s'",
                              params->list[i].name);
    return status;
}
