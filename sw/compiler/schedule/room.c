/* SPDX-License-Identifier: Apache-2.0 */
/* room.c - values that are there in each gap of what is left of a plan. */
#include "room.h"

#include <stdlib.h>
#include <string.h>

/* A node makes two values that this execution of the step part may read: 2 i is the new value, 2 i
 * + 1 the value from before the execution (of nodes executed ahead). Likewise variables, behind all
 * nodes. */
struct fp3_room {
    const fp3_block *block;
    const char *is_ahead;
    uint32_t limit, issued;
    uint32_t *plan;            /* what is left, from index `issued` on */
    uint32_t *position;        /* in plan */
    int32_t *live;             /* values in the gap before each position */
    uint32_t *begin, *readers; /* nodes that read a value: readers[begin[v] .. begin[v + 1]) */
    char *is_kept;             /* values that are there when the execution ends */
};

static uint32_t value_count(const fp3_room *r) {
    return 2 * (r->block->count + r->block->code->variable_count);
}

/* Which value an operand means, or FP3_NONE_INDEX: one without a lifetime. */
static uint32_t value_of(const fp3_room *r, uint32_t reader, fp3_ref ref) {
    const fp3_block *block = r->block;
    if (ref.at == FP3_AT_OP)
        return 2 * ref.index + (uint32_t)(r->is_ahead[ref.index] && !r->is_ahead[reader]);
    if (ref.at == FP3_AT_VARIABLE && block->writer[ref.index] != FP3_NONE_INDEX)
        return 2 * (block->count + ref.index) + (uint32_t)!r->is_ahead[reader];
    return FP3_NONE_INDEX;
}

/* Operand k, unless an earlier one is the same. */
static uint32_t operand_value(const fp3_room *r, uint32_t node, uint32_t k) {
    const fp3_node *n = &r->block->nodes[node];
    const uint32_t value = value_of(r, node, fp3_node_operand(n, k));
    for (uint32_t j = 0; j < k; j++)
        if (value_of(r, node, fp3_node_operand(n, j)) == value)
            return FP3_NONE_INDEX;
    return value;
}

static void list_readers(fp3_room *r) {
    const uint32_t count = r->block->count, values = value_count(r);
    for (int is_filling = 0; is_filling < 2; is_filling++) {
        for (uint32_t i = 0; i < count; i++)
            for (uint32_t k = 0; k < 3; k++) {
                const uint32_t value = operand_value(r, i, k);
                if (value == FP3_NONE_INDEX)
                    continue;
                if (is_filling)
                    r->readers[r->begin[value + 1]++] = i;
                else
                    r->begin[value + 2]++;
            }
        for (uint32_t v = 0; !is_filling && v < values; v++)
            r->begin[v + 2] += r->begin[v + 1];
    }
}

fp3_room *fp3_room_make(const fp3_block *block, const char *is_ahead, uint32_t limit) {
    fp3_room *r = calloc(1, sizeof *r);
    if (!r)
        return NULL;
    *r = (fp3_room){.block = block, .is_ahead = is_ahead, .limit = limit};
    const size_t n = block->count + 2u, values = value_count(r) + 3u;
    r->plan = calloc(n, sizeof *r->plan);
    r->position = calloc(n, sizeof *r->position);
    r->live = calloc(n, sizeof *r->live);
    r->begin = calloc(values, sizeof *r->begin);
    r->readers = calloc(3 * n, sizeof *r->readers);
    r->is_kept = calloc(values, 1);
    if (!r->plan || !r->position || !r->live || !r->begin || !r->readers || !r->is_kept) {
        fp3_room_free(&r);
        return NULL;
    }
    list_readers(r);
    for (uint32_t i = 0; i < block->count; i++)
        r->is_kept[2 * i] =
            block->nodes[i].fixed != FP3_NONE_INDEX || r->begin[2 * i + 2] > r->begin[2 * i + 1];
    for (uint32_t x = 0; x < block->code->variable_count; x++)
        r->is_kept[2 * (block->count + x)] = 1;
    return r;
}

