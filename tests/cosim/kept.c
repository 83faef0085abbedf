/* kept.c - lists that the hardware makes: `keep`, `raise` and `hold` on the simulated hardware of
 * a configuration that has them, against a model of the store.
 *
 *     kept [SEED [PROGRAMS [CONFIG]]]     CONFIG: world_keep if none is said
 *
 * Programs by chance: phases that make lists from a list of others, which all objects share or have
 * a part of, and are in themselves; checks that raise a flag, or not; phases that go through the
 * lists; phases made several times. Lists end with the last word of the store, have just enough
 * room, one entry too few, or much. Every word of the store, the flags, the half with the published
 * words, the outcome, whether an object has raised, and the cycles must be the model's. With a port
 * to memory each run is started by a list of transfers, which then goes on by what `status` is; all
 * channels of both buses wait by chance. With `overlap` two runs of three work on a part of the
 * store alone, wherever lists point, and the host accesses words of both parts meanwhile: those of
 * the part at work are refused, and no cycle of the run changes.
 */
#include "chance.h"

#include "base/fpu.h"
#include "gen/registers.h"
#include "gen/timing.h"
#include <engine/board/hardware.h>
#include <fp3/isa.h>
#include <inttypes.h>
#include <machine/cycles.h>
#include <machine/execute.h>
#include <machine/neighbours.h>
#include <machine/phased.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    OBJECTS_MAX = 60,
    WORDS_MAX = 400,
    LOG2 = 3, /* of a record's words */
    ROOM_K = 5,
    LIMIT_K = 6,
    CONSTANTS = 8,
    STORE_MAX = 16384,
    EVENTS_MAX = 40000,
    STEPS = 3
};

/* Words of a record: two that neighbours read, the lists' words, and two of its own. */
enum { PLACE, SPEED, MADE, OTHERS, LINKS, OWN, SPARE, RECORD, TEMP = 8 };
enum { PUBLISHED = 1u << PLACE | 1u << SPEED };
/* Which list a loop goes through. */
enum { LENGTH_ONE = 1 << FP3_OBJECTS_LENGTH_LO, NO_ROOM = 0xfff };

typedef struct {
    const fp3_rtl_ops *ops;
    const fp3_config *config;
    fp3_rtl *rtl;
    uint32_t *memory; /* NULL: the configuration has no port to one */
    chance c;
    unsigned failed;
    uint32_t objects, steps;
    fp3_decoded code[WORDS_MAX];
    uint32_t count;
    uint32_t constants[CONSTANTS];
    int is_part; /* the run works on a part of the store: the lower or the upper half of each half
                  */
    uint32_t is_upper;
    unsigned moved, refused; /* accesses of the host within runs */
    /* The model's */
    uint32_t store[STORE_MAX], flags, half, status; /* the store is 0 when the hardware opens */
    uint32_t registers[FP3_BANK_OBJECT_COUNT];      /* of the object that is at work */
    /* What happened, in the order in which the hardware comes to it */
    uint32_t longest[EVENTS_MAX], longest_count, longest_seen;
    char raised[EVENTS_MAX];
    uint32_t raised_count, raised_seen;
    unsigned made, overfull, left_out; /* phases that made lists; ended the run; were left out */
    unsigned told;                     /* runs that say that an object has raised */
} bench;

static void fail(bench *b, const char *what, uint32_t where, uint32_t got, uint32_t expected) {
    if (b->failed++ < 10)
        printf("FAIL: %s %" PRIu32 ": got 0x%" PRIx32 ", expected 0x%" PRIx32 "\n", what, where,
               got, expected);
}

/* ---- the model ---- */

static uint32_t part_bit(const bench *b) { return b->config->store_words / 4; }

/* Where a run finds a word. */
static uint32_t spot(const bench *b, uint32_t word) {
    return b->is_part ? (word & ~part_bit(b)) | b->is_upper * part_bit(b) : word;
}

static uint32_t *word_of(bench *b, uint32_t row, uint32_t reg, uint32_t half) {
    const int is_upper = PUBLISHED >> reg & 1 && half;
    const uint32_t word = (row << LOG2) + reg + (is_upper ? b->config->store_words / 2 : 0);
    return &b->store[spot(b, word)];
}

