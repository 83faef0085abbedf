/* SPDX-License-Identifier: Apache-2.0 */
/* splitting.h - a step as kicks of velocities and drifts of positions. */
#ifndef FP3_SPLITTING_H
#define FP3_SPLITTING_H

#include "compiler/step/advance.h"

/* a->now and a->lost become those after the step. */
fp3_status fp3_splitting(fp3_advance *a, fp3_error *error);

#endif
