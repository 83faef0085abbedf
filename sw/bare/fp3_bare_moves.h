/* SPDX-License-Identifier: Apache-2.0 */
/* fp3_bare_moves.h - moves words between memory and an FP3 with a port to memory, in bursts.
 *
 *     const fp3_bare_move load = {FP3_BARE_TO_PROCESSOR, 0x40000000, 0,
 *                                 FP3_ADDR_WINDOW_PROGRAM, ship_program.word_count, 0};
 *     fp3_bare_moved how;
 *     if (fp3_bare_move_start(&fp3, &load) || fp3_bare_move_wait(&fp3, POLLS, &how))
 *         ... how says what went wrong, fp3.failed_at where ...
 *
 * Freestanding, beside fp3_bare.h. docs/memory.md says what the hardware does. Addresses of memory
 * are those that the port sees; caches that hold these words are the caller's business: clean them
 * before a move to the processor, invalidate them after one to memory.
 */
#ifndef FP3_BARE_MOVES_H
#define FP3_BARE_MOVES_H

#include "fp3_bare.h"

FP3_API_BEGIN

typedef enum { FP3_BARE_TO_PROCESSOR, FP3_BARE_TO_MEMORY } fp3_bare_direction;

typedef struct {
    fp3_bare_direction direction;
    uint32_t memory;    /* byte address, a multiple of 4 */
    uint32_t scheduler; /* or FP3_ALL: a move to the processor goes to all of them */
    uint32_t address;   /* within it, of docs/registers.md: FP3_ADDR_WINDOW_PROGRAM,
                           FP3_ADDRESS_IN(fp3.space_bit, FP3_SPACE_OBJECTS, word) */
    uint32_t words;     /* below 2^24 */
    int stays;          /* all of them to or from this address, as FP3_ADDR_WINDOW_WAKE wants it */
} fp3_bare_move;

typedef enum {
    FP3_BARE_MOVING,
    FP3_BARE_MOVED,        /* all words */
    FP3_BARE_MEMORY_ERROR, /* memory answered with an error: failed_at is the address of the word,
                              or of the burst that was to be written */
    FP3_BARE_REFUSED       /* the processor did: failed_at is the address on its bus */
} fp3_bare_moved;

/* FP3_E_ARGUMENT: the hardware has no port, the scheduler runs or is not there, or an address or
 * the number of words is not possible. One move at a time: FP3_E_SYSTEM if there is one. What is
 * moved does not change what the driver knows of programs: after a program came in this way, call
 * fp3_bare_load anyway, or write its registers. */
fp3_status fp3_bare_move_start(fp3_bare *fp3, const fp3_bare_move *move);
/* Rows row to row + rows - 1 of a lane, whole records. The program must be loaded. FP3_E_ARGUMENT
 * also while what objects publish is in the upper half of the store (fp3.half): not in their
 * records. */
fp3_status fp3_bare_move_rows(fp3_bare *fp3, fp3_bare_direction direction, uint32_t scheduler,
                              uint32_t lane, uint32_t row, uint32_t rows, uint32_t memory);
/* A list of transfers in memory, which begins at this address (docs/memory.md). Runs that it starts
 * are its own: this driver knows of none, and the caller starts none meanwhile. A list of
 * sw/engine/chunks ends with an interrupt, if fp3_bare_interrupt has switched it off before; to
 * take it back, switch it off again. FP3_E_ARGUMENT: a scheduler runs. */
fp3_status fp3_bare_move_list(fp3_bare *fp3, uint32_t memory);
/* Reads the status once; or until nothing moves, polls times at most: FP3_E_LIMIT: it still does.
 * FP3_E_SYSTEM: *how says of which side, failed_at where. */
fp3_status fp3_bare_move_poll(fp3_bare *fp3, fp3_bare_moved *how);
fp3_status fp3_bare_move_wait(fp3_bare *fp3, uint32_t polls, fp3_bare_moved *how);

FP3_API_END

#endif
