/* different_programs.c - each scheduler of an array its own program, all at the same time.
 *
 *     different_programs [SEED [ROUNDS]]
 *
 * Over the raw host port: every scheduler of every configuration that has more than one gets a
 * random program, constants and objects of its own, another number of steps, another visit. They
 * start together or one after the other. Records, status words, flags and counters of each are then
 * those of the isa engine, which ran that program alone. Also listed are objects that sleep: their
 * visit must do nothing.
 */
#include "engine/common/inside.h"
#include "stream.h"

#include "gen/registers.h"
#include <engine/board/hardware.h>
#include <inttypes.h>
#include <stdlib.h>

enum { SCHEDULERS_MAX = 64 };

/* What a scheduler gets, and its isa engine. */
typedef struct {
    stream s;
    fp3_engine *isa;
    uint32_t clock;
    uint32_t objects, steps;
    fp3_stats stats;
} scheduler;

typedef struct {
    const fp3_rtl_ops *ops;
    const fp3_config *config;
    fp3_rtl *rtl;
    chance c;
    uint32_t log2, words;
    scheduler schedulers[SCHEDULERS_MAX];
    fp3_error error;
    unsigned failed;
} bench;

static void fail(bench *b, const char *what, uint32_t at, uint32_t got, uint32_t expected) {
    if (b->failed++ < 10)
        printf("FAIL %s: %s 0x%08" PRIx32 ": got 0x%08" PRIx32 ", expected 0x%08" PRIx32 "\n",
               b->config->name, what, at, got, expected);
}

static void told(bench *b, fp3_status status) {
    if (!status)
        return;
    printf("%s\n", b->error.text);
    exit(1);
}

static void put(bench *b, uint32_t address, uint32_t data) {
    const int answer = fp3_rtl_transfer_one(b->ops, b->rtl, 1, address, &data);
    if (answer)
        fail(b, "a write at", address, (uint32_t)answer, 0);
}

static uint32_t get(bench *b, uint32_t address) {
    uint32_t data = 0;
    const int answer = fp3_rtl_transfer_one(b->ops, b->rtl, 0, address, &data);
    if (answer)
        fail(b, "a read at", address, (uint32_t)answer, 0);
    return data;
}

static void want(bench *b, const char *what, uint32_t address, uint32_t expected) {
    const uint32_t got = get(b, address);
    if (got != expected)
        fail(b, what, address, got, expected);
}

static uint32_t of_scheduler(const bench *b, uint32_t u, uint32_t address) {
    return FP3_ADDRESS_OF(b->config->space_bit, u, address);
}

/* A scheduler's objects go round its own lanes. */
static uint32_t row_of(const bench *b, uint32_t object) { return object / b->config->lanes; }
static uint32_t lane_of(const bench *b, uint32_t object) { return object % b->config->lanes; }

static uint32_t in_space(const bench *b, uint32_t u, uint32_t space, uint32_t word) {
    return of_scheduler(b, u, FP3_ADDRESS_IN(b->config->space_bit, space, word));
}

static uint32_t cell(const bench *b, uint32_t u, uint32_t object, uint32_t reg) {
    return in_space(b, u, FP3_SPACE_OBJECTS,
                    lane_of(b, object) * b->config->store_words + (row_of(b, object) << b->log2) +
                        reg);
}

static uint32_t status_of(const bench *b, uint32_t u, uint32_t object) {
    return in_space(b, u, FP3_SPACE_STATUS,
                    lane_of(b, object) * b->config->store_words + row_of(b, object));
}

/* ---- what a scheduler gets ---- */

static void open_isa(bench *b, scheduler *one) {
    fp3_engine_def def = fp3_engine_default();
    def.engine = "isa";
    def.config = b->config->name;
    def.objects = one->objects;
    def.visit = below(&b->c, 4);
    def.error = &b->error;
    const fp3_image image = stream_image(&one->s);
    told(b, fp3_engine_open(&def, &one->isa));
    told(b, fp3_engine_load_unchecked(one->isa, &image));
    one->clock = below(&b->c, 2) ? (uint32_t)next64(&b->c) : 0;
    *fp3_engine_clock(one->isa) = one->clock;
}

