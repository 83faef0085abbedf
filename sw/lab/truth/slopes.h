/* SPDX-License-Identifier: Apache-2.0 */
/* slopes.h - the equations of an object as GSL takes them: the derivatives of its states, and
 * theirs.
 *
 *     fp3_slopes slopes;
 *     if (!fp3_slopes_open(&slopes, model, params, initial, 20, error))
 *         ... gsl_odeiv2_system system = {fp3_slopes_of, fp3_slopes_jacobian, states, &slopes};
 *     fp3_slopes_close(&slopes);
 */
#ifndef FP3_TRUTH_SLOPES_H
#define FP3_TRUTH_SLOPES_H

#include <fp3/model.h>

#include "compiler/integrate/derivative.h"
#include "switches.h"

typedef struct {
    const fp3_model *model;
    const double *params, *initial;
    fp3_switches switches;
    double *values;             /* of all expressions, and those of `partial` once there are any */
    int has_stopped;            /* at an event: nothing moves any more */
    fp3_differentiated partial; /* made by the first call of fp3_slopes_jacobian */
} fp3_slopes;

/* For times from 0 to end. Errors as of fp3_switches_open. The caller closes, after a failure too.
 */
fp3_status fp3_slopes_open(fp3_slopes *s, const fp3_model *model, const double *params,
                           const double *initial, double end, fp3_error *error);
void fp3_slopes_close(fp3_slopes *s);

/* GSL's two functions: switches are held. GSL_EDOM: a derivative is infinite or has no value. */
int fp3_slopes_of(double t, const double y[], double dydt[], void *slopes);
/* Exact: the partial derivatives of the expressions, by each state and by t. Also GSL_ENOMEM. */
int fp3_slopes_jacobian(double t, const double y[], double *dfdy, double dfdt[], void *slopes);

#endif
