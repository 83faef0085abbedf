/* SPDX-License-Identifier: Apache-2.0 */
/* state.c - a world is saved and restored. */
#include "fields.h"

#include <stdlib.h>
#include <string.h>

struct fp3_bodies_state {
    uint32_t *of;      /* the world's identity */
    fp3_bodies counts; /* its arrays are not used */
    fp3_space space;
    void *array[FP3_PARTS_SAVED];
    uint32_t room[FP3_PARTS_SAVED];
};

/* The forms of shapes, which they share. */
static void keep_forms(const fp3_attached *shape, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        fp3_form_keep(shape[i].form);
}
static void give_back_forms(const fp3_attached *shape, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        fp3_form_give_back(shape[i].form);
}

fp3_status fp3_bodies_save(const fp3_bodies *bodies, fp3_bodies_state **state) {
    fp3_bodies from = *bodies;
    fp3_bodies_state *to = *state ? *state : calloc(1, sizeof *to);
    fp3_status status = to ? FP3_OK : fp3_no_memory(bodies->error);
    for (int i = 0; !status && i < fp3_parts_saved(bodies); i++) {
        const fp3_kept_part p = fp3_part_of(&from, i);
        status = fp3_bodies_room(&to->array[i], &to->room[i], p.size, *p.count + 1u, bodies->error);
    }
    if (!status)
        give_back_forms(to->array[FP3_PART_SHAPES], to->counts.shape_count);
    for (int i = 0; !status && i < fp3_parts_saved(bodies); i++) {
        const fp3_kept_part p = fp3_part_of(&from, i);
        if (*p.count)
            memcpy(to->array[i], *p.array, *p.count * p.size);
    }
    if (!status) {
        keep_forms(to->array[FP3_PART_SHAPES], from.shape_count);
        if (from.space)
            to->space = *from.space;
        to->counts = from;
        fp3_identity_give_back(to->of);
        to->of = bodies->identity;
        ++*to->of;
    }
    if (!status || *state)
        *state = to;
    else
        fp3_bodies_state_free(&to);
    return status;
}

/* Of a number that was not there when the state was saved, and is free. */
static uint32_t next_even(uint32_t generation) { return generation + (generation & 1); }

fp3_status fp3_bodies_restore(fp3_bodies *bodies, const fp3_bodies_state *state) {
    fp3_bodies from = {0};
    fp3_space space = {0};
    if (state && state->of == bodies->identity) {
        from = state->counts;
        space = state->space;
        from.space = from.space ? &space : NULL;
    }
    fp3_status status =
        state && state->of == bodies->identity
            ? FP3_OK
            : fp3_fail(bodies->error, FP3_E_ARGUMENT, "the state was saved of another world");
    for (int i = 0; !status && i < fp3_parts_saved(bodies); i++) {
        const fp3_kept_part to = fp3_part_of(bodies, i);
        status = fp3_bodies_room(to.array, to.room, to.size, *fp3_part_of(&from, i).count + 1u,
                                 bodies->error);
    }
    if (status)
        return status;
    give_back_forms(bodies->shape, bodies->shape_count);
    for (int i = 0; i < fp3_parts_saved(bodies); i++) {
        const fp3_kept_part p = fp3_part_of(&from, i);
        if (*p.count)
            memcpy(*fp3_part_of(bodies, i).array, state->array[i], *p.count * p.size);
    }
    keep_forms(bodies->shape, from.shape_count);
    for (uint32_t i = from.body_count; i < bodies->body_count; i++)
        bodies->body[i] = (fp3_body){.generation = next_even(bodies->body[i].generation)};
    for (uint32_t i = from.shape_count; i < bodies->shape_count; i++)
        bodies->shape[i] = (fp3_attached){.generation = next_even(bodies->shape[i].generation)};
    for (uint32_t i = from.joint_count; i < bodies->joint_count; i++)
        bodies->joint[i] = (fp3_joint){.generation = next_even(bodies->joint[i].generation)};
    const fp3_kept_list *world = &fp3_kept_lists[0];
    for (size_t i = 0; i < world->count; i++)
        memcpy((char *)bodies + world->fields[i].at, (const char *)&from + world->fields[i].at,
               fp3_field_size(&world->fields[i]));
    for (int i = 0; i < fp3_parts_saved(bodies); i++)
        *fp3_part_of(bodies, i).count = *fp3_part_of(&from, i).count;
    fp3_bodies_count_up(bodies);
    return FP3_OK;
}

void fp3_bodies_state_free(fp3_bodies_state **state) {
    if (*state) {
        give_back_forms((*state)->array[FP3_PART_SHAPES], (*state)->counts.shape_count);
        fp3_identity_give_back((*state)->of);
    }
    for (int i = 0; *state && i < FP3_PARTS_SAVED; i++)
        free((*state)->array[i]);
    free(*state);
    *state = NULL;
}
