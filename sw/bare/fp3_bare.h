/* SPDX-License-Identifier: Apache-2.0 */
/* fp3_bare.h - runs FP3 from a processor of your own.
 *
 *     static const fp3_bare_bus bus = {read_word, write_word, NULL};
 *     fp3_bare fp3;
 *     fp3_bare_outcome outcome;
 *     if (fp3_bare_open(&fp3, &bus) || fp3_bare_load(&fp3, FP3_ALL, &ship_program) || ... ||
 *         fp3_bare_list(&fp3, FP3_ALL, 24) || fp3_bare_start(&fp3, FP3_ALL, 1000, 0, 0) ||
 *         fp3_bare_wait(&fp3, FP3_ALL, POLLS, &outcome))
 *         ... fp3.failed_at is the address that was refused, if one was ...
 *
 * Freestanding C11: no libc, no libfp3, no memory of its own. It consists of this file, fp3_bare.c,
 * gen/registers.h (docs/registers.md) and fp3/status.h, image.h and isa.h; `make install` puts them
 * below share/fp3/bare. `fp3 dis IMAGE --header FILE` writes a program for it. docs/integration.md
 * shows a whole host.
 *
 * A call that would be refused by the hardware, because a program runs or because there is no such
 * thing, is refused here with FP3_E_ARGUMENT and without a transfer: on many platforms an answer
 * SLVERR is a trap. FP3_E_SYSTEM: the bus answered a transfer with an error; failed_at says which.
 * What was written before that stays written.
 *
 * A handle is for one thread, and the only driver of its hardware.
 */
#ifndef FP3_BARE_H
#define FP3_BARE_H

#include "gen/registers.h"
#include <fp3/status.h>
#include <stdint.h>

FP3_API_BEGIN

/* How words go over the bus: address is a byte address of docs/registers.md, a multiple of 4. 0:
 * done; anything else: answered with an error, or not at all. Transfers must take place in the
 * order of the calls, one word each. */
typedef struct {
    int (*read)(void *user, uint32_t address, uint32_t *word);
    int (*write)(void *user, uint32_t address, uint32_t word);
    void *user;
} fp3_bare_bus;

/* A bus that is memory from base on. The memory must be uncached and in order; what an error does
 * there is the platform's business. The driver must not outlive *bus of open, nor that the memory.
 */
fp3_bare_bus fp3_bare_memory(volatile uint32_t *base);

typedef struct {
    uint32_t index; /* of the shared constant */
    uint32_t bits;  /* of its FP32 value */
} fp3_bare_constant;

/* Of a program whose objects see each other (docs/relations.md): a list that each object has ... */
typedef struct {
    uint32_t reg;    /* of the object: the list's place and length */
    uint32_t fields; /* words of an entry behind the neighbour */
} fp3_bare_shape;

/* ... and the phases of a step, one after the other. */
typedef struct {
    uint32_t first, end; /* words first .. end - 1 */
} fp3_bare_phase;

/* As `fp3 dis --header` writes it. The loads and stores around a visit of an object are the first
 * and last words; a machine without an object store gets the words between them. */
typedef struct {
    const uint32_t *words;
    uint32_t word_count, loads, stores;
    uint32_t step, last; /* as the registers of these names, loads included */
    const fp3_bare_constant *constants;
    uint32_t constant_count;
    uint32_t registers, shared; /* that it uses: the highest index + 1 */
    uint32_t record;            /* the binary logarithm of the words of an object, 3 to 6 */
    uint32_t revision;          /* of the instruction set */
    uint32_t arithmetic;        /* that it is compiled for: fp3_image.words (fp3/image.h) */
    /* Where objects see each other; else 0. */
    const fp3_bare_shape *lists;
    const fp3_bare_phase *phases;
    uint32_t list_count, phase_count;
    uint32_t published[2]; /* bit r % 32 of r / 32: neighbours read register r, and phases store it
                            */
} fp3_bare_program;

/* All schedulers. Elsewhere a number from 0 on. */
#define FP3_ALL ((uint32_t)FP3_ADDRESS_BROADCAST)
#define FP3_BARE_SCHEDULERS 64

/* Read it, never change it. */
typedef struct {
    fp3_bare_bus bus;
    uint32_t schedulers, lanes;   /* lanes of each scheduler */
    uint32_t registers, contexts; /* of each object; of each lane */
    uint32_t program_words,
        store;              /* store: words of each lane, 0: one object, which is its registers */
    uint32_t space_bit;     /* of an address: the lowest that says the space */
    uint32_t features;      /* the register of this name */
    uint32_t features_more; /* likewise, 0 where the hardware has none */
    uint32_t failed_at;     /* the address of the last transfer that failed */
    const fp3_bare_program *around; /* the program that is loaded, if its objects see each other */
    uint32_t room;    /* words of each lane's store for objects; behind them are lists */
    uint32_t half;    /* the word of the store from which on published registers are: 0, or half */
    uint32_t missing; /* bit i: list i of `around` is not there, so nothing starts */
    uint8_t revision;
    uint8_t record[FP3_BARE_SCHEDULERS];  /* of the program that is loaded; 0: none */
    uint8_t running[FP3_BARE_SCHEDULERS]; /* since start, until poll or wait says that it ended */
} fp3_bare;

typedef enum {
    FP3_BARE_NONE,    /* no run since reset */
    FP3_BARE_RUNNING, /* of FP3_ALL: at least one */
    FP3_BARE_DONE,    /* all steps; of FP3_ALL: by all that ran */
    FP3_BARE_STOPPED, /* by fp3_bare_stop */
    FP3_BARE_ILLEGAL  /* at an instruction that this hardware does not have: register `fault` */
} fp3_bare_outcome;

