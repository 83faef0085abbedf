/* SPDX-License-Identifier: Apache-2.0 */
/* threads.h - threads that live as long as their owner, and help him with a task.
 *
 * They are started when they are first wanted. Who comes late finds the task done: the owner waits
 * only for those that have begun, so help never takes longer than to ask for it.
 *
 *     fp3_threads_run(threads, task, of, 4);
 */
#ifndef FP3_THREADS_H
#define FP3_THREADS_H

#include <fp3/status.h>
#include <stdint.h>

typedef struct fp3_threads fp3_threads;

/* At least 1. */
uint32_t fp3_threads_processors(void);

/* No more than `most` at once, the caller's own among them. The caller frees *threads. */
fp3_status fp3_threads_make(uint32_t most, fp3_threads **threads, fp3_error *error);
void fp3_threads_free(fp3_threads **threads);

/* Calls task(of, 0) here and task(of, number), for numbers below count, in those threads that are
 * free before that one has come to its end. So any of these calls does all that is left to do. */
void fp3_threads_run(fp3_threads *threads, void (*task)(void *of, uint32_t number), void *of,
                     uint32_t count);

#endif
