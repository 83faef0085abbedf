/* host_port.c - every transfer on the bus is answered, and nonsense is refused without a change.
 *
 *     host_port [CONFIGURATION]    or all, with three times as many addresses by chance
 *
 * Addresses of every kind, read and written, idle and running, on each configuration; expected is
 * what isa/registers.toml says, written once more by hand. Every channel waits 0 to 3 cycles in
 * every transfer.
 */
#include "chance.h"

#include "gen/registers.h"
#include <engine/board/hardware.h>
#include <fp3/image.h>
#include <fp3/isa.h>
#include <inttypes.h>
#include <machine/operation.h>
#include <machine/storage.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const fp3_rtl_ops *ops;
    const fp3_config *config;
    uint32_t schedulers;
    uint32_t whole; /* the word of a record that keeps all its bits, as the register of this name */
    fp3_rtl *rtl;
    chance c;
    unsigned failed;
    uint64_t transfers;
    int probes; /* by chance */
} bench;

static const uint32_t start = 1u << FP3_CONTROL_START_LO, stop = 1u << FP3_CONTROL_STOP_LO;

static void fail(bench *b, const char *what, uint32_t address, int64_t got, int64_t expected) {
    if (b->failed++ < 10)
        printf("FAIL %s: %s, address 0x%08" PRIx32 ": got 0x%" PRIx64 ", expected 0x%" PRIx64 "\n",
               b->config->name, what, address, (uint64_t)got, (uint64_t)expected);
}

/* -1, 0 or 1: see fp3_rtl.h. */
static int transfer(bench *b, int is_write, uint32_t address, uint32_t *data) {
    b->transfers++;
    return fp3_rtl_transfer_one(b->ops, b->rtl, is_write, address, data);
}

static int put(bench *b, uint32_t address, uint32_t data) { return transfer(b, 1, address, &data); }

static uint32_t get(bench *b, uint32_t address) {
    uint32_t data = 0;
    const int answer = transfer(b, 0, address, &data);
    if (answer)
        fail(b, "a read", address, answer, 0);
    return data;
}

static void want(bench *b, const char *what, uint32_t address, uint32_t expected) {
    const uint32_t got = get(b, address);
    if (got != expected)
        fail(b, what, address, got, expected);
}

static void must(bench *b, const char *what, uint32_t address, uint32_t data) {
    const int answer = put(b, address, data);
    if (answer)
        fail(b, what, address, answer, 0);
}

static uint32_t of_scheduler(const bench *b, uint32_t scheduler, uint32_t address) {
    return scheduler << (b->config->space_bit + 2) | address;
}

/* All ones, in as many bits as hold the number of schedulers. Of one the bus has no bits that could
 * say all. */
static uint32_t all_of(uint32_t schedulers) {
    uint32_t all = 0;
    while (schedulers > 1 && all < schedulers)
        all = 2 * all + 1;
    return all;
}

static uint32_t of_all(const bench *b, uint32_t address) {
    return of_scheduler(b, all_of(b->schedulers), address);
}

/* What an address says within a scheduler. */
static uint32_t inside(const bench *b, uint32_t address) {
    return address & ((4u << b->config->space_bit) - 1);
}

static uint32_t in_space(const bench *b, uint32_t scheduler, uint32_t space, uint32_t word) {
    return of_scheduler(b, scheduler, space << b->config->space_bit | word << 2);
}

static uint32_t space_of(const bench *b, uint32_t address) {
    return address >> b->config->space_bit & 3;
}

static uint32_t words_of_space(const bench *b) { return 1u << (b->config->space_bit - 2); }

/* Words of the two large memories of a scheduler. */
static uint32_t object_words(const fp3_config *c) {
    return c->interleave ? c->store_words * c->lanes : c->registers;
}

static uint32_t copy_words(const fp3_config *c) { return c->exchange ? c->store_words : 0; }

static uint32_t status_words(const fp3_config *c) {
    return c->status ? c->store_words * c->lanes : 0;
}

/* ---- what may be done with an address, and when ---- */

enum {
    READ = 1,
    WRITE = 2,
    IDLE_ONLY = 4,
    IDLE_WRITE = 8,
    STORE_ONLY = 16,
    AROUND_ONLY = 32,
    COPY_ONLY = 64,
    HALF_ONLY = 128,
    WHOLE_ONLY = 256,
    COUNTERS_ONLY = 512
};

