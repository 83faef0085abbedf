/* SPDX-License-Identifier: Apache-2.0 */
/* past.c - hashes of what a scene makes, and of where its bodies are. */
#include "past.h"

#include "fields.h"

#include "record/library_hdf5.h"

#include <stdlib.h>
#include <string.h>

const char *const fp3_start_names[FP3_STARTS] = {"start:shapes", "start:bodies", "start:joints"};

uint64_t fp3_bodies_steps(const fp3_bodies *bodies) { return bodies->steps; }

static fp3_status add_list(const fp3_hdf5_ops *calls, fp3_hdf5_sum *sum, fp3_bodies *bodies,
                           const fp3_kept_list *list, fp3_error *error) {
    const fp3_kept_part part = fp3_kept_elements(bodies, list);
    for (size_t i = 0; i < list->count; i++) {
        const fp3_kept_field *field = &list->fields[i];
        const size_t size = *part.count * fp3_field_size(field);
        void *column = malloc(size + 1);
        if (!column)
            return fp3_no_memory(error);
        fp3_field_gather(field, *part.array, part.size, *part.count, column);
        calls->sum_add(sum, column, size);
        free(column);
    }
    return FP3_OK;
}

static int start_of(int part) {
    switch (part) {
    case FP3_PART_BODIES:
    case FP3_PART_BODIES3:
        return FP3_START_BODIES;
    case FP3_PART_SHAPES:
    case FP3_PART_FORMS:
    case FP3_PART_CORNERS:
    case FP3_PART_TRIANGLES:
    case FP3_PART_FORM_OF:
        return FP3_START_SHAPES;
    case FP3_PART_JOINTS:
    case FP3_PART_JOINTS3:
        return FP3_START_JOINTS;
    default:
        return -1;
    }
}

static fp3_status begin_one(const fp3_hdf5_ops *calls, fp3_bodies *bodies, int which,
                            fp3_digest *digest, fp3_error *error) {
    fp3_hdf5_sum *sum = calls->sum_begin();
    fp3_status status = sum ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; !status && i < fp3_kept_list_count; i++) {
        const fp3_kept_list *list = &fp3_kept_lists[i];
        if (fp3_list_is_of(list, bodies->def.dimensions) && start_of(list->part) == which)
            status = add_list(calls, sum, bodies, list, error);
    }
    if (sum)
        calls->sum_end(sum, digest->words);
    return status;
}

fp3_status fp3_bodies_past_begin(fp3_bodies *bodies, fp3_bodies_past *past, fp3_error *error) {
    const fp3_hdf5_ops *calls;
    fp3_status status = fp3_library_hdf5(&calls, error);
    if (!status && bodies->space)
        status = fp3_forms_number(bodies);
    for (int i = 0; !status && i < FP3_STARTS; i++)
        status = begin_one(calls, bodies, i, &past->start[i], error);
    if (bodies->space)
        fp3_forms_forget(bodies);
    return status;
}

typedef struct {
    const fp3_hdf5_ops *calls;
    fp3_hdf5_sum *sum;
} summing;

/* An fp3_words_fn. */
static void add(void *user, const void *data, size_t size) {
    const summing *s = user;
    s->calls->sum_add(s->sum, data, size);
}

fp3_status fp3_bodies_sum(const fp3_bodies *bodies, fp3_digest *digest, fp3_error *error) {
    summing s;
    fp3_status status = fp3_library_hdf5(&s.calls, error);
    if (status)
        return status;
    s.sum = s.calls->sum_begin();
    if (!s.sum)
        return fp3_no_memory(error);
    add(&s, &bodies->steps, sizeof bodies->steps);
    fp3_bodies_words(bodies, add, &s);
    s.calls->sum_end(s.sum, digest->words);
    return FP3_OK;
}
