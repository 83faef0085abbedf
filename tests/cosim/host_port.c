/* host_port.c - the host port answers every request, and refuses nonsense without a change.
 *
 *     host_port
 *
 * Every address, read and written, idle and running, on each configuration; expected is what
 * isa/registers.toml says, written once more by hand.
 */
#include <configs.h>
#include <fp3_rtl.h>
#include <inttypes.h>
#include <isa.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define X(name, ...) extern const fp3_rtl_ops fp3_rtl_##name;
FP3_CONFIGS(X)
#undef X

typedef struct {
    const fp3_rtl_ops *ops;
    uint32_t registers, contexts, program_words;
} build;

typedef struct {
    const build *build;
    fp3_rtl *rtl;
    unsigned failed;
} bench;

static void fail(bench *b, const char *what, uint32_t address, int64_t got, int64_t expected) {
    if (b->failed++ < 10)
        printf("FAIL %s: %s, address 0x%04" PRIx32 ": got 0x%" PRIx64 ", expected 0x%" PRIx64 "\n",
               b->build->ops->config, what, address, (uint64_t)got, (uint64_t)expected);
}

/* -1, 0 or 1: see fp3_rtl.h. */
static int put(bench *b, uint32_t address, uint32_t data) {
    return b->build->ops->transfer(b->rtl, 1, address, &data);
}

static uint32_t get(bench *b, uint32_t address) {
    uint32_t data = 0;
    const int answer = b->build->ops->transfer(b->rtl, 0, address, &data);
    if (answer)
        fail(b, "a read", address, answer, 0);
    return data;
}

static void want(bench *b, const char *what, uint32_t address, uint32_t expected) {
    const uint32_t got = get(b, address);
    if (got != expected)
        fail(b, what, address, got, expected);
}

enum { READ = 1, WRITE = 2, IDLE_ONLY = 4, IDLE_WRITE = 8 };

/* What may be done with an address, and when. */
static int access_to(const build *of, uint32_t address) {
    static const struct {
        uint32_t address;
        int access;
    } registers[] = {{FP3_ADDR_ID, READ},
                     {FP3_ADDR_SHAPE, READ},
                     {FP3_ADDR_MEMORY, READ},
                     {FP3_ADDR_FEATURES, READ},
                     {FP3_ADDR_CONTROL, WRITE},
                     {FP3_ADDR_STATUS, READ},
                     {FP3_ADDR_FAULT, READ},
                     {FP3_ADDR_FLAGS, READ},
                     {FP3_ADDR_STEPS, READ | WRITE | IDLE_WRITE},
                     {FP3_ADDR_STEP, READ | WRITE | IDLE_WRITE},
                     {FP3_ADDR_LAST, READ | WRITE | IDLE_WRITE},
                     {FP3_ADDR_SIZE, READ | WRITE | IDLE_WRITE},
#define X(NAME, name, address) {address, READ}, {(address) + 4, READ},
                     FP3_COUNTERS(X)
#undef X
    };
    if (address % 4)
        return 0;
    for (size_t i = 0; i < sizeof registers / sizeof *registers; i++)
        if (registers[i].address == address)
            return registers[i].access;
    if (address >= FP3_ADDR_WINDOW_OBJECTS && address < 0x8000) {
        const uint32_t object = (address - FP3_ADDR_WINDOW_OBJECTS) / 256, reg = address % 256 / 4;
        return object < of->contexts && reg < of->registers ? READ | WRITE | IDLE_ONLY : 0;
    }
    if (address >= FP3_ADDR_WINDOW_CONSTANTS)
        return address < FP3_ADDR_WINDOW_CONSTANTS + 4 * of->registers ? READ | WRITE | IDLE_ONLY
                                                                       : 0;
    if (address >= FP3_ADDR_WINDOW_PROGRAM)
        return address < FP3_ADDR_WINDOW_PROGRAM + 4 * of->program_words ? WRITE | IDLE_ONLY : 0;
    return 0;
}

