/* SPDX-License-Identifier: Apache-2.0 */
/* placement.h - which schedulers run which group of objects, so that all end as early as possible.
 *
 * A scheduler with its lanes runs one program; a group may have several, and its objects then go
 * round all their lanes.
 */
#ifndef FP3_PLACEMENT_H
#define FP3_PLACEMENT_H

#include "operation.h"

#include <fp3/status.h>
#include <stddef.h>

/* What the instruction memory gets: the image's words; interleaved, with loads and stores around.
 */
typedef struct {
    const uint32_t *code;
    const fp3_decoded *decoded; /* each word of code */
    uint32_t count, step, last;
    uint32_t in_front; /* words before the image's own */
    int slept;         /* the register that `sleep` writes; -1: none does */
} fp3_code;

/* A group to be placed. */
typedef struct {
    const fp3_code *program;
    uint32_t objects; /* at least 1 */
    uint32_t log2;    /* interleaved: of the words that the program needs of each in the store */
} fp3_to_place;

/* Objects of a lane, at most: their numbers have 16 bits, and the smallest record has 8 words. */
#define FP3_RECORD_LOG2 3u
uint32_t fp3_placement_rows(const fp3_config *config, uint32_t log2);
/* store_words of an engine whose store is the host's memory. */
#define FP3_STORE_HOST UINT32_MAX
#define FP3_HOST_OBJECTS (UINT32_C(1) << 25)
/* Objects of a configuration, at most. */
uint32_t fp3_placement_room(const fp3_config *config);

/* The number of objects in the fullest lane, if the group has so many schedulers. */
uint32_t fp3_placement_fullest(const fp3_config *config, uint32_t objects, uint32_t schedulers);

/* Cycles that a scheduler needs for one round of visits to so many objects in its fullest lane, if
 * no object sleeps and no other scheduler wants the arithmetic. A visit is so many steps; 0: all of
 * a run, taken to be many. Never falls with rows. */
uint64_t fp3_placement_cycles(const fp3_config *config, const fp3_code *program, uint32_t visit,
                              uint32_t rows);

/* group_of[scheduler] for each scheduler of the configuration. FP3_E_PROGRAM: there are too few, or
 * there is too little room in their stores. */
fp3_status fp3_placement_make(const fp3_config *config, uint32_t visit, const fp3_to_place *groups,
                              size_t count, uint32_t *group_of, fp3_error *error);

#endif