static uint32_t neighbour(const bench *b, uint32_t place) { return b->store[spot(b, place)]; }

static uint32_t operand(const bench *b, uint32_t number) {
    return number >= FP3_BANK_SHARED_BASE ? b->constants[number - FP3_BANK_SHARED_BASE]
                                          : b->registers[number];
}

typedef struct {
    uint32_t row, loop, turn, turns, at, loops; /* loop: index of `each`; at: the list's place */
    int is_inside, is_raised, is_overfull;
    uint32_t flags;
} visit;

/* Of a turn: its entry is another object. */
static int is_other(const bench *b, const visit *v) {
    return neighbour(b, v->at + v->turn) != v->row;
}

static void keep(bench *b, visit *v, const fp3_instruction *in) {
    uint32_t *list = &b->registers[in->d], other = neighbour(b, v->at + v->turn);
    uint32_t length = v->turn ? *list >> FP3_OBJECTS_LENGTH_LO : 0;
    const uint32_t place = *list & (LENGTH_ONE - 1), room = operand(b, in->b) & 0xfff;
    if (is_other(b, v) && operand(b, in->a) >> 31) {
        v->is_overfull |= length >= room;
        if (length < room)
            b->store[spot(b, place + length)] = other;
        length = length < room ? length + 1 : NO_ROOM;
    }
    *list = place | length << FP3_OBJECTS_LENGTH_LO;
}

static void compute(bench *b, visit *v, const fp3_decoded *word) {
    const fp3_instruction *in = &word->in;
    uint32_t operands[3] = {operand(b, in->a), operand(b, in->b), operand(b, in->c)}, flags;
    if (word->of->gives == FP3_GIVES_WORD)
        fp3_operation_place(word->of, operands[0],
                            *word_of(b, neighbour(b, v->at + v->turn), in->b, b->half),
                            &operands[0], &operands[1]);
    b->registers[in->d] =
        fp3_execute(b->config, word->of->computes ? word->of->computes : in->op, operands, &flags);
    v->flags |= flags;
}

/* A word of a phase, for one object. lengths: of the lists of its loops. */
static uint32_t execute(bench *b, visit *v, uint32_t pc, uint32_t *lengths) {
    const fp3_instruction *in = &b->code[pc].in;
    const int is_in_loop = v->turn < v->turns;
    if (is_in_loop && !is_other(b, v) && in->op != FP3_OP_NEXT && in->op != FP3_OP_KEEP)
        return pc + 1;
    switch (in->op) {
    case FP3_OP_EACH:
        v->turns = b->registers[in->d] >> FP3_OBJECTS_LENGTH_LO;
        v->at = b->registers[in->d] & (LENGTH_ONE - 1);
        v->turn = 0;
        v->loop = pc;
        lengths[v->loops++] = v->turns;
        while (!v->turns && b->code[pc].in.op != FP3_OP_NEXT)
            pc++;
        break;
    case FP3_OP_NEXT:
        if (++v->turn < v->turns)
            pc = v->loop;
        break;
    case FP3_OP_LD:
        b->registers[in->d] = *word_of(b, v->row, in->d, b->half);
        break;
    case FP3_OP_ST:
        *word_of(b, v->row, in->d, !b->half) = b->registers[in->d];
        break;
    case FP3_OP_KEEP:
        keep(b, v, in);
        break;
    case FP3_OP_RAISE:
        v->is_raised |= b->registers[in->d] >> 31 != 0;
        break;
    default:
        compute(b, v, &b->code[pc]);
    }
    return pc + 1;
}

static void note_longest(bench *b, const uint32_t lengths[OBJECTS_MAX][8], uint32_t loops) {
    for (uint32_t first = 0; first < b->objects; first += b->config->contexts)
        for (uint32_t l = 0; l < loops; l++) {
            uint32_t most = 0;
            for (uint32_t i = first; i < b->objects && i < first + b->config->contexts; i++)
                most = lengths[i][l] > most ? lengths[i][l] : most;
            b->longest[b->longest_count++] = most;
        }
}

