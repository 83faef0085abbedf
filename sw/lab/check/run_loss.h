/* SPDX-License-Identifier: Apache-2.0 */
/* run_loss.h - what FP32 loses in a run without a flag that tells: increments that are too small
 * for their state, and numbers too small for FP32. The host evaluates the equations in double, and
 * looks.
 */
#ifndef FP3_CHECK_RUN_LOSS_H
#define FP3_CHECK_RUN_LOSS_H

#include "lab/scene/scaled.h"

#include <fp3/program.h>

/* Objects of a model that have made a run. */
typedef struct {
    const fp3_program *program;
    const fp3_params *params;
    fp3_engine *engine;
    size_t first, objects;
    uint64_t steps;
} fp3_run_part;

/* size: rows of the first states, a number for each object. Gives all objects the largest size that
 * one of them has of the vector that the state is part of (r_x, r_y). Objects that see each other
 * are judged so, as a whole: one of them may rest, or move along an axis, and its own size would be
 * that of a rounding. */
void fp3_run_common_size(const fp3_model *model, uint32_t states, size_t objects, double *size);

/* Whether it cannot look at this part: neighbours in double are all objects of the group, also
 * those that do not live, and know nothing of what pairs remember or of other groups. */
int fp3_run_loss_is_blind(const fp3_run_part *part);

typedef struct fp3_run_loss fp3_run_loss;

/* The caller closes *loss, which is NULL on failure. */
fp3_status fp3_run_loss_open(const fp3_run_part *part, fp3_run_loss **loss, fp3_error *error);
/* Sets *loss to NULL, which it may be already. */
void fp3_run_loss_close(fp3_run_loss **loss);

/* How many objects it looks at: all of the part, or the first of them. */
size_t fp3_run_loss_looked(const fp3_run_loss *loss);

/* The final states of an object in double, its start, and by how much underflow has changed each
 * state over the run if its derivative is wrong all the time as it is in the end. Each has as many
 * numbers as the model has states. Also its params, and the time at its end. All belong to the loss
 * until the next call. */
typedef struct {
    const double *states, *start, *lost, *params;
    double t;
} fp3_run_lost;
fp3_status fp3_run_loss_look(fp3_run_loss *loss, size_t number, fp3_run_lost *found,
                             fp3_error *error);

/* Tells the user a warning about the program at path. */
typedef void fp3_run_say_fn(const char *path, const char *warning);

/* Says a warning for each kind of loss that may change a state by more than bound, relative to its
 * size, and for each number that FP32 has less exactly than a normal one. Adds their number to
 * *warnings. */
fp3_status fp3_run_loss_warn(fp3_run_loss *loss, fp3_run_say_fn *say, const char *path,
                             double bound, size_t *warnings, fp3_error *error);

/* After a run in which objects failed: a warning for the first object, if any, with the argument of
 * a sine, a cosine or a tangent that is too large for FP32 to reduce. */
fp3_status fp3_run_loss_warn_failed(fp3_run_loss *loss, fp3_run_say_fn *say, const char *path,
                                    fp3_error *error);

#endif
