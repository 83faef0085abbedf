/* SPDX-License-Identifier: Apache-2.0 */
/* read_ahead.c - see read_ahead.h. */
#include "read_ahead.h"

#include "gen/registers.h"
#include <stdlib.h>
#include <string.h>

#define BLOCK_BYTES (4u * FP3_READ_AHEAD_WORDS)
#define BLOCKS 4096u /* the store of 16,384 objects has 2,048 */

typedef struct {
    uint32_t address, count; /* count 0: nothing is known */
    uint32_t words[FP3_READ_AHEAD_WORDS];
} block;

struct fp3_read_ahead {
    fp3_read_ahead_read_fn *read;
    void *user;
    uint32_t space_bit;
    block blocks[BLOCKS];
};

fp3_read_ahead *fp3_read_ahead_make(uint32_t space_bit, fp3_read_ahead_read_fn *read, void *user) {
    fp3_read_ahead *ahead = calloc(1, sizeof *ahead);
    if (ahead) {
        ahead->read = read;
        ahead->user = user;
        ahead->space_bit = space_bit;
    }
    return ahead;
}

void fp3_read_ahead_free(fp3_read_ahead *ahead) { free(ahead); }

int fp3_read_ahead_has(uint32_t space_bit, uint32_t address) {
    const uint32_t space = address >> space_bit & 3;
    return space == FP3_SPACE_OBJECTS || space == FP3_SPACE_STATUS;
}

/* Where a block is kept, if it is: schedulers and spaces are spread over all places. */
static block *place_of(fp3_read_ahead *ahead, uint32_t address) {
    const uint32_t number = address / BLOCK_BYTES;
    return &ahead->blocks[(number * 2654435761u) >> 20];
}

fp3_status fp3_read_ahead_get(fp3_read_ahead *ahead, uint32_t address, uint32_t *word,
                              int *is_there) {
    const uint32_t first = address - address % BLOCK_BYTES, at = (address - first) / 4;
    block *b = place_of(ahead, first);
    fp3_status status = FP3_OK;
    if (!b->count || b->address != first) {
        b->address = first;
        b->count = 0;
        status = ahead->read(ahead->user, first, b->words, &b->count);
    }
    *is_there = at < b->count;
    if (!status && *is_there)
        *word = b->words[at];
    return status;
}

void fp3_read_ahead_forget(fp3_read_ahead *ahead, uint32_t address, uint32_t count) {
    const uint32_t first = address - address % BLOCK_BYTES;
    if (!fp3_read_ahead_has(ahead->space_bit, address))
        for (uint32_t i = 0; i < BLOCKS; i++)
            ahead->blocks[i].count = 0;
    else
        for (uint32_t at = first; at < address + 4 * count; at += BLOCK_BYTES)
            place_of(ahead, at)->count = 0;
}
