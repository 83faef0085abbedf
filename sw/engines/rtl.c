/* rtl.c - the "rtl" engine: drives a simulated FP3 through its host port, as any host would.
 *
 * What it tells the hardware and what it learns goes over the port: the cycles are the hardware's
 * own count. Retirements alone are watched from outside.
 */
#include "kind.h"

#include "fp3_rtl.h"

#include <configs.h>
#include <errno.h>
#include <inttypes.h>
#include <isa.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define X(name, ...) extern const fp3_rtl_ops fp3_rtl_##name;
FP3_CONFIGS(X)
#undef X

/* Nothing retires for so long: time to ask whether the run has ended. Asking early costs the
 * simulation some cycles, the hardware none; it may be wrong about a long stall. */
#define QUIET_CYCLES 32
#define STOP_CYCLES 10000 /* from control.stop to the end of a run */

typedef struct {
    const fp3_rtl_ops *ops;
    fp3_rtl *rtl;
    FILE *log;
    uint64_t hash; /* FNV-1a of all retirements: the log ends each run with it */
} rtl_engine;

#define BIT(field) (1u << FP3_##field##_LO)
#define FIELD(word, field)                                                                         \
    (((word) >> FP3_##field##_LO) & ((2u << (FP3_##field##_HI - FP3_##field##_LO)) - 1))

static fp3_status transfer(fp3_engine *engine, int is_write, uint32_t address, uint32_t *data) {
    rtl_engine *self = engine->self;
    const int result = self->ops->transfer(self->rtl, is_write, address, data);
    if (result == 0)
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_SYSTEM, "the hardware %s %s at 0x%04" PRIx32,
                    result > 0 ? "refused" : "did not answer", is_write ? "a write" : "a read",
                    address);
}

static fp3_status put(fp3_engine *engine, uint32_t address, uint32_t data) {
    rtl_engine *self = engine->self;
    if (self->log)
        fprintf(self->log, "w %04" PRIx32 " %08" PRIx32 "\n", address, data);
    return transfer(engine, 1, address, &data);
}

static fp3_status get(fp3_engine *engine, uint32_t address, uint32_t *data) {
    rtl_engine *self = engine->self;
    fp3_status status = transfer(engine, 0, address, data);
    if (!status && self->log)
        fprintf(self->log, "r %04" PRIx32 " %08" PRIx32 "\n", address, *data);
    return status;
}

static uint64_t fnv(uint64_t hash, uint32_t word) {
    for (int i = 0; i < 4; i++)
        hash = (hash ^ (word >> 8 * i & 0xff)) * 0x100000001b3u;
    return hash;
}

/* While a log is kept: between the hardware and whom the caller named. */
static void hash_retirement(void *user, const fp3_retirement *retirement) {
    const fp3_engine *engine = user;
    rtl_engine *self = engine->self;
    self->hash = fnv(fnv(fnv(self->hash, retirement->reg), retirement->bits), retirement->flags);
    if (engine->def.retire)
        engine->def.retire(engine->def.retire_user, retirement);
}

/* Whether the hardware is what the configuration says it is. */
static fp3_status check_build(fp3_engine *engine) {
    const fp3_config *config = engine->config;
    uint32_t id, shape, memory, features;
    fp3_status status = FP3_OK;
    if ((status = get(engine, FP3_ADDR_ID, &id)) ||
        (status = get(engine, FP3_ADDR_SHAPE, &shape)) ||
        (status = get(engine, FP3_ADDR_MEMORY, &memory)) ||
        (status = get(engine, FP3_ADDR_FEATURES, &features)))
        return status;
    if (id != (0x46503300u | FP3_ISA_REVISION))
        return fp3_fail(engine->def.error, FP3_E_SYSTEM,
                        "the hardware's id is 0x%08" PRIx32 ", wanted 0x%08x", id,
                        0x46503300u | FP3_ISA_REVISION);
    if (FIELD(shape, SHAPE_REGISTERS) != config->registers ||
        FIELD(shape, SHAPE_CONSTANTS) != config->registers ||
        FIELD(shape, SHAPE_CONTEXTS) != config->contexts || memory != config->program_words ||
        FIELD(features, FEATURES_CHAIN) != (uint32_t)config->chain ||
        FIELD(features, FEATURES_SUBNORMAL) != (uint32_t)config->subnormal ||
        FIELD(features, FEATURES_NEAREST) != (uint32_t)config->nearest)
        return fp3_fail(engine->def.error, FP3_E_SYSTEM,
                        "the hardware is not configuration '%s': shape 0x%08" PRIx32
                        ", memory %" PRIu32 ", features 0x%08" PRIx32,
                        config->name, shape, memory, features);
    return FP3_OK;
}

static fp3_status rtl_open(fp3_engine *engine) {
    static const fp3_rtl_ops *const builds[] = {
#define X(name, ...) &fp3_rtl_##name,
        FP3_CONFIGS(X)
#undef X
    };
    rtl_engine *self = engine->self = calloc(1, sizeof *self);
    if (!self)
        return fp3_fail(engine->def.error, FP3_E_SYSTEM, "out of memory");
    for (size_t i = 0; i < sizeof builds / sizeof *builds; i++)
        if (strcmp(builds[i]->config, engine->config->name) == 0)
            self->ops = builds[i];
    self->hash = 0xcbf29ce484222325u;
    self->rtl = engine->def.bus_log ? self->ops->open(hash_retirement, engine)
                                    : self->ops->open(engine->def.retire, engine->def.retire_user);
    if (!self->rtl)
        return fp3_fail(engine->def.error, FP3_E_SYSTEM, "out of memory");
    if (engine->def.bus_log && !(self->log = fopen(engine->def.bus_log, "w")))
        return fp3_fail(engine->def.error, FP3_E_SYSTEM, "%s: %s", engine->def.bus_log,
                        strerror(errno));
    return check_build(engine);
}

static void rtl_close(fp3_engine *engine) {
    rtl_engine *self = engine->self;
    if (self && self->rtl)
        self->ops->close(self->rtl);
    if (self && self->log)
        fclose(self->log);
    free(self);
}

static fp3_status rtl_load(fp3_engine *engine, const fp3_image *image) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < image->code_count; i++)
        status = put(engine, FP3_ADDR_WINDOW_PROGRAM + 4 * i, image->code[i]);
    if (!status)
        status = put(engine, FP3_ADDR_STEP, image->step);
    if (!status)
        status = put(engine, FP3_ADDR_LAST, image->last);
    if (!status)
        status = put(engine, FP3_ADDR_SIZE, image->code_count);
    return status;
}

