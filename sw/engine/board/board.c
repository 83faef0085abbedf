/* SPDX-License-Identifier: Apache-2.0 */
/* board.c - the "board" engine: hardware behind a serial port, driven as driver.h says. */
#include "driver.h"
#include "identity.h"
#include "memory.h"
#include "read_ahead.h"
#include "session.h"
#include "store_lists.h"

#include "link.h"
#include "packet.h"
#include "port.h"

#include "gen/registers.h"
#include <stdlib.h>
#include <time.h>

/* Milliseconds from one question whether a run has ended to the next: 0, 1, 2, 4 and so on. */
#define LONGEST_PAUSE 128

_Static_assert(FP3_READ_AHEAD_WORDS <= FP3_PACKET_WORDS, "what is read ahead is one transfer");

typedef struct {
    fp3_driver driver; /* first: the calls of driver.h find it there */
    fp3_link *link;
    fp3_read_ahead *ahead;
    int is_clear; /* nothing of an earlier host is left in its memories */
} board_engine;

/* ---- the bus ---- */

static fp3_status transfer_line(fp3_engine *engine, int is_write, uint32_t address, uint32_t *data,
                                uint32_t count, uint32_t *refused) {
    const board_engine *self = engine->self;
    fp3_status status = fp3_link_transfer(self->link, is_write, address, data, count, refused);
    engine->bus.repeats = fp3_link_repeats(self->link);
    engine->bus.bytes = fp3_link_bytes(self->link);
    engine->bus.requests++;
    return status;
}

/* An fp3_read_ahead_read_fn. */
static fp3_status read_ahead(void *user, uint32_t address, uint32_t words[FP3_READ_AHEAD_WORDS],
                             uint32_t *count) {
    uint32_t refused = 0;
    fp3_status status = transfer_line(user, 0, address, words, FP3_READ_AHEAD_WORDS, &refused);
    *count = status ? 0 : refused ? refused - 1 : FP3_READ_AHEAD_WORDS;
    return status;
}

static fp3_status transfer(fp3_engine *engine, int is_write, const uint32_t *addresses,
                           uint32_t *data, uint32_t count, uint32_t *refused) {
    const board_engine *self = engine->self;
    const uint32_t address = addresses[0];
    if (is_write)
        fp3_read_ahead_forget(self->ahead, address, count);
    if (is_write || !fp3_read_ahead_has(engine->config->space_bit, address))
        return transfer_line(engine, is_write, address, data, count, refused);
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && !*refused && i < count; i++) {
        int is_there = 0;
        status = fp3_read_ahead_get(self->ahead, address + 4 * i, &data[i], &is_there);
        *refused = !status && !is_there ? i + 1 : 0;
    }
    return status;
}

static uint64_t now(const fp3_engine *engine) {
    (void)engine;
    return 0;
}

/* By the instructions that the first scheduler has ended, as if all others were as far. */
static fp3_status tell(fp3_engine *engine) {
    uint32_t low = 0, high = 0;
    fp3_status status = fp3_driver_peek(engine, FP3_ADDR_COUNTER_RETIRED, &low);
    if (!status)
        status = fp3_driver_peek(engine, FP3_ADDR_COUNTER_RETIRED + 4, &high);
    const uint64_t retired = (uint64_t)high << 32 | low;
    if (!status)
        fp3_engine_tell(engine,
                        retired * engine->config->lanes * fp3_config_schedulers(engine->config));
    return status;
}

static fp3_status rest(fp3_engine *engine, uint64_t cycles, uint32_t asked) {
    const long longest = LONGEST_PAUSE;
    const long pause = !asked ? 0 : asked > 7 ? longest : 1L << (asked - 1);
    (void)cycles;
    nanosleep(&(struct timespec){.tv_nsec = pause * 1000000}, NULL);
    const int tells = pause == longest && engine->def.progress && engine->config->counters;
    return tells ? tell(engine) : FP3_OK;
}

