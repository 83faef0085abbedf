/* simulated.c - the driver and the example of docs/integration.md on the simulated hardware.
 *
 *     simulated LIBRARY BITS SEED SHIPS STEPS     prints "v s" of each ship, as bits
 *     simulated LIBRARY BITS 0 latency            prints the cycles of transfers
 *     simulated LIBRARY BITS SEED sleep           prints in which step an object fell asleep, the
 * first after 69,999
 *
 * BITS: of the bus's addresses. A window of that size is all that a processor gives FP3.
 * ships.c, ship.h and sleeper.h are made by the test.
 */
#include "ships.c"

#include "sleeper.h"

#include "fp3_rtl.h"
#include <dlfcn.h>
#include <fp3/image.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SHIPS_MAX 4096
#define STREAM 1000 /* words */

#define EXPECT(what)                                                                               \
    do {                                                                                           \
        if (!(what)) {                                                                             \
            fprintf(stderr, "line %d: not so: %s\n", __LINE__, #what);                             \
            exit(1);                                                                               \
        }                                                                                          \
    } while (0)

typedef struct {
    const fp3_rtl_ops *ops;
    fp3_rtl *rtl;
    uint64_t window; /* bytes */
    uint64_t transfers;
    uint64_t broken_at; /* the transfer that the bus answers with an error; 0: none */
} board;

static int read_word(void *user, uint32_t address, uint32_t *word) {
    board *b = user;
    EXPECT(address < b->window);
    return ++b->transfers == b->broken_at || fp3_rtl_transfer_one(b->ops, b->rtl, 0, address, word);
}

static int write_word(void *user, uint32_t address, uint32_t word) {
    board *b = user;
    EXPECT(address < b->window);
    return ++b->transfers == b->broken_at ||
           fp3_rtl_transfer_one(b->ops, b->rtl, 1, address, &word);
}

/* A run that has no end in sight: what the driver refuses by itself costs no transfer, what the
 * hardware refuses comes back, and the run goes on until it is stopped. */
static void refuse_while_running(fp3_bare *fp3, board *b) {
    uint32_t word = 0;
    uint64_t cycles = 0, later = 0;
    fp3_bare_outcome outcome;
    fp3_bare other;
    EXPECT(!fp3_bare_start(fp3, FP3_ALL, UINT32_MAX, 0, 0));
    const uint64_t transfers = b->transfers;
    EXPECT(fp3_bare_load(fp3, FP3_ALL, &ship_program) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_write_shared(fp3, 0, 0, 0) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_write(fp3, FP3_ALL, 0, 0, 0) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_read(fp3, FP3_ALL, 0, 0, &word) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_list(fp3, FP3_ALL, 1) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_start(fp3, 0, 1, 0, 0) == FP3_E_ARGUMENT);
    EXPECT(b->transfers == transfers);
    EXPECT(write_word(b, FP3_ADDR_WINDOW_PROGRAM, 0) && write_word(b, FP3_ADDR_STEPS, 1));
    EXPECT(fp3_bare_wait(fp3, FP3_ALL, 3, &outcome) == FP3_E_LIMIT);
    EXPECT(outcome == FP3_BARE_RUNNING);
    EXPECT(!fp3_bare_counter(fp3, 0, FP3_ADDR_COUNTER_CYCLES, &cycles) && cycles > 0);
    EXPECT(!fp3_bare_counter(fp3, 0, FP3_ADDR_COUNTER_CYCLES, &later) && later > cycles);
    /* A driver that comes anew sees that there is a run. */
    const fp3_bare_bus bus = fp3->bus;
    EXPECT(!fp3_bare_open(&other, &bus) && other.running[0]);
    EXPECT(fp3_bare_load(&other, FP3_ALL, &ship_program) == FP3_E_ARGUMENT);
    EXPECT(!fp3_bare_stop(fp3, FP3_ALL) && !fp3_bare_wait(fp3, FP3_ALL, POLLS, &outcome));
    EXPECT(outcome == FP3_BARE_STOPPED);
}

static int is_interrupted(fp3_bare *fp3, board *b) {
    const uint32_t both = 1u << FP3_INTERRUPT_ENDED_LO | 1u << FP3_INTERRUPT_ENABLE_LO;
    uint32_t raised = 0, before = 0, after = 0;
    EXPECT(!fp3_bare_register(fp3, 0, FP3_ADDR_PENDING, &before));
    for (uint32_t i = 0; i < fp3->schedulers; i++) {
        uint32_t word = 0;
        EXPECT(!read_word(b, FP3_ADDRESS_OF(fp3->space_bit, i, FP3_ADDR_INTERRUPT), &word));
        raised |= (uint32_t)((word & both) == both) << i;
    }
    EXPECT(!fp3_bare_register(fp3, fp3->schedulers - 1, FP3_ADDR_PENDING, &after));
    EXPECT((before & ~raised) == 0 && (raised & ~after) == 0);
    return raised != 0;
}

/* One ship: the schedulers without one end at once, and the end of the last is not missed. */
static void take_interrupts(fp3_bare *fp3, board *b) {
    fp3_bare_outcome outcome = FP3_BARE_RUNNING;
    unsigned times = 0;
    EXPECT(!fp3_bare_list(fp3, FP3_ALL, 1) && !fp3_bare_interrupt(fp3, FP3_ALL, FP3_BARE_ON_END));
    EXPECT(!fp3_bare_start(fp3, FP3_ALL, 1000, 0, 0));
    for (; outcome == FP3_BARE_RUNNING; times++) {
        for (unsigned polls = 0; !is_interrupted(fp3, b); polls++)
            EXPECT(polls < 100000); /* of 9 cycles and more; a run has 720,000 */
        EXPECT(!fp3_bare_handle(fp3, FP3_ALL, &outcome));
    }
    EXPECT(outcome == FP3_BARE_DONE && !is_interrupted(fp3, b));
    EXPECT(times == (fp3->schedulers > 1 ? 2 : 1));
}

/* The driver believes what register `features_more` says. */
static void refuse_hardware(const fp3_bare *of) {
    fp3_bare fp3 = *of;
    fp3.features_more |= 1u << FP3_FEATURES_MORE_LOGARITHMIC_LO;
    EXPECT(fp3_bare_load(&fp3, FP3_ALL, &ship_program) == FP3_E_MISMATCH);
    fp3.features_more = of->features_more | 16u << FP3_FEATURES_MORE_FRACTION_LO;
    EXPECT(fp3_bare_load(&fp3, FP3_ALL, &ship_program) == FP3_E_MISMATCH);
    fp3.features_more = of->features_more;
    fp3_bare_program p = ship_program;
    p.arithmetic = FP3_WORDS_FLOATS; /* as the compiler says for a machine with subnormal numbers */
    fp3.features_more |= 1u << FP3_FEATURES_MORE_MIXED_LO;
    EXPECT(fp3_bare_load(&fp3, FP3_ALL, &p) == FP3_E_MISMATCH);
    p.arithmetic = FP3_WORDS_MIXED; /* as the hardware says: refused for its size alone */
    p.registers = fp3.registers + 1;
    EXPECT(fp3_bare_load(&fp3, FP3_ALL, &p) == FP3_E_PROGRAM);
    fp3.features_more = of->features_more;
    EXPECT(fp3_bare_load(&fp3, FP3_ALL, &p) == FP3_E_MISMATCH);
    p.arithmetic = FP3_WORDS_FLOATS;
    fp3.features &= ~(1u << FP3_FEATURES_SUBNORMAL_LO);
    EXPECT(fp3_bare_load(&fp3, FP3_ALL, &p) == FP3_E_MISMATCH);
}

static void refuse_nonsense(fp3_bare *fp3, board *b) {
    uint32_t word = 0;
    uint64_t count = 0;
    const uint32_t room =
        fp3->store ? fp3->schedulers * fp3->lanes * (fp3->store >> fp3->record[0]) : 1;
    const uint32_t record = fp3->store ? 1u << fp3->record[0] : fp3->registers;
    fp3_bare_program p = ship_program;
    const uint64_t transfers = b->transfers;
    EXPECT(fp3_bare_write(fp3, FP3_ALL, room, 0, 0) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_write(fp3, FP3_ALL, room - 1, record, 0) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_read(fp3, fp3->schedulers, 0, 0, &word) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_write_shared(fp3, FP3_ALL, fp3->registers, 0) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_list(fp3, FP3_ALL, room + 1) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_start(fp3, FP3_ALL, UINT32_MAX, 0, 1) == FP3_E_ARGUMENT);
    EXPECT(fp3->schedulers == 1 ||
           fp3_bare_counter(fp3, FP3_ALL, FP3_ADDR_COUNTER_CYCLES, &count) == FP3_E_ARGUMENT);
    EXPECT((fp3->features >> FP3_FEATURES_STATUS_LO & 1) ||
           fp3_bare_read_status(fp3, FP3_ALL, 0, &word) == FP3_E_ARGUMENT);
    p.revision++;
    EXPECT(fp3_bare_load(fp3, FP3_ALL, &p) == FP3_E_MISMATCH);
    p = ship_program;
    p.arithmetic = FP3_WORDS_FLUSHED; /* compiled for configuration 'flush' */
    EXPECT(fp3_bare_load(fp3, FP3_ALL, &p) == FP3_E_MISMATCH);
    refuse_hardware(fp3);
    p = ship_program;
    p.registers = fp3->registers + 1;
    EXPECT(fp3_bare_load(fp3, FP3_ALL, &p) == FP3_E_PROGRAM);
    p = ship_program;
    p.word_count += fp3->program_words;
    EXPECT(fp3_bare_load(fp3, FP3_ALL, &p) == FP3_E_PROGRAM);
    EXPECT(b->transfers == transfers);
    EXPECT(!fp3_bare_write(fp3, FP3_ALL, room - 1, record - 1, 7));
    EXPECT(!fp3_bare_read(fp3, FP3_ALL, room - 1, record - 1, &word) && word == 7);
    EXPECT(fp3_bare_register(fp3, FP3_ALL, 0x7c, &word) == FP3_E_SYSTEM);
    EXPECT((fp3->failed_at & ((4u << fp3->space_bit) - 1)) == 0x7c);
}

/* The hardware says at which word it stopped. */
static void meet_an_illegal_word(fp3_bare *fp3) {
    const uint32_t words[] = {0, 0, 0};
    const fp3_bare_program p = {.words = words,
                                .word_count = 3,
                                .step = 1,
                                .last = 2,
                                .record = 3,
                                .revision = ship_program.revision};
    uint32_t fault = 9;
    fp3_bare_outcome outcome;
    EXPECT(!fp3_bare_load(fp3, FP3_ALL, &p) && !fp3_bare_list(fp3, FP3_ALL, 1));
    EXPECT(!fp3_bare_start(fp3, 0, 1, 0, 0) && !fp3_bare_wait(fp3, 0, POLLS, &outcome));
    EXPECT(outcome == FP3_BARE_ILLEGAL);
    EXPECT(!fp3_bare_register(fp3, 0, FP3_ADDR_FAULT, &fault) && fault == 0);
}

/* Whichever transfer fails: it is told, and nothing goes on as if it had not. */
static void break_each_transfer(board *b, const fp3_bare_bus *bus) {
    static uint32_t v[SHIPS_MAX], s[SHIPS_MAX];
    fp3_bare fp3;
    b->transfers = b->broken_at = 0;
    EXPECT(!fly(&fp3, bus, 1, 1, v, s));
    for (uint64_t last = b->transfers; last > 0; last--) {
        fp3_bare_outcome outcome;
        b->transfers = 0;
        b->broken_at = last;
        const fp3_status status = fly(&fp3, bus, 1, 1, v, s);
        EXPECT(status == FP3_E_SYSTEM || b->transfers < last); /* it may have been another poll */
        b->broken_at = 0;
        EXPECT(!fp3_bare_open(&fp3, bus));
        EXPECT(!fp3_bare_wait(&fp3, FP3_ALL, POLLS, &outcome));
    }
}

/* A bus that is memory, with nothing behind it and with something that answers like one machine. */
static void look_at_memory(void) {
    static uint32_t memory[FP3_ADDR_WINDOW_WAKE / 4 + 1];
    fp3_bare fp3;
    fp3_bare_outcome outcome;
    const fp3_bare_bus bus = fp3_bare_memory(memory);
    EXPECT(fp3_bare_open(&fp3, &bus) == FP3_E_MISMATCH);
    memory[FP3_ADDR_ID / 4] = 0x46503303;
    EXPECT(fp3_bare_open(&fp3, &bus) == FP3_E_MISMATCH);
    memory[FP3_ADDR_ARRAY / 4] = 0x00010101; /* of an older map of addresses */
    EXPECT(fp3_bare_open(&fp3, &bus) == FP3_E_MISMATCH);
    memory[FP3_ADDR_ARRAY / 4] = 0x10010101;
    memory[FP3_ADDR_SHAPE / 4] = 0x00012020;
    memory[FP3_ADDR_FEATURES_MORE / 4] = 0x1234; /* earlier hardware refuses a read there */
    EXPECT(!fp3_bare_open(&fp3, &bus) && fp3.lanes == 1 && fp3.registers == 32 &&
           fp3.features_more == 0);
    memory[FP3_ADDR_FEATURES / 4] |= 1u << FP3_FEATURES_MORE_LO;
    EXPECT(!fp3_bare_open(&fp3, &bus) && fp3.features_more == 0x1234);
    EXPECT(!fp3_bare_stop(&fp3, FP3_ALL) && memory[FP3_ADDR_CONTROL / 4] == 2);
    /* Two objects, words of which neighbours read; a list for two numbers. */
    memory[FP3_ADDR_FEATURES / 4] |= 1u << FP3_FEATURES_SLEEP_LO;
    memory[FP3_ADDR_FEATURES_MORE / 4] = 1u << FP3_FEATURES_MORE_NEIGHBOURS_LO;
    memory[FP3_ADDR_STORE / 4] = 16;
    EXPECT(!fp3_bare_open(&fp3, &bus));
    fp3.record[0] = 3;
    fp3.around = &ship_program;
    EXPECT(fp3_bare_start(&fp3, FP3_ALL, 1, 0, 0) == FP3_E_ARGUMENT);
    EXPECT(memory[FP3_ADDR_CONTROL / 4] == 2 && !fp3_bare_start(&fp3, FP3_ALL, 1, 1, 0));
    EXPECT(memory[FP3_ADDR_CONTROL / 4] == 1 && !fp3_bare_poll(&fp3, FP3_ALL, &outcome));
    memory[FP3_ADDR_WINDOW_AWAKE / 4] = 1;
    EXPECT(!fp3_bare_wake(&fp3, FP3_ALL, 1) && memory[FP3_ADDR_WINDOW_WAKE / 4] == 1);
    memory[FP3_ADDR_WINDOW_AWAKE / 4] = 2;
    EXPECT(fp3_bare_wake(&fp3, FP3_ALL, 0) == FP3_E_ARGUMENT);
    EXPECT(memory[FP3_ADDR_WINDOW_WAKE / 4] == 1);
}

static uint64_t cycles_of(board *b, int is_write, uint32_t address) {
    const uint64_t begin = b->ops->now(b->rtl);
    uint32_t word = 0;
    EXPECT(!fp3_rtl_transfer_one(b->ops, b->rtl, is_write, address, &word));
    return b->ops->now(b->rtl) - begin;
}

/* Cycles for each of many words of objects, one after the other. */
static double stream(board *b, uint8_t is_write, uint32_t object) {
    static fp3_rtl_word words[STREAM];
    for (uint32_t i = 0; i < STREAM; i++)
        words[i] = (fp3_rtl_word){object + 4 * (i % 16), i, is_write, 0};
    const uint64_t begin = b->ops->now(b->rtl);
    EXPECT(!b->ops->transfer(b->rtl, words, STREAM));
    for (uint32_t i = 0; i < STREAM; i++)
        EXPECT(!words[i].is_refused);
    return (double)(b->ops->now(b->rtl) - begin) / STREAM;
}

static void print_latency(board *b) {
    uint32_t array = 0;
    EXPECT(!read_word(b, FP3_ADDR_ARRAY, &array));
    const uint32_t object = FP3_ADDRESS_IN(array >> FP3_ARRAY_SPACE_BIT_LO, FP3_SPACE_OBJECTS, 0);
    cycles_of(b, 0, FP3_ADDR_STEPS); /* the first one waits until the reset has passed all lanes */
    const uint64_t first = cycles_of(b, 1, FP3_ADDR_STEPS),
                   second = cycles_of(b, 0, FP3_ADDR_STEPS);
    const uint64_t third = cycles_of(b, 1, object), fourth = cycles_of(b, 0, object);
    printf("| `%s` | %" PRIu64 " | %" PRIu64 " | %" PRIu64 " | %" PRIu64 " | %.2f | %.2f |\n",
           b->ops->config, first, second, third, fourth, stream(b, 1, object),
           stream(b, 0, object));
}

static void print_sleep(const fp3_bare_bus *bus) {
    fp3_bare fp3;
    fp3_bare_outcome outcome;
    uint32_t slept = 0;
    EXPECT(!fp3_bare_open(&fp3, bus) && !fp3_bare_load(&fp3, FP3_ALL, &sleeper_program));
    EXPECT(!fp3_bare_write(&fp3, FP3_ALL, 0, sleeper_state_x, 0));
    EXPECT(!fp3_bare_write(&fp3, FP3_ALL, 0, sleeper_asleep, 0) && !fp3_bare_list(&fp3, 0, 1));
    EXPECT(!fp3_bare_start(&fp3, 0, 10, 0, 69999) && !fp3_bare_wait(&fp3, 0, POLLS, &outcome));
    EXPECT(outcome == FP3_BARE_DONE);
    EXPECT(!fp3_bare_read(&fp3, FP3_ALL, 0, sleeper_asleep, &slept));
    printf("%" PRIu32 "\n", slept);
}

int main(int argc, char **argv) {
    static uint32_t v[SHIPS_MAX], s[SHIPS_MAX];
    EXPECT(argc >= 5);
    void *library = dlopen(argv[1], RTLD_NOW);
    board b = {.ops = library ? dlsym(library, "fp3_rtl_table") : NULL,
               .window = (uint64_t)1 << strtoul(argv[2], NULL, 10)};
    EXPECT(b.ops);
    const fp3_rtl_watch watch = {NULL, NULL, NULL};
    b.rtl = b.ops->open(&watch, strtoull(argv[3], NULL, 10));
    EXPECT(b.rtl);
    const fp3_bare_bus bus = {read_word, write_word, &b};
    const uint32_t ships = (uint32_t)strtoul(argv[4], NULL, 10);
    if (strcmp(argv[4], "sleep") == 0) {
        print_sleep(&bus);
    } else if (ships == 0) {
        print_latency(&b);
    } else {
        fp3_bare fp3;
        EXPECT(argc == 6 && ships <= SHIPS_MAX);
        const uint32_t steps = (uint32_t)strtoul(argv[5], NULL, 10);
        EXPECT(!fly(&fp3, &bus, ships, steps, v, s));
        take_interrupts(&fp3, &b);
        refuse_while_running(&fp3, &b);
        refuse_nonsense(&fp3, &b);
        meet_an_illegal_word(&fp3);
        if (strcmp(argv[3], "0") == 0)
            break_each_transfer(&b, &bus);
        look_at_memory();
        memset(v, 0, sizeof v);
        EXPECT(!fly(&fp3, &bus, ships, steps, v, s));
        for (uint32_t i = 0; i < ships; i++)
            printf("%08" PRIx32 " %08" PRIx32 "\n", v[i], s[i]);
    }
    b.ops->close(b.rtl);
    return 0;
}
