/* SPDX-License-Identifier: Apache-2.0 */
/* integrate.h - a model and an integrator to one step. */
#ifndef FP3_INTEGRATE_H
#define FP3_INTEGRATE_H

#include <fp3/model.h>

#include "compiler/step/fit.h"
#include "compiler/step/step.h"

/* fit says which states are computed. The caller closes the step, after a failure too. */
fp3_status fp3_integrate(const fp3_model *model, const fp3_integrator *integrator,
                         const fp3_options *options, const fp3_fit *fit, fp3_step *step,
                         fp3_error *error);

#endif
