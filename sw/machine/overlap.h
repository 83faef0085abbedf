/* SPDX-License-Identifier: Apache-2.0 */
/* overlap.h - cycles of the sweeps of a visit, where those of sums and of products overlap
 * (`dual`).
 *
 * A sweep begins when its unit is free, and at least GAP cycles after the one before. Nothing else
 * makes it wait, so each begins in a cycle that is known.
 */
#ifndef FP3_OVERLAP_H
#define FP3_OVERLAP_H

#include "operation.h"

#include <stdint.h>

/* The words of a visit: loads and first part; so many times the words step .. last - 1; last part
 * and stores. */
typedef struct {
    const fp3_decoded *code; /* of which only the operations count */
    uint32_t count, step, last;
    uint64_t steps;
} fp3_swept;

/* From the first issue of a visit of n contexts after another, to its last issue and beyond: in
 * turns. Zero it for the beginning of a round. */
typedef struct {
    uint64_t soonest;           /* the next sweep does not begin before */
    uint64_t adder, multiplier; /* when each is free */
} fp3_overlap;

/* One visit of n contexts. gap: from sweep to sweep. */
void fp3_overlap_visit(fp3_overlap *now, const fp3_swept *visit, uint32_t n, uint32_t gap);

/* The cycle after the last issue. */
uint64_t fp3_overlap_end(const fp3_overlap *now);

/* Cycles that a step takes in the long run, with n contexts. */
double fp3_overlap_step(const fp3_swept *visit, uint32_t n, uint32_t gap);

#endif
