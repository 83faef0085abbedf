/* SPDX-License-Identifier: Apache-2.0 */
/* path.h - where an object of a model is at any time, from 0 to an end and a little beyond it.
 *
 *     fp3_path *path = NULL;
 *     if (fp3_path_open(model, params, initial, 20, sizes, &path, error))
 *         return ...;
 *     fp3_path_at(path, 7.25, states);
 *     fp3_path_close(&path);
 */
#ifndef FP3_TRUTH_PATH_H
#define FP3_TRUTH_PATH_H

#include <fp3/model.h>
#include <gsl/gsl_odeiv2.h>

typedef struct fp3_path fp3_path;

/* So much of the end it goes beyond, if the solution does: more than FP32 rounds a time. What
 * happens at the end then has two sides, whichever of them rounding puts it on. */
#define FP3_PATH_BEYOND 0x1p-20

/* The solution of fp3_model_truths, with its checks, and its sizes. Between its steps a polynomial
 * is within 1e-10 of each state's size. The caller closes *path, which is NULL on failure. Errors
 * as of fp3_model_truths. */
fp3_status fp3_path_open(const fp3_model *model, const double *params, const double *initial,
                         double end, double *sizes, fp3_path **path, fp3_error *error);
/* Sets *path to NULL, which it may be already. */
void fp3_path_close(fp3_path **path);

/* The states at a time; at that of an event, right after it. A time beyond what it knows is
 * continued to. */
void fp3_path_at(const fp3_path *path, double t, double *states);

/* The last event that is not after t, or the first one that is: when, and the states on its far
 * side from t: right before the one, right after the other. 0: there is none. */
int fp3_path_before(const fp3_path *path, double t, double *when, double *states);
int fp3_path_after(const fp3_path *path, double t, double *when, double *states);

/* After how many of these steps, and so on, an error is looked for. */
uint64_t fp3_path_every(uint64_t steps);

/* What errors are relative to, and room for a row of states. */
typedef struct {
    const double *sizes;
    double span, *room;
} fp3_path_scale;

/* The largest distance of a state from the path at a time. Near an event an object may be on the
 * other side of it: the time to the event then counts like a state whose size is the span. Infinite
 * where a state is no number, or should be 0 all the time. */
double fp3_path_error(const fp3_path *path, const fp3_path_scale *scale, double t,
                      const double *states);

/* ---- how it is made, step by step ---- */

/* What the steps are of; its function is that of the piece that is being made. sizes: of each
 * state, for the 1e-10. NULL: out of memory. */
fp3_path *fp3_path_begin(const gsl_odeiv2_system *system, const gsl_odeiv2_step_type *how,
                         const double *sizes);
/* Where a smooth piece begins; is_event: with an event. Returns GSL's codes, as do the next two. */
int fp3_path_start(fp3_path *path, double t, const double *states, int is_event);
/* A step has come from there, or from the step before, to these states. */
int fp3_path_step(fp3_path *path, double t, const double *states);
/* The piece ends at time t, an event, a turn of the equations or the end of all, a step or none
 * behind the last one. */
int fp3_path_stop(fp3_path *path, double t);
/* No step follows: what only steps need is freed, and so are steps behind the last stop. Returns
 * GSL's codes. */
int fp3_path_finish(fp3_path *path);

#endif
