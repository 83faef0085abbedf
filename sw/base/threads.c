/* SPDX-License-Identifier: Apache-2.0 */
/* threads.c - see threads.h.
 *
 * Stages have numbers that grow, and of each part there is a word with the last stage in which it
 * was taken, and one with the last in which it was done. So neither is ever set back, and who comes
 * with an old stage finds all of its parts taken. Whoever has seen that all parts of a stage are
 * done goes on to the next one: nobody has to tell him.
 *
 * What two processors write in turn costs both a quarter of a microsecond each time, so a thread
 * that is in time writes two lines of its own, and reads one of each other thread.
 */
#include "threads.h"

#include "fpu.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* How often one looks for what comes next, some 100 us, which is what it takes to wake; how long he
 * sleeps then, in ns. */
#define LOOKS 7000
#define NAP 50000
/* Naps, of 1 ms together, after which whoever has the part has lost his processor. */
#define NAPS 10
/* Looks for a part until another does it: 5 us. */
#define LATE 400

typedef void part_fn(void *of, uint32_t from, uint32_t to);

/* What the owner asks for: a stage, or a list of them. number: of the first stage; while the rest
 * is written 0. So who reads the rest between two looks at the same number has what belongs
 * together. */
typedef struct {
    _Alignas(64) _Atomic(uint64_t) number;
    _Atomic(const fp3_lap *) list; /* NULL: one stage, which is what follows */
    _Atomic(part_fn *) part;
    _Atomic(void *) of;
    _Atomic(uint32_t) first, end, count; /* of stages; of parts, if there is one */
} order;

/* Of a part, which is first of all that of the thread with the same number: the last stage in which
 * it was done; in which it was taken. Others read the latter only if it is late. */
typedef struct {
    _Alignas(64) _Atomic(uint64_t) done;
    _Alignas(64) _Atomic(uint64_t) taken;
    _Alignas(64) _Atomic(uint64_t) seen; /* of a thread: the last order that it has seen */
} station;

struct fp3_threads {
    order order;
    _Alignas(64) uint64_t number,
        before;                  /* the owner's own: of the last stage; of the order before */
    uint32_t started, startable; /* startable: fewer than `most` once one has not started */
    pid_t process;
    int was_held_up;
    _Alignas(64) station *stations;
    uint32_t processors, most;
    /* Up to this stage the owner wants no more help: somebody began a part and lost his processor.
     */
    _Atomic(uint64_t) closed;
    _Alignas(64) atomic_uint inside; /* how many may read a list */
    atomic_uint named, asleep;
    atomic_int is_ending;
    pthread_mutex_t lock;
    pthread_cond_t work;
    pthread_t thread[];
};

/* ---- to wait ---- */

/* Where threads have to share processors, who looks is in the way of who works. */
static uint32_t looks(const fp3_threads *t) { return t->most <= t->processors ? LOOKS : LATE; }

static void be_patient(const fp3_threads *t, uint32_t *looked) {
    if (++*looked <= looks(t))
        fp3_fpu_pause();
    else
        nanosleep(&(struct timespec){.tv_nsec = NAP}, NULL);
}

static int is_asked(fp3_threads *t, uint64_t last) {
    return atomic_load(&t->order.number) > last || atomic_load(&t->is_ending);
}

static void wait_for_work(fp3_threads *t, uint64_t last) {
    for (uint32_t i = looks(t); i > 0 && !is_asked(t, last); i--)
        fp3_fpu_pause();
    if (is_asked(t, last))
        return;
    pthread_mutex_lock(&t->lock);
    atomic_fetch_add(&t->asleep, 1);
    while (!is_asked(t, last))
        pthread_cond_wait(&t->work, &t->lock);
    atomic_fetch_sub(&t->asleep, 1);
    pthread_mutex_unlock(&t->lock);
}

/* ---- to work ---- */

static uint32_t begin_of(const fp3_lap *s, uint32_t part) {
    return s->first + (uint32_t)((uint64_t)(s->end - s->first) * part / s->parts);
}

static int take(station *of, uint64_t number) {
    uint64_t taken = atomic_load_explicit(&of->taken, memory_order_acquire);
    return taken < number && atomic_compare_exchange_strong(&of->taken, &taken, number);
}

static void end(station *of, uint64_t number) {
    atomic_store_explicit(&of->done, number, memory_order_release);
}

/* Who does a part: who has seen the order `before` is expected, unless somebody was late in the
 * last stage. */
typedef struct {
    uint32_t own;
    uint64_t before, end; /* end: the last stage of this order */
    int is_late;
} worker;

static int is_closed(fp3_threads *t, uint64_t number) {
    return atomic_load_explicit(&t->closed, memory_order_relaxed) >= number;
}

static int do_part(fp3_threads *t, const fp3_lap *s, uint64_t number, uint32_t k, const worker *w) {
    if ((w->own && is_closed(t, number)) || !take(&t->stations[k], number))
        return 0;
    s->part(s->of, begin_of(s, k), begin_of(s, k + 1));
    end(&t->stations[k], number);
    return 1;
}

