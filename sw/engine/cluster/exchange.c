/* SPDX-License-Identifier: Apache-2.0 */
/* exchange.c - guests are brought up to date, when a phase begins. */
#include "inside.h"
#include "positions.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Whether some object has moved by more than half the skin since guests were chosen: then another
 * may be near that is none. Who has no place, and had none, has not moved. */
static fp3_status look_who_moved(fp3_engine *engine, uint64_t *has_moved) {
    const fp3_ranked *self = engine->self;
    const fp3_near_rule *rule = fp3_positions_rule(&engine->layout.groups[0]);
    const uint32_t own = self->share[fp3_ranks_here(self)];
    const double skin = fp3_positions_skin(&engine->layout.groups[0]),
                 most = skin * skin / 4 * (1 - 1e-5);
    uint32_t *words = malloc((own + (size_t)1) * sizeof *words);
    double *way = calloc(own + (size_t)1, sizeof *way);
    unsigned char *astray = calloc(own + (size_t)1, 1); /* bit 0: it is; bit 1: it was */
    fp3_status status = words && way && astray ? FP3_OK : fp3_ranks_no_memory(engine);
    for (uint32_t k = 0; !status && own && k < rule->dimensions; k++) {
        status = self->own->backend->read(
            self->own, (fp3_cells){FP3_CELLS_REGISTER, rule->regs[k], self->first, own}, words);
        for (uint32_t i = 0; !status && i < own; i++) {
            const double now = fp3_near_number(rule, words[i]),
                         made = fp3_near_number(rule, self->made[k][i]);
            way[i] += (now - made) * (now - made);
            astray[i] |= (unsigned char)((isfinite(now) ? 0 : 1) | (isfinite(made) ? 0 : 2));
        }
    }
    *has_moved = 0;
    for (uint32_t i = 0; !status && i < own; i++)
        *has_moved |= !(way[i] <= most) && astray[i] != 3;
    free(words);
    free(way);
    free(astray);
    return status;
}

/* Words that neighbours read and no phase stores: an exchange does not bring them. */
static fp3_status bring_constants(fp3_engine *engine) {
    const fp3_members *group = &engine->layout.groups[0];
    const uint64_t set = group->lists.shape.published & ~fp3_layout_published(group);
    uint32_t *words = malloc(engine->objects * sizeof *words);
    fp3_status status = words ? FP3_OK : fp3_ranks_no_memory(engine);
    for (uint32_t reg = 0; !status && reg < engine->config->registers; reg++)
        if (set >> reg & 1) {
            const fp3_cells cells = {FP3_CELLS_REGISTER, reg, 0, engine->objects};
            status = fp3_ranks_read(engine, cells, words);
            if (!status && ((fp3_ranked *)engine->self)->own)
                status = fp3_ranks_write_guests(engine->self, cells, words);
        }
    free(words);
    return status;
}

static fp3_status choose_again(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    uint32_t **names = self->standing ? &self->again : &self->names,
             *numbers = malloc((self->room + (size_t)1) * sizeof *numbers),
             *row = malloc(engine->objects * sizeof *row);
    const uint32_t rows = self->own ? self->own->layout.groups[0].rows : 0;
    fp3_remembered saved[FP3_LISTS_MAX] = {{0}};
    fp3_status status = numbers && row ? FP3_OK : fp3_ranks_no_memory(engine);
    if (!status && self->own)
        status = fp3_ranks_keep(self, saved);
    if (!status)
        status = fp3_ranks_choose_guests(engine, self);
    if (!status && self->own && self->share[fp3_ranks_here(self)] + self->guest_count > self->room)
        status = fp3_fail(engine->def.error, FP3_E_PROGRAM,
                          "rank %u has %" PRIu32 " objects of its own and needs %" PRIu32
                          " of other ranks: there is room for %" PRIu32 " together",
                          fp3_ranks_here(self), self->share[fp3_ranks_here(self)],
                          self->guest_count, self->room);
    self->is_stale = 0;
    if (!status && self->own) {
        self->own->layout.groups[0].rows = self->share[fp3_ranks_here(self)] + self->guest_count;
        fp3_ranks_number_rows(self, numbers);
        fp3_ranks_rename_links(self, self->is_new ? self->names : *names, numbers, row);
        status = fp3_engine_set_numbers(self->own, numbers);
        if (!status)
            status = fp3_ranks_rename(self, rows, *names, numbers, saved);
    }
    for (uint32_t k = 0; k < FP3_LISTS_MAX; k++)
        fp3_remembered_free(&saved[k]);
    free(row);
    free(*names);
    *names = numbers;
    return status ? status : bring_constants(engine);
}

