/* SPDX-License-Identifier: Apache-2.0 */
/* schedule.c - code to lines: the step part first, then the parts around it. */
#include "schedule.h"

#include "copies.h"
#include "cost.h"
#include "ends.h"
#include "interval.h"
#include "parts.h"
#include "search.h"
#include "spilled.h"

#include <stdlib.h>

typedef struct {
    const fp3_step_code *code;
    const fp3_config *config;
    fp3_block block; /* the step part */
    fp3_choice best;
    fp3_schedule *made;
} maker;

/* Copies of old values by which steps can overlap more; *split has them, or is empty: none does. */
static fp3_status split_block(const fp3_block *block, fp3_block *split, fp3_error *error) {
    uint32_t least = 0, now = 0;
    int is_split = 0, is_changed;
    fp3_status status = fp3_block_clone(block, split, error);
    if (!status)
        status = fp3_interval_least(block, &least, error);
    for (uint32_t x = 0; !status && x < block->code->variable_count && least > split->count; x++) {
        fp3_block tried = {0};
        status = fp3_block_clone(split, &tried, error);
        if (!status)
            status = fp3_copies_split(&tried, x, &is_changed, error);
        if (!status && is_changed)
            status = fp3_interval_least(&tried, &now, error);
        if (!status && is_changed && now && now < least) {
            fp3_block_free(split);
            *split = tried;
            least = now;
            is_split = 1;
        } else {
            fp3_block_free(&tried);
        }
    }
    if (status || !is_split)
        fp3_block_free(split);
    return status;
}

/* The step with such copies, if it takes fewer cycles. */
static fp3_status try_split(maker *m, fp3_error *error) {
    fp3_block split;
    fp3_choice choice = {0};
    fp3_status status = split_block(&m->block, &split, error);
    if (status || !split.count)
        return status;
    status = fp3_search(&split, &choice, error);
    if (!status && choice.cycles < m->best.cycles) {
        const fp3_block block = m->block;
        const fp3_choice best = m->best;
        m->block = split;
        m->best = choice;
        split = block;
        choice = best;
    }
    fp3_block_free(&split);
    fp3_choice_free(&choice);
    return status == FP3_E_LIMIT ? FP3_OK : status;
}

static fp3_status make_step(maker *m, fp3_error *error) {
    fp3_schedule *made = m->made;
    fp3_status status = fp3_part_step(m->code, m->config, &m->block, error);
    if (!status)
        status = fp3_search(&m->block, &m->best, error);
    if (!status && !m->config->interleave && m->code->allow_ahead)
        status = try_split(m, error);
    if (!status)
        status = fp3_places_lines(&m->block, m->best.order, &m->best.places, &made->step, error);
    if (status)
        return status;
    made->step_count = m->block.count;
    made->copies = m->block.copies;
    made->registers = m->best.places.registers;
    made->needs_minus_zero = m->block.reads_minus_zero;
    for (uint32_t i = 0; i < m->block.count; i++)
        made->ahead += (uint32_t)m->block.nodes[i].is_ahead;
    return FP3_OK;
}

static fp3_status make_in_registers(maker *m, fp3_error *error) {
    fp3_status status = make_step(m, error);
    if (!status)
        status = fp3_ends_first(&m->block, &m->best, m->made, error);
    return status ? status : fp3_ends_last(m->code, m->config, m->made, error);
}

/* ---- the interface ---- */

static fp3_status make_all(const fp3_step_code *code, const fp3_config *config,
                           fp3_schedule **schedule, fp3_error *error) {
    maker m = {.code = code, .config = config, .made = calloc(1, sizeof **schedule)};
    fp3_status status = m.made ? FP3_OK : fp3_no_memory(error);
    if (!status && code->may_spill)
        status = fp3_spilled_make(code, config, m.made, error);
    else if (!status)
        status = make_in_registers(&m, error);
    if (!status)
        status = fp3_cost_find(code, config, m.made, error);
    if (m.made) {
        m.made->needs_minus_zero = m.made->needs_minus_zero && code->minus_zero == FP3_NONE_INDEX;
        m.made->constants = code->constant_count + (uint32_t)m.made->needs_minus_zero;
    }
    if (status)
        fp3_schedule_free(&m.made);
    fp3_block_free(&m.block);
    fp3_choice_free(&m.best);
    *schedule = m.made;
    return status;
}

fp3_status fp3_schedule_make(const fp3_step_code *code, const fp3_config *config,
                             fp3_schedule **schedule, fp3_error *error) {
    fp3_status status = make_all(code, config, schedule, error);
    if (status != FP3_E_LIMIT || !code->allow_ahead || config->interleave)
        return status;
    /* What is executed ahead may be too much for the first part. */
    fp3_step_code in_turn = *code;
    in_turn.allow_ahead = 0;
    return make_all(&in_turn, config, schedule, error);
}

void fp3_schedule_free(fp3_schedule **schedule) {
    if (!*schedule)
        return;
    free((*schedule)->first);
    free((*schedule)->step);
    free((*schedule)->last);
    free(*schedule);
    *schedule = NULL;
}