static void write_program(bench *b, uint32_t u) {
    fp3_engine *isa = b->schedulers[u].isa;
    const fp3_code *p = &fp3_engine_layout(isa)->groups[0].program;
    for (uint32_t i = 0; i < p->count; i++)
        put(b, of_scheduler(b, u, FP3_ADDR_WINDOW_PROGRAM + 4 * i), p->code[i]);
    put(b, of_scheduler(b, u, FP3_ADDR_STEP), p->step);
    put(b, of_scheduler(b, u, FP3_ADDR_LAST), p->last);
    put(b, of_scheduler(b, u, FP3_ADDR_SIZE), p->count);
    put(b, of_scheduler(b, u, FP3_ADDR_RECORD), b->log2);
    put(b, of_scheduler(b, u, FP3_ADDR_STEPS), b->schedulers[u].steps);
    put(b, of_scheduler(b, u, FP3_ADDR_VISIT), fp3_engine_definition(isa)->visit);
    put(b, of_scheduler(b, u, FP3_ADDR_CLOCK), b->schedulers[u].clock);
}

static void write_values(bench *b, uint32_t u) {
    scheduler *one = &b->schedulers[u];
    fp3_engine *isa = one->isa;
    for (uint32_t i = 0; i < b->config->registers; i++) {
        const uint32_t bits = value(&b->c);
        told(b, fp3_engine_write_shared_words(isa, 0, i, 1, &bits));
        put(b, of_scheduler(b, u, FP3_ADDR_WINDOW_CONSTANTS + 4 * i), bits);
    }
    for (uint32_t object = 0; object < one->objects; object++) {
        for (uint32_t reg = 0; reg < one->s.pool; reg++) {
            const int is_slept = (int)reg == one->s.slept;
            const uint32_t bits = is_slept && below(&b->c, 4) ? 0 : value(&b->c);
            told(b, fp3_engine_write_words(isa, object, 1, reg, &bits));
            put(b, cell(b, u, object, reg), bits);
        }
        if (b->config->status)
            put(b, status_of(b, u, object), 0);
    }
}

/* All objects, from the last to the first. */
static void write_lists(bench *b, uint32_t u) {
    const scheduler *one = &b->schedulers[u];
    const uint32_t lanes = b->config->lanes;
    for (uint32_t lane = 0; lane < lanes; lane++)
        put(b, of_scheduler(b, u, FP3_ADDR_WINDOW_AWAKE + 4 * lane),
            b->config->sleep ? 0 : (one->objects + lanes - 1 - lane) / lanes);
    for (uint32_t i = one->objects; b->config->sleep && i-- > 0;)
        put(b, of_scheduler(b, u, FP3_ADDR_WINDOW_WAKE + 4 * lane_of(b, i)), row_of(b, i));
}

static void prepare(bench *b, uint32_t u) {
    scheduler *one = &b->schedulers[u];
    const uint32_t room = (b->config->store_words >> b->log2) * b->config->lanes;
    const uint32_t most = 2 * b->config->contexts * b->config->lanes;
    do
        make_stream(&b->c, &one->s, b->config, b->words);
    while (one->s.illegal != NOWHERE);
    one->objects = 1 + below(&b->c, room < most ? room : most);
    one->steps = 1 + below(&b->c, 5);
    open_isa(b, one);
    write_program(b, u);
    write_values(b, u);
    write_lists(b, u);
}

/* ---- what comes of it ---- */

static void run(bench *b, uint32_t schedulers) {
    const uint32_t all = of_scheduler(b, fp3_config_broadcast(b->config), 0);
    const uint32_t start = 1u << FP3_CONTROL_START_LO;
    if (below(&b->c, 2))
        put(b, all | FP3_ADDR_CONTROL, start);
    else
        for (uint32_t u = 0; u < schedulers; u++) {
            put(b, of_scheduler(b, u, FP3_ADDR_CONTROL), start);
            b->ops->clock(b->rtl, below(&b->c, 100), 100);
        }
    for (int i = 0; i < 1000 && get(b, all | FP3_ADDR_STATUS) & 1u << FP3_STATUS_RUNNING_LO; i++)
        b->ops->clock(b->rtl, 100000, 64);
}