static fp3_status gather(const fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    const uint64_t published = fp3_layout_published(&engine->layout.groups[0]);
    fp3_status status = FP3_OK;
    uint32_t *to = self->out.words;
    for (uint32_t r = 0, row = 0; r < self->ranks->count; row += self->out.count[r], r++)
        for (uint32_t reg = 0; !status && self->out.count[r] && reg < 64; reg++)
            if (published >> reg & 1) {
                status =
                    fp3_engine_gather(self->own, reg, self->out.rows + row, self->out.count[r], to);
                to += self->out.count[r];
            }
    self->use.sent += (uint64_t)(to - self->out.words) * sizeof *to;
    return status;
}

static fp3_status scatter(const fp3_engine *engine) {
    const fp3_ranked *self = engine->self;
    const uint64_t published = fp3_layout_published(&engine->layout.groups[0]);
    fp3_status status = FP3_OK;
    const uint32_t *from = self->in.words;
    for (uint32_t r = 0, guest = 0; r < self->ranks->count; guest += self->in.count[r], r++)
        for (uint32_t reg = 0; !status && self->in.count[r] && reg < 64; reg++)
            if (published >> reg & 1) {
                const fp3_cells cells = {FP3_CELLS_REGISTER, reg, fp3_ranks_row(self, guest),
                                         self->in.count[r]};
                status = self->own->backend->write(self->own, cells, from);
                from += self->in.count[r];
            }
    return status;
}

static fp3_status send_words(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    uint64_t has_moved = 0;
    fp3_status status = self->made[0] ? look_who_moved(engine, &has_moved) : FP3_OK;
    has_moved |= (uint64_t)self->is_stale;
    if (!status && self->made[0] && self->ranks->calls->most(self->ranks->world, has_moved))
        status = choose_again(engine);
    if (!status)
        status = gather(engine);
    if (!status) {
        self->ranks->calls->begin(self->plan);
        self->is_open = 1;
    }
    return status;
}

static fp3_status receive_words(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    self->ranks->calls->end(self->plan);
    self->is_open = 0;
    self->use.times++;
    return scatter(engine);
}

static uint64_t now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

/* The engine that makes a run again stands in for the own one. */
static fp3_status stand_in(fp3_engine *engine, fp3_engine *own,
                           fp3_status (*part)(fp3_engine *engine)) {
    fp3_ranked *self = engine->self;
    fp3_engine *usual = self->own;
    const fp3_rank_use before = self->use;
    const uint64_t began = now();
    self->is_new = own != usual && self->standing != own && self->made[0];
    self->own = own;
    self->standing = own != usual ? own : NULL;
    if (self->is_new) {
        memcpy(self->again, self->began, self->room * sizeof *self->again);
        self->is_stale = 1;
    }
    const fp3_status status = part(engine);
    self->own = usual;
    self->use.exchange += now() - began;
    if (own != usual) {
        self->use = before;
        self->is_stale = self->made[0] != NULL;
    }
    return status;
}

uint64_t fp3_ranks_worst(void *user, uint64_t key) {
    const fp3_engine *engine = user;
    const fp3_ranks *ranks = ((const fp3_ranked *)engine->self)->ranks;
    return ranks->calls->most(ranks->world, key);
}

fp3_status fp3_ranks_send(void *user, fp3_engine *own) { return stand_in(user, own, send_words); }

fp3_status fp3_ranks_receive(void *user, fp3_engine *own) {
    return stand_in(user, own, receive_words);
}