/* 0 everywhere: a legal value for every register that can be written, and no command. */
static void sweep(bench *b, int is_running) {
    for (uint32_t address = 0; address < 0x10000; address++)
        for (int is_write = 0; is_write < 2; is_write++) {
            const int access = access_to(b->build, address);
            const int refused = !(access & (is_write ? WRITE : READ)) ||
                                (is_running && (access & IDLE_ONLY)) ||
                                (is_running && is_write && (access & IDLE_WRITE));
            uint32_t data = 0;
            const int answer = b->build->ops->transfer(b->rtl, is_write, address, &data);
            if (answer != refused)
                fail(b, is_write ? "a write" : "a read", address, answer, refused);
            if (refused && !is_write && data != 0)
                fail(b, "a refused read shows data", address, data, 0);
        }
}

/* Fills what can be read with marks, and looks for them. */
static uint32_t mark(uint32_t address) { return address * 0x9e3779b9u ^ 0x5a5a5a5au; }

static void memories_keep_words_apart(bench *b) {
    for (int is_check = 0; is_check < 2; is_check++)
        for (uint32_t address = FP3_ADDR_WINDOW_CONSTANTS; address < 0x8000; address += 4)
            if (access_to(b->build, address) & READ) {
                if (is_check)
                    want(b, "a word written before", address, mark(address));
                else
                    put(b, address, mark(address));
            }
}

/* One instruction, r0 = k0 + r1, as the whole step part. */
static void load(bench *b, uint32_t steps) {
    const uint32_t word = (uint32_t)FP3_OP_ADD << FP3_FIELD_OP_LO |
                          FP3_BANK_SHARED_BASE << FP3_FIELD_A_LO | 1u << FP3_FIELD_B_LO;
    const uint32_t writes[][2] = {
        {FP3_ADDR_WINDOW_PROGRAM, word}, {FP3_ADDR_STEP, 0}, {FP3_ADDR_LAST, 1}, {FP3_ADDR_SIZE, 1},
        {FP3_ADDR_STEPS, steps},
    };
    for (size_t i = 0; i < sizeof writes / sizeof *writes; i++)
        if (put(b, writes[i][0], writes[i][1]))
            fail(b, "a write of a program", writes[i][0], 1, 0);
}

static const uint32_t start = 1u << FP3_CONTROL_START_LO, stop = 1u << FP3_CONTROL_STOP_LO;

static void nonsense_does_not_start(bench *b) {
    const uint32_t size = b->build->program_words;
    const uint32_t shapes[][3] = {{0, 0, 1}, {1, 1, 1}, {2, 1, 2}, {0, 2, 1}, {0, 0, 0}};
    load(b, 1);
    if (put(b, FP3_ADDR_STEP, size + 1) != 1 || put(b, FP3_ADDR_LAST, 0xffffffffu) != 1 ||
        put(b, FP3_ADDR_SIZE, 0x80000001u) != 1)
        fail(b, "an index beyond the memory", FP3_ADDR_SIZE, 0, 1);
    want(b, "a refused write changes nothing:", FP3_ADDR_SIZE, 1);
    want(b, "a refused write changes nothing:", FP3_ADDR_LAST, 1);
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        put(b, FP3_ADDR_STEP, shapes[i][0]);
        put(b, FP3_ADDR_LAST, shapes[i][1]);
        put(b, FP3_ADDR_SIZE, shapes[i][2]);
        if (put(b, FP3_ADDR_CONTROL, start) != 1)
            fail(b, "a start without sense", (uint32_t)i, 0, 1);
    }
    load(b, 1);
    if (put(b, FP3_ADDR_CONTROL, start | stop) != 1)
        fail(b, "start and stop at once", FP3_ADDR_CONTROL, 0, 1);
    if (put(b, FP3_ADDR_CONTROL, stop) != 0)
        fail(b, "a stop of nothing", FP3_ADDR_CONTROL, 1, 0);
    want(b, "no run came of it: status", FP3_ADDR_STATUS, 0);
}