/* Returns where the next phase begins; *is_over: a list had no room. */
static uint32_t make_phase(bench *b, uint32_t begin, fp3_repetition *repetition, int *is_over) {
    static uint32_t lengths[OBJECTS_MAX][8];
    uint32_t end = begin, loops = 0, flags = 0;
    int is_raised = 0;
    while (end < b->count && !fp3_ends_phase(&b->code[end])) {
        loops += b->code[end].in.op == FP3_OP_EACH;
        b->made += b->code[end++].in.op == FP3_OP_KEEP;
    }
    for (uint32_t row = 0; row < b->objects; row++) {
        visit v = {.row = row};
        for (uint32_t pc = begin; pc < end;)
            pc = execute(b, &v, pc, lengths[row]);
        flags |= v.flags;
        is_raised |= v.is_raised;
        *is_over |= v.is_overfull;
    }
    note_longest(b, (const uint32_t(*)[8])lengths, loops);
    b->status |= (uint32_t)is_raised << FP3_STATUS_RAISED_LO;
    if (end == b->count || b->code[end].in.op != FP3_OP_HOLD) {
        b->flags |= flags;
        b->half = !b->half;
        return end == b->count ? end : fp3_neighbourhood_behind(b->code, end, repetition);
    }
    b->raised[b->raised_count++] = (char)is_raised;
    b->left_out += !is_raised && b->code[end].in.d;
    return end + 1 + (is_raised ? 0 : b->code[end].in.d);
}

static void run_model(bench *b) {
    const uint64_t callers = fp3_fpu_begin(b->config->nearest);
    int is_over = 0;
    b->flags = b->status = 0;
    b->longest_count = b->longest_seen = b->raised_count = b->raised_seen = 0;
    for (uint32_t step = 0; step < b->steps && !is_over; step++) {
        fp3_repetition repetition = {0, 0};
        for (uint32_t pc = 0; pc < b->count && !is_over;)
            pc = make_phase(b, pc, &repetition, &is_over);
    }
    b->status |= 1u << (is_over ? FP3_STATUS_NO_ROOM_LO : FP3_STATUS_DONE_LO);
    b->overfull += is_over != 0;
    b->told += b->status >> FP3_STATUS_RAISED_LO & 1;
    fp3_fpu_set(callers);
}

static uint32_t next_longest(const void *user, uint32_t reg, uint32_t first, uint32_t rows) {
    bench *b = (bench *)(uintptr_t)user;
    (void)reg, (void)first, (void)rows;
    return b->longest[b->longest_seen++];
}

static int next_raised(const void *user) {
    bench *b = (bench *)(uintptr_t)user;
    return b->raised[b->raised_seen++];
}

static uint64_t cycles_of(bench *b) {
    const fp3_phased program = {b->code, b->count};
    const fp3_phased_run run = {
        .rows = b->objects, .longest = next_longest, .raised = next_raised, .user = b};
    uint64_t cycles = fp3_cycles_settle(b->config) + FP3_TIMING_RUN;
    for (uint32_t step = 0; step < b->steps; step++)
        cycles += fp3_phased_cycles(b->config, &program, &run);
    return cycles;
}

/* ---- the hardware ---- */

static fp3_rtl_word words[STORE_MAX + WORDS_MAX + 64];
static size_t queued;

static void put(uint32_t address, uint32_t data) {
    words[queued++] = (fp3_rtl_word){address, data, 1, 0};
}

static void transfer(bench *b) {
    if (b->ops->transfer(b->rtl, words, queued))
        fail(b, "a transfer", (uint32_t)queued, 1, 0);
    for (size_t i = 0; i < queued; i++)
        if (words[i].is_refused)
            fail(b, "refused, address", words[i].address, 1, 0);
}

static uint32_t get(bench *b, uint32_t address) {
    words[0] = (fp3_rtl_word){address, 0, 0, 0};
    queued = 1;
    transfer(b);
    queued = 0;
    return words[0].data;
}

static uint32_t in_store(const bench *b, uint32_t word) {
    return FP3_SPACE_OBJECTS << b->config->space_bit | word << 2;
}

