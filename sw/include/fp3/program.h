/* SPDX-License-Identifier: Apache-2.0 */
/* fp3/program.h - a program as a user names it: an image, assembly, or a model with an integrator.
 *
 *     fp3_program_def def = fp3_program_default();
 *     def.compile.config = "many_full";
 *     fp3_program *program = NULL;
 *     if (fp3_program_open("kepler.ode", &def, &program, NULL, &error) ||
 *         fp3_program_load(program, params, engine, &error) || fp3_engine_run(engine, 1000, NULL))
 *         fprintf(stderr, "%s\n", error.text);
 *     fp3_program_close(&program);
 *
 * Threads: any number of threads may read a program or a scene at the same time. Loading it into an
 * engine does not change it.
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
 * other names, such as "0.5*h". A later value replaces an earlier one, but a number does not
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
/* Gets a value; that of the first object if it is spread. FP3_E_ARGUMENT: there is no such value,
 * or its formula has none; *value is unchanged. */
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

/* Read it, never change it. Everything that it points to belongs to it. */
typedef struct {
    fp3_image *image;
    fp3_compiled *compiled; /* this and the next two: NULL unless the program is a model */
    fp3_model *model;
    fp3_integrator *integrator;
    /* The configuration that a model was compiled for; the string of the definition, if that names
     * one, must outlive the program. For another program: "world" if its objects see each other,
     * else NULL (unknown). */
    const char *config;
    int sees_others; /* its objects see each other (docs/relations.md) */
} fp3_program;

/* Whether the name ends in .ode, in upper or lower case. */
int fp3_program_is_model(const char *path);
/* Whether it ends in .ode, .s or .fp3, likewise. */
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

/* Loads the program into the engine, and gives all objects their values. params names states,
 * params and shared constants of the program. For a model it names the model's states, its params
 * and h, which all have defaults. So do the register that `sleep` writes (awake) and `steps`, if
 * the program counts them (0). An object starts at time steps * h. Relations `all` and `near` need
 * nothing. Links must be given for each relation of links, and for each list of an image:
 * fp3_params_link. FP3_E_ARGUMENT: a value or links are missing, out of range, or for something
 * that the program does not have. After a failure the program may be loaded, and some of the values
 * written. If the engine refuses something, error has the message as well as the error of the
 * engine's definition. params may not be NULL. */
fp3_status fp3_program_load(const fp3_program *program, const fp3_params *params,
                            fp3_engine *engine, fp3_error *error);

/* For a model: the compiled->input_count values that the program gets for one object. share: from
 * 0, the first object, to 1, the last. *is_spread: whether another share gives other values. */
fp3_status fp3_program_inputs(const fp3_program *program, const fp3_params *params, double share,
                              float *values, int *is_spread, fp3_error *error);

/* For a model: the text of a file for fp3_params_load, with the values that the compiled program
 * needs. Values that are computed from others (h, params) are written as formulas. The caller frees
 * *text. */
fp3_status fp3_program_values_text(const fp3_program *program, const fp3_params *params,
                                   char **text, fp3_error *error);

/* ---- scenes: groups of objects, each with a program and values, from a file ----
 *
 *     fp3_error error;
 *     fp3_scene *scene = NULL;
 *     fp3_status status = fp3_scene_open("mixed.scene", NULL, &scene, &error);
 *     if (status)
 *         return fp3_exit_code(status);
 *     fp3_engine_def def = fp3_scene_engine(scene);
 *     def.error = &error;
 *     fp3_engine *engine = NULL;
 *     float x;
 *     if (fp3_engine_open(&def, &engine) || fp3_scene_load(scene, engine, &error) ||
 *         fp3_engine_advance(engine, scene->steps, NULL) || fp3_engine_get(engine, 0, "x", &x))
 *         fprintf(stderr, "%s\n", error.text);
 *     fp3_engine_close(&engine);
 *     fp3_scene_close(&scene);
 *
 * docs/scenes.md describes the file.
 */

/* The steps of a group's first and last object. Those of the others lie evenly between, rounded
 * down. */
typedef struct {
    uint64_t first, last;
} fp3_scene_steps;

