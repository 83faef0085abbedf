/* SPDX-License-Identifier: Apache-2.0 */
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
 *         fp3_batch_write(ships, "T", 0, 10000, thrust) || fp3_batch_run(ships, 100) ||
 *         fp3_batch_read(ships, (const char *[]){"s", "v"}, 2, 0, 10000, (float *[]){s, v}))
 *         fprintf(stderr, "%s\n", error.text);
 *     fp3_batch_close(&ships);
 *
 * Names are those of the model: its states, its params, and h, the time step. Other values that the
 * program needs (1/m, products with h) are updated automatically before the next step, for the
 * objects whose values have changed. They are computed in double and rounded to FP32 once, so all
 * bits are those of `fp3 run --set name=value`.
 *
 * Threads: only one thread at a time may use an fp3_batch. Different threads may use different
 * ones, even with the same compiled program.
 *
 * docs/batch.md is an introduction. For single registers, cycles, counters and groups with several
 * programs, use fp3/engine.h and fp3/program.h; for files with scenes, fp3/scene.h.
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

#define FP3_NOBODY UINT32_MAX /* instead of an object's number */

/* What to open. Always start from fp3_batch_default(). The caller owns everything that the
 * definition points to. `compiled`, `native`, `error` and whatever the two `user` pointers point to
 * must outlive the fp3_batch; the rest need only last until fp3_batch_open returns. */
typedef struct {
    uint32_t cookie;  /* as in fp3_engine_def */
    fp3_error *error; /* receives the message when a call of this fp3_batch fails; or NULL */
    /* Exactly one of three: the name of a file, which is a model (.ode), assembly (.s) or else an
     * image; the text of a model; or a program that was compiled for compile.config. */
    const char *model;
    const char *text;
    size_t text_size;
    const fp3_compiled *compiled;
    size_t objects; /* 1 (default) to 2^25: the largest number that live at the same time */
    int is_empty;   /* 0 (default): all live from the start; 1: none does */

    /* The next three members apply to a model that is not compiled yet. integrator: a built-in
     * table or a file; NULL (default): rk4, or cash_karp if adaptive. compile.config: NULL
     * (default): "many_full", or "world" if objects see each other. */
    const char *integrator;
    const fp3_adaptive_def *adaptive; /* each object chooses its steps; NULL (default): all steps
                                         are h */
    fp3_compile_def compile;          /* arithmetic, passes, observed states */

    double h;           /* the time step; 0 (default): the model's */
    const char *engine; /* as in fp3_engine_def; default "fast" */
    uint32_t threads;   /* "fast" only; 0 (default): one for each processor */
    /* "fast" only. 1: the library may start a C compiler to make native code, and keeps the code in
     * a cache directory. 0 (default): never, because a game does not expect a library to start
     * programs and write files, and short runs are interpreted anyway. Native code pays off in long
     * runs (docs/fast.md). */
    int may_compile;
    const char *native; /* "fast" only: file with native code, as in fp3_engine_def, or NULL */
    /* "fast" only, as in fp3_engine_def: the caller's threads and memory. NULL and {0} (default):
     * the library's. */
    fp3_tasks_fn *tasks;
    void *tasks_user;
    fp3_allocator allocator;
    /* For near objects: lists reach farther by this share of the reach, so they stay valid until an
     * object has moved by half of that distance. 0 (default): 0.3. The skin changes no bit. */
    double skin;
    int may_fail; /* 1: fp3_batch_run returns FP3_OK though objects failed */
} fp3_batch_def;

/* For fp3_batch_default() only. size is that of fp3_batch_def in the calling program. */
void fp3_batch_set_default(fp3_batch_def *def, size_t size);
static inline fp3_batch_def fp3_batch_default(void) {
    fp3_batch_def def;
    fp3_batch_set_default(&def, sizeof def);
    return def;
}

/* Opens an fp3_batch. All objects have the model's defaults and are at time 0. They have the
 * numbers 0 .. objects-1. The caller closes *batch, which is NULL on failure. Errors are those of
 * fp3_program_open, fp3_compile and fp3_engine_open. A call with NULL, after a failed open, does
 * nothing and returns FP3_E_ARGUMENT, 0 or NULL. */
