/* rtl.c - the "rtl" engine: drives a simulated FP3 over its AXI4-Lite bus, as a driver would.
 *
 * What it tells the hardware and what it learns goes over the bus: the cycles are the hardware's
 * own count. Retirements alone are watched from outside.
 */
#include "backend.h"

#include "base/file.h"
#include "hardware.h"
#include "in_flight.h"

#include "gen/registers.h"
#include <fp3/isa.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Nothing issues or retires for so long: time to ask whether the run has ended. Asking early costs
 * the simulation some cycles, the hardware none; it may be wrong about a long stall. */
#define QUIET_CYCLES 64
#define TELL_CYCLES 4096  /* from one report of progress to the next */
#define STOP_CYCLES 10000 /* from control.stop to the end of a run */

typedef struct {
    fp3_hardware hardware;
    fp3_rtl *rtl;
    fp3_output *output;       /* NULL unless there is a bus log ... */
    FILE *log;                /* ... and its stream */
    fp3_in_flight *in_flight; /* NULL unless somebody traces */
    uint64_t executed;        /* instructions of this run */
    uint64_t hash;            /* FNV-1a of all retirements: the log ends each run with it */
} rtl_engine;

#define BIT(field) (1u << FP3_##field##_LO)
#define VALUE(field, value) ((uint32_t)(value) << FP3_##field##_LO)
#define FIELD(word, field)                                                                         \
    (((word) >> FP3_##field##_LO) & ((2u << (FP3_##field##_HI - FP3_##field##_LO)) - 1))

/* ---- the bus ---- */

static uint32_t schedulers(const fp3_engine *engine) {
    return fp3_config_schedulers(engine->config);
}

static uint32_t of_scheduler(uint32_t scheduler, uint32_t address) {
    return scheduler << FP3_ADDRESS_SCHEDULER_LO | address;
}

/* The address for all schedulers: a write goes to all, a read gives the OR. */
static uint32_t of_all(const fp3_engine *engine, uint32_t address) {
    return of_scheduler(schedulers(engine) > 1 ? FP3_ADDRESS_BROADCAST : 0, address);
}

static uint32_t in_space(uint32_t scheduler, uint32_t space, uint32_t word) {
    return of_scheduler(scheduler, space << FP3_ADDRESS_SPACE_LO | word << FP3_ADDRESS_WORD_LO);
}

static fp3_status transfer(fp3_engine *engine, int is_write, uint32_t address, uint32_t *data) {
    rtl_engine *self = engine->self;
    const uint64_t begin = self->hardware.ops->now(self->rtl);
    const int result = self->hardware.ops->transfer(self->rtl, is_write, address, data);
    engine->bus.transfers++;
    engine->bus.cycles += self->hardware.ops->now(self->rtl) - begin;
    if (result == 0)
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_SYSTEM, "the hardware %s %s at 0x%08" PRIx32,
                    result > 0 ? "refused" : "did not answer", is_write ? "a write" : "a read",
                    address);
}

static fp3_status put(fp3_engine *engine, uint32_t address, uint32_t data) {
    rtl_engine *self = engine->self;
    if (self->log)
        fprintf(self->log, "w %08" PRIx32 " %08" PRIx32 "\n", address, data);
    return transfer(engine, 1, address, &data);
}

static fp3_status get(fp3_engine *engine, uint32_t address, uint32_t *data) {
    rtl_engine *self = engine->self;
    fp3_status status = transfer(engine, 0, address, data);
    if (!status && self->log)
        fprintf(self->log, "r %08" PRIx32 " %08" PRIx32 "\n", address, *data);
    return status;
}

typedef struct {
    uint32_t address, data;
} request;

static fp3_status put_all(fp3_engine *engine, const request *list, size_t count) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < count; i++)
        status = put(engine, of_all(engine, list[i].address), list[i].data);
    return status;
}

/* ---- what is watched ---- */

static uint64_t fnv(uint64_t hash, uint32_t word) {
    for (int i = 0; i < 4; i++)
        hash = (hash ^ (word >> 8 * i & 0xff)) * 0x100000001b3u;
    return hash;
}

static void note_issue(void *user, const fp3_rtl_issue *issue) {
    const fp3_engine *engine = user;
    fp3_in_flight_issue(((rtl_engine *)engine->self)->in_flight, issue);
}