static uint32_t object_address(size_t object, uint32_t reg) {
    return FP3_ADDR_WINDOW_OBJECTS + 256 * (uint32_t)object + 4 * reg;
}

static fp3_status rtl_write(fp3_engine *engine, size_t object, uint32_t reg, uint32_t bits) {
    return put(engine, object_address(object, reg), bits);
}

static fp3_status rtl_read(fp3_engine *engine, size_t object, uint32_t reg, uint32_t *bits) {
    return get(engine, object_address(object, reg), bits);
}

static fp3_status rtl_write_shared(fp3_engine *engine, uint32_t index, uint32_t bits) {
    return put(engine, FP3_ADDR_WINDOW_CONSTANTS + 4 * index, bits);
}

static fp3_status rtl_read_shared(fp3_engine *engine, uint32_t index, uint32_t *bits) {
    return get(engine, FP3_ADDR_WINDOW_CONSTANTS + 4 * index, bits);
}

/* Clocks until the run has ended, for so many cycles at most; *outcome is the status word. */
static fp3_status wait_until_idle(fp3_engine *engine, uint64_t cycles, uint32_t *outcome) {
    rtl_engine *self = engine->self;
    fp3_status status;
    for (uint64_t clocked = 0;;) {
        clocked += self->ops->clock(self->rtl, cycles - clocked, QUIET_CYCLES);
        status = transfer(engine, 0, FP3_ADDR_STATUS, outcome);
        if (status || !FIELD(*outcome, STATUS_RUNNING) || clocked >= cycles)
            return status;
    }
}

