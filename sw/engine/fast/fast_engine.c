/* SPDX-License-Identifier: Apache-2.0 */
/* fast.c - the "fast" engine: blocks of objects by sw/engine/fast, in as many threads as there are
 * processors.
 *
 * It holds objects as columns, a word of each object in the order of their numbers, made when they
 * are first needed; what was never written is 0.
 */
#include "fast_own.h"

#include "base/threads.h"
#include "engine/common/checks.h"
#include "engine/common/words.h"
#include "machine/ahead.h"

#include <fp3/isa.h>
#include <stdlib.h>
#include <string.h>

#define ASLEEP 1         /* since before the first run */
#define BLOCKS_AT_ONCE 8 /* that a thread takes up */
/* Instructions of objects that are worth waking a thread for: about 200 microseconds. */
#define WORTH_A_THREAD 1e7
#define WORTH_INTERPRETED 4e5
#define THREADS_MOST 1024u

static fp3_status no_memory(fp3_engine *engine) { return fp3_no_memory(engine->def.error); }

/* ---- open, close, load ---- */

static fp3_status check_def(fp3_engine *engine) {
    const fp3_engine_def *def = &engine->def;
    if (def->retire)
        return fp3_fail(def->error, FP3_E_ARGUMENT,
                        "engine 'fast' tells no retirements; isa and rtl do");
    if (def->trace)
        return fp3_fail(def->error, FP3_E_ARGUMENT,
                        "engine 'fast' tells no instructions; rtl does");
    if (def->cycle_limit)
        return fp3_fail(def->error, FP3_E_ARGUMENT,
                        "engine 'fast' counts no cycles that a limit could be set to");
    if (def->threads > THREADS_MOST)
        return fp3_fail(def->error, FP3_E_ARGUMENT, "%u threads: expected at most %u", def->threads,
                        THREADS_MOST);
    return FP3_OK;
}

static fp3_status fast_open(fp3_engine *engine) {
    const uint32_t schedulers = fp3_config_schedulers(engine->config);
    fast *self = engine->self = calloc(1, sizeof *self);
    fp3_status status = check_def(engine);
    if (status)
        return status;
    if (!self)
        return no_memory(engine);
    self->hand_count = engine->def.threads ? engine->def.threads : fp3_threads_processors();
    self->groups = calloc(schedulers, sizeof *self->groups);
    self->shared = calloc((size_t)schedulers * engine->config->registers, sizeof *self->shared);
    self->hands = calloc(self->hand_count, sizeof *self->hands);
    if (engine->config->status)
        self->status = fp3_words_make(engine, engine->objects);
    const int is_there =
        self->groups && self->shared && self->hands && (self->status || !engine->config->status);
    return is_there ? fp3_threads_make(self->hand_count, &self->threads, engine->def.error)
                    : no_memory(engine);
}

static void unload(fast *self) {
    for (uint32_t i = 0; i < self->count; i++) {
        fp3_fast_free(&self->groups[i].program);
        free(self->groups[i].is_ahead);
        free(self->groups[i].awake);
        fp3_around_forget(&self->groups[i]);
        self->groups[i] = (group){0};
    }
    self->count = 0;
}

static void fast_close(fp3_engine *engine) {
    fast *self = engine->self;
    if (!self)
        return;
    fp3_threads_free(&self->threads);
    unload(self);
    for (uint32_t i = 0; self->hands && i < self->hand_count; i++)
        fp3_fast_worker_free(&self->hands[i].worker);
    for (int i = 0; i < FP3_BANK_OBJECT_COUNT; i++) {
        fp3_words_free(engine, self->column[i], engine->objects);
        fp3_words_free(engine, self->other_half[i], engine->objects);
    }
    free(self->row);
    free(self->hands);
    free(self->groups);
    free(self->shared);
    fp3_words_free(engine, self->status, engine->objects);
    fp3_words_free(engine, self->slept_in, engine->objects);
    free(self);
}

