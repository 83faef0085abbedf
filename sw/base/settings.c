/* SPDX-License-Identifier: Apache-2.0 */
#include "settings.h"

#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "file.h"
#include "host.h"
#include "nearest.h"
#include "number.h"

/* ---- opening ---- */

static fp3_status parse(fp3_settings *s) {
    if (config_read_string(&s->file, s->spelled.text)) {
        s->root = config_root_setting(&s->file);
        return FP3_OK;
    }
    const char *why = config_error_text(&s->file);
    return fp3_fail_at(s->error, s->wrong, s->name, (unsigned)config_error_line(&s->file), 0,
                       "%s%s", why,
                       strcmp(why, "syntax error") == 0 ? ", expected settings as name = value;"
                       : strncmp(why, "mismatched element type", 23) == 0
                           ? ", expected ( ) around a list in which numbers and texts are mixed"
                           : "");
}

fp3_status fp3_settings_read(const char *text, size_t size, const char *name, fp3_status wrong,
                             fp3_settings *s, fp3_error *error) {
    *s = (fp3_settings){.name = name, .wrong = wrong, .error = error};
    config_init(&s->file);
    fp3_status status = fp3_spelled_open(text, size, name, &s->spelled, error);
    if (status == FP3_E_ARGUMENT)
        return wrong;
    return status ? status : parse(s);
}

fp3_status fp3_settings_load(const char *path, fp3_status wrong, fp3_settings *s,
                             fp3_error *error) {
    char *text = NULL;
    size_t size = 0;
    fp3_status status = fp3_file_read(path, &text, &size, error);
    if (status) {
        *s = (fp3_settings){0};
        config_init(&s->file);
        return status;
    }
    status = fp3_settings_read(text, size, path, wrong, s, error);
    s->source = text;
    return status;
}

void fp3_settings_close(fp3_settings *s) {
    config_destroy(&s->file);
    fp3_spelled_close(&s->spelled);
    free(s->source);
}

/* ---- messages ---- */

unsigned fp3_setting_line(const config_setting_t *setting) {
    const unsigned line = config_setting_source_line(setting);
    return line ? line : 1; /* the file as a whole has none */
}

fp3_status fp3_setting_wrong(const fp3_settings *s, const config_setting_t *at, const char *format,
                             ...) {
    char text[400];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return fp3_fail_at(s->error, s->wrong, s->name, fp3_setting_line(at), 0, "%s", text);
}

int fp3_setting_is_list(const config_setting_t *setting) {
    return config_setting_is_list(setting) || config_setting_is_array(setting);
}

int fp3_setting_is_number(const config_setting_t *setting) {
    return config_setting_type(setting) == CONFIG_TYPE_INT;
}

static fp3_token spelling(const fp3_settings *s, const config_setting_t *number) {
    return s->spelled.numbers[config_setting_get_int(number)];
}

/* "'1e6'", "a list [ ] of 2". */
static const char *found(const fp3_settings *s, const config_setting_t *setting,
                         char text[FP3_TOKEN_SHOWN_SIZE]) {
    switch (config_setting_type(setting)) {
    case CONFIG_TYPE_INT:
        return fp3_token_shown(spelling(s, setting), text);
    case CONFIG_TYPE_STRING:
        return "a text";
    case CONFIG_TYPE_BOOL:
        return "true or false";
    case CONFIG_TYPE_GROUP:
        return "a group { }";
    default:
        snprintf(text, FP3_TOKEN_SHOWN_SIZE, "a list %s of %d",
                 config_setting_is_array(setting) ? "[ ]" : "( )", config_setting_length(setting));
        return text;
    }
}

fp3_status fp3_setting_expected(const fp3_settings *s, const config_setting_t *at, const char *what,
                                const char *expected) {
    char text[FP3_TOKEN_SHOWN_SIZE];
    return fp3_setting_wrong(s, at, "%s: found %s, expected %s", what, found(s, at, text),
                             expected);
}

/* ---- names ---- */

const config_setting_t *fp3_setting_need(const fp3_settings *s, const char *key) {
    const config_setting_t *setting = config_setting_get_member(s->root, key);
    if (!setting)
        fp3_setting_wrong(s, s->root, "found no '%s', expected one", key);
    return setting;
}

static fp3_status unknown(const fp3_settings *s, const config_setting_t *setting, const char *where,
                          const char *const *names) {
    const char *name = config_setting_name(setting), *near = NULL;
    const fp3_token wanted = {.text = name, .length = strlen(name), .kind = FP3_TOKEN_NAME};
    char all[256] = "", shown[FP3_TOKEN_SHOWN_SIZE];
    for (size_t i = 0; names[i]; i++) {
        fp3_nearest(wanted, names[i], &near);
        snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", i ? ", " : "", names[i]);
    }
    return fp3_setting_wrong(s, setting, "found %s, expected a setting of %s: %s%s%s%s",
                             fp3_token_shown(wanted, shown), where, all,
                             near ? " (did you mean '" : "", near ? near : "", near ? "'?)" : "");
}

