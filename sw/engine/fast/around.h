/* SPDX-License-Identifier: Apache-2.0 */
/* around.h - a phase of objects that see each other, a block of them at a time.
 *
 * Objects are columns, as in fast.h. A word that neighbours read and a phase stores has two
 * columns: a phase reads `own` and `seen`, and writes `next`.
 */
#ifndef FP3_FAST_AROUND_H
#define FP3_FAST_AROUND_H

#include "fast.h"
#include "pack.h"

/* What a phase of a group works on. */
typedef struct {
    uint32_t *const *own, *const *next; /* [64]: of the group's first object on */
    const uint32_t *constants;          /* [64] */
    const fp3_fast_packed *lists;
    float *records;   /* fp3_fast_records of them, or NULL where no list needs them */
    uint32_t objects; /* of the group */
} fp3_fast_group;

/* Of its vectors; 0: it is interpreted. */
unsigned fp3_fast_native_lanes(const fp3_fast *fast);
uint32_t fp3_fast_phases(const fp3_fast *fast);
/* How many phases a step makes, and which is the n-th of them. */
uint32_t fp3_fast_made(const fp3_fast *fast);
uint32_t fp3_fast_phase_at(const fp3_fast *fast, uint32_t n);
/* Words that change and that neighbours read: they have two columns. */
uint64_t fp3_fast_doubled(const fp3_fast *fast);
/* Floats that the records of so many objects take. */
size_t fp3_fast_records(const fp3_fast *fast, uint32_t objects);
/* Objects first .. first + count - 1 of the group make a phase, or, as phase number
 * fp3_fast_phases, their records; first is a multiple of FP3_BLOCK. What they raise is the
 * worker's. */
void fp3_fast_phase(const fp3_fast *fast, fp3_fast_worker *worker, const fp3_fast_group *group,
                    uint32_t phase, uint32_t first, uint32_t count);

#endif