static fp3_status need_column(fp3_engine *engine, uint32_t reg) {
    fast *self = engine->self;
    if (!self->column[reg])
        self->column[reg] = fp3_words_make(engine, engine->objects);
    return self->column[reg] ? FP3_OK : no_memory(engine);
}

static fp3_status need_columns(fp3_engine *engine, uint64_t set) {
    fp3_status status = FP3_OK;
    for (uint32_t reg = 0; !status && reg < FP3_BANK_OBJECT_COUNT; reg++)
        if (set >> reg & 1)
            status = need_column(engine, reg);
    return status;
}

static fp3_fast_def def_of(const fp3_engine *engine, const fp3_members *members) {
    return (fp3_fast_def){.config = engine->config,
                          .code = &members->program,
                          .states = fp3_engine_states_of(members),
                          .is_interpreted = engine->def.is_interpreted,
                          .is_without_compiler = engine->def.is_without_compiler,
                          .native = engine->def.native,
                          .around = &members->lists.shape};
}

static fp3_status load_group(fp3_engine *engine, uint32_t i) {
    const fp3_members *members = &engine->layout.groups[i];
    group *g = &((fast *)engine->self)->groups[i];
    fp3_fast_def def = def_of(engine, members);
    def.is_ahead = g->is_ahead = calloc(members->program.count + 1u, 1);
    if (!g->is_ahead)
        return no_memory(engine);
    fp3_ahead_find(&members->program, def.states, g->is_ahead);
    fp3_status status = fp3_fast_make(&def, &g->program, engine->def.error);
    return status ? status : need_columns(engine, fp3_fast_columns(g->program));
}

static fp3_status fast_check(fp3_engine *engine, const fp3_members *members) {
    const fp3_fast_def def = def_of(engine, members);
    return fp3_fast_check(&def, engine->def.error);
}

static const uint32_t *fast_rows(const fp3_engine *engine) {
    return ((const fast *)engine->self)->row;
}

static fp3_status fast_connect(fp3_engine *engine, fp3_members *members, const fp3_list *list) {
    fast *self = engine->self;
    (void)list;
    fp3_around_forget(&self->groups[members - engine->layout.groups]);
    return fp3_order_undo(engine);
}

static fp3_status fast_load(fp3_engine *engine) {
    fast *self = engine->self;
    fp3_status status = fp3_order_undo(engine);
    unload(self);
    for (uint32_t i = 0; !status && i < engine->layout.count; i++) {
        self->count = i + 1;
        status = load_group(engine, i);
    }
    return status;
}

/* ---- what objects hold ---- */

/* The first of all of this kind; NULL: they were never written. */
static uint32_t *find(const fp3_engine *engine, fp3_cells cells) {
    const fast *self = engine->self;
    if (cells.kind == FP3_CELLS_CONSTANT)
        return &self->shared[(size_t)cells.number * engine->config->registers];
    return cells.kind == FP3_CELLS_STATUS ? self->status : self->column[cells.number];
}

/* Of each object; NULL: its number. */
static const uint32_t *rows_of(const fp3_engine *engine, fp3_cells cells) {
    const fast *self = engine->self;
    return cells.kind == FP3_CELLS_REGISTER && self->row ? self->row + cells.first : NULL;
}

static fp3_status fast_read(fp3_engine *engine, fp3_cells cells, void *words) {
    const uint32_t *from = find(engine, cells), *row = rows_of(engine, cells);
    uint32_t *to = words;
    if (!from)
        memset(words, 0, cells.count * sizeof *from);
    else if (!row)
        memcpy(words, from + cells.first, cells.count * sizeof *from);
    for (size_t i = 0; from && row && i < cells.count; i++)
        to[i] = from[row[i]];
    return FP3_OK;
}

static fp3_status fast_write(fp3_engine *engine, fp3_cells cells, const void *words) {
    const fp3_status status =
        cells.kind == FP3_CELLS_REGISTER ? need_column(engine, cells.number) : FP3_OK;
    if (status)
        return status;
    const uint32_t *from = words, *row = rows_of(engine, cells);
    uint32_t *to = find(engine, cells);
    if (!row)
        memcpy(to + cells.first, words, cells.count * sizeof *to);
    for (size_t i = 0; row && i < cells.count; i++)
        to[row[i]] = from[i];
    return FP3_OK;
}

