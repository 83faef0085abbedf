/* SPDX-License-Identifier: Apache-2.0 */
/* chebyshev.h - a step of a stabilised explicit method (Runge, Kutta, Chebyshev), by its
 * recurrence. */
#ifndef FP3_COMPILER_CHEBYSHEV_H
#define FP3_COMPILER_CHEBYSHEV_H

#include "compiler/step/advance.h"

/* a->now and a->lost become those after the step. */
fp3_status fp3_chebyshev(fp3_advance *a, fp3_error *error);

#endif
