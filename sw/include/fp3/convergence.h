/* SPDX-License-Identifier: Apache-2.0 */
/* fp3/convergence.h - how the error of a program falls with its time step.
 *
 *     fp3_ladder *ladder = NULL;
 *     fp3_convergence found;
 *     if (fp3_ladder_open(model, 0, 100000, &ladder, &error) ||
 *         fp3_converge(ladder, compiled, compiled->order, &found, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     else
 *         printf("order %.2f, error %.1e at best\n", found.order, found.floor);
 *     fp3_ladder_close(&ladder);
 *
 * This header belongs to the library libfp3_lab, which needs GSL.
 *
 * Threads: a call works in the calling thread. Calls in different threads do not affect each other.
 * Experimental.
 */
#ifndef FP3_CONVERGENCE_H
#define FP3_CONVERGENCE_H

#include <fp3/compile.h>
#include <fp3/model.h>
#include <fp3/status.h>
#include <stdint.h>

FP3_API_BEGIN

#define FP3_RUNGS_MOST 40
#define FP3_STEPS_MOST 8388608 /* of the last of FP3_RUNGS_MOST rungs */
/* A run is compared with the truth at this number of times, evenly spaced, the last at its end. */
#define FP3_LOOKS 8

/* Runs ("rungs") of one model over the same span, each with about 1.4 times the steps of the
 * previous rung, and the true states for each. Never change a ladder. */
typedef struct {
    const fp3_model *model;   /* the caller's; it must outlive the ladder */
    double *params, *initial; /* the model's defaults, as FP32 has them */
    double *scale;            /* the largest magnitude of each state along the truth */
    unsigned count;           /* of rungs */
    uint64_t steps[FP3_RUNGS_MOST];
    float h[FP3_RUNGS_MOST];
    double *truth[FP3_RUNGS_MOST]; /* FP3_LOOKS rows of one number per state */
    double span, *sizes;           /* of each state, all the time */
    struct fp3_path *path;         /* the truth all the time */
} fp3_ladder;

/* span: how long to integrate, in the model's unit of time; 0: the model's span. most_steps: the
 * steps of the last rung, at least FP3_LOOKS. The caller closes *ladder, which is NULL on failure.
 * FP3_E_MISMATCH as for fp3_model_truth. */
fp3_status fp3_ladder_open(const fp3_model *model, double span, uint64_t most_steps,
                           fp3_ladder **ladder, fp3_error *error);
/* Closes *ladder and sets it to NULL. *ladder may be NULL already. */
void fp3_ladder_close(fp3_ladder **ladder);

typedef struct {
    /* For each rung, relative to the scale: root mean square over states and looks. NaN or infinite
     * if the run failed; NaN also beyond the rung from which only noise is left. */
    double error[FP3_RUNGS_MOST];   /* of the steps in FP32 */
    double method[FP3_RUNGS_MOST];  /* of the same steps in double: the integrator's own error */
    double noise[FP3_RUNGS_MOST];   /* difference between the two */
    double largest[FP3_RUNGS_MOST]; /* the error of the steps in FP32 as in fp3_tune */
    /* Slopes of error and method over rungs from .. to, where the noise is small compared with the
     * method's error; NaN: no such rungs. */
    double order, method_order;
    unsigned from, to;
    double finest_order;   /* slope of method, as far down as double resolves it; NaN likewise */
    double floor;          /* the smallest error ... */
    unsigned best;         /* ... and its rung */
    double largest_floor;  /* the smallest of `largest` ... */
    unsigned largest_best; /* ... and its rung */
} fp3_convergence;

/* Runs the program's reference, which has the bits of every engine. compiled: made from the
 * ladder's model. order: the theoretical one, which determines over how many rungs slopes are
 * taken. */
fp3_status fp3_converge(const fp3_ladder *ladder, const fp3_compiled *compiled, unsigned order,
                        fp3_convergence *convergence, fp3_error *error);

FP3_API_END

#endif
