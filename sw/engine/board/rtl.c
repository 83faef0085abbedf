/* SPDX-License-Identifier: Apache-2.0 */
/* rtl.c - the "rtl" engine: simulated hardware on a simulated AXI4-Lite bus, driven as driver.h
 * says.
 *
 * What it tells the hardware and what it learns goes over the bus: the cycles are the hardware's
 * own count. Retirements alone are watched from outside.
 */
#include "driver.h"
#include "hardware.h"
#include "in_flight.h"
#include "memory.h"
#include "session.h"
#include "store_lists.h"

#include <inttypes.h>
#include <stdlib.h>

/* Nothing issues or retires for so long: time to ask whether the run has ended. Asking early costs
 * the simulation some cycles, the hardware none; it may be wrong about a long stall. */
#define QUIET_CYCLES 64
#define TELL_CYCLES 4096 /* from one report of progress to the next */

typedef struct {
    fp3_driver driver; /* first: the calls of driver.h find it there */
    fp3_hardware hardware;
    fp3_rtl *rtl;
    fp3_in_flight *in_flight; /* NULL without a trace */
    uint64_t executed;        /* instructions of this run */
    uint64_t hash;            /* FNV-1a of all retirements: the log ends each run with it */
} rtl_engine;

/* ---- the bus ---- */

static uint64_t now(const fp3_engine *engine) {
    const rtl_engine *self = engine->self;
    return self->hardware.ops->now(self->rtl);
}

static fp3_status transfer(fp3_engine *engine, int is_write, const uint32_t *addresses,
                           uint32_t *data, uint32_t count, uint32_t *refused) {
    const rtl_engine *self = engine->self;
    fp3_rtl_word words[FP3_BUS_WORDS];
    for (uint32_t i = 0; i < count; i++)
        words[i] =
            (fp3_rtl_word){addresses[i], is_write ? data[i] : 0, (uint8_t)(is_write != 0), 0};
    if (self->hardware.ops->transfer(self->rtl, words, count))
        return fp3_fail(engine->def.error, FP3_E_SYSTEM,
                        "the hardware did not answer a %s at 0x%08" PRIx32 " or after it",
                        is_write ? "write" : "read", addresses[0]);
    for (uint32_t i = count; i-- > 0;) {
        if (words[i].is_refused)
            *refused = i + 1;
        data[i] = words[i].data;
    }
    return FP3_OK;
}

/* Runs until nothing happens any more; with a progress callback in pieces. */
static fp3_status rest(fp3_engine *engine, uint64_t cycles, uint32_t asked) {
    const rtl_engine *self = engine->self;
    uint64_t piece = engine->def.progress ? TELL_CYCLES : cycles;
    uint64_t clocked = piece;
    (void)asked;
    for (; cycles > 0 && clocked == piece; cycles -= clocked) {
        const uint64_t begin = now(engine);
        piece = piece < cycles ? piece : cycles;
        self->hardware.ops->clock(self->rtl, piece, QUIET_CYCLES);
        clocked = now(engine) - begin;
        fp3_engine_tell(engine, self->executed);
    }
    return FP3_OK;
}

static fp3_status ended(fp3_engine *engine) {
    const rtl_engine *self = engine->self;
    const fp3_status status = fp3_driver_note(engine, 'h', (uint32_t)(self->hash >> 32),
                                              (uint32_t)(self->hash & UINT32_MAX));
    if (status)
        return status;
    if (self->in_flight && fp3_in_flight_is_lost(self->in_flight))
        return fp3_fail(engine->def.error, FP3_E_SYSTEM,
                        "the hardware ended an instruction that it had not issued");
    return FP3_OK;
}

static const fp3_bus bus = {FP3_BUS_WORDS, 1, transfer, now, rest, ended};

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
        traced.pc += self->driver.first;
        engine->def.trace(engine->def.trace_user, &traced);
    }
    if (!end->has_result)
        return;
    if (self->driver.log) {
        const uint32_t words[] = {column, row, r.reg, r.bits, r.flags};
        for (size_t i = 0; i < sizeof words / sizeof *words; i++)
            self->hash = fnv(self->hash, words[i]);
    }
    if (engine->def.retire)
        engine->def.retire(engine->def.retire_user, &r);
}

/* ---- the engine ---- */

static fp3_status rtl_open(fp3_engine *engine) {
    rtl_engine *self = engine->self = calloc(1, sizeof *self);
    if (!self)
        return fp3_no_memory(engine->def.error);
    self->driver.bus = &bus;
    fp3_status status = fp3_hardware_load(engine->config->name, &self->hardware, engine->def.error);
    if (status)
        return status;
    self->hash = 0xcbf29ce484222325u;
    if (engine->def.trace && !(self->in_flight = fp3_in_flight_make(engine->config)))
        return fp3_no_memory(engine->def.error);
    const fp3_rtl_watch watch = {self->in_flight ? note_issue : NULL, note_end, engine};
    if (!(self->rtl = self->hardware.ops->open(&watch, engine->def.bus_waits)))
        return fp3_no_memory(engine->def.error);
    return fp3_driver_open(engine);
}

static void rtl_close(fp3_engine *engine) {
    rtl_engine *self = engine->self;
    if (!self)
        return;
    if (self->rtl)
        self->hardware.ops->close(self->rtl);
    fp3_hardware_unload(&self->hardware);
    fp3_driver_close(engine);
    fp3_in_flight_free(self->in_flight);
    free(self);
}

static fp3_status rtl_run(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    rtl_engine *self = engine->self;
    self->executed = 0;
    return fp3_session_run(engine, steps, stats);
}

const fp3_backend fp3_backend_rtl = {
    .is = {"rtl", .is_hardware = 1, .is_simulated = 1},
    .check = fp3_store_lists_check,
    .open = rtl_open,
    .close = rtl_close,
    .load = fp3_memory_load,
    .read = fp3_memory_read,
    .write = fp3_memory_write,
    .list = fp3_memory_list,
    .run = rtl_run,
    .begins_at_0 = 1,
};