static int access_to_register(const fp3_config *c, uint32_t address) {
    static const struct {
        uint32_t address;
        int access;
    } registers[] = {{FP3_ADDR_ID, READ},
                     {FP3_ADDR_SHAPE, READ},
                     {FP3_ADDR_MEMORY, READ},
                     {FP3_ADDR_FEATURES, READ},
                     {FP3_ADDR_FEATURES_MORE, READ},
                     {FP3_ADDR_VERSION, READ},
                     {FP3_ADDR_CONTROL, WRITE},
                     {FP3_ADDR_STATUS, READ},
                     {FP3_ADDR_FAULT, READ},
                     {FP3_ADDR_FLAGS, READ},
                     {FP3_ADDR_INTERRUPT, READ | WRITE},
                     {FP3_ADDR_PENDING, READ},
                     {FP3_ADDR_PENDING_MORE, READ},
                     {FP3_ADDR_ARRAY, READ},
                     {FP3_ADDR_STORE, READ},
                     {FP3_ADDR_VISIT, READ | WRITE | IDLE_WRITE | STORE_ONLY},
                     {FP3_ADDR_CLOCK, READ | WRITE | IDLE_WRITE | STORE_ONLY},
                     {FP3_ADDR_RECORD, READ | WRITE | IDLE_WRITE | STORE_ONLY},
                     {FP3_ADDR_PUBLISHED, READ | WRITE | IDLE_WRITE | AROUND_ONLY},
                     {FP3_ADDR_PUBLISHED_MORE, READ | WRITE | IDLE_WRITE | AROUND_ONLY},
                     {FP3_ADDR_HALF, READ | WRITE | IDLE_WRITE | AROUND_ONLY},
                     {FP3_ADDR_COPIES, READ | WRITE | IDLE_WRITE | COPY_ONLY},
                     {FP3_ADDR_SEED, READ | WRITE | IDLE_WRITE | HALF_ONLY},
                     {FP3_ADDR_FIRST, READ | WRITE | IDLE_WRITE | HALF_ONLY},
                     {FP3_ADDR_STRIDE, READ | WRITE | IDLE_WRITE | HALF_ONLY},
                     {FP3_ADDR_WHOLE, READ | WRITE | IDLE_WRITE | WHOLE_ONLY},
                     {FP3_ADDR_STEPS, READ | WRITE | IDLE_WRITE},
                     {FP3_ADDR_STEP, READ | WRITE | IDLE_WRITE},
                     {FP3_ADDR_LAST, READ | WRITE | IDLE_WRITE},
                     {FP3_ADDR_SIZE, READ | WRITE | IDLE_WRITE},
#define X(NAME, name, address)                                                                     \
    {address, READ | COUNTERS_ONLY}, {(address) + 4, READ | COUNTERS_ONLY},
                     FP3_COUNTERS(X)
#undef X
    };
    for (size_t i = 0; i < sizeof registers / sizeof *registers; i++)
        if (registers[i].address == address)
            return (!(registers[i].access & STORE_ONLY) || c->interleave) &&
                           (!(registers[i].access & AROUND_ONLY) || c->neighbours) &&
                           (!(registers[i].access & COPY_ONLY) || c->exchange) &&
                           (!(registers[i].access & HALF_ONLY) || c->storage) &&
                           (!(registers[i].access & COUNTERS_ONLY) || c->counters) &&
                           (!(registers[i].access & WHOLE_ONLY) || (c->storage && c->sleep))
                       ? registers[i].access
                       : 0;
    return 0;
}

static int access_to_window(const fp3_config *c, uint32_t address) {
    const struct {
        uint32_t begin, words;
        int access;
    } windows[] = {
        {FP3_ADDR_WINDOW_PROGRAM, c->program_words, WRITE},
        {FP3_ADDR_WINDOW_CONSTANTS, c->registers, READ | WRITE},
        {FP3_ADDR_WINDOW_AWAKE, c->interleave ? c->lanes : 0, READ | WRITE},
        {FP3_ADDR_WINDOW_WAKE, c->sleep ? c->lanes : 0, WRITE},
    };
    for (size_t i = 0; i < sizeof windows / sizeof *windows; i++)
        if (address >= windows[i].begin && address < windows[i].begin + 4 * windows[i].words)
            return windows[i].access | IDLE_ONLY;
    return 0;
}

static int access_to(const bench *b, uint32_t address) {
    const fp3_config *c = b->config;
    const uint32_t scheduler = address >> (b->config->space_bit + 2);
    const uint32_t space = space_of(b, address);
    const uint32_t word = address / 4 % words_of_space(b);
    if (address % 4 || (scheduler >= b->schedulers && scheduler != all_of(b->schedulers)))
        return 0;
    if (space == FP3_SPACE_COPIES)
        return word < copy_words(c) ? WRITE | IDLE_ONLY : 0;
    if (space == FP3_SPACE_OBJECTS)
        return word < object_words(c) ? READ | WRITE | IDLE_ONLY : 0;
    if (space == FP3_SPACE_STATUS)
        return word < status_words(c) ? READ | WRITE | IDLE_ONLY : 0;
    return access_to_register(c, inside(b, address)) | access_to_window(c, inside(b, address));
}

/* A legal value for every register that can be written, and no command. */
static uint32_t harmless(const bench *b, uint32_t address) {
    switch (inside(b, address)) {
    case FP3_ADDR_RECORD:
        return 3;
    case FP3_ADDR_WHOLE:
        return FP3_BANK_OBJECT_COUNT;
    default:
        return 0;
    }
}

static void probe(bench *b, uint32_t address, int is_running) {
    for (int is_write = 0; is_write < 2; is_write++) {
        const int access = access_to(b, address);
        const int refused = !(access & (is_write ? WRITE : READ)) ||
                            (is_running && (access & IDLE_ONLY)) ||
                            (is_running && is_write && (access & IDLE_WRITE));
        uint32_t data = harmless(b, address);
        const int answer = transfer(b, is_write, address, &data);
        if (answer != refused)
            fail(b, is_write ? "a write" : "a read", address, answer, refused);
        if (refused && !is_write && data != 0)
            fail(b, "a refused read shows data", address, data, 0);
    }
}

/* All of scheduler 0 that has a name and as much beyond it, the ends of the memories, whatever else
 * chance finds. While scheduler 0 runs, only its own. */
