/* SPDX-License-Identifier: Apache-2.0 */
/* fast_order.c - in which order objects stand in the columns of the "fast" engine. */
#include "fast_own.h"

#include <stdlib.h>
#include <string.h>

/* Objects: it pays from some thousands on, and engine isa can be compared with 512. */
#define WORTH_AN_ORDER 256
#define LISTS_IN_ORDER 16 /* that are made before objects are put in order again */

/* Row i gets what is in row rows[i] of the first `count`. */
static void move_one(uint32_t *column, const uint32_t *rows, uint32_t count, uint32_t *scratch) {
    for (uint32_t i = 0; column && i < count; i++)
        scratch[i] = column[rows[i]];
    if (column)
        memcpy(column, scratch, count * sizeof *column);
}

/* Both halves: a phase that does not store a published word leaves it as it was two phases ago. */
static void move(fast *self, const uint32_t *rows, uint32_t count, uint32_t *scratch) {
    for (int reg = 0; reg < FP3_BANK_OBJECT_COUNT; reg++) {
        move_one(self->column[reg], rows, count, scratch);
        move_one(self->other_half[reg], rows, count, scratch);
    }
}

fp3_status fp3_order_undo(fp3_engine *engine) {
    fast *self = engine->self;
    if (!self->row)
        return FP3_OK;
    uint32_t *scratch = malloc(engine->objects * sizeof *scratch);
    if (!scratch)
        return fp3_no_memory(engine->def.error);
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < engine->layout.count; i++)
        status = fp3_lists_move(&engine->layout.groups[i].lists, self->row, engine->objects,
                                engine->def.error);
    if (!status)
        move(self, self->row, engine->objects, scratch);
    free(scratch);
    if (status)
        return status;
    free(self->row);
    self->row = NULL;
    self->order_due = 0;
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        fp3_lists *lists = &engine->layout.groups[i].lists;
        for (uint32_t k = 0; k < lists->shape.list_count; k++)
            fp3_near_close(&lists->lists[k].near);
    }
    return FP3_OK;
}

static fp3_status need_rows(fp3_engine *engine) {
    fast *self = engine->self;
    if (self->row)
        return FP3_OK;
    self->row = malloc(engine->objects * sizeof *self->row);
    if (!self->row)
        return fp3_no_memory(engine->def.error);
    for (uint32_t i = 0; i < engine->objects; i++)
        self->row[i] = i;
    return FP3_OK;
}

static void put_guests_behind(const fp3_members *members, const uint32_t *from, uint32_t *rows) {
    uint32_t own = 0, guests = members->objects;
    for (uint32_t i = 0; i < members->rows; i++)
        rows[from[i] - members->from < members->objects ? own++ : guests++] = from[i];
}

static fp3_status put_in_order(fp3_engine *engine, fp3_members *members,
                               const fp3_where_they_are *now) {
    fast *self = engine->self;
    const uint32_t count = members->rows;
    uint32_t *rows = malloc(count * sizeof *rows), *scratch = malloc(count * sizeof *scratch);
    fp3_status status = need_rows(engine);
    if (!status && (!rows || !scratch))
        status = fp3_no_memory(engine->def.error);
    if (!status)
        status = fp3_near_order(&members->lists.lists[0].near, now, scratch, engine->def.error);
    if (!status)
        put_guests_behind(members, scratch, rows);
    if (!status)
        status = fp3_lists_move(&members->lists, rows, count, engine->def.error);
    if (!status) {
        move(self, rows, count, scratch);
        for (uint32_t i = 0; i < count; i++)
            scratch[rows[i]] = i;
        for (uint32_t i = 0; i < count; i++)
            self->row[i] = scratch[self->row[i]];
        for (uint32_t i = 0; i < members->lists.shape.list_count; i++)
            fp3_near_close(&members->lists.lists[i].near);
        self->order_due = members->lists.lists[0].near.lists + LISTS_IN_ORDER;
    }
    free(rows);
    free(scratch);
    return status;
}

/* Sums go through lists of numbers that the host gave, or through all, in the order of rows. */
static int may_have_an_order(const fp3_members *members) {
    const fp3_lists *lists = &members->lists;
    int is_near = members->objects > WORTH_AN_ORDER;
    for (uint32_t i = 0; i < lists->shape.list_count; i++)
        is_near &= lists->lists[i].is_near;
    return is_near;
}

fp3_status fp3_order_follow(fp3_engine *engine, fp3_members *members) {
    const fast *self = engine->self;
    const fp3_near_rule *rule = &members->lists.lists[0].near;
    fp3_where_they_are now = {
        .row = self->row, .stride = 1, .objects = members->rows, .dimensions = rule->dimensions};
    if (!may_have_an_order(members))
        return fp3_order_undo(engine);
    if (rule->lists < self->order_due)
        return FP3_OK;
    for (uint32_t k = 0; k < now.dimensions; k++)
        now.position[k] = self->column[rule->regs[k]];
    if (!fp3_near_is_stale(rule, &now))
        return FP3_OK;
    return put_in_order(engine, members, &now);
}
