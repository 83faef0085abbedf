/* fp3/truth.h - where an object of a model really is, what the steps of a program are by the equations, and
 * how the error falls with the time step. Experimental: it may change from version to version.
 *
 *     fp3_ladder *ladder = NULL;
 *     fp3_convergence found;
 *     if (fp3_ladder_open(model, 0, 100000, &ladder, &error) ||
 *         fp3_converge(ladder, compiled, compiled->order, &found, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     else
 *         printf("order %.2f, error %.1e at best\n", found.order, found.floor);
 *     fp3_ladder_close(&ladder);
 */

#ifndef FP3_TRUTH_H
#define FP3_TRUTH_H

#include <fp3/api.h>
#include <fp3/compile.h>
#include <fp3/model.h>

FP3_API_BEGIN

/* At time t (negative, too): GSL's rk8pd at tight tolerance, and the closed forms of the model if it
 * has them, with which it must agree: FP3_E_MISMATCH. states has model->state_count numbers. */
fp3_status fp3_model_truth(const fp3_model *model, const double *params, const double *initial,
                           double t, double *states, fp3_error *error);
/* At several times above 0, upwards, in one go: states has a row of model->state_count numbers for each
 * of count times. sizes (may be NULL) gets the largest magnitude of each state up to the last; with it
 * two truths are compared at each time. FP3_E_ARGUMENT: also for other times. */
fp3_status fp3_model_truths(const fp3_model *model, const double *params, const double *initial,
                            const double *times, size_t count, double *states, double *sizes,
                            fp3_error *error);

/* ---- the steps of a compiled program, straight from the equations ---- */

/* Without any pass that keeps the bits, in FP32: what every engine must equal bit for bit. params,
 * initial and h as of fp3_compiled_inputs. states has count rows of model->state_count floats. Row i gets,
 * after steps[i] steps (none less than the one before), the states that are computed (observed, or
 * needed by what is), a NaN as 7FC00000; others are unchanged. */
fp3_status fp3_compiled_reference(const fp3_compiled *compiled, const double *params,
                                  const double *initial, double h, const uint64_t *steps,
                                  size_t count, float *states, fp3_error *error);

/* The same with the second words of double-single, which are 0 in any other arithmetic. low has as many
 * floats as states; a state is the sum of its two. */
fp3_status fp3_compiled_reference_pairs(const fp3_compiled *compiled, const double *params,
                                        const double *initial, double h, const uint64_t *steps,
                                        size_t count, float *states, float *low, fp3_error *error);

/* The same steps in double, with quotients and roots in double: the integrator without FP32. All other
 * functions are the same polynomials. */
fp3_status fp3_compiled_exact(const fp3_compiled *compiled, const double *params,
                              const double *initial, double h, const uint64_t *steps, size_t count,
                              double *states, fp3_error *error);

/* The same steps in double again, by the numbers that the host gives the program, rounded as the program has them
 * (h, params, coefficients and what is made of them): what FP32 does to the method before a step is made. Of
 * double-single nothing is rounded. The start is not, either. */
fp3_status fp3_compiled_exact_given(const fp3_compiled *compiled, const double *params,
                                    const double *initial, double h, const uint64_t *steps,
                                    size_t count, double *states, fp3_error *error);

/* ---- how the error of a program falls with its time step ---- */

#define FP3_RUNGS_MOST 40
#define FP3_STEPS_MOST 8388608 /* of the last of so many rungs */
#define FP3_LOOKS                                                                                  \
    8 /* times at which a run is compared with the truth, evenly, the last at its end */

/* Runs of one model over the same span, each with about 1.4 times the steps of the one before, and
 * where the object then really is. Read it, never change it. */
typedef struct {
    const fp3_model *model;   /* the caller's; it must outlive the ladder */
    double *params, *initial; /* the model's defaults, as FP32 has them */
    double *scale;            /* of each state: the largest magnitude along the truth */
    unsigned count;           /* rungs */
    uint64_t steps[FP3_RUNGS_MOST];
    float h[FP3_RUNGS_MOST];
    double *truth[FP3_RUNGS_MOST]; /* FP3_LOOKS rows of a number for each state */
} fp3_ladder;

/* span: how long the model is integrated, in its unit of time; 0: the model's own span. most_steps:
 * of the last rung, at least FP3_LOOKS. The caller closes *ladder, which is NULL on failure.
 * FP3_E_MISMATCH as of fp3_model_truth. */
fp3_status fp3_ladder_open(const fp3_model *model, double span, uint64_t most_steps,
                           fp3_ladder **ladder, fp3_error *error);
/* Sets *ladder to NULL; that it was NULL before does no harm. */
void fp3_ladder_close(fp3_ladder **ladder);

typedef struct {
    /* By rung, relative to the scale, root of the mean square over states and looks. NaN or infinite
     * where a run went wrong; NaN also beyond the rung from which only noise is left. */
    double error[FP3_RUNGS_MOST];  /* of FP32 */
    double method[FP3_RUNGS_MOST]; /* of the same steps in double: the integrator's own */
    double noise[FP3_RUNGS_MOST];  /* between the two */
    /* Slopes of error and method over rungs from .. to, where the noise is small beside the method's
     * error; NaN: there are no such rungs. */
    double order, method_order;
    unsigned from, to;
    double finest_order; /* slope of method as far down as double sees it; NaN likewise */
    double floor;        /* the smallest error ... */
    unsigned best;       /* ... and its rung */
} fp3_convergence;

/* Runs the program's reference, which has the bits of every engine. compiled: from the ladder's
 * model; order: the theoretical one, which says over how many rungs slopes are taken. */
fp3_status fp3_converge(const fp3_ladder *ladder, const fp3_compiled *compiled, unsigned order,
                        fp3_convergence *convergence, fp3_error *error);

FP3_API_END

#endif
