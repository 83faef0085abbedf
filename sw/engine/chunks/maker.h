/* SPDX-License-Identifier: Apache-2.0 */
/* maker.h - what is being made of objects in chunks: memory, lists, transfers. */
#ifndef FP3_CHUNKS_MAKER_H
#define FP3_CHUNKS_MAKER_H

#include "made.h"

#include "engine/board/near_code.h"
#include "engine/cluster/places.h"

#define FP3_CHUNKS_PARTS 3 /* of what a chunk has of the store, that lists stand in */

/* Words of memory from `at` on, which go to words of the store. */
typedef struct {
    uint32_t at, to, count;
} fp3_chunk_words;

typedef struct {
    fp3_chunk_words lists[FP3_CHUNKS_PARTS]; /* of a chunk's objects, in a step */
    fp3_chunk_words wide[FP3_CHUNKS_PARTS];  /* wide ones besides, when near lists are made */
    uint32_t awake;
} fp3_chunk_data;

/* In memory: words; registers step, last, size; registers published, published_more. */
typedef struct {
    uint32_t at, words, shape, published;
    int is_near; /* it goes through the list of near objects */
} fp3_chunks_program;

/* A list of near objects, made by the hardware of a wide one, which has everybody who may come near
 * before the list of transfers ends. Wide ones are the only ones that the host makes. */
typedef struct {
    const fp3_list *list; /* NULL: there is none */
    fp3_near_rule rule;   /* the list's */
    fp3_positions places;
    uint32_t *begin, *other; /* of the wide lists */
    uint32_t *lengths;       /* of the lists as they are now */
    double roam;             /* how far an object may go from where it is now */
    uint32_t room;           /* entries of a list at most */
    fp3_near_names names;
    uint32_t constant; /* the first of those that nothing else has */
    /* Words of memory, of each place: where the object was when its list was made, and when the
     * wide one was; the word of its wide list. */
    uint32_t made, stood, wide;
    uint32_t rows, rest; /* ... numbers of objects: of a half of the store, and of what is left */
    fp3_chunks_program check, renew, roamed;
} fp3_chunks_near;

typedef struct {
    fp3_engine *engine;
    const fp3_members *group;
    const fp3_config *config;
    fp3_chunks *chunks;
    fp3_lists lists; /* the group's, but for the near ones: the wide ones */
    fp3_chunks_near near;
    uint32_t room; /* words that chunks->memory could have */
    int is_full;   /* of host memory, or of addresses */
    fp3_chunk_data *data;
    fp3_chunks_program *phases;
    uint32_t phase_count, half, enable;
    /* A chunk has the store, or one of two parts of it, of each half the lower or the upper half.
     * Then the next one comes, and the last one goes, while one runs. */
    uint32_t parts;
    uint32_t start[2];            /* ... of a run there */
    uint32_t base;                /* ... the first word of the part that is moved now */
    uint32_t constants, settings; /* words of memory: what the list loads once */
    int counts;                   /* descriptors are those of the first step */
    fp3_error *error;
} fp3_chunks_maker;

/* Of so many words that follow, which one is the first. Their addresses have 32 bits. NULL: they
 * are 0. */
uint32_t fp3_chunks_put(fp3_chunks_maker *m, const uint32_t *words, uint32_t count);
/* published: registers, as numbered now. */
void fp3_chunks_put_program(fp3_chunks_maker *m, const uint32_t *words, uint32_t count,
                            uint64_t published, fp3_chunks_program *program);
/* Of the store's words: where the upper half begins; how many of either half a chunk has. */
uint32_t fp3_chunks_upper(const fp3_chunks_maker *m);
uint32_t fp3_chunks_room(const fp3_chunks_maker *m);
/* By the number that a register has now. NULL: it is not moved. */
const fp3_chunks_run *fp3_chunks_run_of(const fp3_chunks *chunks, uint32_t number);

#endif
