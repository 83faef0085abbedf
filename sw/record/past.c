/* SPDX-License-Identifier: Apache-2.0 */
/* past.c - what a run knows of itself, and what it was loaded with, as words and hashes. */
#include "checkpoint.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

fp3_status fp3_past_open(const fp3_engine *engine, fp3_past *past, fp3_error *error) {
    *past = (fp3_past){.failures = calloc(fp3_engine_groups(engine), sizeof *past->failures),
                       .has_failed = calloc(fp3_engine_objects(engine), sizeof *past->has_failed)};
    return past->failures && past->has_failed ? FP3_OK : fp3_no_memory(error);
}

void fp3_past_free(fp3_past *past) {
    free(past->failures);
    free(past->has_failed);
    *past = (fp3_past){0};
}

void fp3_checkpoint_name(char name[FP3_CHECKPOINT_NAME], const char *what, uint32_t group) {
    snprintf(name, FP3_CHECKPOINT_NAME, "%s:%u", what, (unsigned)group);
}

void fp3_checkpoint_list_name(char name[FP3_CHECKPOINT_NAME], uint32_t group, uint32_t reg) {
    snprintf(name, FP3_CHECKPOINT_NAME, "pairs:%u:%u", (unsigned)group, (unsigned)reg);
}

void fp3_failure_pack(const fp3_failure *failure, uint32_t words[FP3_FAILURE_WORDS]) {
    const uint64_t failed = failure->failed, object = failure->object;
    const uint32_t all[FP3_FAILURE_WORDS] = {
        (uint32_t)failed,
        (uint32_t)(failed >> 32),
        (uint32_t)object,
        (uint32_t)(object >> 32),
        failure->step,
        (uint32_t)failure->is_before,
        failure->flags,
        failure->partner ? failure->partner : failure->state}; /* one of them is 0 */
    memcpy(words, all, sizeof all);
    memcpy(&words[FP3_FAILURE_WORDS - 1], &failure->value, sizeof failure->value);
}

fp3_failure fp3_failure_unpack(const uint32_t words[FP3_FAILURE_WORDS]) {
    fp3_failure failure = {.failed = (size_t)((uint64_t)words[1] << 32 | words[0]),
                           .object = (size_t)((uint64_t)words[3] << 32 | words[2]),
                           .step = words[4],
                           .is_before = (int)words[5],
                           .flags = words[6],
                           .state = words[7]};
    if (failure.flags) {
        failure.partner = failure.state;
        failure.state = 0;
    }
    memcpy(&failure.value, &words[FP3_FAILURE_WORDS - 1], sizeof failure.value);
    return failure;
}

/* ---- what the engine was loaded with ---- */

/* A list of those that are near is made as objects move: its rule counts, but not its skin, which
 * changes no bit. Fields that the program writes are part of the state. */
static void add_list(const fp3_hdf5_ops *calls, fp3_hdf5_sum *sum, const fp3_list *list) {
    const uint32_t head[] = {
        list->reg,     list->fields,         (uint32_t)list->is_all, (uint32_t)list->is_near,
        list->objects, list->near.dimensions};
    calls->sum_add(sum, head, sizeof head);
    if (list->is_near) {
        calls->sum_add(sum, list->near.regs, list->near.dimensions * sizeof *list->near.regs);
        calls->sum_add(sum, &list->near.reach, sizeof list->near.reach);
        const uint32_t more[] = {list->near.radius, list->near.their_radius, list->kind};
        if (more[0] || more[1] || more[2])
            calls->sum_add(sum, more, sizeof more);
    } else if (!list->is_all && list->begin) {
        const fp3_entries all = fp3_list_given(list); /* whoever lives now */
        const size_t entries = all.begin[list->objects];
        calls->sum_add(sum, all.begin, (list->objects + (size_t)1) * sizeof *all.begin);
        calls->sum_add(sum, all.other, entries * sizeof *all.other);
        for (size_t i = 0; i < entries * list->fields; i++)
            if (!(list->kept >> i % list->fields & 1))
                calls->sum_add(sum, &all.field[i], sizeof *all.field);
    }
}

fp3_status fp3_checkpoint_links(const fp3_state *state, fp3_digest *links, fp3_error *error) {
    fp3_hdf5_sum *sum = state->calls->sum_begin();
    if (!sum)
        return fp3_no_memory(error);
    for (uint32_t i = 0; i < state->layout->count; i++) {
        const fp3_lists *lists = &state->layout->groups[i].lists;
        for (uint32_t k = 0; k < lists->shape.list_count; k++)
            add_list(state->calls, sum, &lists->lists[k]);
    }
    state->calls->sum_end(sum, links->words);
    return FP3_OK;
}

fp3_status fp3_checkpoint_lives(const fp3_state *state, fp3_digest *lives, fp3_error *error) {
    fp3_hdf5_sum *sum = state->calls->sum_begin();
    if (!sum)
        return fp3_no_memory(error);
    for (size_t i = 0; i < fp3_engine_objects(state->engine); i++) {
        uint64_t life[2];
        fp3_engine_life_of(state->engine, i, &life[0], &life[1]);
        state->calls->sum_add(sum, life, sizeof life);
    }
    state->calls->sum_end(sum, lives->words);
    return FP3_OK;
}