static uint32_t patience(const worker *w, station *of) {
    const uint64_t seen = atomic_load_explicit(&of->seen, memory_order_relaxed);
    return w->is_late || seen < w->before ? 0 : LATE;
}

/* Whether it had to be done for another. */
static int wait_for(fp3_threads *t, const fp3_lap *s, uint64_t number, uint32_t k, worker *w) {
    station *of = &t->stations[k];
    uint32_t looked = 0, most = patience(w, of);
    while (atomic_load_explicit(&of->done, memory_order_acquire) < number) {
        if (looked >= most) {
            if (do_part(t, s, number, k, w))
                return 1;
            most = UINT32_MAX; /* it has begun: to look again would only disturb */
        }
        be_patient(t, &looked);
    }
    if (w->own == 0 && looked > looks(t) + NAPS) {
        t->was_held_up = 1;
        atomic_store_explicit(&t->closed, w->end, memory_order_relaxed);
        w->is_late = 1;
    }
    return 0;
}

/* One's own part, then those of whoever is late. */
static void do_stage(fp3_threads *t, const fp3_lap *s, uint64_t number, worker *w) {
    int is_late = s->parts == 1 && w->is_late;
    if (w->own < s->parts)
        do_part(t, s, number, w->own, w);
    for (uint32_t k = 0; k < s->parts; k++)
        is_late |= wait_for(t, s, number, k, w);
    w->is_late = is_late || is_closed(t, number);
}

static void do_list(fp3_threads *t, const fp3_lap *list, uint32_t count, uint64_t number,
                    worker *w) {
    for (uint32_t i = 0; i < count; i++)
        do_stage(t, &list[i], number + i, w);
}

/* Whether there is something new. */
static int look_up(fp3_threads *t, uint64_t *last, fp3_lap *s, const fp3_lap **list) {
    order *o = &t->order;
    const uint64_t number = atomic_load_explicit(&o->number, memory_order_acquire);
    if (number <= *last)
        return 0;
    *list = atomic_load_explicit(&o->list, memory_order_acquire);
    *s = (fp3_lap){atomic_load_explicit(&o->part, memory_order_acquire),
                   atomic_load_explicit(&o->of, memory_order_acquire),
                   atomic_load_explicit(&o->first, memory_order_acquire),
                   atomic_load_explicit(&o->end, memory_order_acquire),
                   atomic_load_explicit(&o->count, memory_order_acquire)};
    if (atomic_load_explicit(&o->number, memory_order_relaxed) != number)
        return 0;
    *last = number;
    return 1;
}

static void *help(void *user) {
    fp3_threads *t = user;
    const uint32_t own = atomic_fetch_add(&t->named, 1) + 1;
    uint64_t last = 0;
    fp3_lap s;
    const fp3_lap *list;
    while (!atomic_load(&t->is_ending)) {
        if (!look_up(t, &last, &s, &list)) {
            wait_for_work(t, last);
            continue;
        }
        atomic_store_explicit(&t->stations[own].seen, last, memory_order_relaxed);
        if (!list) {
            do_stage(t, &s, last, &(worker){.own = own});
            continue;
        }
        atomic_fetch_add(&t->inside, 1);
        if (atomic_load(&t->order.number) == last) /* else it may be changing */
            do_list(t, list, s.parts, last, &(worker){.own = own});
        atomic_fetch_sub(&t->inside, 1);
    }
    return NULL;
}

/* ---- of the owner ---- */

uint32_t fp3_threads_processors(void) {
    cpu_set_t set;
    const int processors = sched_getaffinity(0, sizeof set, &set)
                               ? (int)sysconf(_SC_NPROCESSORS_ONLN) /* more than a set has */
                               : CPU_COUNT(&set);
    return processors > 1 ? (uint32_t)processors : 1;
}

/* Of 64 bytes each, at least one; NULL: there is no memory. */
static void *lines(size_t size) {
    const size_t whole = (size + 64) / 64 * 64;
    void *made = aligned_alloc(64, whole);
    return made ? memset(made, 0, whole) : NULL;
}

fp3_status fp3_threads_make(uint32_t most, fp3_threads **threads, fp3_error *error) {
    fp3_threads *t = *threads = lines(sizeof *t + most * sizeof t->thread[0]);
    if (t)
        t->stations = lines(most * sizeof *t->stations);
    if (!t || !t->stations) {
        free(t);
        *threads = NULL;
        return fp3_no_memory(error);
    }
    t->most = most;
    t->startable = most - 1;
    t->process = getpid();
    atomic_store(&t->stations[0].seen, UINT64_MAX);
    t->processors = fp3_threads_processors();
    pthread_mutex_init(&t->lock, NULL);
    pthread_cond_init(&t->work, NULL);
    return FP3_OK;
}

/* The child of a fork has none of the threads: it starts its own. Between two calls of the owner no
 * part is left that they had begun. */