static void fast_gather(const fp3_engine *engine, uint32_t reg, const uint32_t *objects,
                        size_t count, uint32_t *words) {
    const fast *self = engine->self;
    const uint32_t *from = self->column[reg];
    for (size_t i = 0; i < count; i++)
        words[i] = !from ? 0 : from[self->row ? self->row[objects[i]] : objects[i]];
}

/* NULL: they stand in another order. */
static fp3_status fast_column(fp3_engine *engine, uint32_t reg, const uint32_t **words) {
    const fast *self = engine->self;
    if (self->row)
        return FP3_OK;
    const fp3_status status = need_column(engine, reg);
    *words = self->column[reg];
    return status;
}

/* ---- who is awake ---- */

/* Whether some objects of a group may be left out of a run. */
static int has_list(const fp3_engine *engine, uint32_t i) {
    return engine->config->interleave &&
           (engine->layout.groups[i].program.slept >= 0 || fp3_lives_vary(engine));
}

static fp3_status fast_list(fp3_engine *engine) {
    fast *self = engine->self;
    for (uint32_t i = 0; i < self->count; i++) {
        const fp3_members *members = &engine->layout.groups[i];
        group *g = &self->groups[i];
        if (!has_list(engine, i))
            continue;
        if (!g->awake)
            g->awake = calloc(engine->objects, sizeof *g->awake);
        if (!self->slept_in)
            self->slept_in = fp3_words_make(engine, engine->objects);
        if (!g->awake || !self->slept_in)
            return no_memory(engine);
        g->awake_count = 0;
        for (uint32_t n = members->first; n < members->first + members->objects; n++) {
            self->slept_in[n] = fp3_engine_is_awake(engine, n) ? 0 : ASLEEP;
            if (!self->slept_in[n])
                g->awake[g->awake_count++] = n;
        }
    }
    self->runs = ASLEEP;
    return FP3_OK;
}

/* Who fell asleep leaves the list. */
static void keep_awake(const fp3_engine *engine) {
    const fast *self = engine->self;
    for (uint32_t i = 0; i < self->count; i++) {
        group *g = &self->groups[i];
        uint32_t left = 0;
        for (uint32_t n = 0; g->awake && n < g->awake_count; n++) {
            g->awake[left] = g->awake[n];
            left += !self->slept_in[g->awake[n]];
        }
        g->awake_count = left;
    }
}

/* ---- a run ---- */

static uint32_t members_of(const fp3_engine *engine, uint32_t i) {
    const fast *self = engine->self;
    return has_list(engine, i) ? self->groups[i].awake_count : engine->layout.groups[i].objects;
}

static uint64_t blocks_of(const fp3_engine *engine, uint32_t i) {
    return ((uint64_t)members_of(engine, i) + FP3_BLOCK - 1) / FP3_BLOCK;
}

static fp3_fast_run run_of(const fp3_engine *engine, uint32_t i, uint32_t steps) {
    const fast *self = engine->self;
    const int visits = engine->config->interleave && engine->def.visit;
    return (fp3_fast_run){.columns = self->column,
                          .objects = engine->objects,
                          .status = self->status,
                          .slept_in = self->slept_in,
                          .number = self->runs,
                          .constants = &self->shared[(size_t)i * engine->config->registers],
                          .steps = steps,
                          .visit = visits ? engine->def.visit : steps,
                          .clock = engine->clock,
                          .seed = fp3_engine_seed(engine)};
}

/* Blocks are begun in order. */
static void tell(void *user, uint32_t steps) {
    const fast *self = user;
    const work *all = &self->work;
    const double blocks = (double)self->hands[0].block + (double)steps / all->steps;
    fp3_engine_tell(all->engine, (uint64_t)(all->engine->expected * blocks / (double)all->blocks));
}

