/* SPDX-License-Identifier: Apache-2.0 */
/* step.c - known values, nodes and variables of a step. */
#include "step.h"

#include <assert.h>
#include <stdlib.h>

fp3_status fp3_step_open(fp3_step *step, const fp3_model *model, const fp3_options *options,
                         fp3_error *error) {
    *step = (fp3_step){.model = model,
                       .notes = {.is_on = options->has_notes},
                       .tested = FP3_NONE,
                       .sight.stopped = FP3_NONE,
                       .kept_place = FP3_NONE,
                       .coupling = options->coupling,
                       .phases = 1};
    fp3_known_open(&step->known, model, options->arithmetic == FP3_DOUBLE_SINGLE ? 2 : 1);
    fp3_dag_open(&step->values, &step->known, options->passes);
    fp3_dag_open(&step->last, &step->known, options->passes);
    step->values.is_flushed = step->last.is_flushed =
        !options->config->subnormal || options->config->logarithmic;
    step->values.is_finite = step->last.is_finite = options->config->finite;
    step->values.terms = step->last.terms = fp3_options_terms(options);
    step->values.is_abstract = step->last.is_abstract = options->arithmetic == FP3_DOUBLE_SINGLE;
    step->values.is_direct = step->last.is_direct =
        options->config->logarithmic || options->config->mixed;
    return step->known.has_failed ? fp3_no_memory(error) : FP3_OK;
}

void fp3_step_close(fp3_step *step) {
    fp3_known_close(&step->known);
    fp3_dag_close(&step->values);
    fp3_dag_close(&step->last);
    free(step->variables);
    free(step->sight.list);
    fp3_notes_close(&step->notes);
    *step = (fp3_step){0};
}

int fp3_step_add(fp3_step *step, role role, uint32_t state) {
    assert(role == ROLE_CARRIED || fp3_step_find(step, role, state) == FP3_NONE);
    if (step->variable_count == step->variable_room) {
        const uint32_t room = step->variable_room ? 2 * step->variable_room : 16;
        variable *variables = realloc(step->variables, room * sizeof *variables);
        if (!variables)
            return 0;
        step->variables = variables;
        step->variable_room = room;
    }
    step->variables[step->variable_count++] = (variable){
        .role = role, .state = state, .next = FP3_NONE, .first = FP3_NONE, .last = FP3_NONE};
    return 1;
}

uint32_t fp3_step_find(const fp3_step *step, role role, uint32_t state) {
    for (uint32_t i = 0; i < step->variable_count; i++)
        if (step->variables[i].role == role && step->variables[i].state == state)
            return i;
    return FP3_NONE;
}

fp3_status fp3_step_check(const fp3_step *step, fp3_error *error) {
    if (step->notes.has_failed || step->sight.has_failed || step->known.has_failed ||
        step->values.has_failed || step->last.has_failed)
        return fp3_no_memory(error);
    if (step->values.is_full || step->last.is_full)
        return fp3_fail(error, FP3_E_LIMIT,
                        "a step needs more than %u operations: no instruction memory holds them",
                        FP3_DAG_LIMIT);
    return FP3_OK;
}