fp3_status fp3_batch_open(const fp3_batch_def *def, fp3_batch **batch);
/* Closes *batch and sets it to NULL. *batch may be NULL already. */
void fp3_batch_close(fp3_batch **batch);

/* ---- values ----
 *
 * FP3_E_ARGUMENT: there is no such name (the message suggests the nearest), no such object, or the
 * value is not finite; nothing is changed. A value below 2^-150 becomes 0. The next step checks
 * whether values that are computed from it fit FP32. A state that is written before the first step
 * is the start of its object. Later, the object continues from the new value. If the model computes
 * a start from params, the start follows these params, at the first step and after
 * fp3_batch_restart, unless the state itself is written. After the first step, an integrator that
 * keeps earlier positions (stoermer) refuses new states and another h; another h is also refused if
 * the equations contain t. */

/* Sets a value of all objects, or a shared value. */
fp3_status fp3_batch_set(fp3_batch *batch, const char *name, double value);
/* Write a column for objects first .. first+count-1, one number each. */
fp3_status fp3_batch_write(fp3_batch *batch, const char *name, size_t first, size_t count,
                           const float *values);
fp3_status fp3_batch_write_double(fp3_batch *batch, const char *name, size_t first, size_t count,
                                  const double *values);
/* Read columns of objects first .. first+count-1: values[i] receives count numbers of names[i], for
 * each of name_count names. fp3_batch_read_double gives a double-single state as the sum of its two
 * words. */
fp3_status fp3_batch_read(fp3_batch *batch, const char *const *names, size_t name_count,
                          size_t first, size_t count, float *const *values);
fp3_status fp3_batch_read_double(fp3_batch *batch, const char *const *names, size_t name_count,
                                 size_t first, size_t count, double *const *values);

/* Several columns interleaved, as in a buffer of vertices: number k of the n-th of these objects is
 * values[n * stride + k]. stride is in floats; other numbers stay as they are. FP3_E_ARGUMENT: also
 * if stride is below name_count. After an error, columns of earlier names are written or read. */
fp3_status fp3_batch_read_strided(fp3_batch *batch, const char *const *names, size_t name_count,
                                  size_t first, size_t count, float *values, size_t stride);
fp3_status fp3_batch_write_strided(fp3_batch *batch, const char *const *names, size_t name_count,
                                   size_t first, size_t count, const float *values, size_t stride);

/* Read-only pointer to the column of a state, or of a param of each object, as fp3_engine_column.
 * *values stays valid until the fp3_batch is closed, and changes with each step. If objects see
 * each other, it shows their values only until the next fp3_batch_run, fp3_batch_add,
 * fp3_batch_remove, fp3_batch_link or fp3_batch_restart: ask again after each. The column shows
 * values that were written before the first step, from this call on. A state that is written later
 * shows at once, a param after the next step at the latest. NULL: no such column; fp3_batch_read
 * gives a copy. FP3_E_ARGUMENT: no such name, or a value computed from written values is refused as
 * in fp3_batch_run. */
fp3_status fp3_batch_column(fp3_batch *batch, const char *name, const float **values);

/* ---- links (docs/relations.md) ----
 *
 * Relations `all` and `near` need no call. The reach of `near` follows its params.
 */

/* Sets the links of a relation, before the first step and at any time later. The links are copied
 * and replace earlier links. Both ends have to live. For an image, `relation` is the name of a
 * list's register, also for near objects. FP3_E_ARGUMENT: no such relation or field; a link does
 * not join two objects, or joins the same two as another link; or a field is not finite. After an
 * error the links are unchanged. */
fp3_status fp3_batch_link(fp3_batch *batch, const char *relation, const fp3_links *links);
/* Appends links to those of a relation, which keep what their pairs remember. Otherwise as
 * fp3_batch_link. fp3_batch_numbers gives the numbers of handles. */
fp3_status fp3_batch_link_more(fp3_batch *batch, const char *relation, const fp3_links *links);
/* Removes the links of pairs of objects, whose ends may be in either order; all other links stay.
 * FP3_E_ARGUMENT: a pair has no link of this relation, or is given twice; nothing is changed. */
