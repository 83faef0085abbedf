/* SPDX-License-Identifier: Apache-2.0 */
/* model.c - models that have been read. */
#include <fp3/model.h>

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static void free_quantities(fp3_quantity *quantities, uint32_t count) {
    for (uint32_t i = 0; quantities && i < count; i++) {
        free(quantities[i].dimension);
        free(quantities[i].doc);
    }
    free(quantities);
}

void fp3_model_free(fp3_model **model) {
    fp3_model *m = *model;
    if (!m)
        return;
    free_quantities(m->states, m->state_count);
    free_quantities(m->params, m->param_count);
    free_quantities(m->fields, m->field_count);
    free(m->relations);
    free(m->kinds);
    free(m->memories);
    free(m->definitions);
    free(m->invariants);
    free(m->group_invariants);
    free(m->events);
    free(m->projections);
    free(m->repeats);
    free(m->assignments);
    free(m->exprs);
    free(m->doc);
    free(m);
    *model = NULL;
}

fp3_status fp3_model_check_alone(const fp3_model *model, fp3_error *error) {
    if (fp3_model_removes(model))
        return fp3_fail(error, FP3_E_PROGRAM,
                        "line %" PRIu32 " of model '%s' removes objects, and this command needs "
                        "objects that make all steps",
                        fp3_model_removes(model), model->name);
    if (!model->relation_count)
        return FP3_OK;
    return fp3_fail(error, FP3_E_PROGRAM,
                    "objects of model '%s' see each other ('%s', line %" PRIu32
                    "), and this command computes each object alone",
                    model->name, model->relations[0].name, model->relations[0].line);
}

static uint32_t find(const fp3_quantity *quantities, uint32_t count, const char *name) {
    for (uint32_t i = 0; i < count; i++)
        if (!strcmp(quantities[i].name, name))
            return i;
    return FP3_NONE;
}

uint32_t fp3_model_state(const fp3_model *model, const char *name) {
    return find(model->states, model->state_count, name);
}

uint32_t fp3_model_param(const fp3_model *model, const char *name) {
    return find(model->params, model->param_count, name);
}
