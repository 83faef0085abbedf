/* SPDX-License-Identifier: Apache-2.0 */
/* write_words.h - words and names of the C that a program becomes: for write.c and write_around.c.
 *
 * Names in the text: r5_2 is register 5 of the vector 2 of those side by side, k3 a shared
 * constant.
 */
#ifndef FP3_FAST_WRITE_WORDS_H
#define FP3_FAST_WRITE_WORDS_H

#include "plan.h"

#include <stdio.h>

typedef struct {
    const fp3_fast_plan *plan;
    FILE *to;
    fp3_fast_part_number part;
    unsigned beside; /* vectors */
} fp3_writer;

/* All registers that the program names. */
uint64_t fp3_write_registers(const fp3_fast_plan *plan);
void fp3_write_operand(const fp3_writer *w, uint32_t number, unsigned vector);
void fp3_write_constants(const fp3_writer *w);
/* Unread results must be computed, too, for their flags: this tells the compiler that they are
 * read. */
void fp3_write_keep(const fp3_writer *w, uint32_t reg, unsigned vector);
/* Behind a store: a later one may overwrite the word, and then the store alone does not keep what
 * it stored. */
void fp3_write_stored(const fp3_writer *w, uint32_t reg, unsigned vector);
void fp3_write_arithmetic(const fp3_writer *w, const fp3_fast_word *p, unsigned vector);
/* A word that adds to what a loop keeps, and adds -0 where the mask is 0. */
void fp3_write_fold(const fp3_writer *w, const fp3_fast_word *p, unsigned vector, const char *mask);

#endif
