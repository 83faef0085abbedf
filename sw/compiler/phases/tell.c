/* SPDX-License-Identifier: Apache-2.0 */
/* tell.c - see tell.h. */
#include "tell.h"

static int is_of_kind(const fp3_cut_plan *c, uint32_t relation) {
    return c->step->model->relations[relation].of_kind != FP3_NONE;
}

static int look(fp3_cut_plan *c, uint32_t place, uint32_t phase) {
    const uint32_t number = fp3_step_place(c->step, place);
    if (number == FP3_NONE)
        return 0;
    c->step->looks |= UINT64_C(1) << number;
    if (c->base + phase > c->step->phase[number])
        c->step->phase[number] = (uint8_t)(c->base + phase);
    return 1;
}

static void compare(fp3_cut_plan *c, uint32_t node) {
    const uint32_t which = fp3_cut_node(c, node)->c;
    c->step->compares |= 1u << which;
    c->step->behind[which] = (uint8_t)(c->base + c->when[node] / FP3_CUT_SLOTS - 1);
}

fp3_status fp3_cut_tell(fp3_cut_plan *c, fp3_error *error) {
    fp3_step *step = c->step;
    int is_good = 1;
    step->phases = c->base + c->phase_count;
    for (uint32_t i = 0; i < FP3_PLACES; i++)
        if (c->handled >> i & 1)
            step->phase[i] = (uint8_t)(c->base + c->phase_of[i]);
    for (uint32_t i = 0; i < c->g->count; i++)
        if (c->is_needed[i] && fp3_cut_node(c, i)->op == NODE_WORST)
            compare(c, i);
    for (uint32_t i = 0; i < c->g->count; i++)
        if (c->is_needed[i] && fp3_dag_is_fold(fp3_cut_node(c, i)->op) &&
            is_of_kind(c, fp3_dag_relation(c->g, i)))
            is_good &= look(c, fp3_dag_place(c->g, i), c->when[i] / FP3_CUT_SLOTS);
    for (uint32_t k = 0; k < step->kept_count; k++)
        if (is_of_kind(c, step->kept[k].relation))
            is_good &= look(c, step->kept_place, c->kept / FP3_CUT_SLOTS);
    return is_good ? FP3_OK
                   : fp3_fail(error, FP3_E_LIMIT,
                              "too many projections and events: a sum over another kind is at one "
                              "of the first %d places of a step, and each repetition has its own",
                              FP3_LAST_PLACE);
}