/* Whether this program has something there; other words are what programs before have left. */
static int is_named(const bench *b, uint32_t word) {
    const uint32_t n = b->objects, half = b->config->store_words / 2;
    return word < (n << LOG2) + n * n || (word >= half && word < half + (n << LOG2) + 2 * n) ||
           word >= 2 * half - n * n;
}

static int is_used(const bench *b, uint32_t word) {
    if (!b->is_part)
        return is_named(b, word);
    return spot(b, word) == word &&
           (is_named(b, word & ~part_bit(b)) || is_named(b, word | part_bit(b)));
}

/* A list of transfers starts the run, and keeps its status where it goes on by it: nobody has
 * raised; somebody has; the run had another end. */
enum { STARTS, ASKS, ENDS, RAISED, TELLS, BACK, FULL, FULL_BACK, LIST, KEPT = 256 };

static void start_by_list(bench *b) {
    const uint32_t done = 1u << FP3_STATUS_DONE_LO, raised = done | 1u << FP3_STATUS_RAISED_LO;
    const uint32_t load = 1u << FP3_TRANSFER_CONTROL_LOAD_LO;
    const uint32_t store = 1u << FP3_TRANSFER_CONTROL_STORE_LO;
    const uint32_t asks =
        1u << FP3_TRANSFER_CONTROL_WAIT_LO | 1u << FP3_TRANSFER_CONTROL_OTHERWISE_LO;
    /* What stands for a descriptor's number or a word's is an address below. */
    const uint32_t list[LIST][4] = {
        [STARTS] = {KEPT, FP3_ADDR_CONTROL, 1, load},
        [ASKS] = {4 * RAISED, FP3_ADDR_STATUS, done, asks},
        [ENDS] = {KEPT + 1, FP3_ADDR_STATUS, 1, store | 1u << FP3_TRANSFER_CONTROL_LAST_LO},
        [RAISED] = {4 * FULL, FP3_ADDR_STATUS, raised, asks},
        [TELLS] = {KEPT + 2, FP3_ADDR_STATUS, 1, store},
        [BACK] = {4 * ENDS, FP3_ADDR_STATUS, 0, asks},
        [FULL] = {KEPT + 3, FP3_ADDR_STATUS, 1, store},
        [FULL_BACK] = {4 * ENDS, FP3_ADDR_STATUS, 0, asks}};
    for (uint32_t i = 0; i < 4 * LIST; i++)
        b->memory[i] = list[i / 4][i % 4] << (i % 4 ? 0 : 2);
    b->memory[KEPT] = 1u << FP3_CONTROL_START_LO | (uint32_t)b->is_part << FP3_CONTROL_PART_LO |
                      b->is_upper << FP3_CONTROL_UPPER_LO;
    memset(b->memory + KEPT + 1, 0, 3 * sizeof *b->memory);
    put(FP3_ADDR_TRANSFER_MEMORY, 0);
    put(FP3_ADDR_TRANSFER_CONTROL, 1u << FP3_TRANSFER_CONTROL_LIST_LO);
}

/* After the model's run, which says how the list has gone on. */
static void compare_list(bench *b) {
    const uint32_t done = 1u << FP3_STATUS_DONE_LO, raised = done | 1u << FP3_STATUS_RAISED_LO;
    const int is_raised = b->status == raised, is_other = !is_raised && b->status != done;
    const uint32_t kept[] = {b->status, is_raised ? b->status : 0, is_other ? b->status : 0};
    const uint32_t ended = get(b, FP3_ADDR_TRANSFER_STATUS);
    if (ended != 1u << FP3_TRANSFER_STATUS_DONE_LO)
        fail(b, "the list's end", b->objects, ended, 1u << FP3_TRANSFER_STATUS_DONE_LO);
    for (uint32_t i = 0; i < 3; i++)
        if (b->memory[KEPT + 1 + i] != kept[i])
            fail(b, "what the list has kept", i, b->memory[KEPT + 1 + i], kept[i]);
    if (get(b, FP3_ADDR_TRANSFER_NEXT) != 16 * (ENDS + 1))
        fail(b, "transfer_next", b->objects, get(b, FP3_ADDR_TRANSFER_NEXT), 16 * (ENDS + 1));
}

