/* SPDX-License-Identifier: Apache-2.0 */
/* allocate.c - which gaps a value needs, and a register that is free there. */
#include "allocate.h"

#include <assert.h>
#include <fp3/isa.h>
#include <machine/operation.h>
#include <stdlib.h>
#include <string.h>

/* In the registers of variables, while no variable is there. */
typedef enum { LEAVE_VARIABLES, BORROW_VARIABLES } to_borrow;

/* Gaps begin .. end; in a circle of so many gaps end may go around, below begin + gaps. */
typedef struct {
    uint32_t begin, end;
    uint32_t node;
} arc;

typedef struct {
    const fp3_block *block;
    uint32_t gaps;
    uint32_t banks;     /* register r belongs to bank r % banks; a value to that of what makes it */
    uint32_t lowest[2]; /* of each bank: the first free register */
    uint32_t registers; /* that busy knows */
    char *busy;         /* [register * gaps + gap] */
    arc *arcs;
    uint32_t *position; /* of each node */
    uint32_t *reads;    /* of each variable, the last gap in which its register is needed */
} work;

/* ---- lifetimes ---- */

/* Instruction `reader` reads in the gap before it; in a circle that may be in the next step. */
static uint32_t gap_of(const work *w, const fp3_node *writer, uint32_t reader) {
    const fp3_node *node = &w->block->nodes[reader];
    const int is_later = w->block->is_cyclic && writer && writer->is_ahead && !node->is_ahead;
    return w->position[reader] + (is_later ? w->gaps : 0);
}

static void raise_to(uint32_t *value, uint32_t least) {
    if (*value < least)
        *value = least;
}

static void note_reader(const work *w, uint32_t reader, fp3_ref operand) {
    const fp3_block *block = w->block;
    if (operand.at == FP3_AT_OP) {
        const fp3_node *writer = &block->nodes[operand.index];
        raise_to(&w->arcs[operand.index].end, gap_of(w, writer, reader));
    } else if (operand.at == FP3_AT_VARIABLE) {
        const uint32_t writer = block->writer[operand.index];
        if (!block->is_cyclic || writer == FP3_NONE_INDEX)
            raise_to(&w->reads[operand.index], w->position[reader]);
        else
            raise_to(&w->arcs[writer].end,
                     w->position[reader] + (block->nodes[reader].is_ahead ? 0 : w->gaps));
    }
}

/* Instructions that write begin their arc; what is needed at the end goes to the last gap. */
static void find_arcs(work *w) {
    const fp3_block *block = w->block;
    for (uint32_t i = 0; i < block->count; i++) {
        const uint32_t begin = w->position[i] + 1;
        const int is_kept = block->nodes[i].fixed != FP3_NONE_INDEX;
        w->arcs[i] = (arc){begin, is_kept ? block->count : begin, i};
    }
    for (uint32_t i = 0; i < block->count; i++)
        for (uint32_t k = 0; k < 3; k++)
            note_reader(w, i, fp3_node_operand(&block->nodes[i], k));
}

/* A later write to the register of an unread value would have to wait while that value is in
 * flight. */
static void keep_unread(work *w) {
    const fp3_block *block = w->block;
    for (uint32_t i = 0; i < block->count; i++) {
        const uint32_t longer = block->nodes[i].delay - 1;
        if (w->arcs[i].end == w->arcs[i].begin)
            w->arcs[i].end += longer < w->gaps ? longer : w->gaps - 1;
    }
}

/* ---- registers ---- */

/* In one row of gaps; end at most one circle after begin. */
static int is_free(const work *w, uint32_t reg, uint32_t begin, uint32_t end) {
    const char *row = &w->busy[(size_t)reg * w->gaps];
    const uint32_t first = begin % w->gaps, count = end - begin + 1;
    const uint32_t ahead = first + count < w->gaps ? count : w->gaps - first;
    return !memchr(row + first, 1, ahead) && !memchr(row, 1, count - ahead);
}

static int take(const work *w, uint32_t reg, uint32_t begin, uint32_t end) {
    if (end - begin >= w->gaps || !is_free(w, reg, begin, end))
        return 0;
    for (uint32_t gap = begin; gap <= end; gap++)
        w->busy[(size_t)reg * w->gaps + gap % w->gaps] = 1;
    return 1;
}

/* How long a register has been free before a gap: the one with the least to lose is taken. */
static uint32_t idle_before(const work *w, uint32_t reg, uint32_t gap) {
    const char *row = &w->busy[(size_t)reg * w->gaps], *found;
    const uint32_t at = gap % w->gaps;
    if ((found = memrchr(row, 1, at)))
        return (uint32_t)(row + at - found) - 1;
    if ((found = memrchr(row + at, 1, w->gaps - at)))
        return at + (uint32_t)(row + w->gaps - found) - 1;
    return w->gaps;
}

/* Where there are two: sums, and products. */
static uint32_t bank_of(const work *w, uint32_t node) {
    return w->banks == 2 &&
           fp3_operation_multiplies(fp3_operation_find(w->block->nodes[node].op.op));
}

