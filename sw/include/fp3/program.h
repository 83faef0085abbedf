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
 * Threads: any number of threads may read a program or a scene at the same time. Loading one does not change it.
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
    int is_adaptive;        /* the model is adapted (fp3/compile.h), as `adaptive` says */
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

/* Steps of the first and of the last object of a group; those of the others lie evenly between, whole. */
typedef struct {
    uint64_t first, last;
} fp3_scene_steps;

typedef struct {
    char *path;                          /* of the program */
    char *integrator_file, *params_file; /* NULL: none was read */
    fp3_program *program;
    /* What the file says. More may be set before fp3_scene_load. */
    fp3_params *params;
    size_t first, objects; /* the group is objects first .. first + objects - 1 */
    /* fp3_engine_live; born {0, 0} and gone {FP3_FOREVER, FP3_FOREVER} are what the file need not say. */
    fp3_scene_steps born, gone;
    int line; /* of the scene file */
} fp3_scene_group;

/* Read it, never change it (but params). All that it points to belongs to it. */
typedef struct {
    char *path, *config, *engine;
    uint64_t steps;
    uint32_t visit; /* 0: all steps */
    fp3_scene_group *groups;
    size_t group_count, objects;
    int line; /* of the file's `groups` */
} fp3_scene;

/* Reads the file and opens all its programs. config replaces the file's unless it is NULL. What the
 * file does not say is: engine "rtl", steps 1 (FP3_ADAPTIVE_ATTEMPTS if all groups are adaptive), visit 0. The caller closes *scene, which is NULL on
 * failure. Messages begin with the path and the line of the file. */
fp3_status fp3_scene_open(const char *path, const char *config, fp3_scene **scene,
                          fp3_error *error);
/* Sets *scene to NULL; that it was NULL before does no harm. */
void fp3_scene_close(fp3_scene **scene);

/* The lifetime of an object of a group, 0 .. objects - 1. */
void fp3_scene_life(const fp3_scene_group *group, size_t object, uint64_t *born, uint64_t *gone);

/* The definition of an engine for the scene: fp3_engine_default() with its engine, configuration,
 * objects and visit. The scene must outlive the engine. */
fp3_engine_def fp3_scene_engine(const fp3_scene *scene);

/* Loads programs, values and lifetimes into an engine that has as many objects as the scene. What the engine
 * refuses is told where its definition says, with the path and the line of `groups` in front.
 * FP3_E_ARGUMENT: also if objects have lifetimes or only some groups adaptive steps, which splits a run, and a program's first or last part does
 * more than prepare and complete values. */
fp3_status fp3_scene_load(const fp3_scene *scene, fp3_engine *engine, fp3_error *error);

/* ---- recordings: named values of all objects after chosen steps, in a file ----
 * file.
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

/* What to record. Always start from fp3_recording_default(). The caller owns what it points to, which
 * must outlive the call that opens. */
typedef struct {
    /* A file, a picture or both; NULL: none. A name that ends in .h5 or .hdf5 is HDF5, any other CSV, "-"
     * standard output. A picture, of 8 objects at most, ends in .svg or .png; gnuplot draws it. */
    const char *path, *plot;
    /* Names of states, and of a model's definitions and invariants. NULL (default): a model's states;
     * all states of another program. */
    const char *const *observed;
    size_t observed_count;
    uint64_t steps; /* of the run, as of fp3_engine_run; 1 by default */
    /* A snapshot before the run, after each `every` steps (0, the default: none of these; of a picture
     * some 500) and at the end; unless there are times: then at these alone. */
    uint64_t every;
    /* Adaptive steps (fp3/compile.h) have snapshots at times alone, any that ascend, where objects end and go on; `steps` then
     * limits the attempts from one to the next. */
    const double *times; /* ascending, from the start of the run, in the unit of h; or NULL */
    size_t time_count;
    int is_compressed; /* HDF5 alone */
} fp3_recording_def;

fp3_recording_def fp3_recording_default(void);

/* How many steps a run to the last of these times has: whole multiples of h, to within rounding of h
 * and of the time. FP3_E_ARGUMENT: a time is none, and error names those next to it. */
fp3_status fp3_recording_steps(const fp3_program *program, const fp3_params *params,
                               const double *times, size_t count, uint64_t *steps,
                               fp3_error *error);

/* What the whole run cost and who failed in it. */
typedef struct {
    fp3_stats stats; /* sums over its parts; cycles: of each part the maximum */
    /* Of all parts, as of fp3_engine_failure; of adaptive steps fp3_adaptive_report_make tells. A state that is not finite at a snapshot is a failure. */
    fp3_failure failure;
    /* Of each of stats.schedulers schedulers; belongs to the recording. */
    const uint64_t (*counter)[FP3_COUNTER_COUNT];
} fp3_cost;

/* The program and its values are loaded (fp3_program_load), params are the same, and engine has one
 * group. All of them must outlive the recording. Opens the file beside its place. The caller closes
 * *recording, which is NULL on failure. FP3_E_ARGUMENT: no such name, times that are no steps, too
 * much for a picture, or a file that cannot be written; or there are snapshots on the way, and the
 * program's first or last part does more than prepare and complete values, so that the parts of a run
 * are not the run. */
fp3_status fp3_recording_open(const fp3_recording_def *def, const fp3_program *program,
                              const fp3_params *params, fp3_engine *engine,
                              fp3_recording **recording, fp3_error *error);

/* Runs the steps, once: split into runs from snapshot to snapshot. Each part of the run is a run of its
 * own, which executes the program's first and last part, and to which a cycle_limit applies. The file has its name when all went well,
 * failures of objects included. cost is filled as stats are by fp3_engine_run; it may be NULL. */
fp3_status fp3_recording_run(fp3_recording *recording, fp3_cost *cost, fp3_error *error);

/* From a progress callback: how much of the whole run is done if share of its part is. */
double fp3_recording_share(const fp3_recording *recording, double share);

/* Sets *recording to NULL; that it was NULL before does no harm. What was not written whole is
 * removed. */
void fp3_recording_close(fp3_recording **recording);

FP3_API_END

#endif
