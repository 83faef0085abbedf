/* SPDX-License-Identifier: Apache-2.0 */
/* options.c - passes for a configuration, and sets of states. */
#include "options.h"

#include "compiler/value/dag.h"

#include <assert.h>

unsigned fp3_options_usable(unsigned passes, const fp3_config *config) {
    if (!config->scale)
        passes &= ~FP3_PASS(FP3_PASS_SCALE);
    if (!config->chain && !config->fused)
        passes &= ~FP3_PASS(FP3_PASS_CHAIN);
    if (!config->fused)
        passes &= ~FP3_PASS(FP3_PASS_FUSE);
    if (config->interleave)
        passes &= ~FP3_PASS(FP3_PASS_AHEAD);
    if (!(passes & FP3_PASS(FP3_PASS_COMMON))) /* carry finds a value by its one node */
        passes &= ~FP3_PASS(FP3_PASS_CARRY);
    return passes;
}

/* An estimate is off by 2^-8 at most, or by 2^-6 with the fewest bits, and the omitted term is the
 * square or the cube of that error: less than half of the last place. */
int fp3_options_terms(const fp3_options *options) {
    return options->config->fraction <= 15 ? 1 : FP3_DAG_TERMS;
}

fp3_status fp3_options_observe(const fp3_model *model, const char *const *names, size_t count,
                               uint64_t *observed, fp3_error *error) {
    assert(model->state_count <= FP3_STATES_MAX);
    *observed = model->state_count >= 64 ? UINT64_MAX : (UINT64_C(1) << model->state_count) - 1;
    if (!names)
        return FP3_OK;
    *observed = 0;
    for (size_t i = 0; i < count; i++) {
        const uint32_t state = fp3_model_state(model, names[i]);
        if (state == FP3_NONE)
            return fp3_fail(error, FP3_E_ARGUMENT, "the model has no state '%s'", names[i]);
        *observed |= UINT64_C(1) << state;
    }
    return FP3_OK;
}
