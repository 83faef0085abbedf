/* SPDX-License-Identifier: Apache-2.0 */
/* rosenbrock.h - a step of a linearly implicit method (Rosenbrock and Wanner). */
#ifndef FP3_ROSENBROCK_H
#define FP3_ROSENBROCK_H

#include "compiler/step/advance.h"

/* Whether the integrator has its order whatever matrix stands for the Jacobian (a W-method); also 1
 * for one that is not linearly implicit. Where objects see each other, the matrix has derivatives
 * by the object's own states alone. */
int fp3_rosenbrock_is_free(const fp3_integrator *integrator);

/* The partial derivatives of a->step->model, as of fp3_differentiate, are `partial`. a->now and
 * a->lost become the values after the step. */
fp3_status fp3_rosenbrock(fp3_advance *a, const uint32_t *partial, fp3_error *error);

#endif
