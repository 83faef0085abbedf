/* SPDX-License-Identifier: Apache-2.0 */
/* numbers.h - registers of a program numbered so that records are as short as can be.
 *
 * A word of a record has its register's number. The compiler gives numbers as registers come to be
 * needed, so what an object keeps may have high ones, and its record be mostly empty.
 */
#ifndef FP3_CHUNKS_NUMBERS_H
#define FP3_CHUNKS_NUMBERS_H

#include "engine/common/inside.h"

typedef struct {
    uint8_t now[FP3_BANK_OBJECT_COUNT];    /* of each register, its number */
    uint8_t before[FP3_BANK_OBJECT_COUNT]; /* the inverse */
    uint32_t moved;                        /* those below this number are kept by objects */
    uint32_t published;                    /* ... those below this one are published */
} fp3_chunks_numbers;

/* What is moved alike has numbers that follow each other: what neighbours read and steps store;
 * what neighbours read; what is stored; what is loaded; of what is loaded, those of `apart`, a bit
 * for each. */
void fp3_chunks_number(const fp3_members *group, uint64_t apart, fp3_chunks_numbers *numbers);

/* A word of the program, which is an instruction, with these numbers. */
uint32_t fp3_chunks_renamed(const fp3_chunks_numbers *numbers, const fp3_decoded *word);

#endif