static fp3_status run_block(fast *self, uint32_t hand_number, uint32_t i, uint32_t number) {
    const fp3_engine *engine = self->work.engine;
    const fp3_members *members = &engine->layout.groups[i];
    hand *h = &self->hands[hand_number];
    fp3_fast_run run = run_of(engine, i, self->work.steps);
    const uint32_t first = number * FP3_BLOCK, left = members_of(engine, i) - first;
    run.tell = hand_number == 0 && engine->def.progress ? tell : NULL;
    run.user = self;
    const uint32_t *list = has_list(engine, i) ? self->groups[i].awake + first : NULL;
    return fp3_fast_block(self->groups[i].program, h->worker, &run, list, members->first + first,
                          left < FP3_BLOCK ? left : FP3_BLOCK, &h->error);
}

static fp3_status run_number(fast *self, uint32_t hand_number, uint64_t number) {
    const fp3_engine *engine = self->work.engine;
    uint32_t i = 0;
    self->hands[hand_number].block = number;
    for (; number >= blocks_of(engine, i); i++)
        number -= blocks_of(engine, i);
    return run_block(self, hand_number, i, (uint32_t)number);
}

static void take_part(void *of, uint32_t number) {
    fast *self = of;
    work *all = &self->work;
    hand *h = &self->hands[number];
    while (!h->status) {
        const uint64_t first = atomic_fetch_add(&all->next, BLOCKS_AT_ONCE);
        if (first >= all->blocks)
            break;
        for (uint64_t n = first; !h->status && n < first + BLOCKS_AT_ONCE && n < all->blocks; n++)
            h->status = run_number(self, number, n);
    }
}

/* As many hands as there is work for. In a phase a hand takes one block at a time. */
static uint32_t hands_for(const fp3_engine *engine) {
    const fast *self = engine->self;
    const int is_around = fp3_around_is_any(engine);
    const uint64_t at_once = is_around ? 1 : BLOCKS_AT_ONCE;
    const uint64_t chunks = (self->work.blocks + at_once - 1) / at_once;
    const double worth =
        engine->expected * (is_around ? fp3_around_turns(engine) : 1) /
            (fp3_fast_is_native(self->groups[0].program) ? WORTH_A_THREAD : WORTH_INTERPRETED) +
        1;
    uint64_t hands = self->hand_count < chunks ? self->hand_count : chunks;
    hands = (double)hands < worth ? hands : (uint64_t)worth;
    return hands ? (uint32_t)hands : 1;
}

static fp3_status need_workers(fp3_engine *engine, uint32_t count) {
    fast *self = engine->self;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < self->used; i++)
        if (self->hands[i].worker)
            fp3_fast_forget(self->hands[i].worker);
    self->used = count;
    for (uint32_t i = 0; !status && i < count; i++) {
        self->hands[i].status = FP3_OK;
        if (!self->hands[i].worker)
            status = fp3_fast_worker_make(&self->hands[i].worker, engine->def.error);
    }
    return status;
}

static fp3_status fast_run(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    fast *self = engine->self;
    for (uint32_t i = 0; i < engine->layout.count; i++)
        if (i >= self->count || !self->groups[i].program) /* memory ran out in the load */
            return fp3_fail(engine->def.error, FP3_E_ARGUMENT, "no program is loaded");
    stats->schedulers = 1;
    self->runs++;
    self->has_steps = steps != 0;
    self->work = (work){.engine = engine, .steps = steps};
    for (uint32_t i = 0; i < self->count; i++)
        self->work.blocks += blocks_of(engine, i);
    fp3_status status = need_workers(engine, hands_for(engine));
    if (!status && fp3_around_is_any(engine))
        status = fp3_around_run(engine, steps);
    else if (!status && steps && engine->def.tasks)
        engine->def.tasks(engine->def.tasks_user, take_part, self, self->used);
    else if (!status && steps)
        fp3_threads_run(self->threads, take_part, self, self->used);
    for (uint32_t i = 0; !status && i < self->used; i++) {
        stats->flags |= fp3_fast_flags(self->hands[i].worker);
        if ((status = self->hands[i].status) && engine->def.error)
            *engine->def.error = self->hands[i].error;
    }
    keep_awake(engine);
    return status;
}