/* The hardware numbers objects within their lane, the caller all of them. */
static void note_end(void *user, const fp3_rtl_end *end) {
    const fp3_engine *engine = user;
    rtl_engine *self = engine->self;
    self->executed += end->outcome == FP3_EXECUTED;
    fp3_retirement r = end->result;
    const uint32_t row = r.object, column = r.scheduler * engine->config->lanes + r.lane;
    r.object =
        fp3_layout_who(&engine->layout, engine->config, &(fp3_where){r.scheduler, r.lane, row});
    fp3_traced traced;
    if (self->in_flight && fp3_in_flight_end(self->in_flight, end, &traced)) {
        traced.object = r.object;
        engine->def.trace(engine->def.trace_user, &traced);
    }
    if (!end->has_result)
        return;
    if (self->log) {
        const uint32_t words[] = {column, row, r.reg, r.bits, r.flags};
        for (size_t i = 0; i < sizeof words / sizeof *words; i++)
            self->hash = fnv(self->hash, words[i]);
    }
    if (engine->def.retire)
        engine->def.retire(engine->def.retire_user, &r);
}

/* ---- open ---- */

static fp3_status check_build(fp3_engine *engine) {
    const fp3_config *c = engine->config;
    const uint32_t id = 0x46503300u | FP3_ISA_REVISION;
    const struct {
        uint32_t address, expected;
    } rows[] = {
        {FP3_ADDR_ID, id},
        {FP3_ADDR_SHAPE, VALUE(SHAPE_REGISTERS, c->registers) |
                             VALUE(SHAPE_CONSTANTS, c->registers) |
                             VALUE(SHAPE_CONTEXTS, c->contexts)},
        {FP3_ADDR_MEMORY, c->program_words},
        {FP3_ADDR_STORE, c->store_words},
        {FP3_ADDR_ARRAY, VALUE(ARRAY_TILES, c->tiles) | VALUE(ARRAY_SCHEDULERS, c->schedulers) |
                             VALUE(ARRAY_LANES, c->lanes)},
        {FP3_ADDR_FEATURES, FP3_FEATURES_OF(c)},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        uint32_t got = 0;
        fp3_status status = get(engine, rows[i].address, &got);
        if (status)
            return status;
        if (got != rows[i].expected)
            return fp3_fail(engine->def.error, FP3_E_SYSTEM,
                            "the hardware is not configuration '%s': at 0x%04" PRIx32
                            " it has 0x%08" PRIx32 ", wanted 0x%08" PRIx32,
                            c->name, rows[i].address, got, rows[i].expected);
    }
    return FP3_OK;
}

static fp3_status rtl_open(fp3_engine *engine) {
    rtl_engine *self = engine->self = calloc(1, sizeof *self);
    if (!self)
        return fp3_fail(engine->def.error, FP3_E_SYSTEM, "out of memory");
    fp3_status status = fp3_hardware_load(engine->config->name, &self->hardware, engine->def.error);
    if (status)
        return status;
    self->hash = 0xcbf29ce484222325u;
    if (engine->def.trace && !(self->in_flight = fp3_in_flight_make(engine->config)))
        return fp3_fail(engine->def.error, FP3_E_SYSTEM, "out of memory");
    const fp3_rtl_watch watch = {self->in_flight ? note_issue : NULL, note_end, engine};
    if (!(self->rtl = self->hardware.ops->open(&watch, engine->def.bus_waits)))
        return fp3_fail(engine->def.error, FP3_E_SYSTEM, "out of memory");
    if (engine->def.bus_log) {
        status = fp3_output_open(engine->def.bus_log, &self->output, engine->def.error);
        if (status)
            return status;
        self->log = fp3_output_stream(self->output);
    }
    return check_build(engine);
}

static void rtl_close(fp3_engine *engine) {
    rtl_engine *self = engine->self;
    if (self && self->rtl)
        self->hardware.ops->close(self->rtl);
    if (self)
        fp3_hardware_unload(&self->hardware);
    if (self)
        fp3_output_close(&self->output);
    if (self)
        fp3_in_flight_free(self->in_flight);
    free(self);
}

/* ---- memories ---- */

