/* SPDX-License-Identifier: Apache-2.0 */
/* state.c - see state.h. */
#include "state.h"

#include "library_hdf5.h"
#include "machine/visit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK 4096 /* words that are put in order at once */

/* ---- what is kept ---- */

/* What a visit loads and stores. Where objects are not visited, what a visit of them would. */
static fp3_status find_kept(const fp3_members *group, uint64_t *kept, fp3_error *error) {
    fp3_visit *own = NULL;
    const fp3_status status = group->visit ? FP3_OK : fp3_visit_make(group->image, &own, error);
    const uint32_t room = 1u << group->log2;
    if (status)
        return status;
    *kept = group->visit ? group->visit->kept : own->kept;
    if (group->visit && room < 64)
        *kept &= ((uint64_t)1 << room) - 1;
    fp3_visit_free(&own);
    return FP3_OK;
}

fp3_status fp3_state_open(fp3_engine *engine, fp3_state *state, fp3_error *error) {
    *state = (fp3_state){.engine = engine, .layout = fp3_engine_layout(engine)};
    fp3_status status = fp3_library_hdf5(&state->calls, error);
    if (status)
        return status;
    state->kept = calloc(state->layout->count, sizeof *state->kept);
    state->words = calloc(fp3_engine_objects(engine), sizeof *state->words);
    if (!state->kept || !state->words)
        return fp3_no_memory(error);
    for (uint32_t i = 0; !status && i < state->layout->count; i++)
        status = find_kept(&state->layout->groups[i], &state->kept[i], error);
    return status;
}

void fp3_state_free(fp3_state *state) {
    free(state->kept);
    free(state->words);
    *state = (fp3_state){0};
}

uint32_t fp3_state_registers(const fp3_state *state, uint32_t group) {
    uint32_t count = 0;
    for (uint64_t set = state->kept[group]; set; set &= set - 1)
        count++;
    return count;
}

/* ---- hashes ---- */

static void add_words(const fp3_hdf5_ops *calls, fp3_hdf5_sum *sum, const uint32_t *words,
                      size_t count) {
    uint8_t bytes[4 * BLOCK];
    for (size_t done = 0, now; done < count; done += now) {
        now = count - done < BLOCK ? count - done : BLOCK;
        for (size_t i = 0; i < now; i++) {
            const uint32_t word = words[done + i];
            bytes[4 * i] = (uint8_t)word;
            bytes[4 * i + 1] = (uint8_t)(word >> 8);
            bytes[4 * i + 2] = (uint8_t)(word >> 16);
            bytes[4 * i + 3] = (uint8_t)(word >> 24);
        }
        calls->sum_add(sum, bytes, 4 * now);
    }
}

/* Pairs of near objects that remember nothing are left out: which of these are in a list depends on
 * its skin. *words is the caller's to free. */
static fp3_status find_pairs(const fp3_list *list, const fp3_remembered *from, fp3_state_row *row,
                             uint32_t **words, fp3_error *error) {
    const uint32_t fields = list->fields, names = list->is_near ? 2 : 0;
    row->pairs = list->is_near ? from->begin[list->own] : fp3_list_given(list).begin[list->objects];
    row->each = names + fields;
    uint32_t *made = *words = malloc(((size_t)row->pairs * row->each + 1) * sizeof *made);
    if (!made)
        return fp3_no_memory(error);
    row->words = made;
    for (uint32_t i = 0, object = 0; i < row->pairs; i++, made += row->each) {
        while (names && from->begin[object + 1] <= i)
            object++;
        if (names) {
            made[0] = object;
            made[1] = from->other[i];
        }
        memcpy(&made[names], &from->field[(size_t)i * fields], fields * sizeof *made);
    }
    return FP3_OK;
}