static const fp3_bus bus = {FP3_PACKET_WORDS, 0, transfer, now, rest, NULL};

/* ---- the engine ---- */

static fp3_status check_def(const fp3_engine_def *def) {
    if (!def->port)
        return fp3_fail(def->error, FP3_E_ARGUMENT,
                        "engine 'board' needs a port: the name of a serial port, or that of the "
                        "pseudo-terminal that fp3 board prints");
    if (def->retire || def->trace)
        return fp3_fail(def->error, FP3_E_ARGUMENT,
                        "engine 'board' tells no retirements and no instructions; rtl does");
    if (def->cycle_limit)
        return fp3_fail(def->error, FP3_E_ARGUMENT,
                        "engine 'board' has no cycle limit: a serial line is too slow to stop a "
                        "run at a cycle");
    return FP3_OK;
}

static uint32_t baud_of(uint32_t baud) { return baud ? baud : FP3_PORT_BAUD; }

/* What an earlier host left running would refuse every access to memories. */
static fp3_status stop_what_runs(fp3_engine *engine) {
    uint32_t word = 0;
    fp3_status status = fp3_driver_peek(engine, fp3_driver_of_all(engine, FP3_ADDR_STATUS), &word);
    return status || !(word >> FP3_STATUS_RUNNING_LO & 1) ? status : fp3_session_stop(engine);
}

static fp3_status board_open(fp3_engine *engine) {
    const fp3_engine_def *def = &engine->def;
    board_engine *self = engine->self = calloc(1, sizeof *self);
    fp3_status status = check_def(def);
    if (status)
        return status;
    if (!self ||
        !(self->ahead = fp3_read_ahead_make(engine->config->space_bit, read_ahead, engine)))
        return fp3_no_memory(def->error);
    self->driver.bus = &bus;
    status = fp3_link_open(def->port, baud_of(def->baud), &self->link, def->error);
    if (!status)
        status = fp3_driver_open(engine);
    return status ? status : stop_what_runs(engine);
}

/* A reset keeps memories, and a host that begins does not even reset. */
static fp3_status board_load(fp3_engine *engine) {
    board_engine *self = engine->self;
    fp3_status status = fp3_memory_load(engine);
    if (!status && !self->is_clear)
        status = fp3_memory_clear(engine);
    self->is_clear = !status;
    return status;
}

static void board_close(fp3_engine *engine) {
    board_engine *self = engine->self;
    if (!self)
        return;
    fp3_link_close(&self->link);
    fp3_read_ahead_free(self->ahead);
    fp3_driver_close(engine);
    free(self);
}

fp3_status fp3_engine_find(const char *port, uint32_t baud, const char **config, fp3_error *error) {
    uint32_t words[FP3_IDENTITY_WORDS] = {0}, refused = 0;
    fp3_link *link = NULL;
    fp3_status status = fp3_link_open(port, baud_of(baud), &link, error);
    for (int i = 0; !status && i < FP3_IDENTITY_WORDS; i++)
        if (fp3_identity_has(words, i))
            status = fp3_link_transfer(link, 0, fp3_identity_addresses[i], &words[i], 1, &refused);
    fp3_link_close(&link);
    if (!status)
        status = fp3_identity_check_id(words[0], error);
    if (status)
        return status;
    const fp3_config *found = fp3_identity_find(words);
    if (!found)
        return fp3_fail(error, FP3_E_SYSTEM,
                        "port %s: the hardware is none of this libfp3's configurations", port);
    *config = found->name;
    return FP3_OK;
}

const fp3_backend fp3_backend_board = {
    .is = {"board", .is_hardware = 1, .has_port = 1},
    .check = fp3_store_lists_check,
    .open = board_open,
    .close = board_close,
    .load = board_load,
    .read = fp3_memory_read,
    .write = fp3_memory_write,
    .list = fp3_memory_list,
    .run = fp3_session_run,
    .begins_at_0 = 1,
};
