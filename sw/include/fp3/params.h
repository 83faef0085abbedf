/* fp3/params.h - the values that a host gives a program, by name.
 *
 *     fp3_params *params = NULL;
 *     if (fp3_params_make(&params, &error) || fp3_params_load(params, "ship.cfg", &error) ||
 *         fp3_params_set(params, "h=2^-7", &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     fp3_params_free(&params);
 *
 * A file is in libconfig's syntax, name = value; a value is a number, or a formula of numbers and
 * other names, "0.5*h". A value that is set again replaces the one before; but a number does not
 * replace a formula: whoever asks for the value is refused unless both are the same FP32 number.
 */
#ifndef FP3_PARAMS_H
#define FP3_PARAMS_H

#include <fp3/api.h>
#include <fp3/status.h>
#include <stddef.h>

FP3_API_BEGIN

typedef struct fp3_params fp3_params;

/* Without values at first. The caller frees *params, which is NULL on failure. */
fp3_status fp3_params_make(fp3_params **params, fp3_error *error);
/* Likewise with the values of others, which stay as they are. */
fp3_status fp3_params_copy(const fp3_params *from, fp3_params **params, fp3_error *error);
/* Sets *params to NULL; that it was NULL before does no harm. */
void fp3_params_free(fp3_params **params);

/* All values of a file. Messages begin with the path and the line. After a failure the values in
 * front of that line are set. */
fp3_status fp3_params_load(fp3_params *params, const char *path, fp3_error *error);
/* One value; text is "name=value", value a number or a constant expression like 2^-7. */
fp3_status fp3_params_set(fp3_params *params, const char *text, fp3_error *error);
/* Of the first and the last object, as "name=first:last"; those between lie evenly between. */
fp3_status fp3_params_spread(fp3_params *params, const char *text, fp3_error *error);
/* As fp3_params_set, with a number. */
fp3_status fp3_params_put(fp3_params *params, const char *name, double value, fp3_error *error);

size_t fp3_params_count(const fp3_params *params);
int fp3_params_has(const fp3_params *params, const char *name);
/* A value that differs from object to object (`spread` in a scene): that of the first object.
 * FP3_E_ARGUMENT: no such value, or its formula has none; *value is unchanged. */
fp3_status fp3_params_get(const fp3_params *params, const char *name, double *value,
                          fp3_error *error);

FP3_API_END

#endif
