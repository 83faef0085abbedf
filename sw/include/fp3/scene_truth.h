/* SPDX-License-Identifier: Apache-2.0 */
/* fp3/scene_truth.h - where the objects of a scene really are, computed from its equations in
 * double.
 *
 *     fp3_scene *scene = NULL;
 *     fp3_scene_truth_def def = fp3_scene_truth_default();
 *     fp3_scene_solved solved;
 *     status = fp3_scene_open("stars.scene", NULL, &scene, &error);
 *     if (status)
 *         return status;
 *     double *states = calloc(fp3_scene_truth_width(scene), sizeof *states);
 *     if (fp3_scene_solution(scene, &def, &scene->steps, 1, states, &solved, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     else if (solved.known)
 *         printf("x of object 3: %g\n", states[fp3_scene_truth_place(scene, 0, "x", 3)]);
 *     free(states);
 *     fp3_scene_close(&scene);
 *
 * There are two truths. fp3_scene_in_double makes the scene's own steps, with its integrator and
 * its h, in double: an engine differs from it by what FP32 costs. fp3_scene_solution is what the
 * steps tend to as h becomes shorter: an engine differs from it by its whole error. Both have the
 * scene's relations, kinds, projections, events, lifetimes and what pairs remember, and share no
 * code with the compiler and the engines. docs/truth.md says how.
 *
 * States are in the units of their models. Both refuse a scene with FP3_E_PROGRAM and the reason:
 * a group that is no model, adaptive steps. With a line `rest` nobody sleeps in them.
 *
 * This header belongs to the library libfp3_lab.
 *
 * Threads: a call works in the calling thread. Calls in different threads do not affect each other.
 * Experimental.
 */
#ifndef FP3_SCENE_TRUTH_H
#define FP3_SCENE_TRUTH_H

#include <fp3/scene.h>
#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

FP3_API_BEGIN

/* The numbers of a row: group by group, in each group state by state, and of each state one for
 * each object. */
size_t fp3_scene_truth_width(const fp3_scene *scene);
/* The place in a row; object is counted in its group. SIZE_MAX: there is none. */
size_t fp3_scene_truth_place(const fp3_scene *scene, size_t group, const char *state,
                             size_t object);

/* The scene's method in double, in `parts` steps for each of the scene's, each of h/parts. states
 * gets a row for each of `count` numbers of steps of the scene, which ascend. An object that does
 * not live holds its states. FP3_E_PROGRAM: also an integrator that is not there in double
 * (Rosenbrock methods, stoermer_verlet). FP3_E_FAILED: a state is no number. */
fp3_status fp3_scene_in_double(const fp3_scene *scene, uint64_t parts, const uint64_t *steps,
                               size_t count, double *states, fp3_error *error);

typedef struct {
    /* Two lengths of step have to agree within this, as a share of a state's size: the largest that
     * it, or another component of its vector, has in any object at the times that have a truth.
     * Default 1e-6.
     */
    double within;
    /* How many numbers may be computed for it, about 10^9 in a second. Default 1e10. */
    double work;
    /* NULL, or called as it goes on: this share of the steps with h/parts is made. 1: no more; the
     * solution is known as far as it is. */
    int (*tell)(void *user, uint64_t parts, double share);
    void *user;
} fp3_scene_truth_def;
/* For fp3_scene_truth_default() only. size is that of fp3_scene_truth_def in the calling program.
 */
void fp3_scene_truth_set_default(fp3_scene_truth_def *def, size_t size);
static inline fp3_scene_truth_def fp3_scene_truth_default(void) {
    fp3_scene_truth_def def;
    fp3_scene_truth_set_default(&def, sizeof def);
    return def;
}

#define FP3_SCENE_WHY_SIZE 512
typedef struct {
    size_t known; /* how many of the times have a truth, from the first one on */
    char method[FP3_NAME_SIZE];
    uint64_t parts;        /* of a step of the scene, in the shorter of both lengths */
    unsigned extrapolated; /* order in h of the error that was taken out; 0: none was */
    double apart;          /* by how much both lengths differ up to there, as a share of the size */
    char why[FP3_SCENE_WHY_SIZE]; /* there is no more of it; or "" */
} fp3_scene_solved;

/* The solution, after each of these numbers of steps of the scene, which ascend. A row whose time
 * has no truth is NaN: lengths of step do not agree there (the motion is chaotic, or its error
 * falls too slowly), or the work is done. FP3_E_PROGRAM: also projections alone move a group, so
 * its steps have no length. */
fp3_status fp3_scene_solution(const fp3_scene *scene, const fp3_scene_truth_def *def,
                              const uint64_t *steps, size_t count, double *states,
                              fp3_scene_solved *solved, fp3_error *error);

/* The size of each state of a row, as above, from such rows: a row of sizes, the same for all
 * objects of a group. Numbers that are NaN do not count. */
void fp3_scene_sizes(const fp3_scene *scene, const double *states, size_t count, double *sizes);

FP3_API_END

#endif
