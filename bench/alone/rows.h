/* SPDX-License-Identifier: Apache-2.0 */
/* rows.h - what build/bench/alone measures, a row of JSON each. */
#ifndef FP3_ALONE_ROWS_H
#define FP3_ALONE_ROWS_H

#include <stdint.h>

/* rate: words of memory in 1,000 cycles. waits: a seed, 0: no channel waits. */
void measure_load(const char *config, uint32_t objects, uint32_t rate, uint32_t latency,
                  uint64_t waits);

/* image: kepler by rk4. steps: of each visit of a chunk, and of the run. The words that it ends
 * with must be those of the engine fast. */
void measure_chunks(const char *config, const char *image, uint32_t objects, uint32_t steps,
                    uint32_t rate, uint32_t latency);

/* A run of a scene: one group of objects that see each other by links, or are near. */
typedef struct {
    const char *scene;
    uint32_t steps, from; /* how many, after so many others */
    double roam;          /* how far near objects may go meanwhile */
} linked_run;

/* The words that it ends with must be those of the engine fast. */
void measure_linked(const char *config, const linked_run *run, uint32_t rate, uint32_t latency);

/* Writes what memory has to be from byte address `at` on, words of 32 bits, low byte first; no
 * hardware is needed. The row has the rest: `list`, where the list of transfers begins; `runs`, of
 * words that steps store where they begin before and after, and how many an object has; `places`,
 * where each object is within them; hashes of these words before and after the steps. */
void image_linked(const char *config, const linked_run *run, uint32_t at, const char *image);

#endif