/* Finds out what stands behind the bus, and which schedulers run. Copies *bus.
 * FP3_E_MISMATCH: it is no FP3, or one with an older map of addresses. */
fp3_status fp3_bare_open(fp3_bare *fp3, const fp3_bare_bus *bus);

/* Words, shape and constants of a program. FP3_E_MISMATCH: it is of another revision of the
 * instruction set, or compiled for another arithmetic (docs/arithmetic.md), or the hardware's
 * words are logarithms or numbers of fewer fraction bits, which constants would have to be
 * converted to. FP3_E_PROGRAM: there is no room for it; or its objects see each other, and the
 * hardware has no neighbours, or several lanes. The objects then have no values, and the lists are
 * empty. A program whose objects see each other must outlive its runs; fp3_bare_neighbours.h has
 * what else it needs. */
fp3_status fp3_bare_load(fp3_bare *fp3, uint32_t scheduler, const fp3_bare_program *program);
/* A constant that the program leaves to the host, as h. */
fp3_status fp3_bare_write_shared(fp3_bare *fp3, uint32_t scheduler, uint32_t index, uint32_t bits);

/* Objects have numbers from 0 on, through the lanes of the scheduler, or of all schedulers: object
 * i is in lane i % lanes, row i / lanes. The program must be loaded. reg: below 1 << record. */
fp3_status fp3_bare_write(fp3_bare *fp3, uint32_t scheduler, uint32_t object, uint32_t reg,
                          uint32_t bits);
fp3_status fp3_bare_read(fp3_bare *fp3, uint32_t scheduler, uint32_t object, uint32_t reg,
                         uint32_t *bits);
/* Exceptions that an object raised since the host wrote 0, and the step of the first invalid or
 * overflow; where FP3_FEATURES_STATUS. */
fp3_status fp3_bare_write_status(fp3_bare *fp3, uint32_t scheduler, uint32_t object, uint32_t word);
fp3_status fp3_bare_read_status(fp3_bare *fp3, uint32_t scheduler, uint32_t object, uint32_t *word);

/* Runs visit the objects 0 to count - 1 from now on, all awake; those of one that sleeps are not
 * visited until it is listed again, or woken. */
fp3_status fp3_bare_list(fp3_bare *fp3, uint32_t scheduler, uint32_t count);
/* Appends an object that fell asleep to its lane's list; the host wrote 0 into the register of
 * `sleep` before. One that is in the list already would be there twice; FP3_E_ARGUMENT: the list is
 * full of such. Where FP3_FEATURES_SLEEP. */
fp3_status fp3_bare_wake(fp3_bare *fp3, uint32_t scheduler, uint32_t object);

/* A run of this number of steps. visit: steps per visit, 0: all. clock: steps made before this run.
 * One object has no use for these two. visit must be 1 where objects see each other. A program that
 * counts its steps in FP32 counts to 2^24: the caller keeps count. */
fp3_status fp3_bare_start(fp3_bare *fp3, uint32_t scheduler, uint32_t steps, uint32_t visit,
                          uint32_t clock);
/* Reads the status once; or until no scheduler runs, polls times at most. FP3_E_LIMIT: one still
 * runs. */
fp3_status fp3_bare_poll(fp3_bare *fp3, uint32_t scheduler, fp3_bare_outcome *outcome);
fp3_status fp3_bare_wait(fp3_bare *fp3, uint32_t scheduler, uint32_t polls,
                         fp3_bare_outcome *outcome);
/* Ends a run early; wait for it. All that is in flight retires first. */
fp3_status fp3_bare_stop(fp3_bare *fp3, uint32_t scheduler);
/* What raises the interrupt: 0, or these added. A failure is an overflow or an invalid operation,
 * by any object, in the middle of a run or not; FP3_ADDR_FLAGS says which, and fp3_bare_read_status
 * of which object. */
enum { FP3_BARE_ON_END = 1, FP3_BARE_ON_FAILURE = 2 };
/* Takes the interrupt back, and says what raises the next one. Before start. */
fp3_status fp3_bare_interrupt(fp3_bare *fp3, uint32_t scheduler, unsigned events);
/* What a handler of the interrupt calls: takes it back and reads the status. It switches
 * FP3_BARE_ON_FAILURE off, because a run that goes on failing would raise the interrupt again at
 * once. To hear of the next failure, call fp3_bare_interrupt afterwards. The first scheduler that
 * ends raises the interrupt. While *outcome is FP3_BARE_RUNNING, the end of another one raises it
 * again. Once no scheduler runs, FP3_BARE_ON_END is off, too: call fp3_bare_interrupt before the
 * next start. */
fp3_status fp3_bare_handle(fp3_bare *fp3, uint32_t scheduler, fp3_bare_outcome *outcome);

/* A register by its address, FP3_ADDR_FLAGS, FP3_ADDR_FAULT or FP3_ADDR_PENDING; of FP3_ALL the OR.
 */
fp3_status fp3_bare_register(fp3_bare *fp3, uint32_t scheduler, uint32_t address, uint32_t *word);
/* A counter by its address, FP3_ADDR_COUNTER_CYCLES, of one scheduler; also while it runs.
 * FP3_E_ARGUMENT: the configuration has no counters. */
fp3_status fp3_bare_counter(fp3_bare *fp3, uint32_t scheduler, uint32_t address, uint64_t *count);

/* The bits of a number, and the number of bits. */
uint32_t fp3_bare_bits(float number);
float fp3_bare_number(uint32_t bits);

FP3_API_END

#endif