fp3_status fp3_batch_unlink(fp3_batch *batch, const char *relation, const uint32_t *ends_a,
                            const uint32_t *ends_b, size_t count);

/* ---- steps ---- */

/* All objects that live make this number of steps. With adaptive steps, each makes at most this
 * number of attempts until it reaches `until`. FP3_E_ARGUMENT: links are missing; a computed value
 * is refused as by fp3_compiled_inputs ("object 3: 1/m is inf"); nothing was executed.
 * FP3_E_FAILED: all steps were made and values can be read, but objects failed in them
 * (fp3_batch_failure); see may_fail. An object that has made all its attempts, and can continue to
 * `until` in the next call, has not failed. Other errors are those of fp3_engine_run. */
fp3_status fp3_batch_run(fp3_batch *batch, uint64_t steps);
/* The time since the start, with fixed steps. With adaptive steps, read `t`. */
double fp3_batch_time(const fp3_batch *batch);
/* Goes back to the starting states at time 0. Params, h and links do not change, and the same
 * objects live. */
fp3_status fp3_batch_restart(fp3_batch *batch);

/* Which of the objects that live failed in the last fp3_batch_run, as fp3_engine_failure. text (may
 * be NULL) gets a description, or "" if none failed. FP3_E_ARGUMENT: also if a value was written,
 * or objects were added or removed, since. With adaptive steps: which are stuck
 * (FP3_ADAPTIVE_STUCK), or have a state that is not finite; step is the number of accepted steps,
 * and later members are 0. */
fp3_status fp3_batch_failure(fp3_batch *batch, fp3_failure *failure,
                             char text[FP3_FAILURE_TEXT_SIZE]);

/* ---- objects that come and go ----
 *
 * An object that lives has a number below `objects`, and a handle, which no other object ever has;
 * no handle is 0. Columns have a place for each number, even if no object with this number lives;
 * what is written to such a place, no object ever sees. FP3_E_PROGRAM: the configuration has no
 * `sleep`, so all its objects make all steps, unless they see each other. */

/* `count` objects are born: handles[i] receives the handle of each. They get the lowest free
 * numbers, in ascending order, and the model's defaults; t and `steps` are 0. Starts that the model
 * computes from params follow the params that are written before the next step. They have no links.
 * FP3_E_LIMIT: there is no room for them. After an error no object was born. */
fp3_status fp3_batch_add(fp3_batch *batch, size_t count, uint64_t *handles);
/* Removes objects: no object sees them any more, and their links and what pairs remember of them
 * are gone for good. Their numbers are free for others. FP3_E_ARGUMENT: an object was removed
 * before, or occurs twice; none is removed. */
fp3_status fp3_batch_remove(fp3_batch *batch, const uint64_t *handles, size_t count);
/* The number of objects that have a handle, including objects that an event removed. */
size_t fp3_batch_living(const fp3_batch *batch);
/* The numbers of objects; FP3_NOBODY if a handle is 0 or its object was removed. An object has the
 * same number as long as it lives. */
void fp3_batch_numbers(const fp3_batch *batch, const uint64_t *handles, size_t count,
                       uint32_t *numbers);
/* The handles of objects first .. first+count-1; 0: no object with this number lives.
 * FP3_E_ARGUMENT: no such numbers. */
fp3_status fp3_batch_handles(const fp3_batch *batch, size_t first, size_t count, uint64_t *handles);
/* As fp3_batch_write, fp3_batch_write_double and fp3_batch_read, of these objects in this order.
 * FP3_E_ARGUMENT: also if an object was removed; nothing is changed. */
fp3_status fp3_batch_write_of(fp3_batch *batch, const char *name, const uint64_t *handles,
                              size_t count, const float *values);
fp3_status fp3_batch_write_of_double(fp3_batch *batch, const char *name, const uint64_t *handles,
                                     size_t count, const double *values);
fp3_status fp3_batch_read_of(fp3_batch *batch, const char *name, const uint64_t *handles,
                             size_t count, float *values);

