/* SPDX-License-Identifier: Apache-2.0 */
/* longest.h - how long a step must take on the solo machine, from its data alone. */
#ifndef FP3_LONGEST_H
#define FP3_LONGEST_H

#include "code.h"

/* Cycles per step of the longest dependence from step to step. */
fp3_status fp3_longest_path(const fp3_step_code *code, const fp3_config *config, double *cycles,
                            fp3_error *error);

#endif