static void forget_those_of_a_parent(fp3_threads *t) {
    if (t->process == getpid())
        return;
    t->process = getpid();
    t->started = 0;
    t->startable = t->most - 1;
    atomic_store(&t->named, 0);
    atomic_store(&t->inside, 0);
    atomic_store(&t->asleep, 0);
    pthread_mutex_init(&t->lock, NULL); /* one of them may have had it */
    pthread_cond_init(&t->work, NULL);
}

static void wake(fp3_threads *t) {
    forget_those_of_a_parent(t);
    pthread_mutex_lock(&t->lock);
    pthread_cond_broadcast(&t->work);
    pthread_mutex_unlock(&t->lock);
}

void fp3_threads_free(fp3_threads **threads) {
    fp3_threads *t = *threads;
    if (!t)
        return;
    atomic_store(&t->is_ending, 1);
    wake(t);
    for (uint32_t i = 0; i < t->started; i++)
        pthread_join(t->thread[i], NULL);
    pthread_cond_destroy(&t->work);
    pthread_mutex_destroy(&t->lock);
    free(t->stations);
    free(t);
    *threads = NULL;
}

/* One that does not start leaves its part to the others; to try again at each stage would take
 * longer than the stage. */
static void start(fp3_threads *t, uint32_t count) {
    while (t->started + 1 < count && t->started < t->startable) {
        if (pthread_create(&t->thread[t->started], NULL, help, t))
            t->startable = t->started;
        else
            t->started++;
    }
}

static void post(fp3_threads *t, const fp3_lap *list, fp3_lap s, uint64_t number) {
    order *o = &t->order;
    atomic_store_explicit(&o->number, 0, memory_order_relaxed);
    atomic_store_explicit(&o->list, list, memory_order_release);
    atomic_store_explicit(&o->part, s.part, memory_order_release);
    atomic_store_explicit(&o->of, s.of, memory_order_release);
    atomic_store_explicit(&o->first, s.first, memory_order_release);
    atomic_store_explicit(&o->end, s.end, memory_order_release);
    atomic_store_explicit(&o->count, s.parts, memory_order_release);
    atomic_store(&o->number, number);
    if (atomic_load(&t->asleep))
        wake(t);
}

int fp3_threads_held_up(fp3_threads *t) {
    const int was = t && t->was_held_up;
    if (t)
        t->was_held_up = 0;
    return was;
}

uint32_t fp3_threads_most(const fp3_threads *t) { return t ? t->most : 1; }

uint32_t fp3_threads_parts(const fp3_threads *t, uint32_t count, uint32_t least) {
    const uint32_t worth = t ? count / least : 1;
    return worth < 2 ? 1 : worth < t->most ? worth : t->most;
}

static void do_alone(const fp3_lap *s) {
    if (s->first < s->end)
        s->part(s->of, s->first, s->end);
}

void fp3_threads_share(fp3_threads *t, fp3_lap s) {
    if (s.parts == 1 || t->was_held_up) {
        do_alone(&s);
        return;
    }
    start(t, s.parts);
    post(t, NULL, s, ++t->number);
    do_stage(t, &s, t->number, &(worker){.before = t->before, .end = t->number});
    t->before = t->number;
}

void fp3_threads_do(fp3_threads *t, const fp3_lap *list, uint32_t count) {
    uint32_t most = 1;
    for (uint32_t i = 0; i < count; i++)
        most = list[i].parts > most ? list[i].parts : most;
    if (most == 1 || t->was_held_up) {
        for (uint32_t i = 0; i < count; i++)
            do_alone(&list[i]);
        return;
    }
    const uint64_t number = t->number + 1;
    t->number += count;
    start(t, most);
    post(t, list, (fp3_lap){.parts = count}, number);
    do_list(t, list, count, number, &(worker){.before = t->before, .end = t->number});
    t->before = number;
}

void fp3_threads_let_go(fp3_threads *t) {
    uint32_t looked = 0;
    if (!t)
        return;
    atomic_store(&t->order.number, 0);
    if (atomic_load(&t->inside))
        forget_those_of_a_parent(t);
    while (atomic_load(&t->inside))
        be_patient(t, &looked);
}

typedef struct {
    void (*task)(void *of, uint32_t number);
    void *of;
} task;

static void begin_task(void *of, uint32_t from, uint32_t to) {
    const task *own = of;
    (void)to;
    own->task(own->of, from);
}

void fp3_threads_run(fp3_threads *t, void (*own)(void *of, uint32_t number), void *of,
                     uint32_t count) {
    task made = {own, of};
    if (count < 2) {
        own(of, 0);
        return;
    }
    const fp3_lap s = {begin_task, &made, 0, count, count};
    const uint64_t number = ++t->number;
    start(t, count);
    atomic_store_explicit(&t->stations[0].taken, number, memory_order_relaxed);
    post(t, NULL, s, number);
    own(of, 0);
    end(&t->stations[0], number);
    for (uint32_t k = 1; k < count; k++) /* nothing is left */
        if (take(&t->stations[k], number))
            end(&t->stations[k], number);
    for (uint32_t k = 1; k < count; k++)
        wait_for(t, &s, number, k, &(worker){.end = number});
    t->before = number;
}
