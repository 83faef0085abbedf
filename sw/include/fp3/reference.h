/* fp3/reference.h - the steps of a compiled program, straight from the equations. */
#ifndef FP3_REFERENCE_H
#define FP3_REFERENCE_H

#include <fp3/api.h>
#include <fp3/compile.h>

FP3_API_BEGIN

/* Without any pass that keeps the bits, in FP32: what every engine must equal bit for bit. params,
 * initial and h as in fp3/start.h. states has count rows of model->state_count floats. Row i gets,
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

FP3_API_END

#endif
