/* SPDX-License-Identifier: Apache-2.0 */
/* moves.c - fp3_bare_moves.h on simulated hardware with a memory.
 *
 *     moves LIBRARY SEED     prints "v s" of each ship, as bits: the program, its constants and the
 *                            ships came from memory, and went back there
 *
 * ship.h is made by the test. */
#include "fp3_bare_moves.h"

#include "ship.h"

#include "fp3_rtl.h"
#include <dlfcn.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SHIPS 30u
#define STEPS 3u
#define POLLS 10000000u
/* Words of memory; where things are in it, as words. */
#define WORDS 4096u
#define SHIPS_AT 1021u /* the ships go over a multiple of 4 KB */
#define BACK_AT 2045u

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
    uint32_t *memory;
    uint64_t transfers;
} board;

static int read_word(void *user, uint32_t address, uint32_t *word) {
    board *b = user;
    b->transfers++;
    return fp3_rtl_transfer_one(b->ops, b->rtl, 0, address, word);
}

static int write_word(void *user, uint32_t address, uint32_t word) {
    board *b = user;
    b->transfers++;
    return fp3_rtl_transfer_one(b->ops, b->rtl, 1, address, &word);
}

static fp3_status move(fp3_bare *fp3, fp3_bare_direction direction, uint32_t word, uint32_t address,
                       uint32_t words, int stays, fp3_bare_moved *how) {
    const fp3_bare_move m = {direction, 4 * word, 0, address, words, stays};
    const fp3_status status = fp3_bare_move_start(fp3, &m);
    return status ? status : fp3_bare_move_wait(fp3, POLLS, how);
}

static uint32_t object(const fp3_bare *fp3, uint32_t word) {
    return FP3_ADDRESS_IN(fp3->space_bit, FP3_SPACE_OBJECTS, word);
}

static void load(fp3_bare *fp3, board *b) {
    fp3_bare_moved how;
    uint32_t fault;
    const fp3_bare_program *p = &ship_program;
    const uint32_t nothing[] = {0};
    fp3_bare_program empty = ship_program;
    empty.words = nothing;
    empty.word_count = empty.last = 1;
    empty.step = 0;
    /* The shape by the driver; then the true words and constants from memory. */
    EXPECT(!fp3_bare_load(fp3, FP3_ALL, &empty));
    EXPECT(!fp3_bare_register(fp3, 0, FP3_ADDR_SIZE, &fault) && fault == 1);
    memcpy(b->memory, p->words, 4 * p->word_count);
    EXPECT(!move(fp3, FP3_BARE_TO_PROCESSOR, 0, FP3_ADDR_WINDOW_PROGRAM, p->word_count, 0, &how));
    EXPECT(how == FP3_BARE_MOVED);
    EXPECT(!write_word(b, FP3_ADDR_SIZE, p->word_count) && !write_word(b, FP3_ADDR_LAST, p->last));
    EXPECT(!write_word(b, FP3_ADDR_STEP, p->step));
    for (uint32_t i = 0; i < p->shared; i++)
        b->memory[i] = i == ship_shared_h ? fp3_bare_bits(0.0078125f) : 0;
    for (uint32_t i = 0; i < p->constant_count; i++)
        b->memory[p->constants[i].index] = p->constants[i].bits;
    EXPECT(!move(fp3, FP3_BARE_TO_PROCESSOR, 0, FP3_ADDR_WINDOW_CONSTANTS, p->shared, 0, &how));
    /* Numbers for the list of those that are awake, all to one place. */
    for (uint32_t i = 0; i < SHIPS; i++)
        b->memory[i] = i;
    EXPECT(!fp3_bare_list(fp3, 0, 0));
    EXPECT(!move(fp3, FP3_BARE_TO_PROCESSOR, 0, FP3_ADDR_WINDOW_WAKE, SHIPS, 1, &how));
}