static void sweep(bench *b, int is_running) {
    const uint32_t ends[] = {object_words(b->config), status_words(b->config),
                             copy_words(b->config), words_of_space(b)};
    for (uint32_t address = 0; address < 0x4000; address += address < 0x100 ? 1 : 4)
        probe(b, address, is_running);
    const uint32_t programs[] = {FP3_ADDR_WINDOW_PROGRAM,
                                 FP3_ADDR_WINDOW_PROGRAM + 4 * b->config->program_words, 0x10000};
    for (size_t i = 0; i < sizeof programs / sizeof *programs; i++)
        for (uint32_t address = programs[i] - 32; address < programs[i] + 32; address++)
            probe(b, address, is_running);
    for (uint32_t space = 0; space < 4; space++)
        for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
            for (uint32_t word = ends[i] - 2; word != ends[i] + 2; word++)
                probe(b, in_space(b, 0, space, word % words_of_space(b)), is_running);
    for (int i = 0; i < b->probes; i++)
        probe(b, inside(b, (uint32_t)next64(&b->c)), is_running);
    for (uint32_t scheduler = 1; scheduler < 256 && !is_running; scheduler++) {
        probe(b, of_scheduler(b, scheduler, FP3_ADDR_ID), 0);
        probe(b, of_scheduler(b, scheduler, FP3_ADDR_STEPS), 0);
        probe(b, of_scheduler(b, scheduler, inside(b, (uint32_t)next64(&b->c))), 0);
    }
}

/* ---- memories ---- */

/* Records have 8 words. */
static int is_whole(const bench *b, uint32_t address) { return address / 4 % 8 == b->whole; }

/* What is read where this word was written: a record of 16 bits has it rounded to nearest. */
static uint32_t kept(const bench *b, uint32_t address, uint32_t word) {
    uint32_t flags;
    return space_of(b, address) == FP3_SPACE_OBJECTS && !is_whole(b, address)
               ? fp3_stored(b->config, word, NULL, &flags)
               : word;
}

/* Fills what can be read with marks, and looks for them. Records of 16 bits get numbers that they
 * tell apart. */
static uint32_t mark(const bench *b, uint32_t address) {
    const uint32_t word = address * 0x9e3779b9u ^ 0x5a5a5a5au;
    const int is_half =
        b->config->storage && space_of(b, address) == FP3_SPACE_OBJECTS && !is_whole(b, address);
    return is_half ? (word & 0x87ffffffu) | 0x38000000u : word;
}

static void put_or_want(bench *b, int is_check, uint32_t address) {
    if (is_check)
        want(b, "a word written before", address, kept(b, address, mark(b, address)));
    else
        must(b, "a write", address, mark(b, address));
}

/* A lane has status for as many objects as smallest records. */
static void memories_keep_words_apart(bench *b) {
    const fp3_config *c = b->config;
    const uint32_t stride = object_words(c) > 10000 ? 97 : 1;
    for (int is_check = 0; is_check < 2; is_check++)
        for (uint32_t scheduler = 0; scheduler < b->schedulers; scheduler++) {
            for (uint32_t i = 0; i < c->registers; i++)
                put_or_want(b, is_check,
                            of_scheduler(b, scheduler, FP3_ADDR_WINDOW_CONSTANTS + 4 * i));
            for (uint32_t word = 0; word < object_words(c); word += stride)
                put_or_want(b, is_check, in_space(b, scheduler, FP3_SPACE_OBJECTS, word));
            for (uint32_t word = 0; word < status_words(c); word += stride)
                if (word % c->store_words < c->store_words / 8)
                    put_or_want(b, is_check, in_space(b, scheduler, FP3_SPACE_STATUS, word));
        }
}

/* An integer of each record of 16 bits, whichever word it is. */
static void one_word_is_whole(bench *b) {
    if (!b->config->storage || !b->config->sleep)
        return;
    for (b->whole = 0; b->whole < 8; b->whole += 5) {
        for (uint32_t scheduler = 0; scheduler < b->schedulers; scheduler++)
            must(b, "a whole word", of_scheduler(b, scheduler, FP3_ADDR_WHOLE), b->whole);
        memories_keep_words_apart(b);
    }
    b->whole -= 5;
}

/* ---- many at once ---- */

#define TRACKED 48 /* at most: a small machine has fewer words */
#define AT_ONCE 64

/* Words that are known, in all memories and in registers that keep what is written. */
typedef struct {
    uint32_t address[TRACKED], word[TRACKED], count;
} known;

static void know(known *k, uint32_t address) {
    for (uint32_t i = 0; i < k->count; i++)
        if (k->address[i] == address)
            return;
    k->address[k->count++] = address;
}

static void choose_known(bench *b, known *k) {
    const fp3_config *c = b->config;
    for (int tries = 0; tries < 10 * TRACKED && k->count < TRACKED; tries++) {
        const uint32_t scheduler = below(&b->c, b->schedulers);
        const uint32_t row = c->interleave ? below(&b->c, c->store_words / 8) : 0;
        switch (below(&b->c, 6)) {
        case 0:
            know(k, of_scheduler(b, scheduler,
                                 FP3_ADDR_WINDOW_CONSTANTS + 4 * below(&b->c, c->registers)));
            break;
        case 1:
            know(k, of_scheduler(b, scheduler, FP3_ADDR_STEPS));
            break;
        case 2:
            if (status_words(c))
                know(k, in_space(b, scheduler, FP3_SPACE_STATUS,
                                 below(&b->c, c->lanes) * c->store_words + row));
            break;
        default: /* neighbours, too */
            know(k, in_space(b, scheduler, FP3_SPACE_OBJECTS,
                             below(&b->c,
                                   below(&b->c, 2) && object_words(c) > 8 ? 8 : object_words(c))));
        }
    }
    for (uint32_t i = 0; i < k->count; i++) {
        const uint32_t word = (uint32_t)next64(&b->c);
        k->word[i] = kept(b, k->address[i], word);
        must(b, "a word", k->address[i], word);
    }
}

/* One more transfer for the list: of a known word (in one list it is either written once, or read),
 * or a refused one. */
