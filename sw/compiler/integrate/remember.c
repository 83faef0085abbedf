/* SPDX-License-Identifier: Apache-2.0 */
/* remember.c - see remember.h. */
#include "remember.h"

#include "compiler/value/ops.h"

/* An attempt that is rejected changes nothing. */
static uint32_t kept(const fp3_advance *a, uint32_t field, uint32_t node) {
    dag *g = &a->step->values;
    return a->is_adaptive
               ? sel(g, a->is_good, node, fp3_dag_neighbour(g, NODE_FIELD, field, FP3_NONE, 0))
               : node;
}

fp3_status fp3_remember(fp3_advance *a, fp3_error *error) {
    const fp3_model *model = a->step->model;
    fp3_step *step = a->step;
    lowering l;
    if (!model->memory_count)
        return FP3_OK;
    const fp3_status status = fp3_advance_behind(a, &l, error);
    step->kept_place = l.index;
    if (!status)
        fp3_advance_show(a, &l);
    for (uint32_t i = 0; !status && i < model->memory_count; i++) {
        const fp3_memory *m = &model->memories[i];
        step->kept[step->kept_count++] =
            (fp3_kept){m->relation, m->field,
                       kept(a, m->field, fp3_term_value(&step->values, fp3_lower(&l, m->expr))), 0};
        fp3_lower_look(&l, m->relation);
    }
    fp3_lower_close(&l);
    return status;
}