static void fly(fp3_bare *fp3, board *b) {
    fp3_bare_outcome outcome;
    fp3_bare_moved how = FP3_BARE_MOVING;
    const uint32_t record = 1u << ship_program.record;
    for (uint32_t i = 0; i < SHIPS; i++) {
        uint32_t *words = b->memory + SHIPS_AT + i * record;
        words[ship_state_v] = fp3_bare_bits((float)i);
        words[ship_param_T] = fp3_bare_bits(2.9e5f);
        words[ship_param_C] = fp3_bare_bits(4.1e4f);
        words[ship_param_rm] = fp3_bare_bits(1 / 8.7e5f);
    }
    EXPECT(!fp3_bare_move_rows(fp3, FP3_BARE_TO_PROCESSOR, 0, 0, 0, SHIPS, 4 * SHIPS_AT));
    EXPECT(!fp3_bare_move_wait(fp3, POLLS, &how) && how == FP3_BARE_MOVED);
    EXPECT(!fp3_bare_start(fp3, 0, STEPS, 0, 0) && !fp3_bare_wait(fp3, 0, POLLS, &outcome));
    EXPECT(outcome == FP3_BARE_DONE);
    b->memory[BACK_AT - 1] = b->memory[BACK_AT + SHIPS * record] = 77;
    EXPECT(!fp3_bare_move_rows(fp3, FP3_BARE_TO_MEMORY, 0, 0, 0, SHIPS, 4 * BACK_AT));
    EXPECT(!fp3_bare_move_wait(fp3, POLLS, &how));
    EXPECT(b->memory[BACK_AT - 1] == 77 && b->memory[BACK_AT + SHIPS * record] == 77);
    for (uint32_t i = 0; i < SHIPS; i++)
        for (uint32_t r = 0; r < record; r++) {
            uint32_t word;
            EXPECT(!fp3_bare_read(fp3, 0, i, r, &word));
            EXPECT(word == b->memory[BACK_AT + i * record + r]);
        }
}

/* What the driver knows to be impossible costs no transfer. */
static void refuse_nonsense(fp3_bare *fp3, board *b) {
    const fp3_bare_move right = {FP3_BARE_TO_PROCESSOR, 0, 0, object(fp3, 0), 8, 0};
    const uint64_t transfers = b->transfers;
    const uint32_t rows = fp3->store >> ship_program.record;
    fp3_bare_moved how;
    fp3_bare_move m;
#define REFUSE(change)                                                                             \
    do {                                                                                           \
        m = right;                                                                                 \
        change;                                                                                    \
        EXPECT(fp3_bare_move_start(fp3, &m) == FP3_E_ARGUMENT);                                    \
    } while (0)
    REFUSE(m.memory = 2);
    REFUSE(m.address += 2);
    REFUSE(m.words = 1u << 24);
    REFUSE(m.scheduler = 1);
    REFUSE(m.address = 4u << fp3->space_bit);
    EXPECT(fp3_bare_move_rows(fp3, FP3_BARE_TO_MEMORY, 0, 0, 1, rows, 0) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_move_rows(fp3, FP3_BARE_TO_MEMORY, 0, 1, 0, 1, 0) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_move_rows(fp3, FP3_BARE_TO_MEMORY, 1, 0, 0, 1, 0) == FP3_E_ARGUMENT);
    fp3->features_more &= ~(1u << FP3_FEATURES_MORE_MASTER_LO);
    REFUSE(m.words = 8);
    EXPECT(fp3_bare_move_poll(fp3, &how) == FP3_E_ARGUMENT);
    fp3->features_more |= 1u << FP3_FEATURES_MORE_MASTER_LO;
    EXPECT(b->transfers == transfers);
}