/* To all schedulers of a group: to all that there are in one transfer. */
static fp3_status put_group(fp3_engine *engine, uint32_t number, uint32_t address, uint32_t data) {
    const fp3_members *group = &engine->layout.groups[number];
    fp3_status status = FP3_OK;
    if (engine->layout.count == 1)
        return put(engine, of_all(engine, address), data);
    for (uint32_t i = 0; !status && i < group->scheduler_count; i++)
        status = put(engine, of_scheduler(group->schedulers[i], address), data);
    return status;
}

static fp3_status load_group(fp3_engine *engine, uint32_t number) {
    const fp3_members *group = &engine->layout.groups[number];
    const fp3_code *p = &group->program;
    const request shape[] = {{FP3_ADDR_STEP, p->step},
                             {FP3_ADDR_LAST, p->last},
                             {FP3_ADDR_SIZE, p->count},
                             {FP3_ADDR_RECORD, group->log2}};
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < p->count; i++)
        status = put_group(engine, number, FP3_ADDR_WINDOW_PROGRAM + 4 * i, p->code[i]);
    for (size_t i = 0; !status && i < (engine->config->interleave ? 4 : 3); i++)
        status = put_group(engine, number, shape[i].address, shape[i].data);
    return status;
}

static fp3_status rtl_load(fp3_engine *engine) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < engine->layout.count; i++)
        status = load_group(engine, i);
    return status;
}

static fp3_where where(const fp3_engine *engine, size_t object) {
    return fp3_layout_where(&engine->layout, engine->config, object);
}

static uint32_t cell_address(const fp3_engine *engine, size_t object, uint32_t reg) {
    const fp3_where at = where(engine, object);
    const uint32_t record = at.row << fp3_layout_group_of(&engine->layout, object)->log2;
    return in_space(at.scheduler, FP3_SPACE_OBJECTS,
                    at.lane * engine->config->store_words + record + reg);
}

static uint32_t status_address(const fp3_engine *engine, size_t object) {
    const fp3_where at = where(engine, object);
    return in_space(at.scheduler, FP3_SPACE_STATUS, at.lane * engine->config->store_words + at.row);
}

static fp3_status rtl_write(fp3_engine *engine, size_t object, uint32_t reg, uint32_t bits) {
    return put(engine, cell_address(engine, object, reg), bits);
}

static fp3_status rtl_read(fp3_engine *engine, size_t object, uint32_t reg, uint32_t *bits) {
    return get(engine, cell_address(engine, object, reg), bits);
}

static fp3_status rtl_write_shared(fp3_engine *engine, uint32_t group, uint32_t index,
                                   uint32_t bits) {
    return put_group(engine, group, FP3_ADDR_WINDOW_CONSTANTS + 4 * index, bits);
}

static fp3_status rtl_read_shared(fp3_engine *engine, uint32_t group, uint32_t index,
                                  uint32_t *bits) {
    const uint32_t scheduler = engine->layout.groups[group].schedulers[0];
    return get(engine, of_scheduler(scheduler, FP3_ADDR_WINDOW_CONSTANTS + 4 * index), bits);
}

static fp3_status rtl_write_status(fp3_engine *engine, size_t object, uint32_t word) {
    return put(engine, status_address(engine, object), word);
}

static fp3_status rtl_read_status(fp3_engine *engine, size_t object, uint32_t *word) {
    return get(engine, status_address(engine, object), word);
}

/* With sleep the numbers of a lane's objects, in the order of their rows; without, how many. */
static fp3_status rtl_list(fp3_engine *engine) {
    const fp3_config *config = engine->config;
    const fp3_layout *layout = &engine->layout;
    fp3_status status = FP3_OK;
    for (uint32_t scheduler = 0; scheduler < schedulers(engine); scheduler++)
        for (uint32_t lane = 0; !status && lane < config->lanes; lane++)
            status = put(engine, of_scheduler(scheduler, FP3_ADDR_WINDOW_AWAKE + 4 * lane),
                         config->sleep ? 0 : fp3_layout_rows(layout, config, scheduler, lane));
    for (uint32_t i = 0; !status && config->sleep && i < engine->objects; i++) {
        const fp3_where at = where(engine, i);
        if (fp3_engine_is_awake(engine, i))
            status =
                put(engine, of_scheduler(at.scheduler, FP3_ADDR_WINDOW_WAKE + 4 * at.lane), at.row);
    }
    return status;
}

/* ---- a run ---- */