static void a_running_machine_guards_its_memories(bench *b) {
    const uint32_t running = 1u << FP3_STATUS_RUNNING_LO, stopped = 1u << FP3_STATUS_STOPPED_LO;
    load(b, 0xffffffffu);
    put(b, FP3_ADDR_WINDOW_CONSTANTS, mark(0));
    if (put(b, FP3_ADDR_CONTROL, start))
        fail(b, "a start", FP3_ADDR_CONTROL, 1, 0);
    sweep(b, 1);
    if (put(b, FP3_ADDR_CONTROL, start) != 1)
        fail(b, "a start while running", FP3_ADDR_CONTROL, 0, 1);
    want(b, "still running: status", FP3_ADDR_STATUS, running);
    if (put(b, FP3_ADDR_CONTROL, stop))
        fail(b, "a stop", FP3_ADDR_CONTROL, 1, 0);
    b->build->ops->clock(b->rtl, 10000, 100);
    want(b, "stopped: status", FP3_ADDR_STATUS, stopped);
    want(b, "untouched:", FP3_ADDR_WINDOW_CONSTANTS, mark(0));
    want(b, "untouched:", FP3_ADDR_STEPS, 0xffffffffu);
}

static void counters_are_0_before_the_first_run(bench *b) {
#define X(NAME, name, address)                                                                     \
    want(b, "counter " name, address, 0);                                                          \
    want(b, "counter " name ", high word", address + 4, 0);
    FP3_COUNTERS(X)
#undef X
}

static int one_bit(uint32_t word) { return word && !(word & (word - 1)); }

/* Whenever a host looks, a run either goes on or has one outcome; whether it comes to its end, meets
 * an illegal word, is stopped, or more than one of these at once. */
static void a_run_has_one_outcome(bench *b) {
    for (unsigned is_illegal = 0; is_illegal < 2; is_illegal++)
        for (unsigned is_stopped = 0; is_stopped < 2; is_stopped++)
            for (uint64_t when = 0; when < 60; when++) {
                load(b, 1);
                put(b, FP3_ADDR_WINDOW_PROGRAM + 4, 0);
                if (is_illegal)
                    put(b, FP3_ADDR_SIZE, 2);
                if (put(b, FP3_ADDR_CONTROL, start))
                    fail(b, "a start", FP3_ADDR_CONTROL, 1, 0);
                b->build->ops->clock(b->rtl, when, when + 1);
                if (is_stopped)
                    put(b, FP3_ADDR_CONTROL, stop);
                for (int i = 0; i < 2; i++) {
                    const uint32_t status = get(b, FP3_ADDR_STATUS);
                    if (!one_bit(status))
                        fail(b, "running or one outcome: status", FP3_ADDR_STATUS, status,
                             1u << FP3_STATUS_RUNNING_LO);
                    b->build->ops->clock(b->rtl, 10000, 100);
                }
            }
}

int main(void) {
    static const build builds[] = {
#define X(name, doc, registers, contexts, program_words, ...)                                      \
    {&fp3_rtl_##name, registers, contexts, program_words},
        FP3_CONFIGS(X)
#undef X
    };
    unsigned failed = 0;
    for (size_t i = 0; i < sizeof builds / sizeof *builds; i++) {
        bench b = {.build = &builds[i], .rtl = builds[i].ops->open(NULL, NULL)};
        if (!b.rtl)
            return 1;
        counters_are_0_before_the_first_run(&b);
        sweep(&b, 0);
        memories_keep_words_apart(&b);
        nonsense_does_not_start(&b);
        a_running_machine_guards_its_memories(&b);
        a_run_has_one_outcome(&b);
        sweep(&b, 0);
        builds[i].ops->close(b.rtl);
        failed += b.failed;
    }
    printf("%u failed\n", failed);
    return failed != 0;
}