typedef struct {
    char *path;                          /* of the program */
    char *integrator_file, *params_file; /* NULL if none was read */
    char **files;                        /* of points and links that were read */
    size_t file_count;
    fp3_program *program;
    /* The values in the file. More may be set before fp3_scene_load. */
    fp3_params *params;
    size_t first, objects; /* the group is objects first .. first + objects - 1 */
    /* See fp3_engine_live. The defaults are born {0, 0} and gone {FP3_FOREVER, FP3_FOREVER}. */
    fp3_scene_steps born, gone;
    int line; /* of the scene file */
} fp3_scene_group;

/* Read it, never change it, except for params. Everything that it points to belongs to it. */
typedef struct {
    char *path, *config, *engine;
    uint64_t steps;
    uint32_t visit; /* steps per visit; 0: all steps */
    uint32_t seed;  /* as in fp3_engine_def */
    fp3_scene_group *groups;
    size_t group_count, objects;
    int line; /* of `groups` in the file */
} fp3_scene;

/* Reads the file and opens all its programs. config replaces the file's unless it is NULL. Defaults
 * of the file: config "world" if objects of the first group's model see each other; engine "rtl",
 * or "fast" with a configuration for such objects; steps 1 (FP3_ADAPTIVE_ATTEMPTS if all groups are
 * adaptive); visit 0; seed 0. The caller closes *scene, which is NULL on failure. Messages begin
 * with the path and the line of the file. */
fp3_status fp3_scene_open(const char *path, const char *config, fp3_scene **scene,
                          fp3_error *error);
/* Closes *scene and sets it to NULL. *scene may be NULL already. */
void fp3_scene_close(fp3_scene **scene);

/* The lifetime of one object of a group; object is 0 .. objects - 1. */
void fp3_scene_life(const fp3_scene_group *group, size_t object, uint64_t *born, uint64_t *gone);

/* For fp3_scene_engine() only: writes what the scene says into a definition of this version. */
void fp3_scene_set_engine(const fp3_scene *scene, fp3_engine_def *def);
/* The definition of an engine for the scene: fp3_engine_default() with the scene's engine,
 * configuration, objects and visit. The scene must outlive the engine. */
static inline fp3_engine_def fp3_scene_engine(const fp3_scene *scene) {
    fp3_engine_def def = fp3_engine_default();
    fp3_scene_set_engine(scene, &def);
    return def;
}

/* Loads programs, values and lifetimes into an engine that has as many objects as the scene. If the
 * engine refuses something, error has the message as well as the error of the engine's definition;
 * the message begins with the path and the line of `groups`. FP3_E_ARGUMENT: also if the run has to
 * be split (objects have lifetimes, or only some groups have adaptive steps), and the first or last
 * part of a program does more than prepare and complete values. */
fp3_status fp3_scene_load(const fp3_scene *scene, fp3_engine *engine, fp3_error *error);

/* ---- recordings: named values of all objects after chosen steps, in a file ----
 *
 *     fp3_recording_def def = fp3_recording_default();
 *     def.path = "ship.csv";
 *     def.steps = 1000;
 *     def.every = 10;
 *     fp3_recording *recording = NULL;
 *     fp3_cost cost;
 *     if (fp3_program_load(program, params, engine, &error) ||
 *         fp3_recording_open(&def, program, params, engine, &recording, &error) ||
 *         fp3_recording_run(recording, &cost, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     fp3_recording_close(&recording);
 *
 * docs/outputs.md describes the files.
 */

typedef struct fp3_recording fp3_recording;

/* What to record. Always start from fp3_recording_default(). The caller owns what it points to,
 * which must last until fp3_recording_open returns. */