static fp3_status start(fp3_engine *engine, uint32_t steps) {
    const request list[] = {{FP3_ADDR_VISIT, engine->def.visit},
                            {FP3_ADDR_CLOCK, engine->clock},
                            {FP3_ADDR_STEPS, steps},
                            {FP3_ADDR_CONTROL, BIT(CONTROL_START)}};
    const size_t without = engine->config->interleave ? 0 : 2;
    return put_all(engine, list + without, sizeof list / sizeof *list - without);
}

/* Until nothing happens any more; with somebody who wants to know how far it is, piece by piece. */
static void clock_in_pieces(fp3_engine *engine, uint64_t cycles) {
    const rtl_engine *self = engine->self;
    uint64_t piece = engine->def.progress ? TELL_CYCLES : cycles;
    uint64_t clocked = piece;
    for (; cycles > 0 && clocked == piece; cycles -= clocked) {
        const uint64_t begin = self->hardware.ops->now(self->rtl);
        piece = piece < cycles ? piece : cycles;
        self->hardware.ops->clock(self->rtl, piece, QUIET_CYCLES);
        clocked = self->hardware.ops->now(self->rtl) - begin;
        fp3_engine_tell(engine, self->executed);
    }
}

/* Clocks until no scheduler runs, for so many cycles at most; *outcome is the OR of all status words. */
static fp3_status wait_until_idle(fp3_engine *engine, uint64_t cycles, uint32_t *outcome) {
    rtl_engine *self = engine->self;
    fp3_status status;
    const uint64_t begin = self->hardware.ops->now(self->rtl);
    for (uint64_t clocked = 0;; clocked = self->hardware.ops->now(self->rtl) - begin) {
        if (clocked < cycles)
            clock_in_pieces(engine, cycles - clocked);
        status = transfer(engine, 0, of_all(engine, FP3_ADDR_STATUS), outcome);
        if (status || !FIELD(*outcome, STATUS_RUNNING) || clocked >= cycles)
            return status;
    }
}

static fp3_status wait_or_stop(fp3_engine *engine) {
    rtl_engine *self = engine->self;
    const uint64_t limit = engine->def.cycle_limit ? engine->def.cycle_limit : UINT64_MAX;
    uint32_t outcome = 0;
    fp3_status status = wait_until_idle(engine, limit, &outcome);
    if (!status && FIELD(outcome, STATUS_RUNNING)) {
        status = put(engine, of_all(engine, FP3_ADDR_CONTROL), BIT(CONTROL_STOP));
        if (!status)
            status = wait_until_idle(engine, STOP_CYCLES, &outcome);
        if (!status && FIELD(outcome, STATUS_RUNNING))
            return fp3_fail(engine->def.error, FP3_E_SYSTEM, "the hardware does not stop");
    }
    if (self->log)
        fprintf(self->log, "p %08" PRIx32 " %08x\n", of_all(engine, FP3_ADDR_STATUS),
                BIT(STATUS_RUNNING));
    return status;
}

static fp3_status read_counters(fp3_engine *engine, uint32_t scheduler, uint64_t *counter) {
    static const uint32_t addresses[] = {
#define X(NAME, name, address) address,
        FP3_COUNTERS(X)
#undef X
    };
    fp3_status status = FP3_OK;
    for (int i = 0; !status && i < FP3_COUNTER_COUNT; i++) {
        uint32_t low = 0, high = 0;
        status = get(engine, of_scheduler(scheduler, addresses[i]), &low);
        if (!status)
            status = get(engine, of_scheduler(scheduler, addresses[i] + 4), &high);
        counter[i] = (uint64_t)high << 32 | low;
    }
    return status;
}

/* docs/registers.md: every running cycle is an issue or a stall; all that was issued retires. */
static fp3_status check_counters(fp3_engine *engine, uint32_t scheduler, const uint64_t *n,
                                 int is_done) {
    uint64_t issued = 0, stalled = 0;
    for (int i = 0; i < FP3_COUNTER_COUNT; i++) {
        stalled += fp3_counter_is_stall((fp3_counter)i) ? n[i] : 0;
        issued += strncmp(fp3_counter_name((fp3_counter)i), "issued_", 7) == 0 ? n[i] : 0;
    }
    const uint64_t retired = n[FP3_COUNTER_RETIRED];
    if (n[FP3_COUNTER_CYCLES] == issued + stalled &&
        (is_done ? retired == issued : retired <= issued))
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_SYSTEM,
                    "the hardware's counters do not add up: scheduler %" PRIu32 ", %" PRIu64
                    " cycles, %" PRIu64 " issued, %" PRIu64 " stalled, %" PRIu64 " retired",
                    scheduler, n[FP3_COUNTER_CYCLES], issued, stalled, retired);
}

