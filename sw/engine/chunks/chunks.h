/* SPDX-License-Identifier: Apache-2.0 */
/* chunks.h - objects that see each other by links, more than the store of hardware with a port to
 * memory holds: what its memory has to be, and the list of transfers that makes the steps.
 *
 *     fp3_chunks *chunks = NULL;
 *     if (fp3_chunks_make(engine, config, 0x40000000, 100, &chunks, &error))
 *         return ...
 *     ... chunks->memory goes to byte address chunks->at; the hardware makes the list that begins
 *         at chunks->list (fp3_bare_move_list) ...
 *     fp3_chunks_read(chunks, memory, reg, words);
 *     fp3_chunks_free(&chunks);
 *
 * Of a phase a chunk loads the words of its objects, their lists, and the words that others publish
 * to them; it runs, and what it publishes goes to the other of two places, so each chunk reads what
 * held when the phase began. What one object alone has is in a single place. docs/memory.md has the
 * words of a step. Each start clears `flags`, so after the list it tells of the last chunk's phase
 * alone. The last transfer enables the interrupt, whose `ended` the last run has set: `irq` rises
 * when all steps are made, if it was disabled before. After an error of the list it does not.
 */
#ifndef FP3_CHUNKS_H
#define FP3_CHUNKS_H

#include "numbers.h"
#include "pieces.h"

/* Registers that follow each other, as they are numbered now, and are moved alike; in memory those
 * of an object stand together, by place. */
typedef struct {
    uint32_t reg, count;
    int is_published, is_stored, is_seen; /* seen: ghosts have them */
    uint32_t at[2];                       /* words of memory; the second place only if published */
} fp3_chunks_run;

#define FP3_CHUNKS_RUNS 4 /* published, seen, stored, and what is only loaded */

typedef struct {
    uint32_t *memory;
    uint32_t words;
    uint32_t at, list; /* byte addresses */
    fp3_pieces cut;    /* a piece is a chunk */
    fp3_chunks_numbers numbers;
    uint32_t log2; /* of the words of a record */
    uint32_t run_count;
    fp3_chunks_run runs[FP3_CHUNKS_RUNS];
    int is_second; /* published words are in the second place when all steps are made */
    /* Of a step: words to the processor, descriptors not counted; words to memory; descriptors. */
    uint64_t in, out, descriptors;
} fp3_chunks;

/* The engine has a program and objects, which stay as they are; `config` says the hardware, of
 * which the chunks are as few as fit. steps: at least 1. FP3_E_PROGRAM: chunks cannot do what the
 * objects need, or one alone has no room; FP3_E_ARGUMENT: the hardware has no port or no
 * neighbours, computes otherwise, or memory would go beyond 32 bits of address; FP3_E_SYSTEM: out
 * of memory. */
fp3_status fp3_chunks_make(fp3_engine *engine, const fp3_config *config, uint32_t at,
                           uint32_t steps, fp3_chunks **chunks, fp3_error *error);
/* *chunks may be NULL, and is NULL then. */
void fp3_chunks_free(fp3_chunks **chunks);

/* A word of each object, of memory as it is after the steps. 0: no step changes it, and no chunk
 * needs it: it is what the engine has. */
int fp3_chunks_read(const fp3_chunks *chunks, const uint32_t *memory, uint32_t reg,
                    uint32_t *words);

#endif
