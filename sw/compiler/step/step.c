/* SPDX-License-Identifier: Apache-2.0 */
/* step.c - known values, nodes and variables of a step. */
#include "step.h"

#include <assert.h>
#include <stdlib.h>

/* Empty, with the rules of another one. */
static void open_like(dag *made, const dag *g, known_table *known) {
    fp3_dag_open(made, known, g->passes);
    made->is_flushed = g->is_flushed;
    made->is_finite = g->is_finite;
    made->terms = g->terms;
    made->is_abstract = g->is_abstract;
    made->is_direct = g->is_direct;
}

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

int fp3_step_cut(fp3_step *step, uint32_t times) {
    fp3_segment *more = realloc(step->segments, (step->segment_count + 1u) * sizeof *more);
    uint32_t *next = malloc((step->variable_count + 1u) * sizeof *next);
    if (more)
        step->segments = more;
    if (!more || !next) {
        free(next);
        return 0;
    }
    for (uint32_t i = 0; i < step->variable_count; i++) {
        next[i] = step->variables[i].next;
        step->variables[i].next = FP3_NONE;
    }
    more[step->segment_count++] = (fp3_segment){step->values, next, step->sight, times};
    open_like(&step->values, &step->last, &step->known);
    step->sight = (fp3_sight){.stopped = FP3_NONE};
    return 1;
}

void fp3_step_close(fp3_step *step) {
    for (uint32_t i = 0; i < step->segment_count; i++) {
        fp3_dag_close(&step->segments[i].values);
        free(step->segments[i].next);
        free(step->segments[i].sight.list);
    }
    free(step->segments);
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
    int has_failed = step->notes.has_failed || step->sight.has_failed || step->known.has_failed ||
                     step->values.has_failed || step->last.has_failed;
    int is_full = step->values.is_full || step->last.is_full;
    for (uint32_t i = 0; i < step->segment_count; i++) {
        has_failed |= step->segments[i].values.has_failed || step->segments[i].sight.has_failed;
        is_full |= step->segments[i].values.is_full;
    }
    if (has_failed)
        return fp3_no_memory(error);
    if (is_full)
        return fp3_fail(error, FP3_E_LIMIT,
                        "a step needs more than %u operations: no instruction memory holds them",
                        FP3_DAG_LIMIT);
    return FP3_OK;
}
