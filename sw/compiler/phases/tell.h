/* SPDX-License-Identifier: Apache-2.0 */
/* tell.h - what the programs of other kinds have to know of a step. */
#ifndef FP3_PHASES_TELL_H
#define FP3_PHASES_TELL_H

#include "plan.h"

/* The step's phases, when others see what, and at which places it looks at them. FP3_E_LIMIT: at
 * too many. */
fp3_status fp3_cut_tell(fp3_cut_plan *plan, fp3_error *error);

#endif
