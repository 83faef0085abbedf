/* SPDX-License-Identifier: Apache-2.0 */
/* phased.h - cycles of a program in which objects see each other: its phases, its loops over
 * neighbours.
 *
 * A phase is a round. All contexts of a batch go through a loop as often as the longest of their
 * lists is long, so the cycles follow from the program, the lists and isa/timing.toml:
 * tests/cosim/foreseen.h holds those of a run to the hardware's.
 */
#ifndef FP3_PHASED_H
#define FP3_PHASED_H

#include "config.h"
#include "operation.h"

#include <stdint.h>

/* The words of a step. */
typedef struct {
    const fp3_decoded *code;
    uint32_t count;
} fp3_phased;

/* What a phase costs, beyond what its batches and turns say. With FULL contexts or more in each
 * batch, and no batch whose lists are all empty, a phase takes objects * (object + sum over loops:
 * turns * turn) + batches * loops * loop + around. */
typedef struct {
    uint32_t begin, end;    /* its words; `end` is that of its `phase`, or of the program */
    uint32_t object, loops; /* cycles; how many loops there are */
    uint32_t loop, around, full;
} fp3_phase_cost;

/* Of the phase that begins at this word. */
fp3_phase_cost fp3_phase_cost_of(const fp3_config *config, const fp3_phased *program,
                                 uint32_t begin);
/* Of the loop that begins with the word `each`: cycles of a turn, for each object. */
uint32_t fp3_turn_cost_of(const fp3_phased *program, uint32_t each);

/* Who makes a step. */
typedef struct {
    uint32_t rows;   /* objects of the fullest lane */
    uint32_t copies; /* from lane to lane before each phase ... */
    uint32_t words;  /* ... of so many published words */
    /* The longest of the lists of register reg that the objects in these rows have, in whichever
     * lane. Asked in the order in which batches come to their loops. */
    uint32_t (*longest)(const void *user, uint32_t reg, uint32_t first, uint32_t rows);
    /* At each `hold` that a step comes to: whether an object has raised in the phase that ends
     * there. NULL: the program has none. */
    int (*raised)(const void *user);
    const void *user;
} fp3_phased_run;

/* Of a step, exactly. */
uint64_t fp3_phased_cycles(const fp3_config *config, const fp3_phased *program,
                           const fp3_phased_run *run);

#endif