static uint32_t best_fit(const work *w, const arc *a, uint32_t bank, uint32_t used,
                         to_borrow borrow) {
    uint32_t best = used, least = UINT32_MAX;
    if (a->end - a->begin >= w->gaps)
        return FP3_NONE_INDEX;
    for (uint32_t reg = borrow == BORROW_VARIABLES ? bank : w->lowest[bank]; reg < used;
         reg += w->banks)
        if (is_free(w, reg, a->begin, a->end)) {
            const uint32_t idle = idle_before(w, reg, a->begin);
            if (idle < least) {
                least = idle;
                best = reg;
            }
        }
    return best;
}

/* Those that cross the end come first, for they fit nowhere else; then by their beginning. */
static int by_begin(const void *left, const void *right) {
    const arc *a = left, *b = right;
    return a->begin < b->begin ? -1 : a->begin > b->begin;
}

static fp3_status is_no_order(fp3_error *error) {
    return fp3_fail(error, FP3_E_MISMATCH, "an order of issue that keeps no values");
}

/* Variables and params, and values that belong into a certain register. */
static fp3_status place_fixed(const work *w, fp3_places *places, fp3_error *error) {
    const fp3_block *block = w->block;
    const fp3_step_code *code = block->code;
    for (uint32_t i = 0; i < block->count; i++) {
        const uint32_t reg = block->nodes[i].fixed;
        if (reg == FP3_NONE_INDEX)
            continue;
        if (!take(w, reg, w->arcs[i].begin, w->arcs[i].end))
            return is_no_order(error);
        places->reg[i] = reg;
        raise_to(&places->registers, reg + 1);
    }
    for (uint32_t x = 0; x < code->variable_count; x++) {
        const int is_written = block->writer[x] != FP3_NONE_INDEX;
        const int is_state = code->variables[x].first.at == FP3_AT_NOWHERE;
        const int is_loaded = block->is_first ? is_state : !block->is_cyclic || !is_written;
        uint32_t end = w->reads[x];
        if (!is_written && (is_state || block->is_cyclic))
            end = w->gaps - 1;
        if (is_loaded && !take(w, fp3_code_variable(code, x), 0, end))
            return is_no_order(error);
    }
    for (uint32_t p = 0; p < code->param_count; p++)
        take(w, fp3_code_param(code, p), 0, w->gaps - 1);
    return FP3_OK;
}

static fp3_status place_rest(const work *w, to_borrow borrow, fp3_places *places,
                             fp3_error *error) {
    const fp3_block *block = w->block;
    uint32_t used[2] = {w->lowest[0], w->lowest[1]}; /* of each bank: the first that is not */
    while (w->banks == 1 && used[0] < places->registers)
        used[0]++;
    qsort(w->arcs, block->count, sizeof *w->arcs, by_begin);
    for (int crossing = 1; crossing >= 0; crossing--)
        for (uint32_t i = 0; i < block->count; i++) {
            const arc *a = &w->arcs[i];
            if (block->nodes[a->node].fixed != FP3_NONE_INDEX || (a->end >= w->gaps) != crossing)
                continue;
            const uint32_t bank = bank_of(w, a->node);
            const uint32_t reg = best_fit(w, a, bank, used[bank], borrow);
            if (reg != FP3_NONE_INDEX && reg >= FP3_REGISTERS_CEILING) {
                places->registers = FP3_REGISTERS_CEILING;
                return FP3_OK;
            }
            if (reg == FP3_NONE_INDEX || !take(w, reg, a->begin, a->end))
                return is_no_order(error);
            places->reg[a->node] = reg;
            raise_to(&used[bank], reg + w->banks);
            raise_to(&places->registers, reg + 1);
        }
    return FP3_OK;
}

/* ---- all of it ---- */

static fp3_status open_work(work *w, const fp3_block *block, const uint32_t *order,
                            fp3_error *error) {
    const fp3_step_code *code = block->code;
    *w = (work){.block = block, .banks = code->param_registers ? 2 : 1, .lowest = {0, 1}};
    for (uint32_t x = 0; x < code->variable_count; x++)
        raise_to(&w->lowest[0], fp3_code_variable(code, x) + w->banks);
    for (uint32_t p = 0; p < code->param_count; p++) {
        const uint32_t reg = fp3_code_param(code, p);
        raise_to(&w->lowest[reg % w->banks], reg + w->banks);
    }
    w->gaps = block->count + !block->is_cyclic;
    w->registers = FP3_REGISTERS_CEILING + FP3_BANK_OBJECT_COUNT;
    const uint32_t lowest = w->lowest[0] > w->lowest[1] ? w->lowest[0] : w->lowest[1];
    if (w->registers < lowest + FP3_BANK_OBJECT_COUNT)
        w->registers = lowest + FP3_BANK_OBJECT_COUNT;
    w->arcs = calloc(block->count + 1, sizeof *w->arcs);
    w->position = calloc(block->count + 1, sizeof *w->position);
    w->reads = calloc(code->variable_count + 1, sizeof *w->reads);
    if (!w->arcs || !w->position || !w->reads)
        return fp3_no_memory(error);
    for (uint32_t p = 0; p < block->count; p++)
        w->position[order[p]] = p;
    return FP3_OK;
}

