#include "setting.h"

#include <fp3/model.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>

fp3_status fp3_setting_wrong(const fp3_settings *s, const config_setting_t *at, const char *format,
                             ...) {
    char text[400];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    const unsigned line = config_setting_source_line(at);
    return fp3_fail(s->error, FP3_E_PROGRAM, "%s:%u: %s", s->name, line ? line : 1, text);
}

const char *fp3_setting_type(const config_setting_t *setting) {
    switch (config_setting_type(setting)) {
    case CONFIG_TYPE_INT:
    case CONFIG_TYPE_INT64:
        return "an integer";
    case CONFIG_TYPE_FLOAT:
        return "a number";
    case CONFIG_TYPE_STRING:
        return "a string";
    case CONFIG_TYPE_BOOL:
        return "true or false";
    case CONFIG_TYPE_GROUP:
        return "a group { }";
    default:
        return "a list ( )";
    }
}

int fp3_setting_is_list(const config_setting_t *setting) {
    return config_setting_is_list(setting) || config_setting_is_array(setting);
}

const config_setting_t *fp3_setting_need(const fp3_settings *s, const char *key) {
    const config_setting_t *setting = config_setting_get_member(s->root, key);
    if (!setting)
        fp3_setting_wrong(s, s->root, "found no '%s', expected one", key);
    return setting;
}

fp3_status fp3_setting_text(const fp3_settings *s, const char *key, const char **text) {
    const config_setting_t *setting = fp3_setting_need(s, key);
    if (!setting)
        return FP3_E_PROGRAM;
    *text = config_setting_get_string(setting);
    return *text ? FP3_OK
                 : fp3_setting_wrong(s, setting, "%s: found %s, expected a string", key,
                                     fp3_setting_type(setting));
}

fp3_status fp3_setting_number(const fp3_settings *s, const config_setting_t *setting,
                              const char *what, double *number) {
    switch (config_setting_type(setting)) {
    case CONFIG_TYPE_INT:
    case CONFIG_TYPE_INT64:
        *number = (double)config_setting_get_int64(setting);
        break;
    case CONFIG_TYPE_FLOAT:
        *number = config_setting_get_float(setting);
        break;
    case CONFIG_TYPE_STRING: {
        fp3_error why;
        if (fp3_constant_read(config_setting_get_string(setting), number, &why))
            return fp3_setting_wrong(s, setting, "%s: %s", what, why.text);
        break;
    }
    default:
        return fp3_setting_wrong(s, setting,
                                 "%s: found %s, expected a number or a string like \"1/6\"", what,
                                 fp3_setting_type(setting));
    }
    return isfinite(*number)
               ? FP3_OK
               : fp3_setting_wrong(s, setting, "%s: found %g, expected a finite number", what,
                                   *number);
}
