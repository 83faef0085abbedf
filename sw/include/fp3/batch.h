/* fp3/batch.h - many objects of one model: columns in, steps, columns out.
 *
 *     static float thrust[10000], s[10000], v[10000];
 *     fp3_error error;
 *     fp3_batch_def def = fp3_batch_default();
 *     def.model = "ship.ode";
 *     def.objects = 10000;
 *     def.error = &error;
 *     fp3_batch *ships = NULL;
 *     if (fp3_batch_open(&def, &ships) || fp3_batch_set(ships, "m", 2) ||
 *         fp3_batch_write(ships, "T", 0, 10000, thrust) || fp3_batch_step(ships, 100) ||
 *         fp3_batch_read(ships, (const char *[]){"s", "v"}, 2, 0, 10000, (float *[]){s, v}))
 *         fprintf(stderr, "%s\n", error.text);
 *     fp3_batch_close(&ships);
 *
 * Names are those of the model: its states, its params, and h, the time step. What a program needs besides (1/m,
 * products with h) is computed by itself before the next step, for the objects whose values have changed. A
 * value is in double, and what is made of it is rounded to FP32 once, so all bits are those of
 * `fp3 run --set name=value`.
 *
 * Threads: one thread at a time uses a batch. Different batches share nothing that changes, so each may
 * have a thread of its own; batches of one compiled program, too.
 *
 * docs/batch.md begins at the beginning. For single registers, cycles, counters and groups of
 * several programs there are fp3/engine.h and fp3/program.h.
 */
#ifndef FP3_BATCH_H
#define FP3_BATCH_H

#include <fp3/compile.h>
#include <fp3/engine.h>
#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

FP3_API_BEGIN

typedef struct fp3_batch fp3_batch;

/* What to open. Always start from fp3_batch_default(). What it points to belongs to the caller;
 * `compiled` and `error` must outlive the batch, the rest need not outlive the call that opens. */
typedef struct {
    uint32_t cookie; /* set by fp3_batch_default(): catches a forgotten default, and a definition of
                        another size */
    /* One of the three: a file, by the end of its name a model (.ode), assembly (.s) or an image; the
     * text of a model; or a program that has been compiled for compile.config. */
    const char *model;
    const char *text;
    size_t text_size;
    const fp3_compiled *compiled;
    size_t objects; /* 1 (default) to 2^25; it stays */

    /* Of a model that is not compiled yet. */
    const char
        *integrator; /* a built-in table or a file; NULL (default): rk4, or cash_karp if adaptive */
    const fp3_adaptive_def *adaptive; /* each object chooses its steps; NULL (default): all are h */
    fp3_compile_def
        compile; /* arithmetic, passes, observed states; the default of config is "many_full" */

    double h;           /* 0 (default): the model's */
    const char *engine; /* of fp3_engine_def; "fast" (default) */
    uint32_t threads;   /* of "fast": 0 (default): one for each processor */
    /* Of "fast": 1: a C compiler may be started to make native code, which is kept in a cache directory. 0 (default): never. A
     * library that starts programs and writes files unasked is a surprise in a game, and the interpreter
     * is what short runs take anyway: native code pays in long runs (docs/fast.md). */
    int may_compile;
    const char
        *native; /* of "fast": a file with the program's native code (fp3_engine_def), or NULL */
    /* Of "fast", as in fp3_engine_def: threads and memory of the caller's; what `user` points to must
     * outlive the batch. NULL and {0} (default): the library's. */
    fp3_tasks_fn *tasks;
    void *tasks_user;
    fp3_allocator allocator;
    fp3_error *error; /* where this batch's calls say why they failed; NULL: nowhere */
} fp3_batch_def;

fp3_batch_def fp3_batch_default(void);

/* All objects have the model's defaults at time 0. The caller closes *batch, which is NULL on failure.
 * FP3_E_ARGUMENT, FP3_E_PROGRAM, FP3_E_SYSTEM: as of fp3_program_open, fp3_compile and fp3_engine_open. */
fp3_status fp3_batch_open(const fp3_batch_def *def, fp3_batch **batch);
/* Sets *batch to NULL; that it was NULL before does no harm. */
void fp3_batch_close(fp3_batch **batch);

/* ---- values ----
 *
 * FP3_E_ARGUMENT: there is no such name (the message has the nearest), no such object, or the value
 * is not finite; nothing is changed. That what is made of a value has room in FP32 is seen by the next
 * step. A state that is written before the first step is where its object starts; after it, the object goes on from there. With
 * an integrator that keeps where objects were (stoermer) that is refused, and another h, too; so is another h where the
 * equations have t. */

/* Of all objects, or of what they share. */
fp3_status fp3_batch_set(fp3_batch *batch, const char *name, double value);
/* Of objects first .. first+count-1, of which each has its own. */
fp3_status fp3_batch_write(fp3_batch *batch, const char *name, size_t first, size_t count,
                           const float *values);
fp3_status fp3_batch_write_double(fp3_batch *batch, const char *name, size_t first, size_t count,
                                  const double *values);
/* Columns of objects first .. first+count-1: name_count names, and as many places for count numbers. In double,
 * a state in double-single is the sum of its two words. */
fp3_status fp3_batch_read(fp3_batch *batch, const char *const *names, size_t name_count,
                          size_t first, size_t count, float *const *values);
fp3_status fp3_batch_read_double(fp3_batch *batch, const char *const *names, size_t name_count,
                                 size_t first, size_t count, double *const *values);

/* ---- steps ---- */

/* All objects make this number of steps; with adaptive steps this number of attempts, at most, until they reach
 * `until`. FP3_E_ARGUMENT: a value that is made of others is not finite, or is not 0 and has no room in FP32
 * ("object 3: 1/m is inf"): nothing was executed. Else as of fp3_engine_run. */
fp3_status fp3_batch_step(fp3_batch *batch, uint64_t steps);
/* The time that fixed steps have made since the start; of adaptive ones read `t`. */
double fp3_batch_time(const fp3_batch *batch);
/* Back to the starts, at time 0. Params and h stay. */
fp3_status fp3_batch_restart(fp3_batch *batch);

/* Who failed in the last fp3_batch_step, as of fp3_engine_failure; text (may be NULL) has its words, "" if there is
 * none. FP3_E_ARGUMENT: also if something was written since. */
fp3_status fp3_batch_failure(fp3_batch *batch, fp3_failure *failure,
                             char text[FP3_FAILURE_TEXT_SIZE]);

/* ---- what it is made of; belongs to the batch ---- */

size_t fp3_batch_objects(const fp3_batch *batch);
/* Counters, status, sleep; what is written or loaded behind the batch's back it does not know. */
fp3_engine *fp3_batch_engine(fp3_batch *batch);
/* NULL: of an image. */
const fp3_compiled *fp3_batch_compiled(const fp3_batch *batch);

FP3_API_END

#endif
