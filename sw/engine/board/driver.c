/* SPDX-License-Identifier: Apache-2.0 */
/* driver.c - see driver.h. */
#include "driver.h"

#include "base/path.h"
#include "identity.h"
#include "read_ahead.h"

#include "gen/registers.h"
#include <inttypes.h>
#include <stdlib.h>

uint32_t fp3_driver_of(const fp3_engine *engine, uint32_t scheduler, uint32_t address) {
    return FP3_ADDRESS_OF(engine->config->space_bit, scheduler, address);
}

uint32_t fp3_driver_of_all(const fp3_engine *engine, uint32_t address) {
    return fp3_driver_of(engine, fp3_config_broadcast(engine->config), address);
}

static fp3_status transfer(fp3_engine *engine, int is_write, const uint32_t *addresses,
                           uint32_t *data, uint32_t count) {
    const fp3_driver *self = engine->self;
    const uint64_t begin = self->bus->now(engine);
    uint32_t refused = 0;
    fp3_status status = self->bus->transfer(engine, is_write, addresses, data, count, &refused);
    engine->bus.transfers += refused ? refused : count;
    engine->bus.cycles += self->bus->now(engine) - begin;
    if (status || !refused)
        return status;
    return fp3_fail(engine->def.error, FP3_E_SYSTEM, "the hardware refused a %s at 0x%08" PRIx32,
                    is_write ? "write" : "read", addresses[refused - 1]);
}

/* How many of count words the bus moves at once, from the first on. */
static uint32_t at_once(const fp3_bus *bus, const uint32_t *addresses, uint32_t count) {
    uint32_t n = 1;
    while (n < count && n < bus->words &&
           (bus->is_anywhere || addresses[n] == addresses[n - 1] + 4))
        n++;
    return n;
}

static fp3_status transfer_all(fp3_engine *engine, int is_write, const uint32_t *addresses,
                               uint32_t *data, uint32_t count) {
    const fp3_driver *self = engine->self;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0, now; !status && i < count; i += now) {
        now = at_once(self->bus, addresses + i, count - i);
        status = transfer(engine, is_write, addresses + i, data + i, now);
    }
    return status;
}

static int by_key(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static void sort(uint32_t *where, uint32_t *what, uint32_t count) {
    uint64_t keys[FP3_QUEUE_WORDS];
    uint32_t old[FP3_QUEUE_WORDS];
    if (count < 2)
        return;
    for (uint32_t i = 0; i < count; i++) {
        keys[i] = (uint64_t)where[i] << 32 | i;
        old[i] = what[i];
    }
    qsort(keys, count, sizeof *keys, by_key);
    for (uint32_t i = 0; i < count; i++) {
        where[i] = (uint32_t)(keys[i] >> 32);
        what[i] = old[(uint32_t)keys[i]];
    }
}

/* Columns of objects come register by register, and a bus that moves neighbours at once wants them
 * object by object. Of words that are nothing but memory only the order at one address counts. */
static void arrange(fp3_driver *self, uint32_t space_bit) {
    for (uint32_t i = 0, n; !self->bus->is_anywhere && i < self->queued; i += n + 1) {
        for (n = 0; i + n < self->queued && fp3_read_ahead_has(space_bit, self->where[i + n]);)
            n++;
        sort(&self->where[i], &self->what[i], n);
    }
}

fp3_status fp3_driver_flush(fp3_engine *engine) {
    fp3_driver *self = engine->self;
    const uint32_t count = self->queued;
    arrange(self, engine->config->space_bit);
    self->queued = 0;
    return transfer_all(engine, 1, self->where, self->what, count);
}

fp3_status fp3_driver_note(fp3_engine *engine, char kind, uint32_t x, uint32_t y) {
    fp3_driver *self = engine->self;
    if (!self->log)
        return FP3_OK;
    self->lines++;
    return fprintf(self->log, "%c %08" PRIx32 " %08" PRIx32 "\n", kind, x, y) > 0
               ? FP3_OK
               : fp3_path_fail(engine->def.error, engine->def.bus_log, "cannot write");
}

fp3_status fp3_driver_save_log(fp3_engine *engine) {
    const fp3_driver *self = engine->self;
    return !self->log || !fflush(self->log)
               ? FP3_OK
               : fp3_path_fail(engine->def.error, engine->def.bus_log, "cannot write");
}

fp3_status fp3_driver_put(fp3_engine *engine, uint32_t address, uint32_t data) {
    fp3_driver *self = engine->self;
    const fp3_status status = fp3_driver_note(engine, 'w', address, data);
    if (status)
        return status;
    self->where[self->queued] = address;
    self->what[self->queued++] = data;
    return self->queued == FP3_QUEUE_WORDS ? fp3_driver_flush(engine) : FP3_OK;
}

static fp3_status read_words(fp3_engine *engine, const uint32_t *addresses, uint32_t *data,
                             uint32_t count) {
    fp3_status status = fp3_driver_flush(engine);
    return status ? status : transfer_all(engine, 0, addresses, data, count);
}

fp3_status fp3_driver_get_all(fp3_engine *engine, const uint32_t *addresses, uint32_t *data,
                              uint32_t count) {
    fp3_status status = read_words(engine, addresses, data, count);
    for (uint32_t i = 0; !status && i < count; i++)
        status = fp3_driver_note(engine, 'r', addresses[i], data[i]);
    return status;
}

fp3_status fp3_driver_get(fp3_engine *engine, uint32_t address, uint32_t *data) {
    return fp3_driver_get_all(engine, &address, data, 1);
}

fp3_status fp3_driver_peek(fp3_engine *engine, uint32_t address, uint32_t *data) {
    return read_words(engine, &address, data, 1);
}

fp3_status fp3_driver_open(fp3_engine *engine) {
    fp3_driver *self = engine->self;
    uint32_t words[FP3_IDENTITY_WORDS] = {0};
    fp3_status status = FP3_OK;
    if (engine->def.bus_log)
        status = fp3_output_open(engine->def.bus_log, &self->output, engine->def.error);
    if (!status && self->output)
        self->log = fp3_output_stream(self->output);
    for (int i = 0; !status && i < FP3_IDENTITY_WORDS; i++)
        if (fp3_identity_has(words, i))
            status = fp3_driver_get(engine, fp3_identity_addresses[i], &words[i]);
    return status ? status : fp3_identity_check(engine->config, words, engine->def.error);
}

void fp3_driver_close(fp3_engine *engine) {
    fp3_driver *self = engine->self;
    fp3_driver_note(engine, 'e', self->lines, 0); /* without it the log is refused */
    fp3_output_close(&self->output);
}