static int by_object(const void *a, const void *b) {
    const uint32_t x = ((const fp3_failed *)a)->object, y = ((const fp3_failed *)b)->object;
    return (x > y) - (x < y);
}

/* Who made no step failed if its states were not finite before. Returns 1 if so. */
static int slept_astray(const fp3_engine *engine, const fp3_members *members, uint32_t object,
                        fp3_failed *to) {
    const fast *self = engine->self;
    uint32_t words[FP3_BANK_OBJECT_COUNT] = {0};
    const uint32_t slept_in = self->slept_in ? self->slept_in[object] : 0;
    if (self->has_steps && (!slept_in || slept_in == self->runs))
        return 0;
    for (int reg = 0; reg < FP3_BANK_OBJECT_COUNT; reg++)
        words[reg] =
            self->column[reg] ? self->column[reg][self->row ? self->row[object] : object] : 0;
    const uint32_t reg = fp3_watch_find(fp3_engine_states_of(members), words);
    if (reg == FP3_BANK_OBJECT_COUNT)
        return 0;
    *to =
        (fp3_failed){object, {.raised = FP3_NEVER, .is_astray = 1, .reg = reg, .bits = words[reg]}};
    return 1;
}

/* Fills to, unless it is NULL; how many there are. */
static size_t find_sleepers(const fp3_engine *engine, fp3_failed *to) {
    const fast *self = engine->self;
    fp3_failed one;
    size_t count = 0;
    for (uint32_t i = 0; i < self->count; i++) {
        const fp3_members *members = &engine->layout.groups[i];
        const int is_any = !self->has_steps || self->groups[i].awake;
        for (uint32_t n = 0; is_any && n < members->objects; n++)
            count +=
                (size_t)slept_astray(engine, members, members->first + n, to ? to + count : &one);
    }
    return count;
}

/* Likewise. */
static size_t find_workers_failures(const fast *self, fp3_failed *to) {
    const fp3_failed *of = NULL;
    size_t count = 0;
    for (uint32_t i = 0; i < self->used; i++) {
        const size_t more =
            self->hands[i].worker ? fp3_fast_failures(self->hands[i].worker, &of) : 0;
        if (to && more)
            memcpy(to + count, of, more * sizeof *of);
        count += more;
    }
    return count;
}

static fp3_status fast_failures(fp3_engine *engine, fp3_failed **failed, size_t *count) {
    const fast *self = engine->self;
    const size_t busy = find_workers_failures(self, NULL), asleep = find_sleepers(engine, NULL);
    *count = busy + asleep;
    *failed = calloc(*count + 1, sizeof **failed);
    if (!*failed)
        return no_memory(engine);
    find_workers_failures(self, *failed);
    find_sleepers(engine, *failed + busy);
    qsort(*failed, *count, sizeof **failed, by_object);
    return FP3_OK;
}

static fp3_status fast_write_native(fp3_engine *engine, const char *path) {
    const fast *self = engine->self;
    return fp3_fast_write_native(self->groups[0].program, path, engine->def.error);
}

static const char *fast_how(const fp3_engine *engine) {
    const fast *self = engine->self;
    return self->count ? fp3_fast_how(self->groups[0].program) : "";
}

const fp3_backend fp3_backend_fast = {
    .is = {"fast", .has_threads = 1},
    .open = fast_open,
    .close = fast_close,
    .check = fast_check,
    .load = fast_load,
    .read = fast_read,
    .write = fast_write,
    .column = fast_column,
    .gather = fast_gather,
    .rows = fast_rows,
    .connect = fast_connect,
    .list = fast_list,
    .run = fast_run,
    .failures = fast_failures,
    .write_native = fast_write_native,
    .how = fast_how,
    .is_uncounted = 1,
    .is_in_host = 1,
};
