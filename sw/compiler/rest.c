/* rest.c - see rest.h. */
#include "rest.h"

#include "compiler/adaptive/adaptive.h"
#include "schedule/cost.h"

#include <fp3/isa.h>
#include <stdlib.h>

/* A step is there, or it is 0: any number between serves, and the step has one that tells them apart. */
static uint32_t least_constant(const fp3_step *step, const conversion *c) {
    uint32_t i = 0;
    while (!fp3_known_is(&step->known, c->constants[i], FP3_ADAPTIVE_LEAST))
        i++;
    return FP3_BANK_SHARED_BASE + i;
}

fp3_status fp3_rest(const fp3_step *step, const conversion *c, const fp3_config *config,
                    fp3_schedule *schedule, fp3_error *error) {
    if (step->tested == FP3_NONE || !config->sleep)
        return FP3_OK;
    fp3_line *lines = realloc(schedule->step, (schedule->step_count + 1u) * sizeof *lines);
    if (!lines)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    const uint32_t least = least_constant(step, c);
    lines[schedule->step_count++] = (fp3_line){.op = FP3_OP_SLEEP,
                                               .d = fp3_step_find(step, ROLE_SLEPT, FP3_NONE),
                                               .operand = {step->tested, least, least},
                                               .note = step->rest_note};
    schedule->step = lines;
    return fp3_cost_find(&c->code, config, schedule, error);
}
