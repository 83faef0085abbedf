/* SPDX-License-Identifier: Apache-2.0 */
/* fast_order.c - in which order objects stand in the columns of the "fast" engine. */
#include "fast_own.h"

#include <stdlib.h>
#include <string.h>

/* Objects: it pays from some thousands on, and engine isa can be compared with 512. */
#define WORTH_AN_ORDER 256
#define LISTS_IN_ORDER 16 /* that are made before objects are put in order again */

uint32_t fp3_order_rows(const fp3_members *members) {
    return members->lists.living ? members->lists.living->count : members->rows;
}

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

/* Rows get new places, the first `count` of them; scratch has as many words as there are objects.
 */
static void move_rows(fast *self, const fp3_engine *engine, const uint32_t *rows, uint32_t count,
                      uint32_t *scratch) {
    move(self, rows, count, scratch);
    for (uint32_t i = 0; i < count; i++)
        scratch[rows[i]] = i;
    for (uint32_t i = 0; i < engine->objects; i++)
        if (self->row[i] < count)
            self->row[i] = scratch[self->row[i]];
}

/* Those that live stand in front, by their numbers. */
static fp3_status put_living_in_front(fp3_engine *engine, const fp3_living *living) {
    const uint32_t count = engine->objects;
    uint32_t *rows = malloc(count * sizeof *rows), *scratch = malloc(count * sizeof *scratch);
    uint32_t front = 0, behind = living->count;
    fp3_status status = rows && scratch ? need_rows(engine) : fp3_no_memory(engine->def.error);
    for (uint32_t i = 0; !status && i < count; i++)
        rows[living->is[i] ? front++ : behind++] = i;
    if (!status)
        status = fp3_lists_move(&engine->layout.groups[0].lists, rows, count, engine->def.error);
    if (!status)
        move_rows(engine->self, engine, rows, count, scratch);
    free(rows);
    free(scratch);
    return status;
}

/* Those that are put in order: objects of other kinds stand behind them. */
static uint32_t rows_in_order(const fp3_members *members) {
    const fp3_list *list = &members->lists.lists[0];
    return list->own < list->objects ? list->own : fp3_order_rows(members);
}

static void put_guests_behind(const fp3_members *members, uint32_t count, const uint32_t *from,
                              uint32_t *rows) {
    uint32_t own = 0, guests = members->objects;
    for (uint32_t i = 0; i < count; i++)
        rows[from[i] - members->from < members->objects ? own++ : guests++] = from[i];
}

static fp3_status put_in_order(fp3_engine *engine, fp3_members *members,
                               const fp3_where_they_are *now) {
    fast *self = engine->self;
    const uint32_t count = now->objects, all = engine->objects;
    uint32_t *rows = malloc(all * sizeof *rows), *scratch = malloc(all * sizeof *scratch);
    fp3_status status = need_rows(engine);
    for (uint32_t i = count; rows && i < all; i++)
        rows[i] = i;
    if (!status && (!rows || !scratch))
        status = fp3_no_memory(engine->def.error);
    if (!status)
        status = fp3_near_order(&members->lists.lists[0].near, now, scratch, engine->def.error);
    if (!status)
        put_guests_behind(members, count, scratch, rows);
    if (!status)
        status = fp3_lists_move(&members->lists, rows, all, engine->def.error);
    if (!status) {
        move_rows(self, engine, rows, count, scratch);
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
    int is_near = rows_in_order(members) > WORTH_AN_ORDER;
    for (uint32_t i = 0; i < lists->shape.list_count; i++)
        is_near &= lists->lists[i].is_near;
    return is_near;
}

fp3_status fp3_order_follow(fp3_engine *engine, fp3_members *members) {
    const fast *self = engine->self;
    const fp3_living *living = members->lists.living;
    const fp3_near_rule *rule = &members->lists.lists[0].near;
    fp3_where_they_are now = {
        .stride = 1, .objects = rows_in_order(members), .dimensions = rule->dimensions};
    fp3_status status = FP3_OK;
    if (living && !self->row)
        status = put_living_in_front(engine, living);
    if (!may_have_an_order(members))
        return living ? status : fp3_order_undo(engine);
    if (status || rule->lists < self->order_due)
        return status;
    now.row = self->row;
    for (uint32_t k = 0; k < FP3_NEAR_COLUMNS; k++)
        if (fp3_near_has(rule, k))
            now.position[k] = self->column[rule->regs[k]];
    if (rule->radius && !members->lists.lists[0].kind)
        now.radius = self->column[rule->radius - 1];
    if (!fp3_near_is_stale(rule, &now))
        return FP3_OK;
    return put_in_order(engine, members, &now);
}
