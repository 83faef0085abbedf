/* SPDX-License-Identifier: Apache-2.0 */
/* read_ahead.h - words of objects and of their status that were read with others: a serial line
 * takes about as long for 1 word as for 8, and the engine asks for single ones.
 */
#ifndef FP3_READ_AHEAD_H
#define FP3_READ_AHEAD_H

#include <fp3/status.h>
#include <stdint.h>

#define FP3_READ_AHEAD_WORDS 64

typedef struct fp3_read_ahead fp3_read_ahead;

/* Reads FP3_READ_AHEAD_WORDS words from address on; *count: how many there are. */
typedef fp3_status fp3_read_ahead_read_fn(void *user, uint32_t address,
                                          uint32_t words[FP3_READ_AHEAD_WORDS], uint32_t *count);

/* space_bit: of the configuration. NULL: out of memory. */
fp3_read_ahead *fp3_read_ahead_make(uint32_t space_bit, fp3_read_ahead_read_fn *read, void *user);
void fp3_read_ahead_free(fp3_read_ahead *ahead);

/* Whether words at this address change by writes and runs alone, so that they may be read ahead. */
int fp3_read_ahead_has(uint32_t space_bit, uint32_t address);
/* *is_there: 0: the bus refuses the address. */
fp3_status fp3_read_ahead_get(fp3_read_ahead *ahead, uint32_t address, uint32_t *word,
                              int *is_there);
/* A write to this address: forgets what it changes, or all if it may have started a run. */
void fp3_read_ahead_forget(fp3_read_ahead *ahead, uint32_t address, uint32_t count);

#endif
