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

FP3_API_END

#endif
