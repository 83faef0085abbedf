/* SPDX-License-Identifier: Apache-2.0 */
/* settings.h - files in libconfig's syntax, the one reader of scenes, values and tables.
 *
 * Numbers are read here, from their spelling, and never by libconfig: an integer has as many digits
 * as it needs, and what double or the caller has no room for is refused. Messages are
 * "name:line: what: found ..., expected ...".
 */
#ifndef FP3_SETTINGS_H
#define FP3_SETTINGS_H

#include "spelled.h"

#include <libconfig.h>
#include <stdint.h>

typedef struct {
    const char *name; /* of the text, for messages */
    const config_setting_t *root;
    fp3_error *error;
    fp3_status wrong; /* what a wrong setting is */
    config_t file;
    char *source; /* NULL if it is the caller's */
    fp3_spelled spelled;
} fp3_settings;

/* From a text, which must outlive the settings, as must name. wrong is the status of what is wrong
 * with it. The caller closes *settings, also after a failure. */
fp3_status fp3_settings_read(const char *text, size_t size, const char *name, fp3_status wrong,
                             fp3_settings *settings, fp3_error *error);
/* From a file. */
fp3_status fp3_settings_load(const char *path, fp3_status wrong, fp3_settings *settings,
                             fp3_error *error);
void fp3_settings_close(fp3_settings *settings);

unsigned fp3_setting_line(const config_setting_t *setting);
/* "name:line: ..."; returns settings->wrong. */
__attribute__((format(printf, 3, 4))) fp3_status
fp3_setting_wrong(const fp3_settings *s, const config_setting_t *at, const char *format, ...);
/* "what: found ..., expected ..." */
fp3_status fp3_setting_expected(const fp3_settings *s, const config_setting_t *at, const char *what,
                                const char *expected);

int fp3_setting_is_list(const config_setting_t *setting);
int fp3_setting_is_number(const config_setting_t *setting);

/* The setting, or NULL with an error. */
const config_setting_t *fp3_setting_need(const fp3_settings *s, const char *key);
/* Whether all names are among those expected: up to a NULL, with the nearest for one that is not.
 */
fp3_status fp3_setting_keys(const fp3_settings *s, const config_setting_t *group, const char *where,
                            const char *const *names);

/* what is the setting's name in a message: "steps", "b[2]". */
fp3_status fp3_setting_text(const fp3_settings *s, const config_setting_t *setting,
                            const char *what, const char **text);
fp3_status fp3_setting_flag(const fp3_settings *s, const config_setting_t *setting,
                            const char *what, int *flag);
/* A finite number: decimal, or hexadecimal up to 64 bits. */
fp3_status fp3_setting_number(const fp3_settings *s, const config_setting_t *setting,
                              const char *what, double *number);
/* An integer, written as one: 1e6 is none. */
fp3_status fp3_setting_count(const fp3_settings *s, const config_setting_t *setting,
                             const char *what, uint64_t least, uint64_t most, uint64_t *count);

#endif
