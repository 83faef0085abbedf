/* SPDX-License-Identifier: Apache-2.0 */
/* fp3/program.h - a program as a user names it: an image, assembly, or a model with an integrator;
 * and the values that it gets.
 *
 *     fp3_program_def def = fp3_program_default();
 *     def.compile.config = "many_full";
 *     fp3_program *program = NULL;
 *     if (fp3_program_open("kepler.ode", &def, &program, NULL, &error) ||
 *         fp3_program_load(program, params, engine, &error) || fp3_engine_run(engine, 1000, NULL))
 *         fprintf(stderr, "%s\n", error.text);
 *     fp3_program_close(&program);
 *
 * Threads: any number of threads may read a program at the same time. Loading it into an engine
 * does not change it.
 */
#ifndef FP3_PROGRAM_H
#define FP3_PROGRAM_H

#include <fp3/compile.h>
#include <fp3/engine.h>
#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

FP3_API_BEGIN

/* The values that a host gives a program, by name.
 *
 *     fp3_params *params = NULL;
 *     if (fp3_params_make(&params, &error) || fp3_params_load(params, "ship.cfg", &error) ||
 *         fp3_params_set(params, "h=2^-7", &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     fp3_params_free(&params);
 *
 * A file is in libconfig's syntax, name = value. A value is a number, or a formula of numbers and
 * other names, such as "0.5*h". A later value replaces an earlier value, but a number does not
 * replace a formula: reading the value then fails, unless both are the same FP32 number.
 */
typedef struct fp3_params fp3_params;

/* Makes an empty set. The caller frees *params, which is NULL on failure. */
fp3_status fp3_params_make(fp3_params **params, fp3_error *error);
/* Likewise, with a copy of the values of another set. */
fp3_status fp3_params_copy(const fp3_params *from, fp3_params **params, fp3_error *error);
/* Frees *params and sets it to NULL. *params may be NULL already. */
void fp3_params_free(fp3_params **params);

/* Sets all values of a file. Messages begin with the path and the line. After a failure the values
 * before that line are set. */
fp3_status fp3_params_load(fp3_params *params, const char *path, fp3_error *error);
/* Sets one value. text is "name=value"; value is a number or a constant expression like 2^-7. */
fp3_status fp3_params_set(fp3_params *params, const char *text, fp3_error *error);
/* Spreads a value evenly over the objects, from the first to the last: "name=first:last". */
fp3_status fp3_params_spread(fp3_params *params, const char *text, fp3_error *error);
/* Like fp3_params_set, but with a number. */
fp3_status fp3_params_put(fp3_params *params, const char *name, double value, fp3_error *error);

/* Sets the links of a relation, which are copied and replace earlier ones. FP3_E_ARGUMENT: a field
 * is not finite; fp3_program_load finds all other mistakes. */
fp3_status fp3_params_link(fp3_params *params, const char *relation, const fp3_links *links,
                           fp3_error *error);
/* Likewise from a file, with "relation=file.csv": a head "a,b,field,..." and a line for each link
 * (docs/scenes.md). most: the number of objects; 0: not known yet. *objects: one more than the
 * highest number of an object, 0 without links. Messages begin with the path, the line and the
 * column. */
fp3_status fp3_params_link_file(fp3_params *params, const char *text, size_t most, size_t *objects,
                                fp3_error *error);

size_t fp3_params_count(const fp3_params *params);
int fp3_params_has(const fp3_params *params, const char *name);
/* Gets a value; of a spread value that of the first object. FP3_E_ARGUMENT: no such value, or its
 * formula cannot be computed; *value is unchanged. */
fp3_status fp3_params_get(const fp3_params *params, const char *name, double *value,
                          fp3_error *error);

/* ---- programs ---- */

/* How a model is compiled. Has no effect on assembly and images. Always start from
 * fp3_program_default(). */
typedef struct {
    uint32_t cookie;        /* as in fp3_compile_def */
    const char *integrator; /* a built-in table or a file; NULL: the default (fp3/compile.h) */
    int is_model;           /* treat the program as a model, whatever its name */
    int is_adaptive;        /* adapt the model (fp3/compile.h) with `adaptive` */
    fp3_adaptive_def adaptive;
    /* Its config may be NULL, the default: "world" if objects see each other, else `alone`. */
    fp3_compile_def compile;
    const char *alone; /* default "single_full" */
} fp3_program_def;

