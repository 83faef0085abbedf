/* SPDX-License-Identifier: Apache-2.0 */
/* savings.c - the same model once more without each pass. */
#include "savings.h"

#include "machine/operation.h"

/* Uses of the multiplier. */
static uint32_t products(const fp3_pipeline *p) {
    uint32_t found = 0;
    for (uint32_t i = 0; i < p->code.code.step_count; i++) {
        const fp3_operation *operation = fp3_operation_find(p->code.code.step[i].op);
        found += (operation->path & FP3_UNIT_MULTIPLIER) != 0;
    }
    return found;
}

static double cost(const fp3_pipeline *p, fp3_pass pass) {
    switch (pass) {
    case FP3_PASS_AHEAD:
        return p->schedule->cycles;
    case FP3_PASS_SCALE:
        return products(p);
    case FP3_PASS_CHAIN:
        return p->schedule->step_count;
    case FP3_PASS_SHARE:
        return p->schedule->registers;
    default:
        return p->code.operations;
    }
}

void fp3_savings(const fp3_pipeline *with, const fp3_integrator *integrator,
                 const fp3_options *options, uint32_t saved[FP3_PASS_COUNT]) {
    for (int pass = 0; pass < FP3_PASS_COUNT; pass++) {
        saved[pass] = 0;
        if (!fp3_has_pass(options, (fp3_pass)pass))
            continue;
        fp3_options other = *options;
        fp3_pipeline without;
        other.passes = fp3_options_usable(options->passes & ~FP3_PASS(pass), options->config);
        other.has_notes = 0;
        if (!fp3_pipeline_run(&without, with->step.model, integrator, &other, NULL)) {
            const double less = cost(&without, (fp3_pass)pass) - cost(with, (fp3_pass)pass);
            saved[pass] = less > 0 ? (uint32_t)(less + 0.5) : 0;
        }
        fp3_pipeline_close(&without);
    }
}