static fp3_rtl_word one_of_many(bench *b, known *k, uint8_t *is_used) {
    const uint32_t i = below(&b->c, k->count);
    fp3_rtl_word word = {0, (uint32_t)next64(&b->c), (uint8_t)below(&b->c, 2), 0};
    if (below(&b->c, 8) && !is_used[i] && word.is_write) {
        is_used[i] = 2;
        word.address = k->address[i];
        k->word[i] = kept(b, word.address, word.data);
    } else if (is_used[i] < 2 && !word.is_write && below(&b->c, 8)) {
        is_used[i] = 1;
        word.address = k->address[i];
    } else
        do {
            word.address = below(&b->c, 4) ? (uint32_t)next64(&b->c)
                                           : of_scheduler(b, 0, 4 * below(&b->c, 0x1000));
            word.address &= ~((below(&b->c, 2) ^ 1) << (b->config->space_bit + 1));
        } while (access_to(b, word.address) & (word.is_write ? WRITE : READ));
    if (!word.is_write)
        word.data = 0; /* what is read where the bus leads nowhere */
    return word;
}

static uint32_t known_word(const known *k, uint32_t address) {
    for (uint32_t i = 0; i < k->count; i++)
        if (k->address[i] == address)
            return k->word[i];
    return 0;
}

static void check_list(bench *b, const known *k, const fp3_rtl_word *words, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const int access = access_to(b, words[i].address);
        const int refused = !(access & (words[i].is_write ? WRITE : READ));
        if (words[i].is_refused != refused)
            fail(b, words[i].is_write ? "a write among many" : "a read among many",
                 words[i].address, words[i].is_refused, refused);
        else if (!words[i].is_write && words[i].data != known_word(k, words[i].address))
            fail(b, "a word read among many", words[i].address, words[i].data,
                 known_word(k, words[i].address));
    }
}

/* Lists of transfers, legal and illegal, the master waiting for no response. */
static void many_are_answered_in_order(bench *b, uint32_t lists) {
    known k = {.count = 0};
    choose_known(b, &k);
    for (uint32_t n = 0; n < lists; n++) {
        fp3_rtl_word words[AT_ONCE];
        uint8_t is_used[TRACKED] = {0};
        const uint32_t count = 1 + below(&b->c, AT_ONCE);
        for (uint32_t i = 0; i < count; i++)
            words[i] = one_of_many(b, &k, is_used);
        b->transfers += count;
        if (b->ops->transfer(b->rtl, words, count))
            fail(b, "a list of transfers", words[0].address, -1, 0);
        else
            check_list(b, &k, words, count);
    }
}

static uint32_t kept_mark(const bench *b, uint32_t address, int is_write) {
    return is_write ? mark(b, address) : kept(b, address, mark(b, address));
}

/* Objects come and go with a word a cycle, once the first is there. */
static void objects_stream(bench *b) {
    const uint32_t latency = 40, count = 400;
    fp3_rtl_word words[400];
    for (uint8_t is_write = 2; is_write-- > 0;) {
        for (uint32_t i = 0; i < count; i++) {
            const uint32_t address =
                in_space(b, i % b->schedulers, FP3_SPACE_OBJECTS, i * 37 % object_words(b->config));
            words[i] = (fp3_rtl_word){address, mark(b, address), is_write, 0};
        }
        const uint64_t begin = b->ops->now(b->rtl);
        const int answer = b->ops->transfer(b->rtl, words, count);
        const uint64_t cycles = b->ops->now(b->rtl) - begin;
        b->transfers += count;
        if (answer || cycles > count + latency)
            fail(b, "the cycles of 400 words", words[0].address, (int64_t)cycles, count);
        for (uint32_t i = 0; i < count; i++)
            if (words[i].is_refused || words[i].data != kept_mark(b, words[i].address, is_write))
                fail(b, "a word of 400", words[i].address, words[i].data,
                     kept_mark(b, words[i].address, is_write));
    }
}

static void all_units_are_one(bench *b) {
    uint32_t or = 0;
    for (uint32_t scheduler = 0; scheduler < b->schedulers; scheduler++) {
        must(b, "steps", of_scheduler(b, scheduler, FP3_ADDR_STEPS),
             0x100u << scheduler % 8 | scheduler);
        or |= 0x100u << scheduler % 8 | scheduler;
    }
    want(b, "the OR of all schedulers", of_all(b, FP3_ADDR_STEPS), or);
    must(b, "steps", of_all(b, FP3_ADDR_STEPS), 77);
    for (uint32_t scheduler = 0; scheduler < b->schedulers; scheduler++)
        want(b, "written to all schedulers", of_scheduler(b, scheduler, FP3_ADDR_STEPS), 77);
}

/* No list is told of an object that has no row. What is refused leaves the list as it is. */
static void lists_end_at_their_rows(bench *b, uint32_t lane, uint32_t log2) {
    const uint32_t awake = FP3_ADDR_WINDOW_AWAKE + 4 * lane, wake = FP3_ADDR_WINDOW_WAKE + 4 * lane;
    const uint32_t rows = b->config->store_words >> log2;
    const uint32_t beyond[] = {rows + 1, 2 * rows, 0x10000, 0x80000000u, UINT32_MAX};
    must(b, "a record", FP3_ADDR_RECORD, log2);
    must(b, "a list", awake, b->config->sleep ? 0 : rows);
    if (b->config->sleep)
        must(b, "the last object", wake, rows - 1);
    const uint32_t count = get(b, awake);
    if (count != (b->config->sleep ? 1 : rows))
        fail(b, "a list", awake, count, rows);
    for (size_t i = 0; i < sizeof beyond / sizeof *beyond; i++)
        if (put(b, awake, beyond[i]) != 1 || put(b, wake, beyond[i]) != 1)
            fail(b, "an object without a row", awake, beyond[i], rows);
    if (put(b, wake, rows) != 1 || (b->config->sleep && put(b, awake, 1) != 1))
        fail(b, "an object without a row", wake, rows, rows);
    want(b, "a refused write changes nothing:", awake, count);
}

