/* SPDX-License-Identifier: Apache-2.0 */
/* ranks.c - see ranks.h. */
#include "ranks.h"
#include "base/threads.h"
#include "inside.h"
#include "use.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- open, load, close ---- */

static fp3_status open_ranked(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    const uint32_t groups = fp3_config_schedulers(engine->config);
    self->whose = calloc(engine->objects, sizeof *self->whose);
    self->mine = calloc(engine->objects, sizeof *self->mine);
    self->share = calloc(self->ranks->count, sizeof *self->share);
    self->group = calloc(groups, sizeof *self->group);
    self->constants = calloc((size_t)groups * engine->config->registers, sizeof *self->constants);
    return self->whose && self->mine && self->share && self->group && self->constants
               ? FP3_OK
               : fp3_ranks_no_memory(engine);
}

static void close_ranked(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    fp3_ranks_forget(self);
    free(self->group);
    free(self->constants);
    free(self);
}

static void note_name(fp3_ranked *self, const char *name) {
    for (; *name; name++)
        fp3_ranks_note(self, &(uint32_t){(unsigned char)*name}, 1);
}

/* Programs are new: what objects hold comes by `write`. */
static fp3_status load_ranked(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    memset(self->constants, 0,
           (size_t)fp3_config_schedulers(engine->config) * engine->config->registers *
               sizeof *self->constants);
    note_name(self, engine->config->name);
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        fp3_ranks_note(self, &group->objects, 1);
        fp3_ranks_note(self, group->image->code, group->image->code_count);
    }
    return fp3_ranks_begin(engine);
}

static void note_list(fp3_ranked *self, const fp3_list *list) {
    if (list && list->is_near) {
        fp3_ranks_note(self, list->near.regs, list->near.dimensions);
        fp3_ranks_note(self, &list->near.reach, sizeof list->near.reach / sizeof(uint32_t));
    }
    if (!list || !list->begin || list->is_near)
        return;
    const size_t entries = list->begin[list->objects];
    fp3_ranks_note(self, list->begin, list->objects + (size_t)1);
    fp3_ranks_note(self, list->other, entries);
    fp3_ranks_note(self, list->field, entries * list->fields);
}

static fp3_status connect_ranked(fp3_engine *engine, fp3_members *group, const fp3_list *list) {
    fp3_ranked *self = engine->self;
    (void)group;
    self->is_placed = 0;
    note_list(self, list);
    if (list && list->is_near)
        self->backend.at_once = FP3_RANKS_AT_ONCE;
    return FP3_OK;
}

/* ---- a run ---- */

/* The own engine finds out itself who sleeps; who lives it is told. */
static fp3_status list_ranked(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    const fp3_life *lives = engine->lives.list;
    const fp3_status status = fp3_ranks_tell_lives(engine);
    if (lives)
        fp3_ranks_note(self, lives, engine->objects * sizeof *lives / sizeof(uint32_t));
    if (self->own)
        self->own->sleepers.is_known = self->own->sleepers.is_listed = 0;
    return status;
}

/* Counters of all; schedulers of different ranks count cycles side by side. */
static void add_up(fp3_engine *engine, fp3_stats *stats) {
    const fp3_ranked *self = engine->self;
    const fp3_ranks *ranks = self->ranks;
    uint64_t flags[32];
    for (uint32_t s = 0; s < fp3_config_schedulers(engine->config); s++) {
        uint64_t *counter = engine->counters[s];
        if (self->own)
            memcpy(counter, self->own->counters[s], sizeof engine->counters[s]);
        const uint64_t cycles = ranks->calls->most(ranks->world, counter[FP3_COUNTER_CYCLES]);
        ranks->calls->add(ranks->world, counter, FP3_COUNTER_COUNT);
        counter[FP3_COUNTER_CYCLES] = cycles;
    }
    for (unsigned i = 0; i < 32; i++)
        flags[i] = stats->flags >> i & 1;
    ranks->calls->add(ranks->world, flags, 32);
    for (unsigned i = 0; i < 32; i++)
        stats->flags |= flags[i] ? 1u << i : 0;
    stats->schedulers = (uint32_t)ranks->calls->most(ranks->world, stats->schedulers);
}

/* Ranks that were given other scenes or options would leave a result of neither, or wait for ever.
 */
static fp3_status agree_ranked(fp3_engine *engine, const void *words, size_t size) {
    fp3_ranked *self = engine->self;
    const fp3_ranks *ranks = self->ranks;
    fp3_ranks_note(self, words, size / sizeof(uint32_t));
    const uint64_t most = ranks->calls->most(ranks->world, self->given),
                   least = ~ranks->calls->most(ranks->world, ~self->given);
    return most == least ? FP3_OK
                         : fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                                    "the ranks have different programs, scenes or options: all "
                                    "read their own files, which have to be the same");
}

/* A rank without objects makes no phases, and the others would wait for what it has. */
static fp3_status check_shares(fp3_engine *engine) {
    const fp3_ranked *self = engine->self;
    for (unsigned r = 0; engine->layout.groups[0].lists.shape.worst && r < self->ranks->count; r++)
        if (!self->share[r])
            return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                            "rank %u has no objects: adaptive steps of objects that see each "
                            "other are those of all ranks, so each needs one",
                            r);
    return FP3_OK;
}

