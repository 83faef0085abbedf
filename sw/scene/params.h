/* params.h - the values that a host gives a program, by name, from a file or the command line.
 *
 * A file is in libconfig's syntax, name = value; a value is a number or "1/name". In a scene values may
 * differ from object to object.
 */
#ifndef FP3_PARAMS_H
#define FP3_PARAMS_H

#include <fp3/engine.h>

typedef struct {
    char name[FP3_NAME_SIZE];
    char of[FP3_NAME_SIZE]; /* "1/of" if not empty */
    double value, last;     /* of the first object and, if that is another one, of the last */
    int is_spread, is_used;
} fp3_param;

typedef struct {
    fp3_param *list;
    size_t count;
} fp3_params; /* starts as {0} */

void fp3_params_free(fp3_params *params);

/* Both replace what was there. Messages of load begin with the path and the line; the text of set
 * is "name=value", where a value is a number or a constant expression like 2^-7. */
fp3_status fp3_params_load(fp3_params *params, const char *path, fp3_error *error);
fp3_status fp3_params_set(fp3_params *params, const char *text, fp3_error *error);
/* Likewise one number. */
fp3_status fp3_params_put(fp3_params *params, const char *name, double value, fp3_error *error);

/* The values of a group of settings in a file that has been read; path is for messages. spread: each
 * is [FIRST, LAST], of the first and the last object, and those between lie evenly between. */
struct config_setting_t;
fp3_status fp3_params_read(fp3_params *params, const struct config_setting_t *from,
                           const char *path, fp3_error *error);
fp3_status fp3_params_spread(fp3_params *params, const struct config_setting_t *from,
                             const char *path, fp3_error *error);

/* Whether there is a value of this name. */
int fp3_params_has(const fp3_params *params, const char *name);
/* The value of an object: share is 0 of the first to 1 of the last. */
fp3_status fp3_params_at(fp3_params *params, const char *name, double share, double *value,
                         int *is_spread, fp3_error *error);
/* Between the two, what is asked for is used; end refuses what is not. */
void fp3_params_begin(fp3_params *params);
fp3_status fp3_params_end(const fp3_params *params, fp3_error *error);
/* Of what is spread the first value. */
fp3_status fp3_params_get(fp3_params *params, const char *name, double *value, fp3_error *error);
/* Gives the engine's program all that it declares. Refused: one that has no value, and a value that
 * neither the program nor a reciprocal asks for. The register that `sleep` writes needs none: all
 * are awake; a value is the number of a step. */
fp3_status fp3_params_apply(fp3_params *params, fp3_engine *engine, const fp3_image *image,
                            fp3_error *error);
/* The same for a group of objects, of which the image is the program. */
typedef struct {
    fp3_engine *engine;
    const fp3_image *image;
    size_t group, first, objects;
} fp3_params_target;
fp3_status fp3_params_apply_to(fp3_params *params, const fp3_params_target *to, fp3_error *error);

#endif
