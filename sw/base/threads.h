/* SPDX-License-Identifier: Apache-2.0 */
/* threads.h - threads that live as long as their owner, and help him.
 *
 * They are started when they are first wanted. Each part of a work has a thread that does it if it
 * is there in time; who comes late finds it done by another, and the owner waits only for parts
 * that have begun; once he has had to wait for long he does the rest alone. Who waits looks for
 * some 100 us, then sleeps.
 *
 *     fp3_threads_run(threads, task, of, 4);                       shares itself out
 *     fp3_threads_do(threads, &(fp3_lap){add, rows, 0, 1000, 4}, 1);      a range in four parts
 */
#ifndef FP3_THREADS_H
#define FP3_THREADS_H

#include <fp3/status.h>
#include <stdint.h>

typedef struct fp3_threads fp3_threads;

/* Calls part(of, from, to) for `parts` ranges that make up first .. end-1. What a part does must
 * not depend on which thread does it, and when. */
typedef struct {
    void (*part)(void *of, uint32_t from, uint32_t to);
    void *of;
    uint32_t first, end;
    uint32_t parts; /* 1 or more */
} fp3_lap;

/* At least 1. */
uint32_t fp3_threads_processors(void);

/* No more than `most` at once, the caller's own among them. The caller frees *threads. */
fp3_status fp3_threads_make(uint32_t most, fp3_threads **threads, fp3_error *error);
void fp3_threads_free(fp3_threads **threads);

/* Calls task(of, 0) here and task(of, number), for numbers below count, in those threads that are
 * free before that one has come to its end. So any of these calls does all that is left to do.
 * count: no more than `most`. */
void fp3_threads_run(fp3_threads *threads, void (*task)(void *of, uint32_t number), void *of,
                     uint32_t count);

/* Whether the owner has had to sleep since the last call, as others began a part and lost their
 * processor. From then on until this call he does stages alone. */
int fp3_threads_held_up(fp3_threads *threads);
/* `most`; 1 of NULL. */
uint32_t fp3_threads_most(const fp3_threads *threads);
/* How many parts a range of `count` should have, each of at least `least`. threads may be NULL,
 * here and below: the caller's alone. */
uint32_t fp3_threads_parts(const fp3_threads *threads, uint32_t count, uint32_t least);
/* Does these stages: none begins before all parts of the one before have ended. Who is late may
 * still read the list afterwards: before it is changed or freed, fp3_threads_let_go is called. To
 * do a list that has not changed costs least. */
void fp3_threads_do(fp3_threads *threads, const fp3_lap *stages, uint32_t count);
/* Until nobody reads a list. */
void fp3_threads_let_go(fp3_threads *threads);
/* One stage, which nobody reads afterwards. */
void fp3_threads_share(fp3_threads *threads, fp3_lap stage);

#endif
