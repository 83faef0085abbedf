/* SPDX-License-Identifier: Apache-2.0 */
/* threads.c - see threads.h. */
#include "threads.h"

#include "fpu.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <unistd.h>

/* How often one looks for what comes next before it sleeps: to wake it takes longer than many a
 * task. Some 20 us. */
#define LOOKS 1000

struct fp3_threads {
    atomic_uint asked; /* how often there was something new: to be seen without the lock */
    atomic_uint busy;  /* helpers that have a number; changed with the lock */
    uint32_t processors;
    pthread_mutex_t lock; /* of all that follows */
    pthread_cond_t work, done;
    void (*task)(void *of, uint32_t number);
    void *of;
    uint32_t next, count; /* numbers not taken yet */
    uint32_t started, most;
    int is_ending;
    pthread_t thread[];
};

/* Where threads have to share processors, who looks is in the way of who works. */
static int looks(const fp3_threads *t) { return t->count <= t->processors ? LOOKS : 0; }

static void wait_for_work(fp3_threads *t) {
    const unsigned asked = atomic_load(&t->asked);
    const int most = looks(t);
    pthread_mutex_unlock(&t->lock);
    for (int i = 0; i < most && atomic_load(&t->asked) == asked; i++)
        fp3_fpu_pause();
    pthread_mutex_lock(&t->lock);
    if (atomic_load(&t->asked) == asked)
        pthread_cond_wait(&t->work, &t->lock);
}

static void *help(void *user) {
    fp3_threads *t = user;
    pthread_mutex_lock(&t->lock);
    while (!t->is_ending) {
        if (t->next >= t->count) {
            wait_for_work(t);
            continue;
        }
        const uint32_t number = t->next++;
        atomic_fetch_add(&t->busy, 1);
        pthread_mutex_unlock(&t->lock);
        t->task(t->of, number);
        pthread_mutex_lock(&t->lock);
        if (atomic_fetch_sub(&t->busy, 1) == 1)
            pthread_cond_signal(&t->done);
    }
    pthread_mutex_unlock(&t->lock);
    return NULL;
}

uint32_t fp3_threads_processors(void) {
    cpu_set_t set;
    const int processors = sched_getaffinity(0, sizeof set, &set)
                               ? (int)sysconf(_SC_NPROCESSORS_ONLN) /* more than a set has */
                               : CPU_COUNT(&set);
    return processors > 1 ? (uint32_t)processors : 1;
}

fp3_status fp3_threads_make(uint32_t most, fp3_threads **threads, fp3_error *error) {
    fp3_threads *t = *threads = calloc(1, sizeof *t + most * sizeof t->thread[0]);
    if (!t)
        return fp3_no_memory(error);
    t->most = most;
    t->processors = fp3_threads_processors();
    pthread_mutex_init(&t->lock, NULL);
    pthread_cond_init(&t->work, NULL);
    pthread_cond_init(&t->done, NULL);
    return FP3_OK;
}

void fp3_threads_free(fp3_threads **threads) {
    fp3_threads *t = *threads;
    if (!t)
        return;
    pthread_mutex_lock(&t->lock);
    t->is_ending = 1;
    atomic_fetch_add(&t->asked, 1);
    pthread_cond_broadcast(&t->work);
    pthread_mutex_unlock(&t->lock);
    for (uint32_t i = 0; i < t->started; i++)
        pthread_join(t->thread[i], NULL);
    pthread_cond_destroy(&t->done);
    pthread_cond_destroy(&t->work);
    pthread_mutex_destroy(&t->lock);
    free(t);
    *threads = NULL;
}

/* One that does not start leaves its part to the others. */
static void start(fp3_threads *t, uint32_t count) {
    while (t->started + 1 < count && t->started + 1 < t->most &&
           !pthread_create(&t->thread[t->started], NULL, help, t))
        t->started++;
}

void fp3_threads_run(fp3_threads *t, void (*task)(void *of, uint32_t number), void *of,
                     uint32_t count) {
    if (count > 1) {
        pthread_mutex_lock(&t->lock);
        t->task = task;
        t->of = of;
        t->count = count;
        t->next = 1;
        atomic_fetch_add(&t->asked, 1);
        start(t, count);
        pthread_cond_broadcast(&t->work);
        pthread_mutex_unlock(&t->lock);
    }
    task(of, 0);
    if (count > 1) {
        pthread_mutex_lock(&t->lock);
        t->next = t->count;
        pthread_mutex_unlock(&t->lock);
        for (int i = 0; i < looks(t) && atomic_load(&t->busy); i++)
            fp3_fpu_pause();
        pthread_mutex_lock(&t->lock);
        while (atomic_load(&t->busy))
            pthread_cond_wait(&t->done, &t->lock);
        pthread_mutex_unlock(&t->lock);
    }
}
