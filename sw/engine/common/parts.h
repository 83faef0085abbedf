/* SPDX-License-Identifier: Apache-2.0 */
/* parts.h - a work in parts, each taken by a thread that is free. */
#ifndef FP3_ENGINE_PARTS_H
#define FP3_ENGINE_PARTS_H

#include <stdint.h>

/* Threads that share a work: `run` is as fp3_tasks_fn of fp3/engine.h. */
typedef struct {
    void (*run)(void *user, void (*task)(void *of, uint32_t number), void *of, uint32_t count);
    void *user;
    uint32_t count;
} fp3_crew;

/* Into how many parts a work is divided: more than threads, which do not all begin at once. 1 if
 * crew is NULL. */
uint32_t fp3_parts_of(const fp3_crew *crew);

/* Calls make(of, part) once for each number below count, and returns when all calls have returned.
 * crew may be NULL if count is 1. */
void fp3_parts_make(const fp3_crew *crew, void (*make)(void *of, uint32_t part), void *of,
                    uint32_t count);

/* The first of some things in a part of `count`. */
static inline uint32_t fp3_part_begin(uint32_t things, uint32_t part, uint32_t count) {
    return (uint32_t)((uint64_t)things * part / count);
}

#endif
