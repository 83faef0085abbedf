/* fp3/program.h - a program as a user names it: an image, assembly, or a model with an integrator.
 *
 *     fp3_program_def def = fp3_program_default();
 *     def.compile.config = "many_full";
 *     fp3_program *program = NULL;
 *     if (fp3_program_open("kepler.ode", &def, &program, NULL, &error) ||
 *         fp3_program_load(program, params, engine, &error) || fp3_engine_run(engine, 1000, NULL))
 *         fprintf(stderr, "%s\n", error.text);
 *     fp3_program_close(&program);
 */
#ifndef FP3_PROGRAM_H
#define FP3_PROGRAM_H

#include <fp3/adaptive.h>
#include <fp3/api.h>
#include <fp3/compile.h>
#include <fp3/engine.h>
#include <fp3/status.h>
#include <stddef.h>

FP3_API_BEGIN

/* The values that a host gives a program, by name.
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

/* ---- programs ---- */

/* How a model is compiled; of no effect on assembly and images. */
typedef struct {
    const char *integrator; /* a table or a file; NULL: FP3_FIXED_ or FP3_ADAPTIVE_INTEGRATOR */
    int is_model;           /* the program is a model, whatever its name */
    int is_adaptive;        /* the model is adapted (fp3/adaptive.h), as `adaptive` says */
    fp3_adaptive_def adaptive;
    fp3_compile_def compile;
} fp3_program_def;

/* Fixed steps, fp3_adaptive_default() and fp3_compile_default(). */
fp3_program_def fp3_program_default(void);

/* Read it, never change it. All that it points to belongs to it. */
typedef struct {
    fp3_image *image;
    fp3_compiled *compiled; /* NULL unless it is a model, as are the next two */
    fp3_model *model;
    fp3_integrator *integrator;
} fp3_program;

/* Whether the name ends in .ode, in letters of any case. */
int fp3_program_is_model(const char *path);
/* Whether it ends in .ode, .s or .fp3. */
int fp3_program_is_named(const char *path);

/* By the end of its name, in letters of any case: .ode is a model, .s assembly, all else an image; or
 * as def says. "-" is standard input. The caller closes
 * *program, which is NULL on failure. *report is as of fp3_model_load; report may be NULL. Messages
 * begin with the path. */
fp3_status fp3_program_open(const char *path, const fp3_program_def *def, fp3_program **program,
                            char **report, fp3_error *error);
/* The same of a model's text, which has size bytes; name is for messages. */
fp3_status fp3_program_read(const char *text, size_t size, const char *name,
                            const fp3_program_def *def, fp3_program **program, char **report,
                            fp3_error *error);
/* Sets *program to NULL; that it was NULL before does no harm. */
void fp3_program_close(fp3_program **program);

/* Loads the program into the engine, and gives all objects their values.
 * params names states, params and shared constants of the program; of a model its states, its params
 * and h, which have defaults. The register that `sleep` writes has one, too: awake; and so has `steps`
 * where a program counts them: 0. An object starts at time steps * h.
 * FP3_E_ARGUMENT: a value is missing, out of range, or for something that the program does not have.
 * After a failure the program may be loaded, and some of the values written. What the engine refuses
 * is told where its definition says, not in error. params may not be NULL. */
fp3_status fp3_program_load(const fp3_program *program, const fp3_params *params,
                            fp3_engine *engine, fp3_error *error);

/* Of a model, what the program gets of an object: compiled->input_count values. share: 0 of the first
 * object to 1 of the last. *is_spread: another share gives other values. */
fp3_status fp3_program_inputs(const fp3_program *program, const fp3_params *params, double share,
                              float *values, int *is_spread, fp3_error *error);

/* Of a model, a file for fp3_params_load: the values that the compiled program is given, those that are
 * computed from others (h, params) as formulas. The caller frees *text. */
fp3_status fp3_program_values_text(const fp3_program *program, const fp3_params *params,
                                   char **text, fp3_error *error);

FP3_API_END

#endif