static fp3_status look_at_pairs(fp3_state *state, uint32_t number, uint32_t which,
                                fp3_hdf5_sum *sum, fp3_state_fn *tell, void *user,
                                fp3_error *error) {
    const fp3_list *list = &state->layout->groups[number].lists.lists[which];
    fp3_state_row row = {.group = number, .row = which, .reg = list->reg};
    fp3_remembered saved = {0};
    uint32_t *words = NULL;
    fp3_status status = fp3_engine_read_remembered(state->engine, number, which, &saved);
    if (!status)
        status = find_pairs(list, &saved, &row, &words, error);
    if (!status)
        add_words(state->calls, sum, &row.pairs, 1);
    if (!status)
        add_words(state->calls, sum, words, (size_t)row.pairs * row.each);
    if (!status && tell)
        status = tell(user, &row, error);
    free(words);
    fp3_remembered_free(&saved);
    return status;
}

static fp3_status look_at_group(fp3_state *state, uint32_t number, fp3_hdf5_sum *sum,
                                fp3_state_fn *tell, void *user, fp3_error *error) {
    const fp3_members *group = &state->layout->groups[number];
    fp3_state_row row = {.group = number, .count = group->objects, .words = state->words};
    fp3_status status = FP3_OK;
    for (; !status && row.reg < 64; row.reg++) {
        if (!(state->kept[number] >> row.reg & 1))
            continue;
        status = fp3_engine_read_words(state->engine, group->first, group->objects, row.reg,
                                       state->words);
        if (status)
            break;
        add_words(state->calls, sum, state->words, row.count);
        if (tell)
            status = tell(user, &row, error);
        row.row++;
    }
    for (uint32_t i = 0; !status && i < group->lists.shape.list_count; i++)
        if (fp3_list_remembers(&group->lists.lists[i]))
            status = look_at_pairs(state, number, i, sum, tell, user, error);
    return status;
}

fp3_status fp3_state_look(fp3_state *state, uint64_t step, fp3_state_fn *tell, void *user,
                          fp3_digest *hash, fp3_error *error) {
    /* The upper word is 0 as long as no run has more than 2^32 - 1 steps. */
    const uint32_t steps[2] = {(uint32_t)step, (uint32_t)(step >> 32)};
    fp3_hdf5_sum *sum = state->calls->sum_begin();
    if (!sum)
        return fp3_no_memory(error);
    add_words(state->calls, sum, steps, 2);
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < state->layout->count; i++)
        status = look_at_group(state, i, sum, tell, user, error);
    state->calls->sum_end(sum, hash->words);
    return status;
}

static void put_bytes(const fp3_digest *digest, uint8_t bytes[4 * FP3_DIGEST_WORDS]) {
    for (int i = 0; i < 4 * FP3_DIGEST_WORDS; i++)
        bytes[i] = (uint8_t)(digest->words[i / 4] >> (24 - i % 4 * 8));
}

fp3_status fp3_chain_add(const fp3_hdf5_ops *calls, fp3_digest *chain, const fp3_digest *hash,
                         fp3_error *error) {
    uint8_t bytes[2][4 * FP3_DIGEST_WORDS];
    fp3_hdf5_sum *sum = calls->sum_begin();
    if (!sum)
        return fp3_no_memory(error);
    put_bytes(chain, bytes[0]);
    put_bytes(hash, bytes[1]);
    calls->sum_add(sum, bytes, sizeof bytes);
    calls->sum_end(sum, chain->words);
    return FP3_OK;
}

/* ---- text ---- */

void fp3_digest_text(const fp3_digest *digest, char text[FP3_DIGEST_SIZE]) {
    for (size_t i = 0; i < FP3_DIGEST_WORDS; i++)
        snprintf(text + 8 * i, 9, "%08x", (unsigned)digest->words[i]);
}

int fp3_digest_read(const char *text, fp3_digest *digest) {
    static const char digits[] = "0123456789abcdef";
    if (!text || strspn(text, digits) < FP3_DIGEST_SIZE - 1)
        return 0;
    for (size_t i = 0; i < FP3_DIGEST_WORDS; i++) {
        char word[9] = "";
        memcpy(word, text + 8 * i, 8);
        digest->words[i] = (uint32_t)strtoul(word, NULL, 16);
    }
    return 1;
}
