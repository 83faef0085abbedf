/* SPDX-License-Identifier: Apache-2.0 */
/* apply.h - a program's values to an engine. */
#ifndef FP3_SCENE_APPLY_H
#define FP3_SCENE_APPLY_H

#include <fp3/program.h>

/* Objects of an engine that run the program: a group of it. */
typedef struct {
    fp3_engine *engine;
    size_t group, first, objects;
    double *h; /* NULL, or where the length of a model's step goes */
} fp3_apply_to;

/* How many words a model's program has of a value: 2 in double-single (fp3_number_given). */
unsigned fp3_program_words(const fp3_program *program);

/* What objects of a model are given, one after the other. */
typedef struct {
    const fp3_program *program;
    const fp3_params *given;
    char *is_varied; /* of each param, then of each state: other objects have another value */
    int is_begun;    /* an object was asked */
    /* Of the object that was asked last: */
    double *params, *initial, h, steps;
    double *values; /* of the model's expressions, then params as the program has them */
    int is_spread;  /* some object has others */
} fp3_object_values;

/* Both must outlive it. The caller frees *of, after a failure too. */
fp3_status fp3_object_values_open(const fp3_program *program, const fp3_params *given,
                                  fp3_object_values *of, fp3_error *error);
/* Those of the object with this share, as of fp3_program_inputs. */
fp3_status fp3_object_values_at(fp3_object_values *of, double share, fp3_error *error);
/* Its inputs, as fp3_program_inputs. */
fp3_status fp3_object_values_inputs(const fp3_object_values *of, float *inputs, fp3_error *error);
/* Leaves {0}, which may be freed as well. */
void fp3_object_values_free(fp3_object_values *of);

/* Writes all that the program declares, as fp3_program_load does. error is unchanged if the engine
 * has reported the reason. */
fp3_status fp3_apply(const fp3_program *program, const fp3_params *params, const fp3_apply_to *to,
                     fp3_error *error);

#endif