static void lists_count_their_objects(bench *b) {
    const fp3_config *c = b->config;
    for (uint32_t lane = 0; c->interleave && lane < c->lanes; lane++) {
        const uint32_t awake = FP3_ADDR_WINDOW_AWAKE + 4 * lane;
        must(b, "a record", FP3_ADDR_RECORD, 3);
        must(b, "an empty list", awake, 0);
        want(b, "an empty list", awake, 0);
        if (!c->sleep) {
            const uint32_t count = 1 + lane % (c->store_words / 8);
            must(b, "a list", awake, count);
            want(b, "a list", awake, count);
        }
        for (uint32_t n = 0; c->sleep && n < 3 && n < c->store_words / 8; n++) {
            must(b, "one more object", FP3_ADDR_WINDOW_WAKE + 4 * lane, n);
            want(b, "so many objects", awake, n + 1);
        }
        for (uint32_t log2 = 3; log2 <= 6 && c->store_words >> log2; log2++)
            lists_end_at_their_rows(b, lane, log2);
        must(b, "an empty list", awake, 0);
    }
}

/* ---- runs ---- */

/* One instruction, r0 = k0 + r1, as the whole step part, with what one object needs around it. */
static void load(bench *b, uint32_t steps) {
    const uint32_t is_store = b->config->interleave;
    const uint32_t words[] = {
        fp3_word_encode(&(fp3_instruction){.op = FP3_OP_LD, .d = 1}),
        fp3_word_encode(&(fp3_instruction){.op = FP3_OP_ADD, .a = FP3_BANK_SHARED_BASE, .b = 1}),
        fp3_word_encode(&(fp3_instruction){.op = FP3_OP_ST}),
    };
    const uint32_t first = is_store ? 0 : 1, count = is_store ? 3 : 1;
    for (uint32_t i = 0; i < count; i++)
        must(b, "a write of a program", FP3_ADDR_WINDOW_PROGRAM + 4 * i, words[first + i]);
    const uint32_t writes[][2] = {
        {FP3_ADDR_STEP, is_store}, {FP3_ADDR_LAST, is_store + 1},
        {FP3_ADDR_SIZE, count},    {FP3_ADDR_STEPS, steps},
        {FP3_ADDR_VISIT, 0},       {FP3_ADDR_WINDOW_AWAKE, b->config->sleep ? 0 : 1},
        {FP3_ADDR_WINDOW_WAKE, 0}};
    const size_t known = b->config->sleep ? 7 : is_store ? 6 : 4;
    for (size_t i = 0; i < known; i++)
        must(b, "a write of a program", writes[i][0], writes[i][1]);
}

static void nonsense_does_not_start(bench *b) {
    const uint32_t size = b->config->program_words;
    const uint32_t shapes[][3] = {{0, 0, 1}, {1, 1, 1}, {2, 1, 2}, {0, 2, 1}, {0, 0, 0}};
    load(b, 1);
    const uint32_t count = get(b, FP3_ADDR_SIZE), last = get(b, FP3_ADDR_LAST);
    if (put(b, FP3_ADDR_STEP, size + 1) != 1 || put(b, FP3_ADDR_LAST, 0xffffffffu) != 1 ||
        put(b, FP3_ADDR_SIZE, 0x80000001u) != 1)
        fail(b, "an index beyond the memory", FP3_ADDR_SIZE, 0, 1);
    want(b, "a refused write changes nothing:", FP3_ADDR_SIZE, count);
    want(b, "a refused write changes nothing:", FP3_ADDR_LAST, last);
    for (uint32_t log2 = 0; b->config->interleave && log2 < 32; log2++)
        if (put(b, FP3_ADDR_RECORD, log2) != (log2 < 3 || log2 > 6))
            fail(b, "a record of 8 to 64 words", FP3_ADDR_RECORD, log2, 3);
    for (uint32_t bit = 3; b->config->interleave && bit < 32; bit++)
        if (put(b, FP3_ADDR_RECORD, 3 | UINT32_C(1) << bit) != 1)
            fail(b, "a record beyond 64 words", FP3_ADDR_RECORD, bit, 1);
    for (uint32_t bit = 31; UINT32_C(1) << bit > size; bit--)
        if (put(b, FP3_ADDR_SIZE, UINT32_C(1) << bit) != 1)
            fail(b, "an index beyond the memory", FP3_ADDR_SIZE, bit, 1);
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
    must(b, "a stop of nothing", FP3_ADDR_CONTROL, stop);
    want(b, "no run came of it: status", FP3_ADDR_STATUS, 0);
}

/* With words that neighbours read a visit is one step. */
static void who_is_seen_is_visited_each_step(bench *b) {
    for (uint32_t i = 0; b->config->neighbours && i < 12; i++) {
        static const uint32_t visits[] = {0, 1, 2, 0x10001};
        const uint32_t visit = visits[i / 3], published = i % 3;
        load(b, 1);
        must(b, "visit", FP3_ADDR_VISIT, visit);
        must(b, "published", FP3_ADDR_PUBLISHED, published == 1 ? 0x80000000u : 0);
        must(b, "published_more", FP3_ADDR_PUBLISHED_MORE, published == 2);
        const int is_refused = published && visit != 1;
        if (put(b, FP3_ADDR_CONTROL, start) != is_refused)
            fail(b, "a start with these steps per visit", FP3_ADDR_VISIT, visit, is_refused);
        b->ops->clock(b->rtl, 10000, 100);
    }
    if (b->config->neighbours)
        must(b, "published_more", FP3_ADDR_PUBLISHED_MORE, 0);
}

