/* SPDX-License-Identifier: Apache-2.0 */
/* double_step.h - a step whose values are floats to one whose values are pairs of them. */
#ifndef FP3_DOUBLE_STEP_H
#define FP3_DOUBLE_STEP_H

#include "compiler/step/step.h"

/* FP3_E_PROGRAM: the configuration rounds otherwise. FP3_E_ARGUMENT: the options have
 * another arithmetic, or another division, too. */
fp3_status fp3_double_check(const fp3_options *options, fp3_error *error);

/* Each node becomes a pair (double_single.h). A variable keeps its number and is the first word;
 * the second word is a variable of ROLE_LOW or ROLE_LOW_BEFORE behind all others. Comes before
 * carry.h. */
fp3_status fp3_double_step(fp3_step *step, fp3_error *error);

#endif
