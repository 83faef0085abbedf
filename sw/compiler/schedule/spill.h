/* SPDX-License-Identifier: Apache-2.0 */
/* spill.h - registers for a part whose values do not fit, with loads and stores in between.
 *
 * An object's record has a word for each register. So there is room for a second value: one value
 * is in the word and the other in the register. A value is stored and loaded in one register, and
 * moves to another one by a copy. Variables and params own a register and its word; between two
 * steps each is in one of the two.
 */
#ifndef FP3_SPILL_H
#define FP3_SPILL_H

#include "block.h"
#include "lines.h"

/* Sets of registers with owners: where these are before a part and after it. */
typedef struct {
    uint64_t in, valid;  /* in the register; in the word (or in both) */
    uint64_t out, saved; /* likewise, after it */
    int is_open; /* 1: out and saved do not matter; what is left is of use for another step */
} fp3_spill_ends;

typedef struct {
    fp3_line *lines; /* the caller frees them */
    uint32_t count, moves;
    uint32_t spills;    /* loads and stores */
    uint32_t registers; /* highest in use + 1 */
    uint64_t left;      /* owners that were in their registers before `out` asked for others */
} fp3_spilled;

/* order[p] is the node at position p. FP3_E_LIMIT, without words: it does not fit even so. */
fp3_status fp3_spill(const fp3_block *block, const uint32_t *order, const fp3_spill_ends *ends,
                     fp3_spilled *made, fp3_error *error);

#endif