static int is_running(bench *b) { return get(b, FP3_ADDR_STATUS) >> FP3_STATUS_RUNNING_LO & 1; }

/* One access within a run, of a word that the program does not have. */
static fp3_rtl_word access_within(bench *b, uint32_t *word) {
    chance *c = &b->c;
    do
        *word = below(c, b->config->store_words);
    while (is_used(b, *word));
    words[0] = (fp3_rtl_word){in_store(b, *word), below(c, 1u << 30), below(c, 2), 0};
    const fp3_rtl_word asked = words[0];
    if (b->ops->transfer(b->rtl, words, 1))
        fail(b, "an access within a run", *word, 1, 0);
    if (!words[0].is_refused && asked.is_write)
        b->store[*word] = asked.data;
    else if (!words[0].is_refused && words[0].data != b->store[*word])
        fail(b, "read within a run, word", *word, words[0].data, b->store[*word]);
    return words[0];
}

/* The host does what it may and what it may not. */
static void disturb(bench *b) {
    uint32_t word = 0;
    for (uint32_t i = 0; i < 300 && !is_running(b); i++)
        ;
    for (uint32_t i = 0; i < 100 && is_running(b); i++) {
        const fp3_rtl_word done = access_within(b, &word);
        const int is_aside = b->is_part && spot(b, word) != word;
        if (is_aside && done.is_refused)
            fail(b, "refused within a run, word", word, 1, 0);
        if (!is_aside && !done.is_refused && is_running(b))
            fail(b, "not refused within a run, word", word, 0, 1);
        b->moved += is_aside;
        b->refused += done.is_refused;
    }
}

static void run_hardware(bench *b) {
    const uint32_t settings[][2] = {{FP3_ADDR_RECORD, LOG2},   {FP3_ADDR_WINDOW_AWAKE, b->objects},
                                    {FP3_ADDR_STEP, 0},        {FP3_ADDR_LAST, b->count},
                                    {FP3_ADDR_SIZE, b->count}, {FP3_ADDR_PUBLISHED, PUBLISHED},
                                    {FP3_ADDR_HALF, b->half},  {FP3_ADDR_VISIT, 1},
                                    {FP3_ADDR_STEPS, b->steps}};
    queued = 0;
    for (uint32_t i = 0; i < b->count; i++)
        put(FP3_ADDR_WINDOW_PROGRAM + 4 * i, fp3_word_encode(&b->code[i].in));
    for (uint32_t i = 0; i < CONSTANTS; i++)
        put(FP3_ADDR_WINDOW_CONSTANTS + 4 * i, b->constants[i]);
    for (uint32_t i = 0; i < b->config->store_words; i++)
        if (is_used(b, i))
            put(in_store(b, i), b->store[i]);
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++)
        put(settings[i][0], settings[i][1]);
    if (b->memory)
        start_by_list(b);
    else
        put(FP3_ADDR_CONTROL, 1u << FP3_CONTROL_START_LO);
    transfer(b);
    if (b->config->overlap)
        disturb(b);
    do
        b->ops->clock(b->rtl, 10000000, 200);
    while (b->memory && get(b, FP3_ADDR_TRANSFER_STATUS) & 1u << FP3_TRANSFER_STATUS_RUNNING_LO);
}

/* Now and then of the whole store. */
static void compare(bench *b, int is_all) {
    const uint32_t status = get(b, FP3_ADDR_STATUS), flags = get(b, FP3_ADDR_FLAGS);
    const uint32_t cycles = get(b, FP3_ADDR_COUNTER_CYCLES), half = get(b, FP3_ADDR_HALF);
    for (uint32_t i = queued = 0; i < b->config->store_words; i++)
        if (is_all || is_used(b, i))
            words[queued++] = (fp3_rtl_word){in_store(b, i), 0, 0, 0};
    transfer(b);
    for (uint32_t i = 0, k = 0; i < b->config->store_words; i++)
        if (is_all || is_used(b, i)) {
            if (words[k].data != b->store[i])
                fail(b, "word", i, words[k].data, b->store[i]);
            k++;
        }
    if (status != b->status)
        fail(b, "status", b->objects, status, b->status);
    if (flags != b->flags)
        fail(b, "flags", b->objects, flags, b->flags);
    if (half != b->half)
        fail(b, "half", b->objects, half, b->half);
    const int is_over = b->status >> FP3_STATUS_NO_ROOM_LO & 1;
    const uint32_t foreseen = is_over ? cycles : (uint32_t)cycles_of(b);
    if (cycles != foreseen)
        fail(b, "cycles", b->objects, cycles, foreseen);
}