/* What a run begins with, also one of no steps: no fault and no count of the run before. */
static void a_start_forgets_the_run_before(bench *b) {
    for (uint32_t steps = 0; steps < 2; steps++) {
        load(b, 1);
        const uint32_t step = get(b, FP3_ADDR_STEP);
        must(b, "no word", FP3_ADDR_WINDOW_PROGRAM + 4 * step, 0xffffffffu);
        must(b, "a start", FP3_ADDR_CONTROL, start);
        b->ops->clock(b->rtl, 10000, 100);
        want(b, "an illegal word: fault", FP3_ADDR_FAULT, step);
        if (b->config->counters && !get(b, FP3_ADDR_COUNTER_CYCLES))
            fail(b, "a run without cycles", FP3_ADDR_COUNTER_CYCLES, 0, 1);
        load(b, steps);
        must(b, "a start", FP3_ADDR_CONTROL, start);
        b->ops->clock(b->rtl, 10000, 100);
        want(b, "a legal run: fault", FP3_ADDR_FAULT, 0);
        if (b->config->counters && !get(b, FP3_ADDR_COUNTER_CYCLES) == (steps != 0))
            fail(b, "a run has cycles if it has steps", FP3_ADDR_COUNTER_CYCLES, steps, steps);
    }
}

static void a_running_machine_guards_its_memories(bench *b) {
    const uint32_t running = 1u << FP3_STATUS_RUNNING_LO, stopped = 1u << FP3_STATUS_STOPPED_LO;
    load(b, 0xffffffffu);
    put(b, FP3_ADDR_WINDOW_CONSTANTS, mark(b, 0));
    must(b, "a start", FP3_ADDR_CONTROL, start);
    sweep(b, 1);
    if (put(b, FP3_ADDR_CONTROL, start) != 1)
        fail(b, "a start while running", FP3_ADDR_CONTROL, 0, 1);
    want(b, "still running: status", FP3_ADDR_STATUS, running);
    want(b, "one scheduler runs: status of all", of_all(b, FP3_ADDR_STATUS), running);
    must(b, "a stop", FP3_ADDR_CONTROL, stop);
    b->ops->clock(b->rtl, 10000, 100);
    want(b, "stopped: status", FP3_ADDR_STATUS, stopped);
    want(b, "untouched:", FP3_ADDR_WINDOW_CONSTANTS, mark(b, 0));
    want(b, "untouched:", FP3_ADDR_STEPS, 0xffffffffu);
}

static void counters_are_0_before_the_first_run(bench *b) {
    for (uint32_t scheduler = 0; b->config->counters && scheduler < b->schedulers; scheduler++) {
#define X(NAME, name, address)                                                                     \
    want(b, "counter " name, of_scheduler(b, scheduler, address), 0);                              \
    want(b, "counter " name ", high word", of_scheduler(b, scheduler, (address) + 4), 0);
        FP3_COUNTERS(X)
#undef X
    }
}

static int one_bit(uint32_t word) { return word && !(word & (word - 1)); }

/* Whenever a host looks, a run either goes on or has one outcome; whether it comes to its end,
 * meets an illegal word, is stopped, or more than one of these at once. */
static void a_run_has_one_outcome(bench *b) {
    const uint64_t length = b->config->interleave ? 150 : 60;
    for (unsigned is_illegal = 0; is_illegal < 2; is_illegal++)
        for (unsigned is_stopped = 0; is_stopped < 2; is_stopped++)
            for (uint64_t when = 0; when < length; when++) {
                load(b, 1);
                const uint32_t size = get(b, FP3_ADDR_SIZE);
                put(b, FP3_ADDR_WINDOW_PROGRAM + 4 * size, 0);
                if (is_illegal)
                    put(b, FP3_ADDR_SIZE, size + 1);
                must(b, "a start", FP3_ADDR_CONTROL, start);
                b->ops->clock(b->rtl, when, when + 1);
                if (is_stopped)
                    put(b, FP3_ADDR_CONTROL, stop);
                for (int i = 0; i < 2; i++) {
                    const uint32_t status = get(b, FP3_ADDR_STATUS);
                    if (!one_bit(status) || (i && status & 1))
                        fail(b, "running, then one outcome: status", FP3_ADDR_STATUS, status,
                             1u << FP3_STATUS_RUNNING_LO);
                    b->ops->clock(b->rtl, 10000, 100);
                }
            }
}

/* ended: set by every end, one of 0 steps too; gone when the host writes 1 there, and with the next
 * start. */
static void an_end_is_kept_until_it_is_seen(bench *b) {
    const uint32_t enable = 1u << FP3_INTERRUPT_ENABLE_LO, ended = 1u << FP3_INTERRUPT_ENDED_LO;
    must(b, "a constant", FP3_ADDR_WINDOW_CONSTANTS, 0); /* nothing overflows */
    must(b, "a register", in_space(b, 0, FP3_SPACE_OBJECTS, 1), 0);
    for (uint32_t steps = 0; steps < 2; steps++) {
        load(b, steps);
        must(b, "enable", FP3_ADDR_INTERRUPT, ended | (steps ? enable : 0));
        want(b, "nothing has ended:", FP3_ADDR_INTERRUPT, steps ? enable : 0);
        must(b, "a start", FP3_ADDR_CONTROL, start);
        b->ops->clock(b->rtl, 10000, 100);
        want(b, "an end:", FP3_ADDR_INTERRUPT, ended | (steps ? enable : 0));
        must(b, "a write of 0 keeps it", FP3_ADDR_INTERRUPT, 0);
        want(b, "not seen yet:", FP3_ADDR_INTERRUPT, ended);
        must(b, "seen", FP3_ADDR_INTERRUPT, ended);
        want(b, "seen:", FP3_ADDR_INTERRUPT, 0);
    }
    must(b, "a start", FP3_ADDR_CONTROL, start);
    b->ops->clock(b->rtl, 10000, 100);
    load(b, 0xffffffffu);
    want(b, "an end:", FP3_ADDR_INTERRUPT, ended);
    must(b, "a start", FP3_ADDR_CONTROL, start);
    want(b, "a new run, no end yet:", FP3_ADDR_INTERRUPT, 0);
    must(b, "a stop", FP3_ADDR_CONTROL, stop);
    b->ops->clock(b->rtl, 10000, 100);
    want(b, "a stop is an end:", FP3_ADDR_INTERRUPT, ended);
}

