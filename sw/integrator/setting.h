/* setting.h - values of a text in libconfig's syntax, and messages that name their lines. */
#ifndef FP3_SETTING_H
#define FP3_SETTING_H

#include <fp3/status.h>
#include <libconfig.h>

typedef struct {
    const char *name; /* of the text, for messages */
    const config_setting_t *root;
    fp3_error *error;
} fp3_settings;

/* "name:line: ..."; returns FP3_E_PROGRAM. */
__attribute__((format(printf, 3, 4))) fp3_status
fp3_setting_wrong(const fp3_settings *s, const config_setting_t *at, const char *format, ...);

/* "an integer", "a list ( )". */
const char *fp3_setting_type(const config_setting_t *setting);
int fp3_setting_is_list(const config_setting_t *setting);

/* The setting, or NULL with an error. */
const config_setting_t *fp3_setting_need(const fp3_settings *s, const char *key);
fp3_status fp3_setting_text(const fp3_settings *s, const char *key, const char **text);
/* A finite number, or a formula in a string; what is its name in a message: "b[2]". */
fp3_status fp3_setting_number(const fp3_settings *s, const config_setting_t *setting,
                              const char *what, double *number);

#endif
