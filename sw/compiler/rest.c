/* SPDX-License-Identifier: Apache-2.0 */
/* rest.c - see rest.h. */
#include "rest.h"

#include "compiler/schedule/cost.h"

#include <fp3/isa.h>
#include <stdlib.h>

fp3_status fp3_rest(const fp3_step *step, const conversion *c, const fp3_config *config,
                    fp3_schedule *schedule, fp3_error *error) {
    if (step->tested == FP3_NONE || !config->sleep)
        return FP3_OK;
    fp3_line *lines = realloc(schedule->step, (schedule->step_count + 1u) * sizeof *lines);
    if (!lines)
        return fp3_no_memory(error);
    const uint32_t least = FP3_BANK_SHARED_BASE + c->least;
    lines[schedule->step_count++] = (fp3_line){.op = FP3_OP_SLEEP,
                                               .d = fp3_step_find(step, ROLE_SLEPT, FP3_NONE),
                                               .operand = {step->tested, least, least},
                                               .note = step->rest_note};
    schedule->step = lines;
    return fp3_cost_find(&c->code, config, schedule, error);
}
