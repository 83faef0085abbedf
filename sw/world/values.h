/* SPDX-License-Identifier: Apache-2.0 */
/* values.h - the values of fp3_params, as scenes write them and programs read them. */
#ifndef FP3_SCENE_VALUES_H
#define FP3_SCENE_VALUES_H

#include <fp3/program.h>

#include "base/settings.h"

/* Puts the values of a group of settings. spread: each is [FIRST, LAST], of the first and the last
 * object; the other values lie evenly between. */
fp3_status fp3_values_read(fp3_params *params, const fp3_settings *s, const config_setting_t *from);
fp3_status fp3_values_spread(fp3_params *params, const fp3_settings *s,
                             const config_setting_t *from);

/* A value of its own for each of `count` objects, which is copied. path, line: where it was given,
 * or NULL. */
fp3_status fp3_values_column(fp3_params *params, const char *name, const double *column,
                             size_t count, const char *path, unsigned line, fp3_error *error);

/* Where messages about values point that no file has set. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_values_place(fp3_params *params, const char *path, unsigned line, fp3_error *error);
/* FP3_E_ARGUMENT, "path:line: ..." with the place where the value was set, if there is one. */
__attribute__((format(printf, 4, 5))) fp3_status fp3_value_wrong(const fp3_params *params,
                                                                 const char *name, fp3_error *error,
                                                                 const char *format, ...);

/* The value of an object; share is 0 of the first to 1 of the last. A formula uses other values as
 * rounded by a program with these words (fp3_number_given). *is_spread: another share gives another
 * value. */
fp3_status fp3_values_at(const fp3_params *params, const char *name, double share, unsigned words,
                         double *value, int *is_spread, fp3_error *error);
/* How many words a program has of a value: 2 in double-single, where states have a second one. */
unsigned fp3_values_words(const fp3_image *image);

/* Of lists of near objects, as a share of the reach (the setting `skin`). */
void fp3_values_skin(fp3_params *params, double skin);

/* A given value. formula: NULL, or the formula of the value; without a formula the value is `first`
 * or, if spread, `first` of the first object to `last` of the last. */
typedef struct {
    const char *name, *formula;
    double first, last;
    int is_spread;
    size_t
        objects; /* objects with values of their own, so that first and last are unused; 0: none */
} fp3_value_look;
/* By number, in the order in which the names were first given; 0: there are no more. */
int fp3_values_look(const fp3_params *params, size_t number, fp3_value_look *look);

/* Rejects a value that the program does not use, neither directly (has(of, name)) nor through its
 * reciprocal. */
typedef int fp3_values_has_fn(const void *of, const char *name);
fp3_status fp3_values_check(const fp3_params *params, fp3_values_has_fn *has, const void *of,
                            fp3_error *error);

#endif
