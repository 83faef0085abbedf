/* SPDX-License-Identifier: Apache-2.0 */
/* remember.h - what entries of neighbours remember after a step. */
#ifndef FP3_INTEGRATE_REMEMBER_H
#define FP3_INTEGRATE_REMEMBER_H

#include "compiler/step/advance.h"

/* After projections and events: fills kept of the step. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_remember(fp3_advance *a, fp3_error *error);

#endif