/* How a scheduler's run ended: its status word, and where if at an illegal word. */
static fp3_status ask_scheduler(fp3_engine *engine, uint32_t scheduler, uint32_t *outcome,
                                uint32_t *fault) {
    uint64_t *counter = engine->counters[scheduler];
    fp3_status status = get(engine, of_scheduler(scheduler, FP3_ADDR_STATUS), outcome);
    if (!status)
        status = get(engine, of_scheduler(scheduler, FP3_ADDR_FAULT), fault);
    if (!status)
        status = read_counters(engine, scheduler, counter);
    if (!status)
        status = check_counters(engine, scheduler, counter, *outcome == BIT(STATUS_DONE));
    if (!status && *outcome != BIT(STATUS_DONE) && *outcome != BIT(STATUS_ILLEGAL) &&
        *outcome != BIT(STATUS_STOPPED))
        status = fp3_fail(engine->def.error, FP3_E_SYSTEM,
                          "scheduler %" PRIu32 " ended a run with status 0x%08" PRIx32, scheduler,
                          *outcome);
    return status;
}

static fp3_status close_log_of_run(fp3_engine *engine) {
    rtl_engine *self = engine->self;
    if (!self->log)
        return FP3_OK;
    fprintf(self->log, "h %08" PRIx64 " %08" PRIx64 "\n", self->hash >> 32,
            self->hash & UINT32_MAX);
    return fp3_output_publish(self->output, engine->def.error);
}

/* Asks every scheduler; *illegal: the first that met an illegal word, and which. */
static fp3_status ask_schedulers(fp3_engine *engine, fp3_stats *stats, uint32_t *all,
                                 uint32_t *illegal, uint32_t *word) {
    fp3_status status = FP3_OK;
    *illegal = schedulers(engine);
    for (uint32_t scheduler = 0; !status && scheduler < schedulers(engine); scheduler++) {
        uint32_t outcome = 0, fault = 0;
        status = ask_scheduler(engine, scheduler, &outcome, &fault);
        *all |= outcome;
        stats->schedulers = scheduler + 1;
        if (*illegal == schedulers(engine) && FIELD(outcome, STATUS_ILLEGAL)) {
            *illegal = scheduler;
            *word = fault;
        }
    }
    return status;
}

static fp3_status rtl_run(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    rtl_engine *self = engine->self;
    uint32_t all = 0, illegal = 0, word = 0;
    self->executed = 0;
    fp3_status status = start(engine, steps);
    if (!status)
        status = wait_or_stop(engine);
    if (!status)
        status = ask_schedulers(engine, stats, &all, &illegal, &word);
    if (!status)
        status = get(engine, of_all(engine, FP3_ADDR_FLAGS), &stats->flags);
    if (!status)
        status = close_log_of_run(engine);
    if (!status && self->in_flight && fp3_in_flight_is_lost(self->in_flight))
        status = fp3_fail(engine->def.error, FP3_E_SYSTEM,
                          "the hardware ended an instruction that it had not issued");
    if (status)
        return status;
    if (illegal == schedulers(engine))
        return FIELD(all, STATUS_STOPPED) ? fp3_engine_limit(engine) : FP3_OK;
    const uint32_t group = engine->layout.duty[illegal].group;
    if (word < engine->layout.groups[group].program.count)
        return fp3_engine_illegal(engine, group, word);
    return fp3_fail(engine->def.error, FP3_E_SYSTEM,
                    "the hardware says that word %" PRIu32 " is illegal: there is none", word);
}

const fp3_backend fp3_backend_rtl = {
    .name = "rtl",
    .open = rtl_open,
    .close = rtl_close,
    .load = rtl_load,
    .write = rtl_write,
    .read = rtl_read,
    .write_shared = rtl_write_shared,
    .read_shared = rtl_read_shared,
    .write_status = rtl_write_status,
    .read_status = rtl_read_status,
    .list = rtl_list,
    .run = rtl_run,
};
