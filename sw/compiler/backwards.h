/* SPDX-License-Identifier: Apache-2.0 */
/* backwards.h - where an object of a model was a step before its start, in double. */
#ifndef FP3_BACKWARDS_H
#define FP3_BACKWARDS_H

#include <fp3/model.h>

typedef struct fp3_backwards fp3_backwards;

/* The caller closes *backwards, which is NULL on failure. The model must outlive it. */
fp3_status fp3_backwards_open(const fp3_model *model, fp3_backwards **backwards, fp3_error *error);
/* Sets *backwards to NULL, which it may be already. */
void fp3_backwards_close(fp3_backwards **backwards);

/* The states at time -h, to 3e-13 of each state's size (tests/tune/test_tune.py). For Arenstorf's
 * orbit, beside steps of 80 bits, the error is up to 7e-14; GSL's rk8pd at 1e-14 has 6e-14.
 * FP3_E_ARGUMENT: the equations have no solution that far back. */
fp3_status fp3_backwards_go(fp3_backwards *backwards, const double *params, const double *initial,
                            double h, double *states, fp3_error *error);

#endif
