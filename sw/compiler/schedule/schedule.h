/* SPDX-License-Identifier: Apache-2.0 */
/* schedule.h - an order of issue and registers for a configuration. */
#ifndef FP3_SCHEDULE_H
#define FP3_SCHEDULE_H

#include "code.h"
#include "lines.h"

/* An order and registers for a configuration. FP3_E_LIMIT: too few registers: the message says how
 * many the best order needs, how many the configuration has, and which configuration has more.
 * FP3_E_ARGUMENT: an invalid reference. The caller frees. */
fp3_status fp3_schedule_make(const fp3_step_code *code, const fp3_config *config,
                             fp3_schedule **schedule, fp3_error *error);
void fp3_schedule_free(fp3_schedule **schedule);

#endif