/* ---- programs ---- */

static void put_word(bench *b, uint32_t op, uint32_t d, uint32_t a, uint32_t b_, uint32_t c) {
    b->code[b->count++] = (fp3_decoded){fp3_operation_find(op), {op, d, a, b_, c}};
}

static void load(bench *b) {
    for (uint32_t reg = 0; reg < RECORD; reg++)
        put_word(b, FP3_OP_LD, reg, 0, 0, 0);
}

static uint32_t constant(chance *c) { return FP3_BANK_SHARED_BASE + below(c, 5); }

/* Arithmetic with temporary registers, all of which have been computed. */
static void compute_some(bench *b, int is_inside) {
    static const uint32_t own[] = {FP3_OP_ADD, FP3_OP_SUB, FP3_OP_MUL, FP3_OP_MIN, FP3_OP_MADD};
    static const uint32_t given[] = {FP3_OP_ADDN, FP3_OP_SUBN, FP3_OP_RSBN, FP3_OP_MULN};
    chance *c = &b->c;
    for (uint32_t i = below(c, 4); i > 0; i--) {
        const uint32_t d = TEMP + below(c, 3), a = below(c, 2) ? TEMP + below(c, 3) : OWN;
        if (is_inside && below(c, 2))
            put_word(b, given[below(c, 4)], d, a, below(c, 2), 0);
        else {
            const uint32_t op = own[below(c, 5)];
            put_word(b, op, d, a, constant(c), op == FP3_OP_MADD ? TEMP + below(c, 3) : 0);
        }
    }
}

static void begin_phase(bench *b) {
    load(b);
    put_word(b, FP3_OP_ADD, TEMP, PLACE, constant(&b->c), 0);
    put_word(b, FP3_OP_ADD, TEMP + 1, SPEED, OWN, 0);
    put_word(b, FP3_OP_MUL, TEMP + 2, SPARE, constant(&b->c), 0);
}

/* Makes a list of those that are not farther than a limit, or not, or of whom chance finds. */
static void make_lists(bench *b) {
    chance *c = &b->c;
    const uint32_t begin = b->count, what = below(c, 4);
    begin_phase(b);
    put_word(b, FP3_OP_EACH, OTHERS, 0, 0, 0);
    put_word(b, FP3_OP_SUBN, TEMP, PLACE, PLACE, 0);
    put_word(b, FP3_OP_ABS, TEMP, TEMP, 0, 0);
    compute_some(b, 1);
    if (what)
        put_word(b, FP3_OP_SUB, TEMP + 1, TEMP, FP3_BANK_SHARED_BASE + LIMIT_K, 0);
    if (below(c, 4) == 0)
        put_word(b, FP3_OP_RAISE, TEMP + 1, 0, 0, 0);
    put_word(b, FP3_OP_KEEP, MADE, TEMP + 1, FP3_BANK_SHARED_BASE + ROOM_K, 0);
    if (below(c, 2))
        compute_some(b, 1);
    put_word(b, FP3_OP_NEXT, 0, 0, 0, 0);
    put_word(b, FP3_OP_ST, MADE, 0, 0, 0);
    if (below(c, 2)) {
        put_word(b, FP3_OP_ADD, SPARE, TEMP, FP3_BANK_SHARED_BASE, 0);
        put_word(b, FP3_OP_ST, SPARE, 0, 0, 0);
    }
    put_word(b, FP3_OP_HOLD, 0, 0, 0, 0);
    if (b->count - begin >= b->config->registers)
        b->count = begin; /* `hold` counts no more */
}

/* Raises a flag if an object is far from where it was, or if somebody it sees is, and has lists
 * made then. */
