/* SPDX-License-Identifier: Apache-2.0 */
/* carry.h - values that the step before has computed already ("first same as last").
 *
 * If the step computes a value from its old states, and the same value from its new states, the
 * next step need not compute the first one: it becomes a variable.
 */
#ifndef FP3_CARRY_H
#define FP3_CARRY_H

#include "compiler/step/step.h"

/* Adds variables of ROLE_CARRIED. */
fp3_status fp3_carry(fp3_step *step, fp3_error *error);

#endif