fp3_status fp3_setting_keys(const fp3_settings *s, const config_setting_t *group, const char *where,
                            const char *const *names) {
    for (int i = 0; i < config_setting_length(group); i++) {
        const config_setting_t *setting = config_setting_get_elem(group, (unsigned)i);
        size_t k = 0;
        while (names[k] && strcmp(config_setting_name(setting), names[k]) != 0)
            k++;
        if (!names[k])
            return unknown(s, setting, where, names);
    }
    return FP3_OK;
}

/* ---- values ---- */

fp3_status fp3_setting_text(const fp3_settings *s, const config_setting_t *setting,
                            const char *what, const char **text) {
    *text = config_setting_get_string(setting);
    return *text ? FP3_OK : fp3_setting_expected(s, setting, what, "a text in quotes");
}

fp3_status fp3_setting_flag(const fp3_settings *s, const config_setting_t *setting,
                            const char *what, int *flag) {
    if (config_setting_type(setting) != CONFIG_TYPE_BOOL)
        return fp3_setting_expected(s, setting, what, "true or false");
    *flag = config_setting_get_bool(setting);
    return FP3_OK;
}

static int is_digits(const char *text, const char *digits) {
    return *text && !text[strspn(text, digits)];
}

static int is_hex(const char *text) { return text[0] == '0' && (text[1] | 0x20) == 'x'; }

/* libconfig's syntax has an L or two behind a number that needs 64 bits; here it says nothing. */
static size_t without_suffix(const char *text) {
    size_t length = strlen(text);
    for (int i = 0; i < 2 && length > 1 && text[length - 1] == 'L'; i++)
        length--;
    return length;
}

/* NULL, or what is expected instead. */
static const char *read_integer(const char *text, uint64_t *integer) {
    char digits[FP3_NUMBER_SIZE];
    const size_t length = without_suffix(text);
    memcpy(digits, text, length);
    digits[length] = '\0';
    if (is_hex(digits) ? !is_digits(digits + 2, "0123456789abcdefABCDEF")
                       : !is_digits(digits, "0123456789"))
        return "a number as 2, 0.5, 1.5e-3 or 0x1f";
    errno = 0;
    *integer = strtoull(digits, NULL, is_hex(digits) ? 16 : 10);
    return errno ? "an integer below 2^64" : NULL;
}

static const char *read_number(const char *text, double *number) {
    uint64_t integer = 0;
    if (!is_hex(text) && !strchr(text, 'L'))
        return fp3_number_decimal(text, number);
    const char *expected = read_integer(text, &integer);
    *number = (double)integer;
    return expected;
}

/* *text is the number without its sign; NULL, or what is expected instead. */
static const char *spelled_text(const fp3_settings *s, const config_setting_t *setting,
                                char text[FP3_NUMBER_SIZE], int *is_negative) {
    if (!fp3_setting_is_number(setting))
        return "a number";
    fp3_token number = spelling(s, setting);
    *is_negative = *number.text == '-';
    if (*number.text == '-' || *number.text == '+') {
        number.text++;
        number.length--;
    }
    return fp3_number_copy(number, text);
}

fp3_status fp3_setting_number(const fp3_settings *s, const config_setting_t *setting,
                              const char *what, double *number) {
    char text[FP3_NUMBER_SIZE];
    int is_negative = 0;
    FP3_HOST;
    const char *expected = spelled_text(s, setting, text, &is_negative);
    if (!expected)
        expected = read_number(text, number);
    if (expected)
        return fp3_setting_expected(s, setting, what, expected);
    *number = is_negative ? -*number : *number;
    return FP3_OK;
}

fp3_status fp3_setting_count(const fp3_settings *s, const config_setting_t *setting,
                             const char *what, uint64_t least, uint64_t most, uint64_t *count) {
    char text[FP3_NUMBER_SIZE], wanted[80];
    int is_negative = 0;
    uint64_t found_count = 0;
    const char *expected = spelled_text(s, setting, text, &is_negative);
    if (!expected)
        expected = read_integer(text, &found_count);
    if (expected || is_negative || found_count < least || found_count > most) {
        snprintf(wanted, sizeof wanted, "an integer from %" PRIu64 " to %" PRIu64, least, most);
        return fp3_setting_expected(s, setting, what, wanted);
    }
    *count = found_count;
    return FP3_OK;
}
