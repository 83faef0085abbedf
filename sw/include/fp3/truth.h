/* fp3/truth.h - where an object of a model really is, in double. */
#ifndef FP3_TRUTH_H
#define FP3_TRUTH_H

#include <fp3/api.h>
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

FP3_API_END

#endif
