/* SPDX-License-Identifier: Apache-2.0 */
/* made.h - objects in chunks: what memory has to be, and what stands where in it. */
#ifndef FP3_CHUNKS_MADE_H
#define FP3_CHUNKS_MADE_H

#include "numbers.h"
#include "pieces.h"

/* Registers that follow each other, as they are numbered now, and are moved alike; in memory those
 * of an object stand together, by place. */
typedef struct {
    uint32_t reg, count;
    int is_published, is_stored, is_seen; /* seen: ghosts have them */
    uint32_t at[2];                       /* words of memory; the second place only if published */
} fp3_chunks_run;

#define FP3_CHUNKS_RUNS 5 /* published, seen, stored, only loaded, and of that a near list */

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

#endif
