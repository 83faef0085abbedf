/* SPDX-License-Identifier: Apache-2.0 */
/* allocate.h - registers for an order of issue.
 *
 * A block of n instructions has gaps: gap 0 before the first one, gap p + 1 behind instruction p.
 * A value holds a register in the gaps between its instruction and its last reader. In the step
 * part gap n is gap 0 of the next step, and a value that is computed ahead goes across it.
 */
#ifndef FP3_ALLOCATE_H
#define FP3_ALLOCATE_H

#include "block.h"
#include "lines.h"

typedef struct {
    uint32_t *reg;      /* of the value of each node */
    uint32_t registers; /* highest in use + 1, variables and params included */
} fp3_places;

/* Above this many registers the allocator stops counting: places->registers is at most this, and
 * reg is then of no use. */
#define FP3_REGISTERS_CEILING (2 * 64)

/* order[p] is the node at position p; nodes[].is_ahead says which belong to the next step. Values
 * with a fixed register stay to the end. Borrows registers of variables only if necessary, so that
 * a name stands for its value where possible. places->registers shows whether the program fits the
 * configuration. FP3_E_MISMATCH: the order keeps no values. */
fp3_status fp3_allocate_within(const fp3_block *block, const uint32_t *order, fp3_places *places,
                               fp3_error *error);
void fp3_places_free(fp3_places *places);

/* FP3_E_LIMIT, in words: so many registers are needed, more than there are. */
fp3_status fp3_allocate_refuse(const fp3_block *block, uint32_t needed, fp3_error *error);

/* Fewer registers than this will not do for the order: values that are there at the same time. */
fp3_status fp3_allocate_least(const fp3_block *block, const uint32_t *order, uint32_t *registers,
                              fp3_error *error);

/* The same as instructions. The caller frees. */
fp3_status fp3_places_lines(const fp3_block *block, const uint32_t *order, const fp3_places *places,
                            fp3_line **lines, fp3_error *error);

#endif