static fp3_status run_ranked(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    fp3_ranked *self = engine->self;
    fp3_status status = agree_ranked(engine, &steps, sizeof steps);
    if (!status)
        status = fp3_ranks_wander(engine);
    if (!status && !self->is_placed)
        status = fp3_ranks_place(engine);
    if (!status)
        status = check_shares(engine);
    fp3_stats own = {0};
    self->standing = NULL;
    if (!status)
        status = fp3_ranks_note_names(engine);
    if (!status && self->own) {
        self->own->clock = engine->clock;
        self->own->made = engine->made;
        self->own->def.visit = engine->def.visit;
        status = fp3_engine_run(self->own, steps, &own);
    }
    self->use.steps += (uint64_t)(own.seconds * 1e9);
    if (!status)
        status = fp3_ranks_take_memory(engine);
    if (status) /* the others wait for words that do not come */
        return status;
    stats->flags |= own.flags;
    stats->schedulers = own.schedulers;
    add_up(engine, stats);
    fp3_ranks_count_run(engine);
    return FP3_OK;
}

static int by_object(const void *a, const void *b) {
    const uint32_t x = ((const fp3_failed *)a)->object, y = ((const fp3_failed *)b)->object;
    return (x > y) - (x < y);
}

/* Where objects see each other all ranks make the run again, or none: it takes what all publish. */
static fp3_status find_own(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    const fp3_ranks *ranks = self->ranks;
    int is_suspect = 0;
    fp3_status status = self->own ? fp3_engine_suspect(self->own, &is_suspect) : FP3_OK;
    if (status)
        return status;
    if (engine->layout.groups[0].lists.shape.is_any)
        is_suspect = ranks->calls->most(ranks->world, (uint64_t)is_suspect) != 0;
    status = self->own ? fp3_engine_find_failures(self->own, is_suspect) : FP3_OK;
    for (size_t i = 0; !status && self->own && i < self->own->failures.count; i++) {
        fp3_failed *failed = &self->own->failures.list[i];
        failed->object = self->mine[failed->object - self->first];
        /* Guests have had other rows since, so only an own partner is known. */
        const uint32_t partner = failed->watched.partner - 1 - self->first;
        failed->watched.partner =
            failed->watched.partner && partner < self->share[fp3_ranks_here(self)]
                ? self->mine[partner] + 1
                : 0;
    }
    return status;
}

/* Those of all ranks. */
static fp3_status failures_ranked(fp3_engine *engine, fp3_failed **failed, size_t *count) {
    fp3_ranked *self = engine->self;
    const fp3_ranks *ranks = self->ranks;
    uint64_t *each = calloc(ranks->count, sizeof *each),
             *bytes = calloc(ranks->count, sizeof *bytes);
    uint64_t all = 0;
    fp3_status status = each && bytes ? find_own(engine) : fp3_ranks_no_memory(engine);
    const fp3_failures none = {0}, *own = !status && self->own ? &self->own->failures : &none;
    const uint64_t here = own->count * sizeof *own->list;
    for (unsigned r = 0; r < ranks->count && !status; r++)
        each[r] = sizeof *bytes;
    if (!status)
        ranks->calls->gather(ranks->world, &here, each, bytes);
    for (unsigned r = 0; !status && r < ranks->count; r++)
        all += bytes[r];
    *failed = status ? NULL : malloc(all + sizeof **failed);
    if (!status && !*failed)
        status = fp3_ranks_no_memory(engine);
    if (!status)
        ranks->calls->gather(ranks->world, own->list, bytes, *failed);
    free(each);
    free(bytes);
    *count = status ? 0 : all / sizeof **failed;
    if (*count)
        qsort(*failed, *count, sizeof **failed, by_object);
    return status;
}

static const char *how_ranked(const fp3_engine *engine) {
    const fp3_ranked *self = engine->self;
    return self->own ? fp3_engine_how(self->own) : "rank 0 has no objects";
}

static const fp3_backend ranked = {
    .open = open_ranked,
    .close = close_ranked,
    .load = load_ranked,
    .read = fp3_ranks_read,
    .write = fp3_ranks_write,
    .connect = connect_ranked,
    .list = list_ranked,
    .run = run_ranked,
    .failures = failures_ranked,
    .how = how_ranked,
    .agree = agree_ranked,
    .is_in_host = 1,
    .is_divided = 1,
};

static fp3_status check_def(const fp3_engine_def *def) {
    const char *what = def->retire        ? "retirements are told"
                       : def->trace       ? "a trace is told"
                       : def->bus_log     ? "a bus is logged"
                       : def->cycle_limit ? "a cycle limit is kept"
                       : def->native      ? "native code is taken"
                       : def->seed        ? "stores that round at random"
                                          : NULL;
    return what ? fp3_fail(def->error, FP3_E_ARGUMENT, "%s by one process, not by several", what)
                : FP3_OK;
}

/* Of the processors that the rank may use, no more than its share of the machine. */
static uint32_t share_threads(const fp3_ranks *ranks) {
    const long online = sysconf(_SC_NPROCESSORS_ONLN);
    const uint32_t share = (uint32_t)online / ranks->calls->beside(ranks->world),
                   may = fp3_threads_processors();
    return share < 1 ? 1 : share < may ? share : may;
}

fp3_status fp3_engine_open_ranks(const fp3_engine_def *def, const fp3_ranks *ranks,
                                 fp3_engine **engine) {
    const fp3_backend *own = NULL;
    const fp3_config *config = NULL;
    *engine = NULL;
    fp3_status status = fp3_engine_check(def, &own, &config);
    if (!status)
        status = check_def(def);
    fp3_ranked *self = status ? NULL : calloc(1, sizeof *self);
    if (!self)
        return status ? status : fp3_no_memory(def->error);
    self->backend = ranked;
    self->backend.is = own->is;
    self->backend.begins_at_0 = own->begins_at_0;
    self->ranks = ranks;
    self->def = *def;
    self->def.engine = own->is.name;
    self->def.config = config->name;
    if (!def->threads)
        self->def.threads = share_threads(ranks);
    return fp3_engine_open_on(&self->def, config, &self->backend, self, engine);
}
