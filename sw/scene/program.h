/* program.h - a program as a user names it: an image, assembly, or a model with an integrator.
 *
 *     fp3_program_source source;
 *     if (fp3_program_load("kepler.ode", &(fp3_program_def){.config = "single_full"}, &source, &error))
 *         return fp3_fail(...);
 *     ... fp3_engine_load(engine, source.image) ...
 *     if (fp3_program_apply(&source, &params, &target, &error)) ...
 *     fp3_program_close(&source);
 */
#ifndef FP3_PROGRAM_H
#define FP3_PROGRAM_H

#include <fp3/compile.h>

#include "params.h"

typedef struct {
    const char *config;     /* that a model is compiled for */
    const char *integrator; /* NULL: rk4 */
    int is_compensated;
} fp3_program_def;

typedef struct {
    const fp3_image *image;
    fp3_image *own;   /* of assembly and images */
    fp3_model *model; /* NULL unless it is one */
    fp3_integrator *integrator;
    fp3_compiled *compiled;
} fp3_program_source;

int fp3_program_is_model(const char *path);
/* Whether the name ends in .ode, .s or .fp3. */
int fp3_program_is_known(const char *path);

/* By the end of its name: .s, .ode, else an image. The caller closes, after a failure too. Messages begin with
 * the path. */
fp3_status fp3_program_load(const char *path, const fp3_program_def *def,
                            fp3_program_source *source, fp3_error *error);
void fp3_program_close(fp3_program_source *source);

/* Of a model: what the program gets of an object, as many as compiled->input_count. params names params, states
 * and h of the model, all of which have defaults; share: 0 of the first object to 1 of the last. *is_spread: it depends
 * on share. FP3_E_ARGUMENT: a value for something else. */
fp3_status fp3_program_inputs(const fp3_program_source *source, fp3_params *params, double share,
                              float *values, int *is_spread, fp3_error *error);

/* Writes all that the program declares for the objects: fp3_params_apply_to, but of a model. */
fp3_status fp3_program_apply(const fp3_program_source *source, fp3_params *params,
                             const fp3_params_target *to, fp3_error *error);

#endif