void fp3_room_free(fp3_room **room) {
    fp3_room *r = *room;
    if (!r)
        return;
    free(r->plan);
    free(r->position);
    free(r->live);
    free(r->begin);
    free(r->readers);
    free(r->is_kept);
    free(r);
    *room = NULL;
}

/* ---- lifetimes ---- */

/* The first gap in which only `but` still waits for a value. */
static uint32_t end_of(const fp3_room *r, uint32_t value, uint32_t but) {
    uint32_t end = r->issued;
    for (uint32_t k = r->begin[value]; k < r->begin[value + 1]; k++) {
        const uint32_t reader = r->readers[k];
        if (reader != but && r->position[reader] >= end)
            end = r->position[reader] + 1;
    }
    return end;
}

static void count_from(fp3_room *r, uint32_t begin, uint32_t end) {
    for (uint32_t gap = begin; gap < end; gap++)
        r->live[gap]++;
}

void fp3_room_begin(fp3_room *r, const uint32_t *plan) {
    const fp3_block *block = r->block;
    const uint32_t n = block->count, variables = block->code->variable_count;
    r->issued = 0;
    memcpy(r->plan, plan, n * sizeof *plan);
    for (uint32_t p = 0; p < n; p++)
        r->position[plan[p]] = p;
    memset(r->live, 0, (n + 1) * sizeof *r->live);
    uint32_t always = block->code->param_count;
    for (uint32_t x = 0; x < variables; x++) {
        always += block->writer[x] == FP3_NONE_INDEX;
        count_from(r, 0, end_of(r, 2 * (n + x) + 1, FP3_NONE_INDEX));
    }
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t born = r->position[i] + 1;
        const uint32_t end = r->is_kept[2 * i] ? n + 1 : end_of(r, 2 * i, FP3_NONE_INDEX);
        count_from(r, 0, end_of(r, 2 * i + 1, FP3_NONE_INDEX));
        count_from(r, born, end > born ? end : born + 1);
    }
    for (uint32_t gap = 0; gap <= n; gap++)
        r->live[gap] += (int32_t)always;
}

uint32_t fp3_room_turn(const fp3_room *r, uint32_t node) { return r->position[node] - r->issued; }

/* ---- an instruction before its turn ---- */

/* ends[k]: the first gap in which no other reader waits for operand k's value. */
static void find_ends(const fp3_room *r, uint32_t node, uint32_t ends[3]) {
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t value = operand_value(r, node, k);
        ends[k] = UINT32_MAX;
        if (value != FP3_NONE_INDEX && !r->is_kept[value])
            ends[k] = end_of(r, value, node);
    }
}

/* What the gap behind a gap of the plan has once the node has issued before it. */
static int32_t live_then(const fp3_room *r, uint32_t gap, const uint32_t ends[3]) {
    int32_t live = r->live[gap] + 1;
    for (uint32_t k = 0; k < 3; k++)
        live -= gap >= ends[k];
    return live;
}

int fp3_room_allows(const fp3_room *r, uint32_t node) {
    uint32_t ends[3];
    find_ends(r, node, ends);
    for (uint32_t gap = r->issued; gap < r->position[node]; gap++)
        if (live_then(r, gap, ends) > (int32_t)r->limit)
            return 0;
    return 1;
}

void fp3_room_issue(fp3_room *r, uint32_t node) {
    uint32_t ends[3];
    find_ends(r, node, ends);
    for (uint32_t p = r->position[node]; p > r->issued; p--) {
        r->live[p] = live_then(r, p - 1, ends);
        r->plan[p] = r->plan[p - 1];
        r->position[r->plan[p]] = p;
    }
    r->plan[r->issued] = node;
    r->position[node] = r->issued++;
}
