/* fp3/recording.h - a run that is looked at: named values of all objects after chosen steps, in a
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
#ifndef FP3_RECORDING_H
#define FP3_RECORDING_H

#include <fp3/api.h>
#include <fp3/program.h>
#include <stddef.h>
#include <stdint.h>

FP3_API_BEGIN

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
    /* Adaptive steps (fp3/adaptive.h) have snapshots at times alone, any that ascend, where objects end and go on; `steps` then
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
