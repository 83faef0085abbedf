/* block.c - see block.h. */
#include "block.h"

#include <string.h>

fp3_place fp3_fast_place(fp3_fast_lanes *lanes, const fp3_fast_run *run, const fp3_fast *fast) {
    const unsigned wide = fast->sweep->lanes;
    return (fp3_place){.rows = lanes->rows[0],
                       .records = lanes->records,
                       .constants = (const int *)run->constants,
                       .table = fast->table,
                       .awake = lanes->awake,
                       .seen = &lanes->seen,
                       .vectors = (lanes->count + wide - 1) / wide};
}

static uint32_t filled(uint32_t count) { return (count + 15) / 16 * 16; }

static void fill(void *row, uint32_t count) {
    uint32_t *words = row;
    for (uint32_t i = count; i < filled(count); i++)
        words[i] = words[count - 1];
}

void fp3_fast_fill(fp3_fast_lanes *l, uint64_t rows, uint64_t records) {
    FP3_EACH_REGISTER (rows, reg)
        fill(l->rows[reg], l->count);
    FP3_EACH_REGISTER (l->is_direct ? 0 : records, reg)
        fill(l->own[reg], l->count);
    fill(l->awake, l->count);
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
            memcpy(words, columns[reg] + l->object[0], l->count * sizeof *words);
            continue;
        }
        for (uint32_t i = 0; i < l->count; i++)
            words[i] = columns[reg][l->object[i]];
    }
}

void fp3_fast_scatter(const fp3_fast_lanes *l, const float *const *from, uint32_t *const *columns,
                      uint64_t set) {
    FP3_EACH_REGISTER (set, reg) {
        const uint32_t *words = (const uint32_t *)(const void *)from[reg];
        for (uint32_t i = 0; i < l->count; i++)
            columns[reg][l->object[i]] = words[i];
    }
}