static void compare(bench *b, uint32_t u) {
    scheduler *one = &b->schedulers[u];
    fp3_engine *isa = one->isa;
    if (fp3_engine_run(isa, one->steps, &one->stats))
        fail(b, "the isa engine's end of scheduler", u, 1, 0);
    want(b, "status", of_scheduler(b, u, FP3_ADDR_STATUS), 1u << FP3_STATUS_DONE_LO);
    want(b, "flags", of_scheduler(b, u, FP3_ADDR_FLAGS), one->stats.flags);
    for (uint32_t object = 0; object < one->objects; object++) {
        fp3_object_status status;
        for (uint32_t reg = 0; reg < one->s.pool; reg++) {
            uint32_t bits = 0;
            told(b, fp3_engine_read_words(isa, object, 1, reg, &bits));
            want(b, "a word of an object", cell(b, u, object, reg), bits);
        }
        told(b, fp3_engine_status(isa, object, 1, &status));
        if (b->config->status)
            want(b, "an object's status", status_of(b, u, object),
                 status.flags | status.failed << FP3_STATUS_STEP_LO);
    }
    /* Without sleep, lane 0 says what is issued. */
    const uint64_t rows = (one->objects + b->config->lanes - 1) / b->config->lanes;
    if (b->config->counters && fp3_engine_layout(isa)->groups[0].program.slept < 0) {
        const uint32_t paired = get(b, of_scheduler(b, u, FP3_ADDR_COUNTER_PAIRED));
        want(b, "counter retired", of_scheduler(b, u, FP3_ADDR_COUNTER_RETIRED),
             (uint32_t)(one->stats.counter[FP3_COUNTER_RETIRED] / one->objects * rows) - paired);
    }
    fp3_engine_close(&one->isa);
}

/* So many as work the whole store of some, and leave it half empty in others. */
static unsigned check(const fp3_config *config, const fp3_rtl_ops *ops, uint64_t seed) {
    static bench b;
    b = (bench){.ops = ops, .config = config, .c = {.state = seed}};
    const uint32_t schedulers = fp3_config_schedulers(b.config);
    b.log2 = 3 + below(&b.c, 4);
    while (b.config->store_words >> b.log2 == 0)
        b.log2--;
    b.words = 1u << b.log2;
    b.rtl = ops->open(&(fp3_rtl_watch){0}, 0);
    if (!b.rtl)
        return 1;
    for (uint32_t u = 0; u < schedulers; u++)
        prepare(&b, u);
    run(&b, schedulers);
    for (uint32_t u = 0; u < schedulers; u++)
        compare(&b, u);
    ops->close(b.rtl);
    if (b.failed)
        printf("  seed %" PRIu64 "\n", seed);
    return b.failed;
}

int main(int argc, char **argv) {
    const uint64_t seed = argc > 1 ? strtoull(argv[1], NULL, 0) : 1;
    const uint64_t rounds = argc > 2 ? strtoull(argv[2], NULL, 0) : 25;
    unsigned failed = 0, checked = 0;
    for (uint32_t i = 0; i < fp3_config_count; i++) {
        const fp3_config *config = &fp3_configs[i];
        fp3_hardware hardware;
        fp3_error error;
        if (fp3_config_schedulers(config) == 1)
            continue;
        if (fp3_hardware_load(config->name, &hardware, &error)) {
            printf("%s\n", error.text);
            return 1;
        }
        for (uint64_t n = 0; n < rounds && !failed; n++, checked++)
            failed += check(config, hardware.ops, seed + n);
        fp3_hardware_unload(&hardware);
    }
    printf("%u rounds, %u failed\n", checked, failed);
    return failed != 0;
}
