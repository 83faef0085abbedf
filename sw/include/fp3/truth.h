/* SPDX-License-Identifier: Apache-2.0 */
/* fp3/truth.h - where an object really is, and where a program takes it, computed from the
 * equations.
 *
 *     double params[64], initial[64], states[64];
 *     // Fill params and initial, in the order in which the model has its params and states.
 *     if (fp3_model_truth(model, params, initial, 1.5, states, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *
 * This header belongs to the library libfp3_lab, which needs GSL.
 *
 * Threads: a call works in the calling thread. Calls in different threads do not affect each other.
 * Experimental.
 */
#ifndef FP3_TRUTH_H
#define FP3_TRUTH_H

#include <fp3/compile.h>
#include <fp3/model.h>
#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

FP3_API_BEGIN

/* The states at time t, which may be negative: by GSL's rk8pd at a tight tolerance (by bsimp if the
 * model is stiff), and by the model's closed forms, or by another method if there are none.
 * FP3_E_MISMATCH: the two do not agree. FP3_E_ARGUMENT: also if a method does not reach t. states
 * has model->state_count numbers. */
fp3_status fp3_model_truth(const fp3_model *model, const double *params, const double *initial,
                           double t, double *states, fp3_error *error);
/* The states at count times, all above 0 and ascending: states has a row of model->state_count
 * numbers for each. sizes (may be NULL) gets the largest magnitude of each state up to the last
 * time; with sizes, two truths are compared at each time. FP3_E_ARGUMENT: also if times are not as
 * above. */
fp3_status fp3_model_truths(const fp3_model *model, const double *params, const double *initial,
                            const double *times, size_t count, double *states, double *sizes,
                            fp3_error *error);

/* ---- the steps of a compiled program, computed directly from the equations ---- */

/* The reference, in FP32 and without any of the passes that keep the bits. Every engine must give
 * the same bits. params, initial and h are as for fp3_compiled_inputs. states has count rows of
 * model->state_count floats. Row i gets the states after steps[i] steps; steps must not decrease.
 * Only observed states, and states that these need, are written; a NaN is 7FC00000. */
fp3_status fp3_compiled_reference(const fp3_compiled *compiled, const double *params,
                                  const double *initial, double h, const uint64_t *steps,
                                  size_t count, float *states, fp3_error *error);

/* The same with the second words of double-single, which are 0 in any other arithmetic. low has as
 * many floats as states; a state is the sum of both words. */
fp3_status fp3_compiled_reference_pairs(const fp3_compiled *compiled, const double *params,
                                        const double *initial, double h, const uint64_t *steps,
                                        size_t count, float *states, float *low, fp3_error *error);

/* The same steps in double, including quotients and roots: the integrator without the effects of
 * FP32. All other functions are the same polynomials. */
fp3_status fp3_compiled_exact(const fp3_compiled *compiled, const double *params,
                              const double *initial, double h, const uint64_t *steps, size_t count,
                              double *states, fp3_error *error);

/* The same steps in double, but the numbers that the host gives the program (h, params,
 * coefficients and values computed from these) are rounded as in the program. This shows the effect
 * of FP32 on the method before the first step. The start is not rounded; in double-single nothing
 * is rounded. */
fp3_status fp3_compiled_exact_given(const fp3_compiled *compiled, const double *params,
                                    const double *initial, double h, const uint64_t *steps,
                                    size_t count, double *states, fp3_error *error);

FP3_API_END

#endif
