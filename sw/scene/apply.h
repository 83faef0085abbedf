/* apply.h - a program's values to an engine. */
#ifndef FP3_SCENE_APPLY_H
#define FP3_SCENE_APPLY_H

#include <fp3/program.h>

/* Objects of an engine that run the program: a group of it. */
typedef struct {
    fp3_engine *engine;
    size_t group, first, objects;
} fp3_apply_to;

/* What the inputs of an object of a model are computed from. */
typedef struct {
    double *params, *initial, h;
    int is_spread;
} fp3_object_values;

/* Those of the object with this share, and its inputs. The caller frees *of, after a failure too. */
fp3_status fp3_apply_values(const fp3_program *program, const fp3_params *params, double share,
                            fp3_object_values *of, float *values, fp3_error *error);
void fp3_object_values_free(fp3_object_values *of);

/* Writes all that the program declares, as fp3_program_load does. error stays as it is where the
 * engine has said why. */
fp3_status fp3_apply(const fp3_program *program, const fp3_params *params, const fp3_apply_to *to,
                     fp3_error *error);

#endif