static void check_and_make(bench *b) {
    chance *c = &b->c;
    begin_phase(b);
    put_word(b, FP3_OP_SUB, TEMP, PLACE, SPARE, 0);
    put_word(b, FP3_OP_ABS, TEMP, TEMP, 0, 0);
    put_word(b, FP3_OP_SUB, TEMP, FP3_BANK_SHARED_BASE + below(c, 5), TEMP, 0);
    if (below(c, 3) == 0) {
        put_word(b, FP3_OP_EACH, below(c, 2) ? MADE : LINKS, 0, 0, 0);
        compute_some(b, 1);
        put_word(b, FP3_OP_SUB, TEMP, TEMP, FP3_BANK_SHARED_BASE + LIMIT_K, 0);
        put_word(b, FP3_OP_RAISE, TEMP, 0, 0, 0);
        put_word(b, FP3_OP_NEXT, 0, 0, 0, 0);
        put_word(b, FP3_OP_SUB, TEMP, SPARE, constant(c), 0);
    }
    put_word(b, FP3_OP_RAISE, TEMP, 0, 0, 0);
    const uint32_t at = b->count;
    put_word(b, FP3_OP_HOLD, 0, 0, 0, 0);
    make_lists(b);
    b->code[at].in.d = b->count - at - 1;
}

/* Goes through lists, and moves. */
static void step(bench *b) {
    chance *c = &b->c;
    begin_phase(b);
    for (uint32_t i = below(c, 3); i > 0; i--) {
        put_word(b, FP3_OP_EACH, below(c, 3) ? MADE : LINKS, 0, 0, 0);
        compute_some(b, 1);
        put_word(b, FP3_OP_ADDN, OWN, OWN, PLACE, 0);
        put_word(b, FP3_OP_NEXT, 0, 0, 0, 0);
    }
    compute_some(b, 0);
    put_word(b, FP3_OP_MUL, OWN, OWN, FP3_BANK_SHARED_BASE, 0);
    put_word(b, FP3_OP_ADD, PLACE, PLACE, FP3_BANK_SHARED_BASE + below(c, 3), 0);
    if (below(c, 2))
        put_word(b, FP3_OP_ADD, SPEED, TEMP + 1, FP3_BANK_SHARED_BASE + 1, 0);
    put_word(b, FP3_OP_ST, PLACE, 0, 0, 0);
    put_word(b, FP3_OP_ST, SPEED, 0, 0, 0);
    put_word(b, FP3_OP_ST, OWN, 0, 0, 0);
    if (below(c, 4) == 0) /* also behind the last `hold` */
        put_word(b, FP3_OP_RAISE, TEMP, 0, 0, 0);
}

static void write_program(bench *b) {
    chance *c = &b->c;
    b->count = 0;
    for (uint32_t n = 1 + below(c, 3); n > 0; n--) {
        const int is_repeated = below(c, 4) == 0;
        if (is_repeated) {
            step(b);
            put_word(b, FP3_OP_REPEAT, 1 + below(c, 3), 0, 0, 0);
        }
        if (below(c, 3))
            check_and_make(b);
        else if (below(c, 2))
            make_lists(b);
        step(b);
        if (is_repeated)
            put_word(b, FP3_OP_AGAIN, 0, 0, 0, 0);
        else if (n > 1)
            put_word(b, FP3_OP_PHASE, 0, 0, 0, 0);
    }
}

/* ---- objects ---- */

static uint32_t bits(float value) {
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    return word;
}

static float some(chance *c) { return (float)below(c, 64) / 16; }

/* Rooms for lists are side by side, as far up in the store as they may be, or behind the records;
 * the shared list of others is where there is room. */
