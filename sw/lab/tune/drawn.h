/* SPDX-License-Identifier: Apache-2.0 */
/* drawn.h - a scene with other seeds or other starts, and its solution.
 *
 *     fp3_drawn one;
 *     fp3_status status = fp3_drawn_open(&def, 3, NULL, &one, error);
 *     if (!status)
 *         status = fp3_drawn_solve(&def, &times, &one, error);
 *     ...
 *     fp3_drawn_close(&one);
 */
#ifndef FP3_TUNE_DRAWN_H
#define FP3_TUNE_DRAWN_H

#include <fp3/scene_tune.h>

/* Steps of the scene at which it is looked at: each a multiple of `every`, but for the last. */
typedef struct {
    uint64_t *steps, every;
    size_t count;
} fp3_drawn_times;

typedef struct {
    fp3_scene *scene;
    double *solution, *sizes; /* rows of fp3/scene_truth.h; NULL: not solved */
    size_t width;
    fp3_scene_solved solved;
    int has_seeds, has_shifts; /* what makes it another scene */
} fp3_drawn;

/* The largest power of two that divides a number of steps, with so many parts at least. */
uint64_t fp3_drawn_power(uint64_t steps, uint64_t least);
/* For so many steps, and rows of so many numbers. The caller frees times->steps. */
fp3_status fp3_drawn_times_find(uint64_t steps, size_t width, fp3_drawn_times *times,
                                fp3_error *error);

/* draw: 0, the scene as it is; else it is another one. as_is: the former, or NULL. The caller
 * closes, after a failure too. */
fp3_status fp3_drawn_open(const fp3_scene_tune_def *def, uint64_t draw, const fp3_drawn *as_is,
                          fp3_drawn *drawn, fp3_error *error);
/* FP3_E_FAILED: there is no solution at the first of the times. */
fp3_status fp3_drawn_solve(const fp3_scene_tune_def *def, const fp3_drawn_times *times,
                           fp3_drawn *drawn, fp3_error *error);
/* Whether anything in the solution is ever elsewhere than at the start of the scene. */
fp3_status fp3_drawn_moves(const fp3_drawn *drawn, int *moves, fp3_error *error);
/* Leaves {0}, which may be closed as well. */
void fp3_drawn_close(fp3_drawn *drawn);
/* In what it differs from the scene as it is. */
void fp3_drawn_differ(const fp3_scene_tune_def *def, const fp3_drawn *drawn, char *text,
                      size_t size);

/* The error of a row of states at one of the times with a solution; infinite: one is no number. */
double fp3_drawn_error(const fp3_drawn *drawn, size_t time, const double *states);

#endif
