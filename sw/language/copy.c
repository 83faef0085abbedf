/* SPDX-License-Identifier: Apache-2.0 */
/* copy.c - a second model like the first, for who changes it. */
#include <fp3/model.h>

#include <stdlib.h>
#include <string.h>

/* NULL where there is no memory. */
static void *again(const void *from, size_t count, size_t size) {
    void *to = calloc(count + 1u, size);
    if (to && count)
        memcpy(to, from, count * size);
    return to;
}

/* *is_whole becomes 0 where there is no memory: what is there can be freed. */
static fp3_quantity *quantities(const fp3_quantity *from, uint32_t count, int *is_whole) {
    fp3_quantity *to = again(from, count, sizeof *to);
    for (uint32_t i = 0; to && i < count; i++) {
        to[i].dimension = strdup(from[i].dimension);
        to[i].doc = strdup(from[i].doc);
        *is_whole &= to[i].dimension && to[i].doc;
    }
    *is_whole &= to != NULL;
    return to;
}

fp3_status fp3_model_copy(const fp3_model *model, fp3_model **copy, fp3_error *error) {
    fp3_model *m = *copy = again(model, 1, sizeof *m);
    int is_whole = m != NULL;
    if (m) {
        m->doc = strdup(model->doc);
        m->states = quantities(model->states, model->state_count, &is_whole);
        m->params = quantities(model->params, model->param_count, &is_whole);
        m->fields = quantities(model->fields, model->field_count, &is_whole);
        m->relations = again(model->relations, model->relation_count, sizeof *m->relations);
        m->kinds = again(model->kinds, model->kind_count, sizeof *m->kinds);
        m->memories = again(model->memories, model->memory_count, sizeof *m->memories);
        m->definitions = again(model->definitions, model->definition_count, sizeof *m->definitions);
        m->invariants = again(model->invariants, model->invariant_count, sizeof *m->invariants);
        m->group_invariants = again(model->group_invariants, model->group_invariant_count,
                                    sizeof *m->group_invariants);
        m->events = again(model->events, model->event_count, sizeof *m->events);
        m->projections = again(model->projections, model->projection_count, sizeof *m->projections);
        m->repeats = again(model->repeats, model->repeat_count, sizeof *m->repeats);
        m->assignments = again(model->assignments, model->assignment_count, sizeof *m->assignments);
        m->exprs = again(model->exprs, model->expr_count, sizeof *m->exprs);
        is_whole &= m->doc && m->definitions && m->invariants && m->events && m->projections &&
                    m->assignments && m->exprs && m->relations && m->memories && m->kinds &&
                    m->repeats && m->group_invariants;
    }
    if (is_whole)
        return FP3_OK;
    fp3_model_free(copy);
    return fp3_no_memory(error);
}