typedef struct {
    uint32_t cookie; /* as in fp3_compile_def */
    /* A file, a picture, or both; NULL: none. The name of a file says its form
     * (docs/outputs.md); "-" is standard output. A picture shows at most 8 objects; its name ends
     * in .svg or .png, and gnuplot draws it. */
    const char *path, *plot;
    /* Names of states, and of a model's definitions and invariants. NULL (default): the states of
     * the model, or all states of another program. */
    const char *const *observed;
    size_t observed_count;
    uint64_t steps; /* of the run, as for fp3_engine_run; default 1 */
    /* Without times: a snapshot before the run, one after each `every` steps, and one at the end. 0
     * (default): only the first and the last; some 1000 for a picture. */
    uint64_t every;
    /* Snapshots only at these times, ascending, from the start of the run, in the unit of h; or
     * NULL. Fixed steps: whole multiples of h (fp3_recording_steps). Adaptive steps (fp3/compile.h)
     * need times, which may be any: objects end there and go on, and `steps` limits the attempts
     * from one time to the next. */
    const double *times;
    size_t time_count;
    int is_compressed; /* HDF5 only */
    int is_silent;     /* writes nothing, because another process of a cluster writes the file */
    /* Checkpoints (docs/checkpoints.md), in a recording or alone. Without path and plot there may
     * be several groups, and then the program is NULL. The file gets the whole state after each
     * `checkpoint_every` steps (0: none of these) and at the end; the checkpoint before stays as
     * checkpoint.1. NULL (default): no checkpoints. Not with adaptive steps. */
    const char *checkpoint;
    uint64_t checkpoint_every;
    /* A checkpoint of the same run, from which it goes on; NULL (default): from the start. */
    const char *restart;
    /* A text that checkpoints keep: the arguments of fp3 run, one a line; or NULL. */
    const char *command;
    struct fp3_expected *expected; /* NULL; fp3 verify has some */
} fp3_recording_def;

/* For fp3_recording_default() only. size is that of fp3_recording_def in the calling program. */
void fp3_recording_set_default(fp3_recording_def *def, size_t size);
static inline fp3_recording_def fp3_recording_default(void) {
    fp3_recording_def def;
    fp3_recording_set_default(&def, sizeof def);
    return def;
}

/* The number of steps of a run to the last of these times. Times must be whole multiples of h, to
 * within rounding of h and of the time. FP3_E_ARGUMENT: one is not; error names the nearest two. */
fp3_status fp3_recording_steps(const fp3_program *program, const fp3_params *params,
                               const double *times, size_t count, uint64_t *steps,
                               fp3_error *error);

/* The part of one group. */
typedef struct {
    fp3_failure failure;
    uint64_t object_steps;
} fp3_group_cost;

/* The cost of the whole run from its start or restart, and the objects that failed in it, also
 * before the restart. */
typedef struct {
    fp3_stats stats; /* sums over the parts of the run; cycles: sum of each part's maximum */
    /* Over all parts, as fp3_engine_failure; with adaptive steps see fp3_adaptive_report_make. A
     * state that is not finite at a snapshot is a failure. */
    fp3_failure failure;
    /* For each of stats.schedulers schedulers. Belongs to the recording. */
    const uint64_t (*counter)[FP3_COUNTER_COUNT];
    const fp3_group_cost *groups; /* of each group; belongs to the recording */
    /* SHA-256 in hexadecimal (docs/checkpoints.md). hash: of the final state, if the run has
     * checkpoints, a restart or HDF5, else "". chain: the end of the chain of checkpoints or,
     * without checkpoints, of the snapshots in HDF5, else "". */
    char hash[65], chain[65];
} fp3_cost;

/* Opens a recording. The program and these params must be loaded (fp3_program_load), and the engine
 * must have one group unless only checkpoints are written. Program, params and engine must outlive
 * the recording. The file is written under another name next to its place. The caller closes
 * *recording, which is NULL on failure. FP3_E_ARGUMENT: a definition from another version of the
 * library; no such name; times that are not steps; too much for a picture; a file that cannot be
 * written; or there are snapshots during the run, and the program's first or last part does more
 * than prepare and complete values, so that a run in parts would differ from the whole run. */
fp3_status fp3_recording_open(const fp3_recording_def *def, const fp3_program *program,
                              const fp3_params *params, fp3_engine *engine,
                              fp3_recording **recording, fp3_error *error);

/* Runs the steps, and may be called once. The run is split at the snapshots. Each part is a run of
 * its own: it executes the program's first and last part, and a cycle_limit applies to it. On
 * success the file gets its name, even if objects failed. cost (may be NULL) is filled as
 * fp3_engine_run fills stats. */
fp3_status fp3_recording_run(fp3_recording *recording, fp3_cost *cost, fp3_error *error);

/* For a progress callback: how much of the whole run is done if `share` of the current part is. */
double fp3_recording_share(const fp3_recording *recording, double share);

/* Closes *recording and sets it to NULL. *recording may be NULL already. An incomplete file is
 * removed. */
void fp3_recording_close(fp3_recording **recording);

FP3_API_END

#endif