static fp3_status read_counters(fp3_engine *engine, fp3_stats *stats) {
    static const uint32_t addresses[] = {
#define X(NAME, name, address) address,
        FP3_COUNTERS(X)
#undef X
    };
    for (int i = 0; i < FP3_COUNTER_COUNT; i++) {
        uint32_t low = 0, high = 0;
        fp3_status status = get(engine, addresses[i], &low);
        if (!status)
            status = get(engine, addresses[i] + 4, &high);
        if (status)
            return status;
        stats->counter[i] = (uint64_t)high << 32 | low;
    }
    return get(engine, FP3_ADDR_FLAGS, &stats->flags);
}

/* docs/registers.md: every running cycle is an issue or a stall; all that was issued retires. */
static fp3_status check_counters(fp3_engine *engine, const fp3_stats *stats) {
    const uint64_t *n = stats->counter;
    const uint64_t issued =
        n[FP3_COUNTER_ISSUED_ADD] + n[FP3_COUNTER_ISSUED_MUL] + n[FP3_COUNTER_ISSUED_CHAIN];
    uint64_t stalled = 0;
    for (int i = 0; i < FP3_COUNTER_COUNT; i++)
        stalled += fp3_counter_is_stall((fp3_counter)i) ? n[i] : 0;
    if (n[FP3_COUNTER_CYCLES] == issued + stalled && n[FP3_COUNTER_RETIRED] == issued)
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_SYSTEM,
                    "the hardware's counters do not add up: %" PRIu64 " cycles, %" PRIu64
                    " issued, %" PRIu64 " stalled, %" PRIu64 " retired",
                    n[FP3_COUNTER_CYCLES], issued, stalled, n[FP3_COUNTER_RETIRED]);
}

static fp3_status close_log_of_run(fp3_engine *engine) {
    rtl_engine *self = engine->self;
    if (!self->log)
        return FP3_OK;
    fprintf(self->log, "h %08" PRIx64 " %08" PRIx64 "\n", self->hash >> 32,
            self->hash & UINT32_MAX);
    if (fflush(self->log) == 0)
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_SYSTEM, "%s: %s", engine->def.bus_log,
                    strerror(errno));
}

static fp3_status rtl_run(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    rtl_engine *self = engine->self;
    const uint64_t limit = engine->def.cycle_limit ? engine->def.cycle_limit : UINT64_MAX;
    uint32_t outcome = 0, fault = 0;
    fp3_status status = put(engine, FP3_ADDR_STEPS, steps);
    if (!status)
        status = put(engine, FP3_ADDR_CONTROL, BIT(CONTROL_START));
    if (!status)
        status = wait_until_idle(engine, limit, &outcome);
    if (!status && FIELD(outcome, STATUS_RUNNING)) {
        status = put(engine, FP3_ADDR_CONTROL, BIT(CONTROL_STOP));
        if (!status)
            status = wait_until_idle(engine, STOP_CYCLES, &outcome);
        if (!status && FIELD(outcome, STATUS_RUNNING))
            return fp3_fail(engine->def.error, FP3_E_SYSTEM, "the hardware does not stop");
    }
    if (self->log)
        fprintf(self->log, "p %04x %08x\n", FP3_ADDR_STATUS, BIT(STATUS_RUNNING));
    if (status || (status = get(engine, FP3_ADDR_STATUS, &outcome)) ||
        (status = get(engine, FP3_ADDR_FAULT, &fault)) || (status = read_counters(engine, stats)) ||
        (status = check_counters(engine, stats)) || (status = close_log_of_run(engine)))
        return status;
    if (FIELD(outcome, STATUS_DONE))
        return FP3_OK;
    if (FIELD(outcome, STATUS_STOPPED))
        return fp3_engine_limit(engine);
    if (FIELD(outcome, STATUS_ILLEGAL) && fault < engine->image->code_count)
        return fp3_engine_illegal(engine, fault, engine->image->code[fault]);
    return fp3_fail(engine->def.error, FP3_E_SYSTEM,
                    "a run ended with status 0x%08" PRIx32 ", fault %" PRIu32, outcome, fault);
}

const fp3_engine_kind fp3_kind_rtl = {
    .name = "rtl",
    .open = rtl_open,
    .close = rtl_close,
    .load = rtl_load,
    .write = rtl_write,
    .read = rtl_read,
    .write_shared = rtl_write_shared,
    .read_shared = rtl_read_shared,
    .run = rtl_run,
};