/* failed: set by an overflow; gone when the host writes 1 there, and with the next start. */
static void a_failure_is_kept_until_it_is_seen(bench *b) {
    const uint32_t enable = 1u << FP3_INTERRUPT_ENABLE_FAILED_LO,
                   ended = 1u << FP3_INTERRUPT_ENDED_LO;
    const uint32_t failed = 1u << FP3_INTERRUPT_FAILED_LO, large = 0x7f7f0000u;
    const uint32_t fails = 1u << FP3_FLAGS_OVERFLOW_LO | 1u << FP3_FLAGS_INVALID_LO;
    for (int i = 0; i < 4; i++) {
        const uint32_t enabled = i % 2 ? enable : 0, word = i < 2 ? large : 0;
        load(b, 1);
        must(b, "a constant", FP3_ADDR_WINDOW_CONSTANTS, word);
        must(b, "a register", in_space(b, 0, FP3_SPACE_OBJECTS, 1), word);
        must(b, "enable", FP3_ADDR_INTERRUPT, ended | enabled);
        must(b, "a start", FP3_ADDR_CONTROL, start);
        b->ops->clock(b->rtl, 10000, 100);
        const uint32_t is_failed = get(b, FP3_ADDR_FLAGS) & fails ? failed : 0;
        const int is_binary32 =
            !b->config->logarithmic && !b->config->storage && !b->config->finite;
        if (b->config->flags && is_binary32 && !is_failed != (i >= 2))
            fail(b, "a sum of large numbers: flags", FP3_ADDR_FLAGS, is_failed, fails);
        want(b, "a failure:", FP3_ADDR_INTERRUPT, ended | enabled | is_failed);
        must(b, "a write of 0 there keeps it", FP3_ADDR_INTERRUPT, ended);
        want(b, "not seen yet:", FP3_ADDR_INTERRUPT, is_failed);
        if (i == 0)
            must(b, "seen", FP3_ADDR_INTERRUPT, failed);
        want(b, "seen, or the next start clears it:", FP3_ADDR_INTERRUPT, i == 0 ? 0 : is_failed);
    }
}

/* What the isa engine, which takes them for illegal before they are loaded, cannot be asked. */
static void what_is_left_out_is_illegal(bench *b) {
    for (uint32_t i = 0; i < fp3_operation_count; i++) {
        const fp3_operation *of = &fp3_operations[i];
        const fp3_instruction all_zero = {.op = of->code};
        const int has = fp3_operation_lacks(b->config, of->code) == FP3_KEY_NONE &&
                        !fp3_operation_mixes(b->config, &all_zero);
        load(b, 1);
        const uint32_t step = get(b, FP3_ADDR_STEP), word = fp3_word_encode(&all_zero);
        must(b, "a word", FP3_ADDR_WINDOW_PROGRAM + 4 * step, word);
        must(b, "a start", FP3_ADDR_CONTROL, start);
        b->ops->clock(b->rtl, 10000, 100);
        want(b, "a word that may be left out: status", FP3_ADDR_STATUS,
             1u << (has ? FP3_STATUS_DONE_LO : FP3_STATUS_ILLEGAL_LO));
        if (!has)
            want(b, "a word that is left out: fault", FP3_ADDR_FAULT, step);
    }
}

/* Who sleeps is found by its first load, and nothing is issued for those who all sleep. */
static void sleepers_are_skipped(bench *b) {
    const uint32_t loads = fp3_word_encode(&(fp3_instruction){.op = FP3_OP_LDS, .d = 1});
    for (uint32_t sleeps = 0; b->config->sleep && b->config->counters && sleeps < 2; sleeps++) {
        load(b, 9);
        if (b->config->storage)
            must(b, "a whole word", FP3_ADDR_WHOLE, 1);
        must(b, "a load of who sleeps", FP3_ADDR_WINDOW_PROGRAM, loads);
        must(b, "the step in which it fell asleep", in_space(b, 0, FP3_SPACE_OBJECTS, 1), sleeps);
        must(b, "a start", FP3_ADDR_CONTROL, start);
        b->ops->clock(b->rtl, 100000, 100);
        const uint32_t sums = get(b, FP3_ADDR_COUNTER_ISSUED_ADD);
        if (sleeps ? sums > 4 : sums != 9) /* some have issued until the load has been heard of */
            fail(b, "sums of who is awake", FP3_ADDR_COUNTER_ISSUED_ADD, sums, sleeps ? 0 : 9);
    }
    if (b->config->sleep && b->config->storage)
        must(b, "no whole word", FP3_ADDR_WHOLE, FP3_BANK_OBJECT_COUNT);
}

/* Bits below the fraction are no number: what only has such is 0. The least number chooses, also
 * where subnormal numbers are flushed (isa/isa.toml). Records of 16 bits cannot hold such words. */