static void write_objects(bench *b) {
    chance *c = &b->c;
    const uint32_t n = b->objects, half = b->config->store_words / 2;
    const uint32_t rooms[] = {n, n - 1, n / 2, 4};
    const uint32_t room = rooms[below(c, 4)], is_high = below(c, 2);
    const uint32_t lists = is_high ? 2 * half - n * room : n << LOG2;
    const uint32_t others = half + (n << LOG2), links = others + n;
    for (uint32_t i = 0; i < b->config->store_words; i++)
        b->store[i] = is_used(b, i) ? 0 : b->store[i];
    for (uint32_t k = 0; k < CONSTANTS; k++)
        b->constants[k] = bits(some(c) / 4);
    b->constants[0] = bits(0.125f);
    b->constants[ROOM_K] = room | (below(c, 2) ? 0xabcde000u : 0); /* the low 12 bits count */
    b->constants[LIMIT_K] = below(c, 8) ? bits(some(c)) : below(c, 2) ? FP3_BITS_NAN : bits(100);
    b->half = below(c, 2);
    const int is_in_part = below(c, 3) == 0;
    for (uint32_t i = 0; i < n; i++) {
        b->store[spot(b, others + i)] = i;
        b->store[spot(b, links + i)] = (i + 1) % n;
        for (uint32_t reg = 0; reg < RECORD; reg++)
            *word_of(b, i, reg, b->half) = bits(some(c));
        if (below(c, 16) == 0)
            *word_of(b, i, PLACE, b->half) = below(c, 2) ? FP3_BITS_NAN : 0x7f800000;
        const uint32_t seen = is_in_part ? below(c, n + 1) : n;
        *word_of(b, i, MADE, 0) = lists + i * room;
        *word_of(b, i, OTHERS, 0) = others | seen << FP3_OBJECTS_LENGTH_LO;
        *word_of(b, i, LINKS, 0) = (links + i) | below(c, 2) << FP3_OBJECTS_LENGTH_LO;
        if (seen) /* what the length was does not count */
            *word_of(b, i, MADE, 0) |= below(c, 4096) << FP3_OBJECTS_LENGTH_LO;
    }
}

/* A program goes through lists before any has been made, so they are empty then. */
static void clear_lists(bench *b) {
    for (uint32_t pc = 0; pc < b->count; pc++) {
        if (b->code[pc].in.op == FP3_OP_KEEP)
            return;
        if (b->code[pc].in.op == FP3_OP_EACH && b->code[pc].in.d == MADE)
            break;
        if (b->code[pc].in.op == FP3_OP_HOLD && b->code[pc].in.d)
            break;
    }
    for (uint32_t i = 0; i < b->objects; i++)
        *word_of(b, i, MADE, 0) &= LENGTH_ONE - 1;
}

int main(int argc, char **argv) {
    static bench b;
    static const uint32_t counts[] = {1, 2, 7, 23, 24, 25, 48, 53};
    const uint32_t programs = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 0) : 60;
    fp3_hardware hardware;
    fp3_error error;
    b.config = fp3_config_find(argc > 3 ? argv[3] : "world_keep");
    b.c.state = argc > 1 ? strtoull(argv[1], NULL, 0) : 1;
    if (fp3_hardware_load(b.config->name, &hardware, &error)) {
        printf("FAIL: %s\n", error.text);
        return 1;
    }
    b.ops = hardware.ops;
    b.rtl = b.ops->open(&(fp3_rtl_watch){0}, b.config->master ? b.c.state : 0);
    if (b.rtl && b.config->master)
        b.memory = b.ops->memory(b.rtl, &(fp3_rtl_memory){KEPT + 4, 1000, 20});
    for (uint32_t i = 0; b.rtl && i < programs && b.failed < 10; i++) {
        b.objects = counts[below(&b.c, 8)];
        b.steps = 1 + below(&b.c, STEPS);
        b.is_part = b.config->overlap && below(&b.c, 3);
        b.is_upper = b.is_part && below(&b.c, 2);
        write_program(&b);
        write_objects(&b);
        clear_lists(&b);
        run_hardware(&b);
        run_model(&b);
        compare(&b, i % 16 == 15);
        if (b.memory)
            compare_list(&b);
    }
    if (b.rtl)
        b.ops->close(b.rtl);
    fp3_hardware_unload(&hardware);
    if (b.config->overlap)
        printf("%u moved, %u refused within runs; ", b.moved, b.refused);
    printf("%" PRIu32
           " programs, %u lists made, %u without room, %u left out, %u raised, %u failed\n",
           programs, b.made, b.overfull, b.left_out, b.told, b.failed + !b.rtl);
    return b.failed || !b.rtl;
}
