/* SPDX-License-Identifier: Apache-2.0 */
/* block.c - see block.h. */
#include "block.h"

#include "gen/registers.h"
#include <string.h>

#define FLAGS ((2u << FP3_STATUS_FLAGS_HI) - 1) /* of a status word */

uint32_t fp3_fast_object(const fp3_fast_lanes *l, uint32_t lane) {
    return l->is_counted ? l->object[lane] : l->list ? l->list[lane] : l->first + lane;
}

void fp3_fast_count(fp3_fast_lanes *l, const uint32_t *status) {
    for (uint32_t i = 0; !l->is_counted && i < l->count; i++) {
        l->object[i] = fp3_fast_object(l, i);
        l->lane[i] = i;
        l->known[i] = status ? (int)(status[l->object[i]] & FLAGS) : 0;
        l->grave[i] = 0;
    }
    l->is_counted = 1;
}

void fp3_fast_wake(fp3_fast_lanes *l) {
    if (!l->is_awake)
        memset(l->awake, 0xff, sizeof l->awake);
    l->is_awake = 1;
}

/* The numbers of all objects, those of the last vector that stand for its last object, too. */
static void number(fp3_fast_lanes *l, const uint32_t *status) {
    fp3_fast_count(l, status);
    for (uint32_t i = l->count; i % 16; i++)
        l->object[i] = l->object[l->count - 1];
}

int fp3_fast_native_for(const fp3_fast *fast, const uint32_t *constants) {
    int is = fast->native.library != NULL;
    FP3_EACH_REGISTER (fast->plan.constants, k)
        is &= (constants[k] & 0x7fffffffu) <= 0x7f800000u;
    return is;
}

fp3_fast_place fp3_fast_place_of(fp3_fast_lanes *lanes, const fp3_fast_run *run,
                                 const fp3_fast *fast) {
    const unsigned wide = fast->sweep->lanes;
    if (run->seed)
        number(lanes, run->status);
    return (fp3_fast_place){.rows = lanes->rows[0],
                            .records = lanes->records,
                            .constants = (const int *)run->constants,
                            .table = fast->table,
                            .objects = (const int *)lanes->object,
                            .seed = run->seed,
                            .awake = lanes->awake,
                            .seen = &lanes->seen,
                            .vectors = (lanes->count + wide - 1) / wide};
}

typedef int four __attribute__((vector_size(16), aligned(4), may_alias));

/* In vectors: what is stored word by word keeps a load of a vector waiting. is_there: the lanes
 * that have an object, of the last sixteen. */
static void fill(void *row, uint32_t count, const four is_there[4]) {
    const int last = ((const int *)row)[count - 1];
    four *at = (four *)row + count / 16 * 4;
    for (int i = 0; i < 4; i++)
        at[i] = (at[i] & is_there[i]) | (last & ~is_there[i]);
}

static void find_there(int left, four is_there[4]) {
    static const four lanes[4] = {{0, 1, 2, 3}, {4, 5, 6, 7}, {8, 9, 10, 11}, {12, 13, 14, 15}};
    for (int i = 0; i < 4; i++)
        is_there[i] = lanes[i] < left;
}

void fp3_fast_fill_row(fp3_fast_lanes *l, uint32_t row) {
    four is_there[4];
    find_there((int)(l->count % 16), is_there);
    if (l->count % 16)
        fill(l->rows[row], l->count, is_there);
}

void fp3_fast_fill(fp3_fast_lanes *l, uint64_t rows, uint64_t records) {
    const int left = (int)(l->count % 16);
    four is_there[4];
    if (!left)
        return;
    find_there(left, is_there);
    FP3_EACH_REGISTER (rows, reg)
        fill(l->rows[reg], l->count, is_there);
    FP3_EACH_REGISTER (records, reg)
        fill(l->records[reg], l->count, is_there);
    if (!l->is_awake)
        fill(l->awake, l->count, is_there);
}

static void pick(const void *from, const uint32_t *lanes, uint32_t count, void *to) {
    const uint32_t *source = from;
    uint32_t *words = to;
    for (uint32_t i = 0; i < count; i++)
        words[i] = source[lanes[i]];
}

void fp3_fast_pick_witness(const fp3_fast_lanes *from, const uint32_t *lanes, uint32_t count,
                           fp3_fast_lanes *to) {
    const int *source = from->witness.flags; /* its first row */
    int *rows = to->witness.flags;
    for (size_t i = 0; i < sizeof from->witness / sizeof *rows; i += FP3_BLOCK)
        pick(source + i, lanes, count, rows + i);
}

void fp3_fast_pick(const fp3_fast_lanes *from, const uint32_t *lanes, uint32_t count, uint64_t rows,
                   uint64_t records, fp3_fast_lanes *to) {
    FP3_EACH_REGISTER (rows, reg)
        pick(from->rows[reg], lanes, count, to->rows[reg]);
    FP3_EACH_REGISTER (records, reg) {
        pick(from->records[reg], lanes, count, to->own[reg]);
        to->records[reg] = to->own[reg];
    }
    pick(from->awake, lanes, count, to->awake);
    pick(from->object, lanes, count, to->object);
    pick(from->lane, lanes, count, to->lane);
    pick(from->known, lanes, count, to->known);
    pick(from->grave, lanes, count, to->grave);
    to->is_counted = 1;
    to->is_awake = 0;
    to->common = from->common;
    to->is_tiny = from->is_tiny;
    to->count = count;
    to->is_direct = to->is_dense = 0;
    fp3_fast_fill(to, rows, records);
}

/* Each lane moves to one that is not above it. */
void fp3_fast_keep(fp3_fast_lanes *l, const uint32_t *which, uint32_t count, uint64_t rows,
                   uint64_t records) {
    fp3_fast_pick_witness(l, which, count, l);
    fp3_fast_pick(l, which, count, rows, records, l);
}

void fp3_fast_gather(fp3_fast_lanes *l, float (*to)[FP3_BLOCK], uint32_t *const *columns,
                     uint64_t set) {
    FP3_EACH_REGISTER (set, reg) {
        uint32_t *words = (uint32_t *)(void *)to[reg];
        if (l->is_dense) {
            memcpy(words, columns[reg] + l->first, l->count * sizeof *words);
            continue;
        }
        for (uint32_t i = 0; i < l->count; i++)
            words[i] = columns[reg][fp3_fast_object(l, i)];
    }
}

void fp3_fast_scatter(const fp3_fast_lanes *l, const float *const *from, uint32_t *const *columns,
                      uint64_t set) {
    FP3_EACH_REGISTER (set, reg) {
        const uint32_t *words = (const uint32_t *)(const void *)from[reg];
        if (l->is_dense) {
            memcpy(columns[reg] + l->first, words, l->count * sizeof *words);
            continue;
        }
        for (uint32_t i = 0; i < l->count; i++)
            columns[reg][fp3_fast_object(l, i)] = words[i];
    }
}
