/* SPDX-License-Identifier: Apache-2.0 */
/* fp3/recording.h - named values of all objects after chosen steps, in a file; and checkpoints,
 * from which a run goes on.
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
 *
 * Threads: a recording belongs to the thread that runs its engine.
 */
#ifndef FP3_RECORDING_H
#define FP3_RECORDING_H

#include <fp3/engine.h>
#include <fp3/program.h>
#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

FP3_API_BEGIN

typedef struct fp3_recording fp3_recording;

/* What to record. Always start from fp3_recording_default(). The caller owns everything that the
 * definition points to, until fp3_recording_open returns. */
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
    size_t group;   /* of the engine: the one whose objects are recorded; default 0 */
    uint64_t steps; /* of the run, as for fp3_engine_run; default 1 */
    /* Without times: a snapshot before the run, after each `every` steps, and at the end. 0
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
     * `checkpoint_every` steps (0: never) and at the end; the previous checkpoint stays as
     * checkpoint.1. NULL (default): no checkpoints. Not with adaptive steps. */
    const char *checkpoint;
    uint64_t checkpoint_every;
    /* The run goes on from this checkpoint of the same run; NULL (default): from the start. */
    const char *restart;
    /* A text that checkpoints keep: the arguments of fp3 run, one a line; or NULL. */
    const char *command;
    struct fp3_expected *expected; /* NULL, except for fp3 verify */
} fp3_recording_def;

/* For fp3_recording_default() only. size is that of fp3_recording_def in the calling program. */
void fp3_recording_set_default(fp3_recording_def *def, size_t size);
static inline fp3_recording_def fp3_recording_default(void) {
    fp3_recording_def def;
    fp3_recording_set_default(&def, sizeof def);
    return def;
}

/* The number of steps of a run to the last of these times. Times must be whole multiples of h, to
 * within rounding of h and of the time. FP3_E_ARGUMENT: a time is not; error names the nearest
 * two. */
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
 * library; no such name; times that are not steps; too many points for a picture; a file that
 * cannot be written; or there are snapshots during the run, and the program's first or last part
 * does more than prepare and complete values, so that a run in parts would differ from the whole
 * run. */
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