static void bits_below_the_fraction_are_0(bench *b) {
    const fp3_config *c = b->config;
    const uint32_t choose = fp3_word_encode(&(fp3_instruction){.op = FP3_OP_SEL,
                                                               .d = 0,
                                                               .a = FP3_BANK_SHARED_BASE,
                                                               .b = FP3_BANK_SHARED_BASE + 1,
                                                               .c = 1});
    for (uint32_t is_one = 0; c->select && !c->storage && c->fraction < 23 && is_one < 2;
         is_one++) {
        const uint32_t least = 1u << (23 - c->fraction);
        load(b, 1);
        must(b, "a choice", FP3_ADDR_WINDOW_PROGRAM + 4 * get(b, FP3_ADDR_STEP), choose);
        for (uint32_t i = 0; i < 2; i++)
            must(b, "a constant", FP3_ADDR_WINDOW_CONSTANTS + 4 * i, 0x3f800000u + (i << 23));
        must(b, "what chooses", in_space(b, 0, FP3_SPACE_OBJECTS, 1), is_one ? least : least - 1);
        must(b, "a start", FP3_ADDR_CONTROL, start);
        b->ops->clock(b->rtl, 10000, 100);
        want(b, "a choice by what is almost 0", in_space(b, 0, FP3_SPACE_OBJECTS, 0),
             is_one ? 0x3f800000u : 0x40000000u);
    }
}

/* A list that got one number too many starts no run, also where the start follows at once. Of the
 * first lane, whose count has the longest way, and of the last. */
static void an_overfull_list_does_not_start(bench *b, uint32_t lane) {
    enum { ROWS_MAX = 2048 };
    static fp3_rtl_word words[ROWS_MAX + 2];
    const uint32_t rows = b->config->store_words / 8;
    if (!b->config->sleep || rows > ROWS_MAX)
        return;
    for (uint32_t more = 0; more < 2; more++) {
        load(b, 1);
        must(b, "an empty list", FP3_ADDR_WINDOW_AWAKE + 4 * lane, 0);
        for (uint32_t i = 0; i < rows + more; i++)
            words[i] = (fp3_rtl_word){FP3_ADDR_WINDOW_WAKE + 4 * lane, i % rows, 1, 0};
        words[rows + more] = (fp3_rtl_word){FP3_ADDR_CONTROL, start, 1, 0};
        const int answer = b->ops->transfer(b->rtl, words, rows + more + 1);
        b->transfers += rows + more + 1;
        if (answer || words[rows + more].is_refused != more)
            fail(b, "a start with a full list", rows + more, words[rows + more].is_refused, more);
        b->ops->clock(b->rtl, 1000000, 1000);
        want(b, "a full list", FP3_ADDR_WINDOW_AWAKE + 4 * lane, rows + more);
        if (!more && b->config->counters)
            want(b, "a load and a store of each", FP3_ADDR_COUNTER_ISSUED_MEMORY, 2 * rows);
    }
    must(b, "an empty list", FP3_ADDR_WINDOW_AWAKE + 4 * lane, 0);
    must(b, "a start", FP3_ADDR_CONTROL, start);
    b->ops->clock(b->rtl, 10000, 100);
}

static void a_quick_master_streams(const fp3_config *config, const fp3_rtl_ops *ops, bench *b) {
    bench quick = {.ops = ops, .config = config, .whole = FP3_BANK_OBJECT_COUNT, .c = {.state = 2}};
    quick.schedulers = fp3_config_schedulers(config);
    quick.rtl = ops->open(&(fp3_rtl_watch){0}, 0);
    if (!quick.rtl) {
        b->failed++;
        return;
    }
    if (config->interleave)
        objects_stream(&quick);
    many_are_answered_in_order(&quick, 100);
    an_overfull_list_does_not_start(&quick, 0);
    an_overfull_list_does_not_start(&quick, config->lanes - 1);
    sleepers_are_skipped(&quick);
    bits_below_the_fraction_are_0(&quick);
    a_run_has_one_outcome(&quick);
    ops->close(quick.rtl);
    b->failed += quick.failed;
    b->transfers += quick.transfers;
}

static unsigned check(const fp3_config *config, const fp3_rtl_ops *ops, int probes,
                      uint64_t *transfers) {
    bench b = {.ops = ops, .config = config, .c = {.state = 1}, .probes = probes};
    b.schedulers = fp3_config_schedulers(b.config);
    b.whole = FP3_BANK_OBJECT_COUNT;
    b.rtl = ops->open(&(fp3_rtl_watch){0}, 1);
    if (!b.rtl)
        return 1;
    counters_are_0_before_the_first_run(&b);
    sweep(&b, 0);
    memories_keep_words_apart(&b);
    one_word_is_whole(&b);
    many_are_answered_in_order(&b, 100);
    all_units_are_one(&b);
    lists_count_their_objects(&b);
    nonsense_does_not_start(&b);
    who_is_seen_is_visited_each_step(&b);
    a_start_forgets_the_run_before(&b);
    a_running_machine_guards_its_memories(&b);
    an_end_is_kept_until_it_is_seen(&b);
    a_failure_is_kept_until_it_is_seen(&b);
    what_is_left_out_is_illegal(&b);
    sweep(&b, 0);
    ops->close(b.rtl);
    a_quick_master_streams(config, ops, &b);
    *transfers += b.transfers;
    return b.failed;
}

int main(int argc, char **argv) {
    unsigned failed = 0;
    uint64_t transfers = 0;
    for (uint32_t i = 0; i < fp3_config_count; i++) {
        if (argc > 1 && strcmp(argv[1], fp3_configs[i].name) != 0)
            continue;
        fp3_hardware hardware;
        fp3_error error;
        if (fp3_hardware_load(fp3_configs[i].name, &hardware, &error)) {
            printf("%s\n", error.text);
            return 1;
        }
        failed += check(&fp3_configs[i], hardware.ops, argc > 1 ? 2000 : 6000, &transfers);
        fp3_hardware_unload(&hardware);
    }
    printf("%" PRIu64 " transfers, %u failed\n", transfers, failed);
    return failed != 0;
}
