/* ranks.c - the engine of a cluster: objects divided among processes, each with an engine of its own. */
#include "ranks_own.h"

#include "cells.h"
#include "checks.h"
#include "library.h"
#include "life.h"
#include "origin.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

fp3_status fp3_ranks_open(fp3_ranks *ranks, fp3_error *error) {
    void *library = NULL;
    *ranks = (fp3_ranks){0};
    const fp3_status status =
        fp3_library_load("fp3_mpi.so", "library for clusters", &library, NULL, error);
    if (status)
        return status;
    ranks->calls = fp3_library_symbol(library, "fp3_mpi_calls");
    if (!ranks->calls || ranks->calls->version != FP3_MPI_VERSION ||
        ranks->calls->size != sizeof *ranks->calls)
        return fp3_fail(error, FP3_E_SYSTEM,
                        "fp3_mpi.so is of another version: both must come from one build");
    ranks->world = ranks->calls->open();
    if (!ranks->world)
        return fp3_fail(error, FP3_E_SYSTEM, "MPI does not start");
    ranks->rank = ranks->calls->rank(ranks->world);
    ranks->count = ranks->calls->ranks(ranks->world);
    return FP3_OK;
}

/* ---- words of objects, wherever they are ---- */

/* How many of the own objects have a smaller number. */
static uint32_t place_of(const fp3_ranked *self, size_t number) {
    uint32_t low = 0, high = self->share[self->ranks->rank];
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (self->mine[middle] < number)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Those of a range that are here, as cells of the own engine. */
static fp3_cells own_cells(const fp3_ranked *self, fp3_cells cells) {
    const uint32_t begin = place_of(self, cells.first),
                   end = place_of(self, cells.first + cells.count);
    cells.first = self->first + begin;
    cells.count = end - begin;
    return cells;
}

static fp3_status read_constants(const fp3_engine *engine, fp3_cells cells, void *words) {
    const fp3_ranked *self = engine->self;
    memcpy(words, &self->constants[(size_t)cells.number * engine->config->registers + cells.first],
           cells.count * sizeof *self->constants);
    return FP3_OK;
}

fp3_status fp3_ranks_read(fp3_engine *engine, fp3_cells cells, void *words) {
    fp3_ranked *self = engine->self;
    const unsigned ranks = self->ranks->count;
    if (cells.kind == FP3_CELLS_CONSTANT)
        return read_constants(engine, cells, words);
    const fp3_cells here = own_cells(self, cells);
    uint64_t *bytes = calloc(ranks, sizeof *bytes), *next = calloc(ranks, sizeof *next);
    uint32_t *own = malloc((here.count + 1) * sizeof *own), *to = words,
             *all = malloc((cells.count + 1) * sizeof *all);
    fp3_status status = bytes && next && own && all
                            ? FP3_OK
                            : fp3_fail(engine->def.error, FP3_E_SYSTEM, "out of memory");
    if (!status && here.count)
        status = self->own->backend->read(self->own, here, own);
    for (size_t i = cells.first; !status && i < cells.first + cells.count; i++)
        bytes[self->whose[i]] += sizeof *own;
    if (!status) {
        self->ranks->calls->gather(self->ranks->world, own, bytes, all);
        for (unsigned r = 1; r < ranks; r++)
            next[r] = next[r - 1] + bytes[r - 1] / sizeof *own;
        for (size_t i = 0; i < cells.count; i++)
            to[i] = all[next[self->whose[cells.first + i]]++];
    }
    free(bytes);
    free(next);
    free(own);
    free(all);
    return status;
}

static fp3_status write_constants(fp3_engine *engine, fp3_cells cells, const void *words) {
    fp3_ranked *self = engine->self;
    const int group = self->own ? self->group[cells.number] : -1;
    memcpy(&self->constants[(size_t)cells.number * engine->config->registers + cells.first], words,
           cells.count * sizeof *self->constants);
    if (group < 0)
        return FP3_OK;
    cells.number = (uint32_t)group;
    return fp3_cells_write(self->own, cells, words);
}

fp3_status fp3_ranks_write_guests(fp3_ranked *self, fp3_cells cells, const uint32_t *words) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < self->guest_count; i++) {
        const size_t at = self->guests[i] - cells.first;
        if (self->guests[i] >= cells.first && at < cells.count)
            status = fp3_cells_write(
                self->own, (fp3_cells){cells.kind, cells.number, fp3_ranks_row(self, i), 1},
                words + at);
    }
    return status;
}

static fp3_status write_words(fp3_engine *engine, fp3_cells cells, const void *words) {
    fp3_ranked *self = engine->self;
    if (cells.kind == FP3_CELLS_CONSTANT)
        return write_constants(engine, cells, words);
    const fp3_cells here = own_cells(self, cells);
    const uint32_t begin = (uint32_t)here.first - self->first, *from = words;
    uint32_t *own = malloc((here.count + 1) * sizeof *own);
    fp3_status status = own ? FP3_OK : fp3_fail(engine->def.error, FP3_E_SYSTEM, "out of memory");
    for (size_t i = 0; !status && i < here.count; i++)
        own[i] = from[self->mine[begin + i] - cells.first];
    if (!status && here.count)
        status = fp3_cells_write(self->own, here, own);
    free(own);
    return status || !self->own ? status : fp3_ranks_write_guests(self, cells, words);
}