/* Errors of both sides end a move, say where, and the next one works. */
static void meet_errors(fp3_bare *fp3, board *b) {
    fp3_bare_moved how;
    fp3_bare_outcome outcome;
    /* The end of all addresses, and a space that nothing has here. */
    const uint32_t end = 4u << fp3->space_bit;
    const uint32_t nowhere = FP3_ADDRESS_IN(fp3->space_bit, FP3_SPACE_COPIES, 0);
    static uint32_t before[WORDS];
    EXPECT(move(fp3, FP3_BARE_TO_PROCESSOR, WORDS - 2, object(fp3, 0), 8, 0, &how) == FP3_E_SYSTEM);
    EXPECT(how == FP3_BARE_MEMORY_ERROR && fp3->failed_at == 4 * WORDS);
    EXPECT(move(fp3, FP3_BARE_TO_MEMORY, WORDS - 2, object(fp3, 0), 8, 0, &how) == FP3_E_SYSTEM);
    EXPECT(how == FP3_BARE_MEMORY_ERROR && fp3->failed_at == 4 * WORDS); /* a burst of its own */
    EXPECT(move(fp3, FP3_BARE_TO_PROCESSOR, 0, end - 8, 8, 0, &how) == FP3_E_SYSTEM);
    EXPECT(how == FP3_BARE_REFUSED && fp3->failed_at == end);
    memcpy(before, b->memory, sizeof before);
    EXPECT(move(fp3, FP3_BARE_TO_MEMORY, 5, nowhere, 300, 0, &how) == FP3_E_SYSTEM);
    EXPECT(how == FP3_BARE_REFUSED && fp3->failed_at == nowhere);
    EXPECT(!memcmp(before, b->memory, sizeof before));
    /* A run has its memories for itself; the driver that did not start it learns it this way. */
    EXPECT(!fp3_bare_start(fp3, 0, UINT32_MAX, 0, 0));
    EXPECT(move(fp3, FP3_BARE_TO_PROCESSOR, 0, object(fp3, 0), 8, 0, &how) == FP3_E_ARGUMENT);
    fp3->running[0] = 0;
    EXPECT(move(fp3, FP3_BARE_TO_PROCESSOR, 0, object(fp3, 8), 8, 0, &how) == FP3_E_SYSTEM);
    EXPECT(how == FP3_BARE_REFUSED && fp3->failed_at == object(fp3, 8));
    fp3->running[0] = 1;
    EXPECT(!fp3_bare_stop(fp3, 0) && !fp3_bare_wait(fp3, 0, POLLS, &outcome));
    EXPECT(!move(fp3, FP3_BARE_TO_PROCESSOR, 0, object(fp3, 0), 0, 0, &how));
    EXPECT(!move(fp3, FP3_BARE_TO_PROCESSOR, 0, object(fp3, 0), 8, 0, &how));
    /* One at a time. */
    const fp3_bare_move m = {FP3_BARE_TO_MEMORY, 0, 0, object(fp3, 0), 1000, 0};
    EXPECT(!fp3_bare_move_start(fp3, &m) && fp3_bare_move_start(fp3, &m) == FP3_E_SYSTEM);
    EXPECT(fp3->failed_at == FP3_ADDR_TRANSFER_MEMORY);
    EXPECT(fp3_bare_move_wait(fp3, 1, &how) == FP3_E_LIMIT && how == FP3_BARE_MOVING);
    EXPECT(!fp3_bare_move_wait(fp3, POLLS, &how));
}

int main(int argc, char **argv) {
    EXPECT(argc == 3);
    void *library = dlopen(argv[1], RTLD_NOW);
    board b = {.ops = library ? dlsym(library, "fp3_rtl_table") : NULL};
    EXPECT(b.ops);
    const fp3_rtl_watch watch = {NULL, NULL, NULL};
    const fp3_rtl_memory shape = {WORDS, 1000, 9};
    EXPECT(b.rtl = b.ops->open(&watch, strtoull(argv[2], NULL, 10)));
    EXPECT(b.memory = b.ops->memory(b.rtl, &shape));
    const fp3_bare_bus bus = {read_word, write_word, &b};
    fp3_bare fp3;
    EXPECT(!fp3_bare_open(&fp3, &bus));
    load(&fp3, &b);
    fly(&fp3, &b);
    for (uint32_t i = 0; i < SHIPS; i++) {
        const uint32_t *words = b.memory + BACK_AT + (i << ship_program.record);
        printf("%08" PRIx32 " %08" PRIx32 "\n", words[ship_state_v], words[ship_state_s]);
    }
    refuse_nonsense(&fp3, &b);
    meet_errors(&fp3, &b);
    b.ops->close(b.rtl);
    return 0;
}
