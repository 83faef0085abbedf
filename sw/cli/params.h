/* params.h - the values that a host gives a program, by name, from a file or the command line.
 *
 * A file is in libconfig's syntax, name = value; a value is a number or "1/name".
 */
#ifndef FP3_PARAMS_H
#define FP3_PARAMS_H

#include <fp3/engine.h>

typedef struct {
    char name[FP3_NAME_SIZE];
    char of[FP3_NAME_SIZE]; /* "1/of" if not empty */
    double value;
    int is_used;
} fp3_param;

typedef struct {
    fp3_param *list;
    size_t count;
} fp3_params; /* starts as {0} */

void fp3_params_free(fp3_params *params);

/* Both replace what was there. Messages of load begin with the path and the line; the text of set
 * is "name=value". */
fp3_status fp3_params_load(fp3_params *params, const char *path, fp3_error *error);
fp3_status fp3_params_set(fp3_params *params, const char *text, fp3_error *error);

fp3_status fp3_params_get(fp3_params *params, const char *name, double *value, fp3_error *error);
/* Gives the engine's program all that it declares. Refused: one that has no value, and a value that
 * neither the program nor a reciprocal asks for. The register that `sleep` writes needs none: all
 * are awake; a value is the number of a step. */
fp3_status fp3_params_apply(fp3_params *params, fp3_engine *engine, const fp3_image *image,
                            fp3_error *error);

#endif