/* For fp3_program_default() only. size is that of fp3_program_def in the calling program. */
void fp3_program_set_default(fp3_program_def *def, size_t size);
/* Fixed steps, fp3_adaptive_default(), and fp3_compile_default() without a config. */
static inline fp3_program_def fp3_program_default(void) {
    fp3_program_def def;
    fp3_program_set_default(&def, sizeof def);
    return def;
}

/* Never change a program. Everything that it points to belongs to the program. */
typedef struct {
    fp3_image *image;
    fp3_compiled *compiled; /* this and the next two: NULL unless the program is a model */
    fp3_model *model;
    fp3_integrator *integrator;
    /* The configuration that a model was compiled for; if the definition names a configuration, its
     * string must outlive the program. For another program: "world" if its objects see each other,
     * else NULL (unknown). */
    const char *config;
    int sees_others; /* it has lists of neighbours, of its own group or of others */
    char *source;    /* of a model: the name that messages about it begin with */
} fp3_program;

/* Whether the name ends in .ode, in upper or lower case. */
int fp3_program_is_model(const char *path);
/* Whether the name ends in .ode, .s or .fp3, likewise. */
int fp3_program_is_named(const char *path);

/* Opens a program. The end of its name says what it is, in upper or lower case: .ode a model, .s
 * assembly, anything else an image; or def says so. "-" is standard input. The caller closes
 * *program, which is NULL on failure. *report is as for fp3_model_load; report may be NULL.
 * Messages begin with the path. FP3_E_ARGUMENT: also a definition from another version of the
 * library. */
fp3_status fp3_program_open(const char *path, const fp3_program_def *def, fp3_program **program,
                            char **report, fp3_error *error);
/* The same for the text of a model, which has size bytes. name appears in messages. */
fp3_status fp3_program_read(const char *text, size_t size, const char *name,
                            const fp3_program_def *def, fp3_program **program, char **report,
                            fp3_error *error);
/* Closes *program and sets it to NULL. *program may be NULL already. */
void fp3_program_close(fp3_program **program);

/* ---- groups that see each other (docs/relations.md#kinds) ---- */

/* A group of a scene. */
typedef struct {
    const char *name; /* what a line `kind` of another model calls it; NULL: none does */
    fp3_program *program;
    const fp3_program_def *def; /* that it was opened with */
} fp3_joined;

/* Compiles the programs of groups that see each other again, until their phases fit each other, and
 * puts what is compiled in the place of what was; the images of before are freed. Programs of
 * groups that see no other group and that none sees stay as they are. FP3_E_PROGRAM: a kind is no
 * other group's name, or that of two; a word that the other model has not, or with another unit or
 * size; a group that is no model; different integrators, or double-single in one; adaptive steps in
 * one; or what fp3_compile refuses. Models with adaptive steps get the states and params that one
 * of them needs (docs/adaptive.md). Messages begin with the model's name and the line. After a
 * failure each program is whole, but they do not fit each other. */
fp3_status fp3_programs_join(const fp3_joined *list, size_t count, fp3_error *error);

/* What the program of list[of] reads of other groups, once they are joined: `group` is an index in
 * the list. The caller frees *foreign; its names belong to the programs. */
fp3_status fp3_program_foreign(const fp3_joined *list, size_t count, size_t of,
                               fp3_foreign **foreign, size_t *foreign_count, fp3_error *error);

/* Loads the program into the engine, and gives all objects their values. params names states,
 * params and shared constants of the program. For a model params names the model's states, its
 * params and h, which all have defaults. The register that `sleep` writes (awake) and `steps` (0)
 * have defaults, too. An object starts at time steps * h. Relations `all` and `near` need no
 * values. Each relation of links, and each list of an image, needs links: fp3_params_link.
 * FP3_E_ARGUMENT: a value or links are missing, out of range, or for a name that the program does
 * not have. After a failure the program may be loaded, and some of the values written. If the
 * engine refuses a call, error has the message as well as the error of the engine's definition.
 * params may not be NULL. */
fp3_status fp3_program_load(const fp3_program *program, const fp3_params *params,
                            fp3_engine *engine, fp3_error *error);

/* For a model: the compiled->input_count values that the program gets for one object. share: from
 * 0, the first object, to 1, the last. *is_spread: whether another share gives other values. */
fp3_status fp3_program_inputs(const fp3_program *program, const fp3_params *params, double share,
                              float *values, int *is_spread, fp3_error *error);

/* For a model: the text of a file for fp3_params_load, with the values that the compiled program
 * needs. Values that are computed from h and params are written as formulas. The caller frees
 * *text. */
fp3_status fp3_program_values_text(const fp3_program *program, const fp3_params *params,
                                   char **text, fp3_error *error);

FP3_API_END

#endif