static void close_work(work *w) {
    free(w->busy);
    free(w->arcs);
    free(w->position);
    free(w->reads);
}

static fp3_status allocate(const fp3_block *block, const uint32_t *order, to_borrow borrow,
                           fp3_places *places, fp3_error *error) {
    work w;
    *places = (fp3_places){.reg = calloc(block->count + 1, sizeof *places->reg)};
    fp3_status status = open_work(&w, block, order, error);
    w.busy = calloc((size_t)w.registers * w.gaps + 1, 1);
    if (!status && (!places->reg || !w.busy))
        status = fp3_no_memory(error);
    if (!status && w.gaps) {
        find_arcs(&w);
        if (block->is_cyclic && !block->config->interleave && borrow == LEAVE_VARIABLES)
            keep_unread(&w);
        status = place_fixed(&w, places, error);
    }
    if (!status && w.gaps)
        status = place_rest(&w, borrow, places, error);
    for (uint32_t bank = 0; bank < w.banks; bank++)
        if (w.lowest[bank] > bank)
            raise_to(&places->registers, w.lowest[bank] - w.banks + 1);
    close_work(&w);
    if (status)
        fp3_places_free(places);
    return status;
}

static void add_arc(uint32_t *live, uint32_t gaps, uint32_t begin, uint32_t end) {
    for (uint32_t gap = begin; gap <= end && gap < begin + gaps; gap++)
        live[gap % gaps]++;
}

fp3_status fp3_allocate_least(const fp3_block *block, const uint32_t *order, uint32_t *registers,
                              fp3_error *error) {
    const fp3_step_code *code = block->code;
    work w;
    fp3_status status = open_work(&w, block, order, error);
    uint32_t *live = calloc((size_t)w.gaps + 1, sizeof *live), most = 0;
    if (!status && !live)
        status = fp3_no_memory(error);
    if (!status) {
        find_arcs(&w);
        for (uint32_t i = 0; i < block->count; i++)
            add_arc(live, w.gaps, w.arcs[i].begin, w.arcs[i].end);
        for (uint32_t gap = 0; gap < w.gaps; gap++)
            raise_to(&most, live[gap]);
        most += code->param_count;
        for (uint32_t x = 0; x < code->variable_count; x++)
            most += block->is_cyclic && block->writer[x] == FP3_NONE_INDEX;
        *registers = most;
    }
    free(live);
    close_work(&w);
    return status;
}

fp3_status fp3_allocate_within(const fp3_block *block, const uint32_t *order, fp3_places *places,
                               fp3_error *error) {
    fp3_status status = allocate(block, order, LEAVE_VARIABLES, places, error);
    if (status || places->registers <= block->config->registers)
        return status;
    fp3_places_free(places);
    return allocate(block, order, BORROW_VARIABLES, places, error);
}

fp3_status fp3_allocate_refuse(const fp3_block *block, uint32_t needed, fp3_error *error) {
    fp3_needs needs = fp3_code_needs(block->code);
    needs.registers = needed;
    const fp3_status status = fp3_needs_check(&needs, block->config, error);
    assert(status);
    return status ? FP3_E_LIMIT : FP3_OK;
}

void fp3_places_free(fp3_places *places) {
    free(places->reg);
    *places = (fp3_places){0};
}

static uint32_t code_of(const fp3_block *block, const fp3_places *places, fp3_ref operand) {
    switch (operand.at) {
    case FP3_AT_OP:
        return places->reg[operand.index];
    case FP3_AT_VARIABLE:
        return fp3_code_variable(block->code, operand.index);
    case FP3_AT_PARAM:
        return fp3_code_param(block->code, operand.index);
    case FP3_AT_CONSTANT:
        return FP3_BANK_SHARED_BASE + operand.index;
    default:
        return 0;
    }
}

fp3_status fp3_places_lines(const fp3_block *block, const uint32_t *order, const fp3_places *places,
                            fp3_line **lines, fp3_error *error) {
    *lines = calloc(block->count + 1, sizeof **lines);
    if (!*lines)
        return fp3_no_memory(error);
    for (uint32_t p = 0; p < block->count; p++) {
        const fp3_node *node = &block->nodes[order[p]];
        fp3_line *line = &(*lines)[p];
        *line = (fp3_line){.op = node->op.op, .d = places->reg[order[p]], .note = node->op.note};
        line->from = node->from;
        line->is_ahead = node->is_ahead;
        for (uint32_t k = 0; k < 3; k++)
            line->operand[k] = code_of(block, places, fp3_node_operand(node, k));
    }
    return FP3_OK;
}
