/* SPDX-License-Identifier: Apache-2.0 */
/* rest.h - the instruction by which an object ends its run. */
#ifndef FP3_REST_H
#define FP3_REST_H

#include "compiler/code/convert.h"
#include "compiler/schedule/lines.h"

/* Puts `sleep` behind the step part, if the configuration has `sleep` and step->tested names the
 * compared value. FP3_E_SYSTEM, or FP3_E_LIMIT: the program memory is full. */
fp3_status fp3_rest(const fp3_step *step, const conversion *c, const fp3_config *config,
                    fp3_schedule *schedule, fp3_error *error);

#endif