/* ---- who is where ----
 *
 * These calls find living objects by their present positions. `of` names a relation of near
 * objects, and means its position; or a state, which is a number or a vector of 2 or 3 components.
 * An object whose position is not finite is never found. Points have the same number of components
 * as positions, and follow each other. Distances are computed in double; an object is within a
 * distance if it is nearer. Results are numbers of objects, in ascending order. FP3_E_ARGUMENT: no
 * such relation or state, a number beyond 2^500, or a radius that is neither 0 nor from 2^-500 to
 * 2^500.
 *
 * If the number of results is not known before the call, the caller's arrays have space for `room`
 * results. *count receives the number of all results; those beyond `room` are left out.
 */

/* The number of components of these positions. */
fp3_status fp3_batch_dimensions(fp3_batch *batch, const char *of, uint32_t *dimensions);
/* All pairs of objects within a distance of each other: a[i] below b[i], ascending by a and then b.
 * distance: 0: the reach of the relation, which differs from pair to pair if objects have radii;
 * else 2^-50 to 2^63. */
fp3_status fp3_batch_pairs(fp3_batch *batch, const char *of, double distance, size_t room,
                           uint32_t *a, uint32_t *b, size_t *count);
/* All objects within radii[n] of point n, point after point: which[i] is the point. */
fp3_status fp3_batch_within(fp3_batch *batch, const char *of, const double *points,
                            const double *radii, size_t points_count, size_t room, uint32_t *which,
                            uint32_t *objects, size_t *count);
/* The object that is nearest to each point, and its distance; if there are several, the lowest
 * number. FP3_NOBODY and infinity: no object lives. */
fp3_status fp3_batch_nearest(fp3_batch *batch, const char *of, const double *points, size_t count,
                             uint32_t *objects, double *distances);

/* Rays, each from an origin in a direction of any length but 0. Objects are balls. */
typedef struct {
    size_t count;
    const double *origins, *directions;
    const char *radius_of; /* a param or state, the radius of each object; NULL: `radius` */
    double radius;         /* 0 or above */
    double length;         /* the length of each ray; 0: no end */
} fp3_rays;
/* The first object that each ray meets, and its distance from the origin, which is 0 if the origin
 * is inside the object. If there are several, the lowest number. FP3_NOBODY and infinity: it meets
 * no object. */
fp3_status fp3_batch_ray(fp3_batch *batch, const char *of, const fp3_rays *rays, uint32_t *objects,
                         double *distances);

/* ---- contacts ---- */

/* Pairs of handles, ascending by the objects' numbers, as in fp3_batch_pairs. They belong to the
 * fp3_batch, and are valid until the next such call. */
typedef struct {
    size_t began, ended;
    const uint64_t *began_a, *began_b; /* within the distance now, and not at the call before */
    const uint64_t *ended_a, *ended_b; /* the reverse; objects may have been removed since */
} fp3_contacts;
/* The contacts that began and ended since the last call with this `of`; at the first call all
 * begin. Only the moments of the calls count: contacts that begin and end between two calls are not
 * reported. of, distance: as in fp3_batch_pairs. If an object is removed, its contacts end, even if
 * another object gets its number at once. */
fp3_status fp3_batch_contacts(fp3_batch *batch, const char *of, double distance,
                              fp3_contacts *contacts);
/* What object a[i] remembers of other[i] in a field of a relation of near objects (`remember`),
 * after the last step: the impulse of a contact, if the model keeps it; the library computes none.
 * 0: the pair remembers nothing. FP3_E_ARGUMENT: no such relation or field, or no such objects. */
fp3_status fp3_batch_remembered(fp3_batch *batch, const char *relation, const char *field,
                                const uint32_t *a, const uint32_t *other, size_t count,
                                float *values);

/* ---- its parts, which belong to the fp3_batch ---- */

size_t fp3_batch_objects(const fp3_batch *batch);
/* For counters, status and sleep. The fp3_batch does not notice writes or loads through the
 * engine. */
fp3_engine *fp3_batch_engine(fp3_batch *batch);
/* NULL if the fp3_batch runs an image. */
const fp3_compiled *fp3_batch_compiled(const fp3_batch *batch);

FP3_API_END

#endif