/* ---- open, load, close ---- */

static fp3_status no_memory(fp3_engine *engine) {
    return fp3_fail(engine->def.error, FP3_E_SYSTEM, "out of memory");
}

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
               : no_memory(engine);
}

static void close_ranked(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    fp3_ranks_forget(self);
    free(self->group);
    free(self->constants);
    free(self);
}

/* Programs are new: what objects hold comes by `write`. */
static fp3_status load_ranked(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    memset(self->constants, 0,
           (size_t)fp3_config_schedulers(engine->config) * engine->config->registers *
               sizeof *self->constants);
    return fp3_ranks_begin(engine);
}

static fp3_status connect_ranked(fp3_engine *engine, fp3_members *group, const fp3_list *list) {
    fp3_ranked *self = engine->self;
    (void)group;
    (void)list;
    self->is_placed = 0;
    return FP3_OK;
}

/* ---- a run ---- */

/* The own engine finds out itself who sleeps; who lives it is told. */
static fp3_status list_ranked(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && engine->lives.list && i < self->share[self->ranks->rank]; i++) {
        const fp3_life *life = &engine->lives.list[self->mine[i]];
        status = fp3_engine_live(self->own, self->first + i, 1, life->born, life->gone);
    }
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

static fp3_status run_ranked(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    fp3_ranked *self = engine->self;
    fp3_status status = self->is_placed ? FP3_OK : fp3_ranks_place(engine);
    fp3_stats own = {0};
    if (!status && self->own) {
        self->own->clock = engine->clock;
        self->own->made = engine->made;
        self->own->def.visit = engine->def.visit;
        status = fp3_engine_run(self->own, steps, &own);
    }
    if (self->ranks->exchanged)
        self->ranks->exchanged->steps += (uint64_t)(own.seconds * 1e9);
    if (status) /* the others wait for words that do not come */
        return status;
    stats->flags |= own.flags;
    stats->schedulers = own.schedulers;
    add_up(engine, stats);
    return FP3_OK;
}

static int by_object(const void *a, const void *b) {
    const uint32_t x = ((const fp3_failed *)a)->object, y = ((const fp3_failed *)b)->object;
    return (x > y) - (x < y);
}

/* The ranks look together: where objects see each other each makes the run again. */
static fp3_status failures_ranked(fp3_engine *engine, fp3_failed **failed, size_t *count) {
    fp3_ranked *self = engine->self;
    const fp3_ranks *ranks = self->ranks;
    uint64_t *bytes = calloc(ranks->count, sizeof *bytes), all = 0;
    const uint64_t one = sizeof(uint64_t);
    fp3_status status = bytes ? FP3_OK : no_memory(engine);
    fp3_failed *own = NULL;
    size_t found = 0;
    if (!status && self->own)
        status = fp3_engine_find_failures(self->own);
    if (!status && self->own) {
        found = self->own->failures.count;
        own = self->own->failures.list;
        for (size_t i = 0; i < found; i++)
            own[i].object = self->mine[own[i].object - self->first];
    }
    for (unsigned r = 0; r < ranks->count && !status; r++)
        bytes[r] = one;
    if (!status) {
        const uint64_t mine = found * sizeof *own;
        uint64_t *sizes = calloc(ranks->count, sizeof *sizes);
        if (!sizes)
            status = no_memory(engine);
        else
            ranks->calls->gather(ranks->world, &mine, bytes, sizes);
        for (unsigned r = 0; !status && r < ranks->count; r++)
            all += sizes[r];
        *failed = malloc(all + sizeof **failed);
        if (!*failed)
            status = no_memory(engine);
        if (!status)
            ranks->calls->gather(ranks->world, own, sizes, *failed);
        free(sizes);
    }
    free(bytes);
    *count = status ? 0 : all / sizeof **failed;
    if (*count)
        qsort(*failed, *count, sizeof **failed, by_object);
    return status;
}

static const char *how_ranked(const fp3_engine *engine) {
    const fp3_ranked *self = engine->self;
    return self->own ? fp3_engine_how(self->own) : "";
}

static const fp3_backend ranked = {
    .open = open_ranked,
    .close = close_ranked,
    .load = load_ranked,
    .read = fp3_ranks_read,
    .write = write_words,
    .connect = connect_ranked,
    .list = list_ranked,
    .run = run_ranked,
    .failures = failures_ranked,
    .how = how_ranked,
    .is_in_host = 1,
    .is_divided = 1,
};

static fp3_status check_def(const fp3_engine_def *def) {
    const char *what = def->retire        ? "retirements are told"
                       : def->trace       ? "a trace is told"
                       : def->bus_log     ? "a bus is logged"
                       : def->cycle_limit ? "a cycle limit is kept"
                       : def->native      ? "native code is taken"
                                          : NULL;
    return what ? fp3_fail(def->error, FP3_E_ARGUMENT, "%s by one process, not by several", what)
                : FP3_OK;
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
        return status ? status : fp3_fail(def->error, FP3_E_SYSTEM, "out of memory");
    self->backend = ranked;
    self->backend.name = own->name;
    self->ranks = ranks;
    self->def = *def;
    self->def.engine = own->name;
    self->def.config = config->name;
    return fp3_engine_open_on(&self->def, config, &self->backend, self, engine);
}
