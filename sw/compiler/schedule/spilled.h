/* SPDX-License-Identifier: Apache-2.0 */
/* spilled.h - a program whose values do not fit into the registers, with loads and stores in each
 * part. */
#ifndef FP3_SPILLED_H
#define FP3_SPILLED_H

#include "code.h"
#include "lines.h"

/* Fills the lines of a schedule, the loads and stores of a visit included: the host adds none.
 * FP3_E_LIMIT: the program does not fit even so. FP3_E_PROGRAM: more variables and params than
 * registers. */
fp3_status fp3_spilled_make(const fp3_step_code *code, const fp3_config *config, fp3_schedule *made,
                            fp3_error *error);

#endif
