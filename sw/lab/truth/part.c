/* SPDX-License-Identifier: Apache-2.0 */
/* part.c - see part.h. */
#include "part.h"

#include <gsl/gsl_errno.h>
#include <math.h>

/* bsimp refuses a step that does not change t, and where it fails, its error is infinite. */
int fp3_part_go(gsl_odeiv2_step *step, const gsl_odeiv2_system *system, double t, double h,
                double *y, double *lost) {
    if (t + h == t)
        return GSL_SUCCESS;
    gsl_odeiv2_step_reset(step);
    const int result = gsl_odeiv2_step_apply(step, t, h, y, lost, NULL, NULL, system);
    for (size_t i = 0; !result && i < system->dimension; i++)
        if (!isfinite(lost[i]))
            return GSL_EFAILED;
    return result;
}
